//! Darkens the ground around stones, trunks and stumps near by, where they keep the light off: else they seem to hang above it.

use super::plants::{SHADER, buffers};
use super::shaders::ShaderError;
use super::{BoundScene, Compiler, DrawPass, PipelineDesc};
use crate::options::Options;

pub const NAME: &str = "feet";

#[derive(Debug)]
pub struct Feet {
    pipeline: wgpu::RenderPipeline,
}

impl Feet {
    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let module = compiler.module(&SHADER)?;
        let factor = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Zero,
            dst_factor: wgpu::BlendFactor::Src,
            operation: wgpu::BlendOperation::Add,
        };
        let pipeline = compiler.pipeline(&PipelineDesc {
            vertex: "foot_vertex",
            fragment: Some("foot"),
            buffers: &buffers(),
            blend: Some(wgpu::BlendState { color: factor, alpha: factor }),
            depth_write: false,
            ..PipelineDesc::new(&module, &[&compiler.layouts.view])
        });
        Ok(Self { pipeline })
    }
}

impl DrawPass for Feet {
    fn is_needed(&self, bound: &BoundScene, options: &Options) -> bool {
        options.draw_terrain && bound.feet_draws.count > 0
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, bound: &BoundScene, _: &Options) -> u32 {
        let shapes = &bound.scene.land.plants;
        pass.set_pipeline(&self.pipeline);
        pass.set_vertex_buffer(0, bound.plants.buffer.slice(..));
        pass.set_vertex_buffer(1, shapes.vertices.slice(..));
        pass.set_index_buffer(shapes.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.multi_draw_indexed_indirect(&bound.feet_draws.buffer, 0, bound.feet_draws.count);
        1
    }
}
