//! Draws the terrain in one draw, whatever the LOD mode, and the coarse ring around it in another.

use super::shaders::ShaderError;
use super::{BoundScene, Compiler, DrawPass, FilledOrWire, PipelineDesc, Shader, buffer_layout};
use crate::lod::{block, morph, nested};
use crate::lod_mode::TerrainLodMode;
use crate::options::Options;
use crate::upload::{DRY_ALPHA, RingVertex, SHADED_M};

pub const SHADER: Shader = Shader {
    name: "terrain",
    source: include_str!("terrain.wgsl"),
    constants: &[
        ("GAP", morph::GAP as f64),
        ("BLOCK_VERTICES", (1 << block::BLOCK_BITS) as f64 + 1.0),
        ("RATIO", nested::RATIO as f64),
        ("DRY_ALPHA", DRY_ALPHA as f64),
        ("SHADED_M", SHADED_M as f64),
    ],
};

/// Attributes of [`block::Block`].
pub const BLOCK: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Uint32x2, 1 => Uint32];
/// Attributes of [`RingVertex`].
pub const RING: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4, 3 => Unorm8x4];

#[derive(Debug)]
pub struct Terrain {
    pipelines: FilledOrWire<Pipelines>,
    /// The triangles of any block.
    block_indices: wgpu::Buffer,
    block_index_count: u32,
}

#[derive(Debug)]
struct Pipelines {
    dry: Field,
    /// For land on which water stands.
    wet: Field,
    ring: wgpu::RenderPipeline,
}

#[derive(Debug)]
struct Field {
    blocks: wgpu::RenderPipeline,
    strip: wgpu::RenderPipeline,
    risen: wgpu::RenderPipeline,
}

impl Terrain {
    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        use wgpu::{PrimitiveTopology, VertexStepMode};
        let shader = &compiler.module(&SHADER)?;
        let groups = &[&compiler.layouts.view, &compiler.layouts.ground];
        let blocks = &[buffer_layout::<block::Block>(VertexStepMode::Instance, &BLOCK)];
        let ring = &[buffer_layout::<RingVertex>(VertexStepMode::Vertex, &RING)];
        let pipelines = |wireframe: bool| {
            let drawn = |fragment| PipelineDesc {
                fragment: Some(fragment),
                cull: Some(wgpu::Face::Back),
                wireframe,
                ..PipelineDesc::new(shader, groups)
            };
            let field = |fragment| {
                let topology = PrimitiveTopology::TriangleStrip;
                let blocks = PipelineDesc { vertex: "block_vertex", buffers: blocks, ..drawn(fragment) };
                let strip = PipelineDesc { vertex: "sample_vertex", topology, ..drawn(fragment) };
                let risen = PipelineDesc { vertex: "risen_vertex", ..drawn(fragment) };
                let [blocks, strip, risen] = [blocks, strip, risen].map(|desc| compiler.pipeline(&desc));
                Field { blocks, strip, risen }
            };
            let ring = PipelineDesc { vertex: "ring_vertex", buffers: ring, ..drawn("ring") };
            Pipelines { dry: field("ground"), wet: field("wet_ground"), ring: compiler.pipeline(&ring) }
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
        let field = if bound.scene.land.is_wet { &pipelines.wet } else { &pipelines.dry };
        pass.set_bind_group(1, &bound.ground_group, &[]);
        match options.terrain_lod {
            TerrainLodMode::Morph => {
                pass.set_pipeline(&field.risen);
                terrain.draw_as_indices(pass);
            }
            TerrainLodMode::Roam => {
                pass.set_pipeline(&field.strip);
                terrain.draw_as_indices(pass);
            }
            TerrainLodMode::Distance | TerrainLodMode::Off => {
                pass.set_pipeline(&field.blocks);
                pass.set_vertex_buffer(0, terrain.buffer.slice(..));
                pass.set_index_buffer(self.block_indices.slice(..), wgpu::IndexFormat::Uint16);
                pass.draw_indexed(0..self.block_index_count, 0, 0..terrain.count);
            }
        }
        pass.set_pipeline(&pipelines.ring);
        1 + bound.scene.land.ring.draw(pass, &bound.ring)
    }
}
