//! Tone mapping: radiance → finished picture.

use super::shaders::ShaderError;
use super::{Compiler, PipelineDesc, Shader, Target};

pub const SHADER: Shader = Shader { name: "tone", source: include_str!("tone.wgsl"), constants: &[] };

#[derive(Debug)]
pub struct Tone {
    pipeline: wgpu::RenderPipeline,
}

impl Tone {
    pub const NAME: &str = SHADER.name;

    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let module = compiler.module(&SHADER)?;
        let groups = [&compiler.layouts.view, &compiler.layouts.radiance];
        let desc = PipelineDesc { target: Target::Display, ..PipelineDesc::new(&module, &groups) };
        Ok(Self { pipeline: compiler.pipeline(&desc) })
    }

    /// One draw. Group 0 is set; `radiance` is group 1.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, radiance: &wgpu::BindGroup) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, radiance, &[]);
        pass.draw(0..3, 0..1);
    }
}
