//! winit's events → commands, camera and frames; opens the window.

use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, Result};
use serde_json::json;
use winit::application::ApplicationHandler;
use winit::event::{
    DeviceEvent, DeviceId, ElementState, KeyEvent, MouseScrollDelta, StartCause, WindowEvent,
};
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::keyboard::PhysicalKey;
use winit::window::{WindowAttributes, WindowId};

use super::screen::Screen;
use super::viewports::Viewports;
use super::{App, Live, Wake};
use crate::event::Event;
use crate::input::{Command, Input};
use crate::loader::Loader;
use crate::passes::Shaders;

/// Pixels of a touchpad that count as one line of a wheel.
const PIXELS_PER_LINE: f32 = 40.0;

impl ApplicationHandler<Wake> for App {
    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if let StartCause::ResumeTimeReached { .. } = cause {
            self.redraw();
        }
    }

    fn resumed(&mut self, events: &ActiveEventLoop) {
        events.set_control_flow(ControlFlow::Wait);
        if self.live.is_some() {
            return;
        }
        match self.open_window(events) {
            Ok(live) => self.live = Some(live),
            Err(failure) => {
                self.failure = Some(failure);
                events.exit();
            }
        }
    }

    fn user_event(&mut self, events: &ActiveEventLoop, wake: Wake) {
        let soon = self.pace.soon();
        if wake == Wake::Now || soon <= Instant::now() {
            self.redraw();
        } else {
            let due = if let ControlFlow::WaitUntil(due) = events.control_flow() { due } else { soon };
            events.set_control_flow(ControlFlow::WaitUntil(due.min(soon)));
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(live) = &mut self.live else { return };
        let captured = self.camera.captured();
        // What egui has use for is known a frame later, as `Focus`.
        let seen = !(captured && is_pointer(&event))
            && live.screen.input.on_window_event(&live.screen.window, &event).repaint;
        if event != WindowEvent::RedrawRequested && (seen || is_touch(&event)) {
            live.screen.window.request_redraw();
        }
        if is_touch(&event) {
            self.pace.touch(Instant::now());
        }
        match event {
            WindowEvent::CloseRequested => self.dispatch(Command::Quit.into(), events),
            WindowEvent::Resized(size) => live.screen.resize(size.width, size.height),
            WindowEvent::RedrawRequested => self.frame(events),
            WindowEvent::Focused(false) => {
                self.camera.held.focus_lost();
                self.dispatch(Event::Capture(false), events);
            }
            WindowEvent::KeyboardInput { event, .. } => self.key(&event, events),
            WindowEvent::MouseInput { state, button, .. } => {
                self.button(Input::Mouse(button), state, captured, events);
            }
            WindowEvent::MouseWheel { delta, .. } if captured || self.focus.on_picture => {
                self.camera.held.wheel(match delta {
                    MouseScrollDelta::LineDelta(_, lines) => lines,
                    MouseScrollDelta::PixelDelta(pixels) => pixels.y as f32 / PIXELS_PER_LINE,
                });
            }
            _ => {}
        }
    }

    fn device_event(&mut self, _: &ActiveEventLoop, _: DeviceId, event: DeviceEvent) {
        if let DeviceEvent::MouseMotion { delta: (x, y) } = event
            && self.camera.captured()
        {
            self.camera.held.mouse_moved(x as f32, y as f32);
            self.redraw();
        }
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        self.save_settings();
        self.background.baker = None;
        self.log.note("end", json!({}));
    }
}

impl App {
    fn key(&mut self, event: &KeyEvent, events: &ActiveEventLoop) {
        let PhysicalKey::Code(code) = event.physical_key else { return };
        let Some(input) = Input::from_code(code) else { return };
        self.button(input, event.state, !self.focus.typing, events);
    }

    /// A key or button; one that was pressed while it was `ours` is released all the same when it no longer is.
    fn button(&mut self, input: Input, state: ElementState, ours: bool, events: &ActiveEventLoop) {
        if state == ElementState::Released {
            self.camera.held.release(input);
        } else if ours
            && let Some(command) = self.camera.held.press(&self.file.settings.bindings.value, input)
        {
            self.dispatch(command.into(), events);
        }
    }

    fn open_window(&mut self, events: &ActiveEventLoop) -> Result<Live> {
        let (asked, kept) = (self.cli.size, self.file.settings.window);
        let [width, height] = asked.map_or([kept.width, kept.height], |size| size.map(|side| side as f32));
        let attributes = WindowAttributes::default()
            .with_title(super::title(&self.source))
            .with_maximized(kept.maximized && asked.is_none())
            .with_inner_size(winit::dpi::LogicalSize::new(width.max(480.0), height.max(320.0)));
        let window = Arc::new(events.create_window(attributes).context("no window can be opened")?);
        let (screen, gpu) = Screen::open(window)?;
        if self.log.is_on() {
            screen.ctx.enable_accesskit();
        }
        self.log.note("start", json!({ "version": env!("CARGO_PKG_VERSION"), "adapter": gpu.name }));
        if !gpu.software && self.file.is_new() {
            // Before a person chooses: a card can afford smooth edges.
            self.file.settings.options.samples = 4;
        }
        if gpu.software {
            self.pace.expect_software();
        }
        let shaders = Shaders::from(self.cli.shaders.clone());
        let viewports = Viewports::new(&gpu, shaders, self.file.settings.options.samples)?;
        let loader = Loader::start(&gpu, self.wake(Wake::Now))?;
        screen.window.request_redraw();
        Ok(Live { screen, gpu, viewports, loader })
    }
}

/// Whether a person does something.
fn is_touch(event: &WindowEvent) -> bool {
    is_pointer(event) || matches!(event, WindowEvent::KeyboardInput { .. } | WindowEvent::Touch(_))
}

fn is_pointer(event: &WindowEvent) -> bool {
    matches!(
        event,
        WindowEvent::CursorMoved { .. } | WindowEvent::MouseInput { .. } | WindowEvent::MouseWheel { .. }
    )
}
