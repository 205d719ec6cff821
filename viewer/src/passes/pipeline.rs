//! Shaders and what pipelines differ in → pipelines.

use super::shaders::{ShaderError, Shaders};
use super::{DEPTH, DISPLAY, Layouts, RADIANCE, SHADE, SHADOW};
use crate::gpu::Gpu;
use wgpu::{BindGroupLayout, ComputePipeline, ComputePipelineDescriptor};

/// A pass's WGSL, and the numbers that it has in common with Rust.
#[derive(Debug)]
pub struct Shader {
    /// The file's name without its ending. Also names the pass where times are shown.
    pub name: &'static str,
    /// As it was built in; [`Shaders`] may know a newer one.
    pub source: &'static str,
    /// The value of each `override` that it declares.
    pub constants: &'static [(&'static str, f64)],
}

/// What pipelines are compiled with.
pub(super) struct Compiler<'a> {
    pub gpu: &'a Gpu,
    pub layouts: &'a Layouts,
    pub shaders: &'a Shaders,
    /// Samples a pixel of the picture: 1 or 4.
    pub samples: u32,
}

/// A compiled shader.
pub(super) struct Module {
    module: wgpu::ShaderModule,
    shader: &'static Shader,
}

/// What a pipeline draws into.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Target {
    /// Radiance with reversed depth.
    Radiance,
    /// The same with one sample a pixel, whatever the picture has.
    Mirror,
    /// The mean of radiance, one sample a pixel.
    Mean,
    /// Values for the screen.
    Display,
    /// Depth from the sun alone.
    Shadow,
    /// How much of the sun's light arrives.
    Shade,
}

/// What a render pipeline differs in.
pub(super) struct PipelineDesc<'a> {
    pub shader: &'a Module,
    pub vertex: &'a str,
    pub fragment: Option<&'a str>,
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub groups: &'a [&'a BindGroupLayout],
    pub topology: wgpu::PrimitiveTopology,
    pub cull: Option<wgpu::Face>,
    pub blend: Option<wgpu::BlendState>,
    pub depth_write: bool,
    pub wireframe: bool,
    pub target: Target,
}

impl<'a> PipelineDesc<'a> {
    /// Filled triangles with two sides that hide what is behind, from the entry points "vertex" and "fragment" into
    /// radiance: what most passes draw.
    pub fn new(shader: &'a Module, groups: &'a [&'a BindGroupLayout]) -> Self {
        Self {
            shader,
            vertex: "vertex",
            fragment: Some("fragment"),
            buffers: &[],
            groups,
            topology: wgpu::PrimitiveTopology::TriangleList,
            cull: None,
            blend: None,
            depth_write: true,
            wireframe: false,
            target: Target::Radiance,
        }
    }
}

impl Module {
    fn options(&self) -> wgpu::PipelineCompilationOptions<'static> {
        wgpu::PipelineCompilationOptions { constants: self.shader.constants, ..Default::default() }
    }
}

impl Compiler<'_> {
    pub fn module(&self, shader: &'static Shader) -> Result<Module, ShaderError> {
        Ok(Module { module: self.shaders.module(&self.gpu.device, shader.name)?, shader })
    }

    fn layout(&self, label: &str, groups: &[Option<&BindGroupLayout>]) -> wgpu::PipelineLayout {
        self.gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: groups,
            immediate_size: 0,
        })
    }

    /// A compute pipeline. `None` is a group that it does not use: group 0 is what `common.wgsl` declares.
    pub fn compute(
        &self,
        shader: &Module,
        groups: [Option<&BindGroupLayout>; 2],
        entry: &str,
    ) -> ComputePipeline {
        self.gpu.device.create_compute_pipeline(&ComputePipelineDescriptor {
            label: Some(entry),
            layout: Some(&self.layout(shader.shader.name, &groups)),
            module: &shader.module,
            entry_point: Some(entry),
            compilation_options: shader.options(),
            cache: None,
        })
    }

    pub fn pipeline(&self, desc: &PipelineDesc<'_>) -> wgpu::RenderPipeline {
        use wgpu::CompareFunction::{GreaterEqual, Less};
        let (color, depth, samples) = match desc.target {
            Target::Radiance => (Some(RADIANCE), Some((DEPTH, GreaterEqual)), self.samples),
            Target::Mirror => (Some(RADIANCE), Some((DEPTH, GreaterEqual)), 1),
            Target::Mean => (Some(RADIANCE), None, 1),
            Target::Display => (Some(DISPLAY), None, 1),
            Target::Shadow => (None, Some((SHADOW, Less)), 1),
            Target::Shade => (Some(SHADE), None, 1),
        };
        let write_mask = wgpu::ColorWrites::ALL;
        let color = color.map(|format| wgpu::ColorTargetState { format, blend: desc.blend, write_mask });
        let label = desc.shader.shader.name;
        let groups: Vec<_> = desc.groups.iter().copied().map(Some).collect();
        self.gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(label),
            layout: Some(&self.layout(label, &groups)),
            vertex: wgpu::VertexState {
                module: &desc.shader.module,
                entry_point: Some(desc.vertex),
                compilation_options: desc.shader.options(),
                buffers: desc.buffers,
            },
            primitive: wgpu::PrimitiveState {
                topology: desc.topology,
                strip_index_format: desc.topology.is_strip().then_some(wgpu::IndexFormat::Uint32),
                cull_mode: desc.cull,
                polygon_mode: if desc.wireframe { wgpu::PolygonMode::Line } else { wgpu::PolygonMode::Fill },
                ..Default::default()
            },
            depth_stencil: depth.map(|(format, compare)| wgpu::DepthStencilState {
                format,
                depth_write_enabled: Some(desc.depth_write),
                depth_compare: Some(compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
            fragment: desc.fragment.map(|entry| wgpu::FragmentState {
                module: &desc.shader.module,
                entry_point: Some(entry),
                compilation_options: desc.shader.options(),
                targets: if color.is_some() { std::slice::from_ref(&color) } else { &[] },
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// A vertex buffer's layout, one `T` after the other.
pub(super) fn buffer_layout<T>(
    step_mode: wgpu::VertexStepMode,
    attributes: &[wgpu::VertexAttribute],
) -> Option<wgpu::VertexBufferLayout<'_>> {
    Some(wgpu::VertexBufferLayout { array_stride: size_of::<T>() as u64, step_mode, attributes })
}

/// Pipelines for filled triangles and, where the device can draw them, for their edges.
#[derive(Debug)]
pub(super) struct FilledOrWire<T> {
    filled: T,
    wire: Option<T>,
}

impl<T> FilledOrWire<T> {
    /// `build` is told whether edges are drawn.
    pub fn new(gpu: &Gpu, build: impl Fn(bool) -> T) -> Self {
        let lines = gpu.features.contains(wgpu::Features::POLYGON_MODE_LINE);
        Self { filled: build(false), wire: lines.then(|| build(true)) }
    }

    pub fn get(&self, wireframe: bool) -> &T {
        self.wire.as_ref().filter(|_| wireframe).unwrap_or(&self.filled)
    }
}
