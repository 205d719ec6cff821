//! What one picture is drawn into.

use crate::gpu::{Gpu, cleared, flat};
use crate::passes::{Binding, DEPTH, DISPLAY, Passes, RADIANCE, bind};

/// A picture's render targets.
#[derive(Debug)]
pub struct Targets {
    /// Width and height.
    pub size_px: [u32; 2],
    /// One sample a pixel.
    radiance: wgpu::TextureView,
    /// Several samples a pixel, if the passes draw them.
    multisampled: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
    /// The mean of radiance over pictures of the same.
    mean: wgpu::TextureView,
    /// The finished picture.
    pub display: wgpu::Texture,
    display_view: wgpu::TextureView,
    /// What the pass that draws the landscape is counted by.
    pub(super) statistics: Option<wgpu::QuerySet>,
    /// The radiance of one picture, for the passes that read it.
    pub(super) radiance_group: wgpu::BindGroup,
    /// The same of the mean.
    pub(super) mean_group: wgpu::BindGroup,
}

impl Targets {
    pub(super) fn new(gpu: &Gpu, passes: &Passes, label: &str, size_px: [u32; 2]) -> Self {
        use wgpu::TextureUsages as Usage;
        let texture = |format: wgpu::TextureFormat, samples: u32, usage: Usage| {
            let flat = flat(label, size_px, format, usage | Usage::RENDER_ATTACHMENT);
            gpu.device.create_texture(&wgpu::TextureDescriptor { sample_count: samples, ..flat })
        };
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        let [radiance, mean] = [(); 2].map(|()| view(&texture(RADIANCE, 1, Usage::TEXTURE_BINDING)));
        let display = texture(DISPLAY, 1, Usage::TEXTURE_BINDING | Usage::COPY_SRC);
        let samples = passes.samples;
        let bound = |view: &wgpu::TextureView| {
            bind(gpu, "radiance", &passes.layouts.radiance, [(0, Binding::View(view.clone()))])
        };
        Self {
            size_px,
            multisampled: (samples > 1).then(|| view(&texture(RADIANCE, samples, Usage::empty()))),
            depth: view(&texture(DEPTH, samples, Usage::empty())),
            display_view: view(&display),
            display,
            radiance_group: bound(&radiance),
            mean_group: bound(&mean),
            radiance,
            mean,
            statistics: None,
        }
    }

    /// The pass that draws radiance.
    pub(super) fn picture<'a>(
        &self,
        scope: &'a mut wgpu_profiler::Scope<'_, wgpu::CommandEncoder>,
    ) -> wgpu_profiler::OwningScope<'a, wgpu::RenderPass<'a>> {
        let descriptor = wgpu::RenderPassDescriptor {
            color_attachments: &self.radiance(),
            depth_stencil_attachment: Some(self.depth()),
            ..Default::default()
        };
        scope.scoped_render_pass("picture", descriptor)
    }

    /// Where radiance is drawn to.
    fn radiance(&self) -> [Option<wgpu::RenderPassColorAttachment<'_>>; 1] {
        let resolved = self.multisampled.as_ref().map(|_| &self.radiance);
        [cleared(self.multisampled.as_ref().unwrap_or(&self.radiance), resolved, wgpu::Color::BLACK)]
    }

    fn depth(&self) -> wgpu::RenderPassDepthStencilAttachment<'_> {
        // Reversed depth: infinitely far is 0.
        let load = wgpu::LoadOp::Clear(0.0);
        wgpu::RenderPassDepthStencilAttachment {
            view: &self.depth,
            depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Discard }),
            stencil_ops: None,
        }
    }

    /// Where the mean is drawn to, over what it is of `accumulated` pictures.
    pub(super) fn mean(&self, accumulated: u32) -> [Option<wgpu::RenderPassColorAttachment<'_>>; 1] {
        let cleared = cleared(&self.mean, None, wgpu::Color::BLACK);
        let kept = wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store };
        [cleared.map(|mean| match accumulated {
            0 => mean,
            _ => wgpu::RenderPassColorAttachment { ops: kept, ..mean },
        })]
    }

    /// Where the finished picture is drawn to.
    pub(super) fn display(&self) -> [Option<wgpu::RenderPassColorAttachment<'_>>; 1] {
        [cleared(&self.display_view, None, wgpu::Color::BLACK)]
    }
}
