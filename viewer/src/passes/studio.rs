//! Draws what is around a file that is shown alone: a backdrop, and a grid on the ground.

use super::bound_asset::BoundAsset;
use super::shaders::ShaderError;
use super::{Compiler, PipelineDesc, Shader};

pub const SHADER: Shader = Shader { name: "studio", source: include_str!("studio.wgsl"), constants: &[] };

#[derive(Debug)]
pub struct Studio {
    backdrop: wgpu::RenderPipeline,
    grid: wgpu::RenderPipeline,
}

impl Studio {
    pub const NAME: &str = SHADER.name;

    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let (module, layouts) = (compiler.module(&SHADER)?, compiler.layouts);
        let groups = [&layouts.camera, &layouts.studio];
        let pipeline = |entry: &str, blend: Option<wgpu::BlendState>| {
            let usual = PipelineDesc::new(&module, &groups);
            compiler.pipeline(&PipelineDesc { fragment: Some(entry), depth_write: false, blend, ..usual })
        };
        Ok(Self {
            backdrop: pipeline("backdrop", None),
            grid: pipeline("grid", Some(wgpu::BlendState::ALPHA_BLENDING)),
        })
    }

    /// Two draws at most; tells how many. Group 0 is set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, bound: &BoundAsset, with_grid: bool) -> u32 {
        pass.set_bind_group(1, &bound.studio_group, &[]);
        pass.set_pipeline(&self.backdrop);
        pass.draw(0..3, 0..1);
        if with_grid {
            pass.set_pipeline(&self.grid);
            pass.draw(0..3, 0..1);
        }
        1 + u32::from(with_grid)
    }
}
