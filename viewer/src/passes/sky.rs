//! Draws the sky behind everything (thesis 5).

use super::shaders::ShaderError;
use super::{BoundScene, Compiler, DrawPass, PipelineDesc, Shader};
use crate::options::Options;

pub const SHADER: Shader = Shader { name: "sky", source: include_str!("sky.wgsl"), constants: &[] };

#[derive(Debug)]
pub struct Sky {
    usual: wgpu::RenderPipeline,
    /// While one copy of the clouds fades into the other.
    fading: wgpu::RenderPipeline,
}

impl Sky {
    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let (module, groups) = (compiler.module(&SHADER)?, [&compiler.layouts.view]);
        let pipeline = |fragment: &str| {
            let usual = PipelineDesc::new(&module, &groups);
            compiler.pipeline(&PipelineDesc { fragment: Some(fragment), depth_write: false, ..usual })
        };
        Ok(Self { usual: pipeline("fragment"), fading: pipeline("fading") })
    }
}

impl DrawPass for Sky {
    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, bound: &BoundScene, _: &Options) -> u32 {
        pass.set_pipeline(if bound.clouds_fade { &self.fading } else { &self.usual });
        pass.draw(0..3, 0..1);
        1
    }
}
