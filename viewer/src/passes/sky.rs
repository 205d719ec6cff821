//! Draws the sky behind everything (thesis 5).

use super::shaders::ShaderError;
use super::{BoundScene, Compiler, DrawPass, PipelineDesc, Shader};
use crate::options::Options;

pub const SHADER: Shader = Shader { name: "sky", source: include_str!("sky.wgsl"), constants: &[] };

#[derive(Debug)]
pub struct Sky {
    pipeline: wgpu::RenderPipeline,
}

impl Sky {
    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let (module, groups) = (compiler.module(&SHADER)?, [&compiler.layouts.view]);
        let desc = PipelineDesc { depth_write: false, ..PipelineDesc::new(&module, &groups) };
        Ok(Self { pipeline: compiler.pipeline(&desc) })
    }
}

impl DrawPass for Sky {
    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, _: &BoundScene, _: &Options) -> u32 {
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..3, 0..1);
        1
    }
}
