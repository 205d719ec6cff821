//! Draws what is around a file that is shown alone: a backdrop, and the ground with its shade and a grid.

use super::asset::SHADER;
use super::bound_asset::BoundAsset;
use super::shaders::ShaderError;
use super::{Compiler, PipelineDesc};

#[derive(Debug)]
pub struct Studio {
    backdrop: wgpu::RenderPipeline,
    grid: wgpu::RenderPipeline,
}

impl Studio {
    pub const NAME: &str = "studio";

    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let (module, layouts) = (compiler.module(&SHADER)?, compiler.layouts);
        let groups = [&layouts.camera, &layouts.studio];
        let pipeline = |entry: &str, blend: Option<wgpu::BlendState>| {
            let usual = PipelineDesc::new(&module, &groups);
            let vertex = "corner";
            compiler.pipeline(&PipelineDesc {
                vertex,
                fragment: Some(entry),
                depth_write: false,
                blend,
                ..usual
            })
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
