//! Draws the land in one draw, whatever the mode, and the coarse ring around it in another.

use super::{Layouts, Shape, pipeline};
use crate::gpu::Gpu;
use crate::lod::quadtree::{self, Block};
use crate::shaders::{ShaderError, Shaders};
use crate::upload::{GroundBuffers, RingVertex};

/// What to draw of the land.
#[derive(Clone, Copy, Debug)]
pub enum Land {
    /// So many [`Block`]s.
    Blocks(u32),
    /// A strip of so many sample numbers.
    Strip(u32),
}

/// Attributes of [`Block`].
pub const BLOCK: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Uint32x2, 1 => Uint32];
/// Attributes of [`RingVertex`].
pub const RING: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4];

/// The pipelines.
#[derive(Debug)]
pub struct Terrain {
    filled: Pipelines,
    wire: Option<Pipelines>,
    block_indices: wgpu::Buffer,
    block_index_count: u32,
}

#[derive(Debug)]
struct Pipelines {
    blocks: wgpu::RenderPipeline,
    strip: wgpu::RenderPipeline,
    ring: wgpu::RenderPipeline,
}

impl Terrain {
    /// Compiles them.
    pub fn new(gpu: &Gpu, layouts: &Layouts, shaders: &Shaders, samples: u32) -> Result<Self, ShaderError> {
        use wgpu::util::DeviceExt;
        let module = shaders.module(&gpu.device, "terrain")?;
        let lines = gpu.features.contains(wgpu::Features::POLYGON_MODE_LINE);
        let build = |wireframe| Pipelines::new(&gpu.device, layouts, &module, samples, wireframe);
        let indices = quadtree::block_indices(1 << quadtree::BLOCK_BITS);
        let block_indices = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("block triangles"),
            contents: bytemuck::cast_slice(&indices),
            usage: wgpu::BufferUsages::INDEX,
        });
        Ok(Self {
            filled: build(false),
            wire: lines.then(|| build(true)),
            block_indices,
            block_index_count: indices.len() as u32,
        })
    }

    /// Two draws: `land` from `buffer`, which holds blocks or sample numbers, then the ring. Group 0 is set.
    pub fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        ground: &GroundBuffers,
        group: &wgpu::BindGroup,
        (land, buffer): (Land, &wgpu::Buffer),
        wire: bool,
    ) {
        let pipelines = self.wire.as_ref().filter(|_| wire).unwrap_or(&self.filled);
        pass.set_bind_group(1, group, &[]);
        match land {
            Land::Blocks(count) => {
                pass.set_pipeline(&pipelines.blocks);
                pass.set_vertex_buffer(0, buffer.slice(..));
                pass.set_index_buffer(self.block_indices.slice(..), wgpu::IndexFormat::Uint16);
                pass.draw_indexed(0..self.block_index_count, 0, 0..count);
            }
            Land::Strip(count) => {
                pass.set_pipeline(&pipelines.strip);
                pass.set_index_buffer(buffer.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..count, 0, 0..1);
            }
        }
        if ground.ring_index_count > 0 {
            pass.set_pipeline(&pipelines.ring);
            pass.set_vertex_buffer(0, ground.ring_vertices.slice(..));
            pass.set_index_buffer(ground.ring_indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..ground.ring_index_count, 0, 0..1);
        }
    }
}

impl Pipelines {
    fn new(
        device: &wgpu::Device,
        layouts: &Layouts,
        module: &wgpu::ShaderModule,
        samples: u32,
        wireframe: bool,
    ) -> Self {
        let blocks = wgpu::VertexBufferLayout {
            array_stride: size_of::<Block>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &BLOCK,
        };
        let ring = wgpu::VertexBufferLayout {
            array_stride: size_of::<RingVertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &RING,
        };
        let build =
            |vertex: &str, fragment: &str, buffers: &[Option<wgpu::VertexBufferLayout<'_>>], strip: bool| {
                let groups = [Some(&layouts.view), Some(&layouts.ground)];
                let usual = Shape::new(vertex, module, &groups, samples);
                let topology = if strip { wgpu::PrimitiveTopology::TriangleStrip } else { usual.topology };
                let cull = Some(wgpu::Face::Back);
                let shape = Shape { vertex, fragment, buffers, topology, cull, wireframe, ..usual };
                pipeline(device, &shape)
            };
        Self {
            blocks: build("block_vertex", "ground", &[Some(blocks)], false),
            strip: build("sample_vertex", "ground", &[], true),
            ring: build("ring_vertex", "ring", &[Some(ring)], false),
        }
    }
}
