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
        let shape = Shape {
            label: "sky",
            module: &shaders.module(device, "sky")?,
            vertex: "vertex",
            fragment: "fragment",
            buffers: &[],
            groups: &[Some(&layouts.view)],
            topology: wgpu::PrimitiveTopology::TriangleList,
            cull: None,
            blend: None,
            depth_write: false,
            wireframe: false,
            samples,
            alpha_to_coverage: false,
        };
        Ok(Self { pipeline: pipeline(device, &shape) })
    }

    /// One draw. Group 0 is set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..3, 0..1);
    }
}
