//! Draws the sky behind everything (thesis 5).

use super::{Layouts, Shape, pipeline};
use crate::shaders::{ShaderError, Shaders};

/// The pipeline.
#[derive(Debug)]
pub struct Sky {
    pipeline: wgpu::RenderPipeline,
}

impl Sky {
    /// Compiles it.
    pub fn new(
        device: &wgpu::Device,
        layouts: &Layouts,
        shaders: &Shaders,
        samples: u32,
    ) -> Result<Self, ShaderError> {
        let module = shaders.module(device, "sky")?;
        let groups = [Some(&layouts.view)];
        let shape = Shape { depth_write: false, ..Shape::new("sky", &module, &groups, samples) };
        Ok(Self { pipeline: pipeline(device, &shape) })
    }

    /// One draw. Group 0 is set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..3, 0..1);
    }
}
