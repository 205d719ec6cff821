//! Draws the terrain in one draw, whatever the LOD mode, and the coarse ring around it in another.

use super::shaders::ShaderError;
use super::{BoundScene, Compiler, DrawPass, FilledOrWire, PipelineDesc, Shader, buffer_layout};
use crate::lod::{block, morph, nested};
use crate::lod_mode::TerrainLodMode;
use crate::options::Options;
use crate::upload::RingVertex;

pub const SHADER: Shader = Shader {
    name: "terrain",
    source: include_str!("terrain.wgsl"),
    constants: &[
        ("GAP", morph::GAP as f64),
        ("BLOCK_VERTICES", (1 << block::BLOCK_BITS) as f64 + 1.0),
        ("RATIO", nested::RATIO as f64),
    ],
};

/// Attributes of [`block::Block`].
pub const BLOCK: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Uint32x2, 1 => Uint32];
/// Attributes of [`RingVertex`].
pub const RING: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4];

#[derive(Debug)]
pub struct Terrain {
    pipelines: FilledOrWire<Pipelines>,
    /// The triangles of any block.
    block_indices: wgpu::Buffer,
    block_index_count: u32,
}

#[derive(Debug)]
struct Pipelines {
    blocks: wgpu::RenderPipeline,
    strip: wgpu::RenderPipeline,
    risen: wgpu::RenderPipeline,
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
            let risen = PipelineDesc { vertex: "risen_vertex", ..usual() };
            let ring =
                PipelineDesc { vertex: "ring_vertex", fragment: Some("ring"), buffers: ring, ..usual() };
            let [blocks, strip, risen, ring] =
                [blocks, strip, risen, ring].map(|desc| compiler.pipeline(&desc));
            Pipelines { blocks, strip, risen, ring }
        };
        let indices = block::block_indices(1 << block::BLOCK_BITS);
        Ok(Self {
            pipelines: FilledOrWire::new(compiler.gpu, pipelines),
            block_indices: compiler.gpu.buffer("block triangles", &indices, wgpu::BufferUsages::INDEX),
            block_index_count: indices.len() as u32,
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
        match options.terrain_lod {
            TerrainLodMode::Morph => {
                pass.set_pipeline(&pipelines.risen);
                terrain.draw_as_indices(pass);
            }
            TerrainLodMode::Roam => {
                pass.set_pipeline(&pipelines.strip);
                terrain.draw_as_indices(pass);
            }
            TerrainLodMode::Distance | TerrainLodMode::Off => {
                pass.set_pipeline(&pipelines.blocks);
                pass.set_vertex_buffer(0, terrain.buffer.slice(..));
                pass.set_index_buffer(self.block_indices.slice(..), wgpu::IndexFormat::Uint16);
                pass.draw_indexed(0..self.block_index_count, 0, 0..terrain.count);
            }
        }
        pass.set_pipeline(&pipelines.ring);
        1 + bound.scene.land.ring.draw(pass, &bound.ring)
    }
}
