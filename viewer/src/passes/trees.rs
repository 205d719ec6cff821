//! Draws the trees that were chosen: one draw for each material.

use super::cull::TreeLists;
use super::{Layouts, Shape, pipeline};
use crate::gpu::Gpu;
use crate::scene::TreeVertex;
use crate::shaders::{ShaderError, Shaders};
use crate::upload::{DrawCommand, TreeSet};

/// The pipelines, for filled and for wire pictures.
#[derive(Debug)]
pub struct Trees {
    filled: [wgpu::RenderPipeline; 2],
    wire: Option<[wgpu::RenderPipeline; 2]>,
}

const OPAQUE: usize = 0;
const MASKED: usize = 1;

/// Attributes of [`TreeVertex`].
pub const VERTEX: [wgpu::VertexAttribute; 8] = wgpu::vertex_attr_array![
    0 => Float32x3, 1 => Unorm8x4, 2 => Float32x3, 3 => Snorm16x2,
    4 => Float32x2, 5 => Float32x2, 6 => Snorm16x2, 7 => Snorm16x2,
];
/// Attributes of a visible tree: its number and λ.
pub const VISIBLE: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![8 => Uint32, 9 => Float32];

/// The two vertex buffers of every draw of trees.
pub(super) fn buffers() -> [Option<wgpu::VertexBufferLayout<'static>>; 2] {
    [
        Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<TreeVertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &VERTEX,
        }),
        Some(wgpu::VertexBufferLayout {
            array_stride: 8,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &VISIBLE,
        }),
    ]
}

impl Trees {
    /// Compiles them.
    pub fn new(gpu: &Gpu, layouts: &Layouts, shaders: &Shaders, samples: u32) -> Result<Self, ShaderError> {
        let module = shaders.module(&gpu.device, "trees")?;
        let build = |wireframe: bool| {
            [("bark", Some(wgpu::Face::Back)), ("leaf", None)].map(|(fragment, cull)| {
                let groups = [Some(&layouts.view), Some(&layouts.trees), Some(&layouts.material)];
                let buffers = buffers();
                let usual = Shape::new(fragment, &module, &groups, samples);
                let shape = Shape { fragment, buffers: &buffers, cull, wireframe, ..usual };
                pipeline(&gpu.device, &shape)
            })
        };
        let lines = gpu.features.contains(wgpu::Features::POLYGON_MODE_LINE);
        Ok(Self { filled: build(false), wire: lines.then(|| build(true)) })
    }

    /// One draw for each material. Group 0 is set.
    pub fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        set: &TreeSet,
        groups: &TreeGroups,
        lists: &TreeLists,
        wire: bool,
    ) {
        let pipelines = self.wire.as_ref().filter(|_| wire).unwrap_or(&self.filled);
        draw_chosen(pass, set, groups, lists, pipelines);
    }
}

/// Draws the trees that were chosen, with a pipeline for [`OPAQUE`] materials and one for [`MASKED`] ones.
pub(super) fn draw_chosen(
    pass: &mut wgpu::RenderPass<'_>,
    set: &TreeSet,
    groups: &TreeGroups,
    lists: &TreeLists,
    pipelines: &[wgpu::RenderPipeline; 2],
) {
    pass.set_bind_group(1, &groups.trees, &[]);
    pass.set_vertex_buffer(0, set.vertices.slice(..));
    pass.set_vertex_buffer(1, lists.visible.slice(..));
    pass.set_index_buffer(set.indices.slice(..), wgpu::IndexFormat::Uint32);
    for (slot, material) in set.materials.iter().enumerate() {
        pass.set_pipeline(&pipelines[if material.masked { MASKED } else { OPAQUE }]);
        pass.set_bind_group(2, &groups.materials[slot], &[]);
        let first = slot as u64 * u64::from(lists.buckets) * size_of::<DrawCommand>() as u64;
        pass.multi_draw_indexed_indirect(&lists.commands, first, lists.buckets);
    }
}

/// Bind groups of a landscape's trees.
#[derive(Debug)]
pub struct TreeGroups {
    pub(super) trees: wgpu::BindGroup,
    pub(super) materials: Vec<wgpu::BindGroup>,
}

impl TreeGroups {
    /// Of that landscape.
    pub fn new(gpu: &Gpu, layouts: &Layouts, set: &TreeSet) -> Self {
        let trees = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("trees"),
            layout: &layouts.trees,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: set.trees.as_entire_binding() }],
        });
        let material = |material: &crate::upload::TreeMaterial| {
            let views = [&material.color, &material.normal].map(|t| t.create_view(&Default::default()));
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(&material.name),
                layout: &layouts.material,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: material.uniform.as_entire_binding() },
                    wgpu::BindGroupEntry {
                        binding: 1,
                        resource: wgpu::BindingResource::TextureView(&views[0]),
                    },
                    wgpu::BindGroupEntry {
                        binding: 2,
                        resource: wgpu::BindingResource::TextureView(&views[1]),
                    },
                ],
            })
        };
        Self { trees, materials: set.materials.iter().map(material).collect() }
    }
}
