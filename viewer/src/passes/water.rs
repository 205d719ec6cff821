//! Draws the lake over everything else.

use super::{Layouts, Shape, pipeline};
use crate::shaders::{ShaderError, Shaders};

/// The pipeline.
#[derive(Debug)]
pub struct Water {
    pipeline: wgpu::RenderPipeline,
}

impl Water {
    /// Compiles it.
    pub fn new(
        device: &wgpu::Device,
        layouts: &Layouts,
        shaders: &Shaders,
        samples: u32,
    ) -> Result<Self, ShaderError> {
        let module = shaders.module(device, "water")?;
        let groups = [Some(&layouts.view)];
        let shape = Shape {
            // A diver sees the surface from below, so it has two sides.
            blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
            ..Shape::new("water", &module, &groups, samples)
        };
        Ok(Self { pipeline: pipeline(device, &shape) })
    }

    /// One draw. Group 0 is set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..6, 0..1);
    }
}
