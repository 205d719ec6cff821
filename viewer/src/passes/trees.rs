//! Draws the trees that culling left: one draw for each material.

use super::shaders::ShaderError;
use super::{BoundScene, BoundTrees, Compiler, DrawPass, FilledOrWire, PipelineDesc, Shader, buffer_layout};
use crate::options::Options;
use crate::scene::TreeVertex;
use crate::upload::{DrawCommand, TreeSet};

pub const SHADER: Shader = Shader { name: "trees", source: include_str!("trees.wgsl"), constants: &[] };

#[derive(Debug)]
pub struct Trees {
    pipelines: FilledOrWire<TreePipelines>,
    bark_strips: FilledOrWire<wgpu::RenderPipeline>,
}

/// One for each kind of material.
#[derive(Debug)]
pub(super) struct TreePipelines {
    pub opaque: wgpu::RenderPipeline,
    pub masked: wgpu::RenderPipeline,
    pub thin: wgpu::RenderPipeline,
    pub clusters: wgpu::RenderPipeline,
}

/// Attributes of [`TreeVertex`].
pub const VERTEX: [wgpu::VertexAttribute; 8] = wgpu::vertex_attr_array![
    0 => Float32x3, 1 => Unorm8x4, 2 => Float32x3, 3 => Snorm16x2,
    4 => Float32x2, 5 => Float32x2, 6 => Snorm16x2, 7 => Snorm16x2,
];
/// Attributes of a visible tree: its number, λ, and which of its pixels are drawn, see `Visible` of `cull.wgsl`.
pub const VISIBLE: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![8 => Uint32, 9 => Float32, 10 => Unorm10_10_10_2];

/// The two vertex buffers of every draw of trees.
pub(super) fn buffers() -> [Option<wgpu::VertexBufferLayout<'static>>; 2] {
    [
        buffer_layout::<TreeVertex>(wgpu::VertexStepMode::Vertex, &VERTEX),
        buffer_layout::<[u32; 3]>(wgpu::VertexStepMode::Instance, &VISIBLE),
    ]
}

impl Trees {
    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let (shader, layouts) = (compiler.module(&SHADER)?, compiler.layouts);
        let (buffers, groups) = (buffers(), [&layouts.view, &layouts.trees, &layouts.material]);
        let bark = |wireframe: bool| {
            let usual = PipelineDesc::new(&shader, &groups);
            let (fragment, cull) = (Some("bark"), Some(wgpu::Face::Back));
            PipelineDesc { vertex: "bark_vertex", fragment, buffers: &buffers, cull, wireframe, ..usual }
        };
        let pipelines = |wireframe: bool| {
            let cards = |fragment: &'static str| {
                let cards = PipelineDesc { vertex: "vertex", cull: None, ..bark(wireframe) };
                compiler.pipeline(&PipelineDesc { fragment: Some(fragment), ..cards })
            };
            let opaque = compiler.pipeline(&bark(wireframe));
            TreePipelines { opaque, masked: cards("leaf"), thin: cards("twig"), clusters: cards("cluster") }
        };
        let bark_strips = |wireframe: bool| {
            let topology = wgpu::PrimitiveTopology::TriangleStrip;
            compiler.pipeline(&PipelineDesc { topology, ..bark(wireframe) })
        };
        Ok(Self {
            pipelines: FilledOrWire::new(compiler.gpu, pipelines),
            bark_strips: FilledOrWire::new(compiler.gpu, bark_strips),
        })
    }
}

impl DrawPass for Trees {
    fn is_needed(&self, bound: &BoundScene, options: &Options) -> bool {
        options.draw_trees && bound.trees().is_some()
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, bound: &BoundScene, options: &Options) -> u32 {
        let Some((set, trees)) = bound.trees() else { return 0 };
        let strips = options.bark_strips.then(|| self.bark_strips.get(options.wireframe));
        self.pipelines.get(options.wireframe).draw(pass, set, trees, strips)
    }
}

impl TreePipelines {
    /// Draws the trees that culling left and tells how many draws that takes. `strips`: draws what is opaque as strips, where
    /// trees have some.
    pub fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        set: &TreeSet,
        bound: &BoundTrees,
        strips: Option<&wgpu::RenderPipeline>,
    ) -> u32 {
        let lists = set.materials.len();
        let strips = strips.filter(|_| set.mesh_draws as usize > lists);
        pass.set_bind_group(1, &bound.trees_group, &[]);
        pass.set_vertex_buffer(0, set.vertices.slice(..));
        pass.set_vertex_buffer(1, bound.visible.slice(..));
        pass.set_index_buffer(set.indices.slice(..), wgpu::IndexFormat::Uint32);
        for (slot, (material, group)) in set.materials.iter().zip(&bound.material_groups).enumerate() {
            let (pipeline, draw) = match strips {
                Some(strips) if !material.masked => (strips, lists + slot),
                _ if material.clusters => (&self.clusters, slot),
                _ if material.thin => (&self.thin, slot),
                _ => (if material.masked { &self.masked } else { &self.opaque }, slot),
            };
            pass.set_pipeline(pipeline);
            pass.set_bind_group(2, group, &[]);
            let first = draw as u64 * u64::from(bound.buckets) * size_of::<DrawCommand>() as u64;
            pass.multi_draw_indexed_indirect(&bound.commands, first, bound.buckets);
        }
        set.materials.len() as u32
    }
}
