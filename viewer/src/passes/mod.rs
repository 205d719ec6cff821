//! The passes: each an immutable set of pipelines that records its part of a picture, with its WGSL beside it.
//!
//! Order of a picture: choice of trees, then in one render pass trees, grass, land, sky and water, then tones. Shadows are drawn
//! once for each landscape, before its first picture.

mod cull;
pub mod grass;
mod layouts;
mod shadow;
mod sky;
pub mod terrain;
mod tone;
pub mod trees;
mod view_uniform;
mod water;

pub use cull::{Cull, CullUniform, TreeLists};
pub use grass::Grass;
pub use layouts::{Layouts, bind, texture_view};
pub use shadow::Shadow;
pub use sky::Sky;
pub use terrain::{Land, Terrain};
pub use tone::Tone;
pub use trees::{TreeGroups, Trees};
pub use view_uniform::{ViewUniform, focal_px, shadow_from_world};
pub use water::Water;

use crate::gpu::Gpu;
use crate::shaders::{ShaderError, Shaders};

/// Format of radiance.
pub const RADIANCE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Format of depth: floating point, reversed.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Format of finished pictures: encoded values, as the user interface expects them.
pub const DISPLAY: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Format of shadow maps.
pub const SHADOW: wgpu::TextureFormat = wgpu::TextureFormat::Depth16Unorm;

/// All passes.
#[derive(Debug)]
pub struct Passes {
    /// What their bind groups look like.
    pub layouts: Layouts,
    /// Trees seen from the sun.
    pub shadow: Shadow,
    /// Choice of trees and levels.
    pub cull: Cull,
    /// Trees.
    pub trees: Trees,
    /// The land.
    pub terrain: Terrain,
    /// Grass.
    pub grass: Grass,
    /// The sky.
    pub sky: Sky,
    /// The lake.
    pub water: Water,
    /// Tones.
    pub tone: Tone,
    /// Samples a pixel that they draw.
    pub samples: u32,
}

impl Passes {
    /// Compiles everything. `samples` is 1 or 4.
    pub fn new(gpu: &Gpu, shaders: &Shaders, samples: u32) -> Result<Self, ShaderError> {
        let device = &gpu.device;
        let layouts = Layouts::new(gpu);
        Ok(Self {
            shadow: Shadow::new(device, &layouts, shaders)?,
            cull: Cull::new(device, &layouts, shaders)?,
            trees: Trees::new(gpu, &layouts, shaders, samples)?,
            terrain: Terrain::new(gpu, &layouts, shaders, samples)?,
            grass: Grass::new(gpu, &layouts, shaders, samples)?,
            sky: Sky::new(device, &layouts, shaders, samples)?,
            water: Water::new(device, &layouts, shaders, samples)?,
            tone: Tone::new(device, &layouts, shaders)?,
            layouts,
            samples,
        })
    }
}

/// What a pipeline of the main picture differs in.
struct Shape<'a> {
    label: &'a str,
    module: &'a wgpu::ShaderModule,
    vertex: &'a str,
    fragment: &'a str,
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    groups: &'a [Option<&'a wgpu::BindGroupLayout>],
    topology: wgpu::PrimitiveTopology,
    cull: Option<wgpu::Face>,
    blend: Option<wgpu::BlendState>,
    depth_write: bool,
    wireframe: bool,
    samples: u32,
}

impl<'a> Shape<'a> {
    /// Filled triangles with two sides that hide what is behind, from the entry points "vertex" and "fragment": what
    /// most passes draw.
    fn new(
        label: &'a str,
        module: &'a wgpu::ShaderModule,
        groups: &'a [Option<&'a wgpu::BindGroupLayout>],
        samples: u32,
    ) -> Self {
        Self {
            label,
            module,
            vertex: "vertex",
            fragment: "fragment",
            buffers: &[],
            groups,
            topology: wgpu::PrimitiveTopology::TriangleList,
            cull: None,
            blend: None,
            depth_write: true,
            wireframe: false,
            samples,
        }
    }
}

/// A pipeline that draws into radiance with reversed depth.
fn pipeline(device: &wgpu::Device, shape: &Shape<'_>) -> wgpu::RenderPipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(shape.label),
        bind_group_layouts: shape.groups,
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(shape.label),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: shape.module,
            entry_point: Some(shape.vertex),
            compilation_options: Default::default(),
            buffers: shape.buffers,
        },
        primitive: wgpu::PrimitiveState {
            topology: shape.topology,
            strip_index_format: shape.topology.is_strip().then_some(wgpu::IndexFormat::Uint32),
            cull_mode: shape.cull,
            polygon_mode: if shape.wireframe { wgpu::PolygonMode::Line } else { wgpu::PolygonMode::Fill },
            ..Default::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(shape.depth_write),
            depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: wgpu::MultisampleState { count: shape.samples, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: shape.module,
            entry_point: Some(shape.fragment),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: RADIANCE,
                blend: shape.blend,
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
