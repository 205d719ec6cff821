//! The window: its surface, and the user interface painted onto it.

use std::sync::Arc;

use anyhow::{Result, anyhow};
use winit::window::Window;

use super::ui_painter::UiPainter;
use crate::gpu::{Gpu, GpuError, cleared};
use crate::{settings, ui};

/// A window with its surface and what paints the user interface.
pub struct Screen {
    pub window: Arc<Window>,
    /// egui's side of it.
    pub ctx: egui::Context,
    /// Translates the window's events.
    pub input: egui_winit::State,
    /// Keeps egui's textures.
    renderer: egui_wgpu::Renderer,
    /// Paints its triangles.
    pub painter: UiPainter,
    /// What is for the next frame.
    later: Vec<egui::Event>,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    gpu: Gpu,
}

impl Screen {
    /// Opens a device that can draw to `window`.
    pub fn open(window: Arc<Window>) -> Result<(Self, Gpu)> {
        let instance = crate::gpu::instance();
        let surface = instance.create_surface(window.clone()).map_err(GpuError::NoSurface)?;
        let (gpu, adapter) = Gpu::open(&instance, Some(&surface))?;
        let size = window.inner_size();
        let mut config = surface
            .get_default_config(&adapter, size.width.max(1), size.height.max(1))
            .ok_or_else(|| anyhow!("{} cannot draw to this window", gpu.name))?;
        let formats = surface.get_capabilities(&adapter).formats;
        // The pictures are encoded already: the surface must not encode them again.
        if let Some(plain) = formats.iter().find(|format| !format.is_srgb()) {
            config.format = *plain;
        }
        config.present_mode = wgpu::PresentMode::AutoVsync;
        config.desired_maximum_frame_latency = 2;
        gpu.configure(&surface, &config);
        let ctx = egui::Context::default();
        crate::ui::theme::install(&ctx);
        let scale = window.scale_factor() as f32;
        let id = egui::ViewportId::ROOT;
        let input = egui_winit::State::new(ctx.clone(), id, &window, Some(scale), window.theme(), Some(8192));
        let renderer =
            egui_wgpu::Renderer::new(&gpu.device, config.format, egui_wgpu::RendererOptions::default());
        let painter = UiPainter::new(&gpu, config.format);
        let later = Vec::new();
        Ok((Self { window, ctx, input, renderer, painter, later, surface, config, gpu: gpu.clone() }, gpu))
    }

    /// What has happened since the last frame, up to a press.
    pub fn take_input(&mut self) -> egui::RawInput {
        let mut input = self.input.take_egui_input(&self.window);
        self.later.append(&mut input.events);
        let length = up_to_a_press(&self.later);
        input.events = self.later.drain(..length).collect();
        if !self.later.is_empty() {
            self.window.request_redraw();
        }
        input
    }

    /// Keeps the window's size for the next start.
    pub fn keep(&self, kept: &mut settings::Window) {
        kept.maximized = self.window.is_maximized();
        if !kept.maximized {
            let size = self.window.inner_size().to_logical::<f32>(self.window.scale_factor());
            (kept.width, kept.height) = (size.width, size.height);
        }
    }

    /// Follows the window's size.
    pub fn resize(&mut self, width: u32, height: u32) {
        let max = self.gpu.device.limits().max_texture_dimension_2d;
        (self.config.width, self.config.height) = (width.clamp(1, max), height.clamp(1, max));
        self.gpu.configure(&self.surface, &self.config);
    }

    /// Paints the user interface and shows it; `encoder` has recorded what it shows. False if the window cannot be seen
    /// now.
    pub fn present(&mut self, mut output: egui::FullOutput, mut encoder: wgpu::CommandEncoder) -> bool {
        self.input.handle_platform_output(&self.window, output.platform_output);
        let pixels_per_point = output.pixels_per_point;
        let mut shapes = self.ctx.tessellate(output.shapes, pixels_per_point);
        for (id, deltas) in &output.textures_delta.set {
            for delta in deltas {
                self.renderer.update_texture(&self.gpu.device, &self.gpu.queue, *id, delta);
            }
        }
        self.painter.take_over(&mut shapes, self.ctx.viewport_rect(), &self.renderer);
        let screen = egui_wgpu::ScreenDescriptor {
            size_in_pixels: [self.config.width, self.config.height],
            pixels_per_point,
        };
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let uploads = self.renderer.update_buffers(device, queue, &mut encoder, &shapes, &screen);
        let frame = self.frame();
        if let Some(frame) = &frame {
            let view = frame.texture.create_view(&Default::default());
            let mut pass = encoder
                .begin_render_pass(&wgpu::RenderPassDescriptor {
                    label: Some("user interface"),
                    color_attachments: &[cleared(&view, None, color(ui::theme::ground(&self.ctx)))],
                    ..Default::default()
                })
                .forget_lifetime();
            self.renderer.render(&mut pass, &shapes, &screen);
        }
        self.gpu.queue.submit(uploads.into_iter().chain([encoder.finish()]));
        for id in &output.textures_delta.free {
            self.renderer.free_texture(id);
        }
        // Says that all is done; egui complains of changes that are dropped.
        output.textures_delta.clear();
        let Some(frame) = frame else { return false };
        self.window.pre_present_notify();
        self.gpu.queue.present(frame);
        true
    }

    fn frame(&mut self) -> Option<wgpu::SurfaceTexture> {
        use wgpu::CurrentSurfaceTexture as Current;
        for _ in 0..2 {
            match self.surface.get_current_texture() {
                Current::Success(frame) | Current::Suboptimal(frame) => return Some(frame),
                Current::Outdated | Current::Lost => self.gpu.configure(&self.surface, &self.config),
                _ => return None,
            }
        }
        None
    }
}

/// An opaque colour, for a surface of encoded values.
fn color(color: egui::Color32) -> wgpu::Color {
    let [r, g, b, a] = color.to_normalized_gamma_f32().map(f64::from);
    wgpu::Color { r, g, b, a }
}

/// How many events one frame takes: egui gives a press to whatever is under the pointer at the frame's end. Where frames
/// are long the pointer is elsewhere by then, so what is pressed and moved waits with its movement for the next.
fn up_to_a_press(events: &[egui::Event]) -> usize {
    use egui::Event;
    let is_press = |event: &Event| matches!(event, Event::PointerButton { pressed: true, .. });
    let Some(press) = events.iter().position(is_press) else { return events.len() };
    let moves = |event: &Event| matches!(event, Event::PointerMoved(_));
    events[press..].iter().position(moves).map_or(events.len(), |at| press + at)
}

#[cfg(test)]
mod tests {
    use super::up_to_a_press;
    use egui::{Event, Modifiers, PointerButton, pos2};

    #[test]
    fn a_press_and_the_movement_after_it_come_in_two_frames_and_a_click_in_one() {
        let moved = |x: f32| Event::PointerMoved(pos2(x, 0.0));
        let button = |pressed| Event::PointerButton {
            pos: pos2(1.0, 0.0),
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        let drag = [moved(0.0), moved(1.0), button(true), moved(50.0), moved(90.0), button(false)];
        assert_eq!(up_to_a_press(&drag), 3);
        assert_eq!(up_to_a_press(&drag[3..]), 3);
        assert_eq!(up_to_a_press(&[moved(1.0), button(true), button(false)]), 3);
        assert_eq!(up_to_a_press(&[]), 0);
    }
}
