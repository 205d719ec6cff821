//! Radiance → finished picture.

use super::{DISPLAY, Layouts};
use crate::shaders::{ShaderError, Shaders};

/// The pipeline.
#[derive(Debug)]
pub struct Tone {
    pipeline: wgpu::RenderPipeline,
}

impl Tone {
    /// Compiles it.
    pub fn new(device: &wgpu::Device, layouts: &Layouts, shaders: &Shaders) -> Result<Self, ShaderError> {
        let module = shaders.module(device, "tone")?;
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("tone"),
            bind_group_layouts: &[Some(&layouts.view), Some(&layouts.radiance)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("tone"),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: Default::default(),
                targets: &[Some(DISPLAY.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Ok(Self { pipeline })
    }

    /// One draw. Group 0 is set; `radiance` is group 1.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, radiance: &wgpu::BindGroup) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, radiance, &[]);
        pass.draw(0..3, 0..1);
    }
}
