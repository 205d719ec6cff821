//! Draws the terrain in one draw, whatever the LOD mode, and the coarse ring around it in another.

use super::shaders::ShaderError;
use super::{BoundScene, Compiler, DrawPass, Elements, FilledOrWire, PipelineDesc, Shader, buffer_layout};
use crate::gpu::Gpu;
use crate::lod::{block, morph};
use crate::lod_mode::TerrainLodMode;
use crate::options::Options;
use crate::upload::RingVertex;

pub const SHADER: Shader = Shader {
    name: "terrain",
    source: include_str!("terrain.wgsl"),
    constants: &[("GAP", morph::GAP as f64), ("BLOCK_VERTICES", (1 << block::BLOCK_BITS) as f64 + 1.0)],
};

/// Attributes of [`block::Block`].
pub const BLOCK: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Uint32x2, 1 => Uint32];
/// Attributes of [`RingVertex`].
pub const RING: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4];

#[derive(Debug)]
pub struct Terrain {
    pipelines: FilledOrWire<Pipelines>,
    block_indices: BlockIndices,
}

/// The triangles of any block.
#[derive(Debug)]
pub(super) struct BlockIndices {
    buffer: wgpu::Buffer,
    count: u32,
}

impl BlockIndices {
    pub fn new(gpu: &Gpu) -> Self {
        let indices = block::block_indices(1 << block::BLOCK_BITS);
        let buffer = gpu.buffer("block triangles", &indices, wgpu::BufferUsages::INDEX);
        Self { buffer, count: indices.len() as u32 }
    }

    /// All of these blocks in one draw.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, blocks: &Elements) {
        pass.set_vertex_buffer(0, blocks.buffer.slice(..));
        pass.set_index_buffer(self.buffer.slice(..), wgpu::IndexFormat::Uint16);
        pass.draw_indexed(0..self.count, 0, 0..blocks.count);
    }
}

#[derive(Debug)]
struct Pipelines {
    blocks: wgpu::RenderPipeline,
    strip: wgpu::RenderPipeline,
    ring: wgpu::RenderPipeline,
}

impl Terrain {
    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        use wgpu::{PrimitiveTopology, VertexStepMode};
        let shader = &compiler.module(&SHADER)?;
        let groups = &[&compiler.layouts.view, &compiler.layouts.ground];
        let blocks = &[buffer_layout::<block::Block>(VertexStepMode::Instance, &BLOCK)];
        let ring = &[buffer_layout::<RingVertex>(VertexStepMode::Vertex, &RING)];
        let pipelines = |wireframe: bool| {
            let usual = || PipelineDesc {
                fragment: Some("ground"),
                cull: Some(wgpu::Face::Back),
                wireframe,
                ..PipelineDesc::new(shader, groups)
            };
            let topology = PrimitiveTopology::TriangleStrip;
            let blocks = PipelineDesc { vertex: "block_vertex", buffers: blocks, ..usual() };
            let strip = PipelineDesc { vertex: "sample_vertex", topology, ..usual() };
            let ring =
                PipelineDesc { vertex: "ring_vertex", fragment: Some("ring"), buffers: ring, ..usual() };
            let [blocks, strip, ring] = [blocks, strip, ring].map(|desc| compiler.pipeline(&desc));
            Pipelines { blocks, strip, ring }
        };
        Ok(Self {
            pipelines: FilledOrWire::new(compiler.gpu, pipelines),
            block_indices: BlockIndices::new(compiler.gpu),
        })
    }
}

impl DrawPass for Terrain {
    fn is_needed(&self, _: &BoundScene, options: &Options) -> bool {
        options.draw_terrain
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, bound: &BoundScene, options: &Options) -> u32 {
        let (pipelines, terrain) = (self.pipelines.get(options.wireframe), &bound.terrain);
        pass.set_bind_group(1, &bound.ground_group, &[]);
        if options.terrain_lod == TerrainLodMode::Roam {
            pass.set_pipeline(&pipelines.strip);
            pass.set_index_buffer(terrain.buffer.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..terrain.count, 0, 0..1);
        } else {
            pass.set_pipeline(&pipelines.blocks);
            self.block_indices.draw(pass, terrain);
        }
        pass.set_pipeline(&pipelines.ring);
        1 + bound.scene.land.ring.draw(pass, &bound.ring)
    }
}
