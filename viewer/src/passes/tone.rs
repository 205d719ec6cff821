//! Tone mapping: radiance → finished picture.

use super::shaders::ShaderError;
use super::{Compiler, PipelineDesc, Shader, Target};

pub const SHADER: Shader = Shader { name: "tone", source: include_str!("tone.wgsl"), constants: &[] };

#[derive(Debug)]
pub struct Tone {
    film: wgpu::RenderPipeline,
    neutral: wgpu::RenderPipeline,
}

impl Tone {
    pub const NAME: &str = SHADER.name;

    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let module = compiler.module(&SHADER)?;
        let groups = [&compiler.layouts.camera, &compiler.layouts.radiance];
        let pipeline = |entry: &str| {
            let usual = PipelineDesc::new(&module, &groups);
            compiler.pipeline(&PipelineDesc { target: Target::Display, fragment: Some(entry), ..usual })
        };
        Ok(Self { film: pipeline("fragment"), neutral: pipeline("neutral") })
    }

    /// One draw, like film or with colours as materials have them. Group 0 is set; `radiance` is group 1.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, radiance: &wgpu::BindGroup, like_film: bool) {
        pass.set_pipeline(if like_film { &self.film } else { &self.neutral });
        pass.set_bind_group(1, radiance, &[]);
        pass.draw(0..3, 0..1);
    }
}
