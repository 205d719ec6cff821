//! The application: a window, and a loop that hands each event to its owner. What each does is in its own file: [`desk`]
//! (the person's work), [`show`] (the pictures), [`pilot`] (the camera), [`screen`] (the window), [`loader`] (files to
//! device), [`log`] (what happened).

pub mod desk;
pub mod dispatch;
pub mod loader;
pub mod log;
pub mod model;
pub mod pilot;
pub mod screen;
pub mod show;
mod tally;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use glam::Vec3;
use serde_json::json;
use winit::application::ApplicationHandler;
use winit::event::{DeviceEvent, DeviceId, ElementState, MouseScrollDelta, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::keyboard::PhysicalKey;
use winit::window::{WindowAttributes, WindowId};

use crate::baker::{Baker, BakerOptions};
use crate::event::{Arrangement, Comfort, Event};
use crate::frame::FrameInput;
use crate::gpu::Gpu;
use crate::input::Bindings;
use crate::settings::{Settings, SettingsFile};
use crate::shaders::Shaders;
use crate::ui::model::{Model, Panels};
use crate::ui::{self, Tone};
use crate::world_watch::{Change, WatchOptions, WorldWatch};
use desk::{Desk, Source, Task};
use loader::{Loader, Request};
use log::{Log, Moment};
use pilot::Pilot;
use screen::{Presented, Screen};
use show::Show;

/// Between two looks at whether settings have to be saved.
const SAVE_EVERY: Duration = Duration::from_secs(2);

/// What to show, and how.
#[derive(Clone, Debug)]
pub struct Start {
    /// Where landscapes come from.
    pub source: Source,
    /// Where settings are kept; `None`: nowhere.
    pub settings: Option<PathBuf>,
    /// How to bake; `None`: somebody else does.
    pub bake: Option<BakerOptions>,
    /// A folder with WGSL files that are read again when they change.
    pub shaders: Option<PathBuf>,
    /// Look several times a second, for folders that send no events.
    pub poll: bool,
    /// Where screenshots go.
    pub pictures: PathBuf,
    /// Size of the window in logical pixels, if not the last one.
    pub size: Option<[f32; 2]>,
    /// Where to write what happens.
    pub log: Option<PathBuf>,
}

/// Wakes the loop: something is new somewhere.
#[derive(Clone, Copy, Debug)]
pub struct Wake;

/// Opens the window and stays until it is closed.
pub fn run(start: Start) -> Result<()> {
    let events = EventLoop::<Wake>::with_user_event().build().context(
        "no window can be opened; without a display `viewer --screenshot OUT.png` draws to a file",
    )?;
    let log = Log::create(start.log.as_deref())?;
    let mut app = App::new(start, log, events.create_proxy());
    events.run_app(&mut app)?;
    match app.failure.take() {
        Some(failure) => Err(failure),
        None => Ok(()),
    }
}

/// All parts of the application; each has one owner, and none owns the others.
struct App {
    start: Start,
    proxy: EventLoopProxy<Wake>,
    settings_file: Option<SettingsFile>,
    settings: Settings,
    comfort: Comfort,
    arrangement: Arrangement,
    chosen: usize,
    panels: Panels,
    desk: Desk,
    pilot: Pilot,
    ui: ui::State,
    baker: Option<Baker>,
    watch: Option<WorldWatch>,
    live: Option<Live>,
    notices: Vec<(Tone, String)>,
    typing: bool,
    free_pointer: bool,
    last_step: Instant,
    born: Instant,
    saved: Instant,
    screenshot_wanted: bool,
    quit_wanted: bool,
    failure: Option<anyhow::Error>,
    log: Log,
}

/// What exists once there is a window.
struct Live {
    screen: Screen,
    gpu: Gpu,
    show: Show,
    loader: Loader,
}

impl App {
    fn new(start: Start, log: Log, proxy: EventLoopProxy<Wake>) -> Self {
        let mut notices = Vec::new();
        let (settings_file, settings) = match &start.settings {
            Some(path) => {
                let opened = SettingsFile::open(path);
                notices.extend(opened.problem.map(|problem| (Tone::Warning, problem)));
                (Some(opened.file), opened.settings)
            }
            None => (None, Settings::default()),
        };
        let mut or_default = |what: &str, error: String| {
            notices.push((Tone::Warning, format!("{what} in the settings: {error}; defaults are used")));
        };
        let comfort = settings.comfort.get().unwrap_or_else(|error| {
            or_default("comfort", error);
            None
        });
        let bindings: Option<Bindings> = settings.bindings.get().unwrap_or_else(|error| {
            or_default("bindings", error);
            None
        });
        let (mut pilot, problem) = Pilot::new(bindings.unwrap_or_default());
        notices.extend(problem.map(|problem| (Tone::Info, problem)));
        let kept = settings.worlds.get(&world_key(&start.source)).cloned().unwrap_or_default();
        pilot.return_to(kept.place.as_ref());
        let mut app = Self {
            desk: Desk::open(start.source.clone(), &kept),
            comfort: comfort.unwrap_or_default(),
            settings_file,
            settings,
            arrangement: Arrangement::default(),
            chosen: 0,
            panels: Panels::default(),
            pilot,
            ui: ui::State::default(),
            baker: None,
            watch: None,
            live: None,
            notices,
            typing: false,
            free_pointer: false,
            last_step: Instant::now(),
            born: Instant::now(),
            saved: Instant::now(),
            screenshot_wanted: false,
            quit_wanted: false,
            failure: None,
            log,
            proxy,
            start,
        };
        app.follow_source();
        app
    }

    fn wake(&self) -> impl Fn() + Send + Sync + 'static {
        let proxy = self.proxy.clone();
        // The loop is gone only when the program ends.
        move || {
            let _ = proxy.send_event(Wake);
        }
    }

    /// Watches the source's files and lets them be baked.
    fn follow_source(&mut self) {
        (self.baker, self.watch) = (None, None);
        let Source::World(root) = self.start.source.clone() else { return };
        let options = WatchOptions { shaders: self.start.shaders.clone(), poll: self.start.poll };
        match WorldWatch::start(&root, options, self.wake()) {
            Ok(watch) => self.watch = Some(watch),
            Err(error) => {
                self.notices.push((Tone::Error, format!("{} cannot be watched: {error}", root.display())));
            }
        }
        if let Some(options) = self.start.bake.clone() {
            match Baker::start(&root, options, self.wake()) {
                Ok(baker) => self.baker = Some(baker),
                Err(error) => self.notices.push((Tone::Error, format!("nothing can be baked: {error}"))),
            }
        }
    }

    /// Shows another world or other scenes.
    fn open(&mut self, source: Source) {
        self.keep_settings();
        self.start.source = source;
        let kept = self.settings.worlds.get(&world_key(&self.start.source)).cloned().unwrap_or_default();
        self.desk = Desk::open(self.start.source.clone(), &kept);
        self.pilot.return_to(kept.place.as_ref());
        if let Some(live) = &mut self.live {
            live.show.clear();
        }
        self.follow_source();
    }

    /// Takes in what other threads have brought.
    fn gather(&mut self) {
        let events: Vec<_> = self.baker.iter().flat_map(Baker::events).collect();
        events.into_iter().for_each(|event| self.desk.baked(event));
        let changes: Vec<Change> = self.watch.iter().flat_map(WorldWatch::changes).collect();
        for change in changes {
            if change == Change::Shaders {
                self.reload_shaders();
            }
            self.desk.changed(change);
        }
        let Some(live) = &mut self.live else { return };
        let replies: Vec<_> = live.loader.replies().collect();
        let mut arrived = false;
        for reply in replies {
            let told = reply.result.as_ref().map(|_| ()).map_err(String::as_str);
            if self.desk.loaded(reply.view, reply.generation, told)
                && let Ok(ready) = reply.result
            {
                live.show.put(reply.view, ready);
                arrived = true;
            }
        }
        if arrived {
            let sun = live.show.scene(self.chosen).map(|scene| Vec3::from(scene.sky.sun_direction));
            self.pilot.meet(&live.show.lands(), sun);
        }
        for task in self.desk.take_tasks() {
            match task {
                Task::Load { view, generation, path } => {
                    live.loader.ask(Request { view, generation, path, passes: live.show.passes() });
                }
                Task::Tell(tone, text) => {
                    self.log.note("told", json!({ "text": text }));
                    self.ui.notify(tone, text);
                }
            }
        }
        for (tone, text) in self.notices.drain(..) {
            self.log.note("told", json!({ "text": text }));
            self.ui.notify(tone, text);
        }
    }

    fn reload_shaders(&mut self) {
        let Some(live) = &mut self.live else { return };
        match live.show.reload_shaders(self.settings.options.samples) {
            Ok(()) => {
                self.desk.shaders(None);
                self.ui.notify(Tone::Success, "Shaders are new");
            }
            Err(error) => self.desk.shaders(Some(error.to_string())),
        }
    }

    /// One frame.
    fn frame(&mut self, events: &ActiveEventLoop) {
        self.gather();
        let now = Instant::now();
        let dt_s = (now - std::mem::replace(&mut self.last_step, now)).as_secs_f32();
        let lands = self.live.as_ref().map(|live| live.show.lands()).unwrap_or_default();
        let asked = self.pilot.step(dt_s, &self.comfort, &lands);
        asked.into_iter().for_each(|action| self.act(action));
        let frame = FrameInput { options: self.settings.options, time_s: self.born.elapsed().as_secs_f32() };
        let model = self.model();
        let Some(live) = &mut self.live else { return };
        if let Err(error) = live.show.follow(&self.settings.options) {
            self.desk.shaders(Some(error.to_string()));
        }
        let Live { screen, gpu, show, .. } = live;
        ui::theme::follow(&screen.ctx, &self.comfort);
        let input = screen.input.take_egui_input(&screen.window);
        let ctx = screen.ctx.clone();
        let mut output = ui::Output::default();
        let full = ctx.run_ui(input, |ui| output = ui::show(ui, &model, &mut self.ui));
        let told = full.platform_output.accesskit_update.as_ref();
        let widgets = told.filter(|_| self.log.wants_widgets());
        let widgets = widgets.map(|told| log::widgets(told, full.pixels_per_point));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        show.record(&mut encoder, &mut screen.painter, &output.views.slots, &frame, &self.pilot);
        let presented = screen.present(full, encoder);
        show.settle();
        self.log.frame(Moment {
            model: &model,
            landscapes: std::array::from_fn(|view| show.scene(view)),
            pose: self.pilot.pose(),
            size_px: screen.window.inner_size().into(),
            widgets,
        });
        if presented == Presented::Hidden {
            show.pause();
            std::thread::sleep(Duration::from_millis(50));
        }
        self.typing = output.typing;
        self.free_pointer = output.views.free;
        self.drag(&output.views);
        output.events.into_iter().for_each(|event| self.dispatch(event, events));
        if std::mem::take(&mut self.screenshot_wanted) {
            self.save_screenshot();
        }
        if self.quit_wanted {
            return events.exit();
        }
        if self.saved.elapsed() > SAVE_EVERY {
            self.keep_settings();
        }
        self.pace(events, now.elapsed());
    }

    /// When the next frame comes: at once, for clouds drift and waves run; but not while there is nothing to look at, and
    /// where the processor draws while it bakes or reads, it does the one half of the time and the other half the other.
    fn pace(&self, events: &ActiveEventLoop, frame: Duration) {
        let Some(live) = &self.live else { return };
        let idle = live.show.lands().is_empty();
        let waiting = self.desk.baking().is_some() || self.desk.awaits_scenes();
        let shared = live.gpu.software && waiting;
        let rest = match (idle, shared) {
            (true, _) => Duration::from_millis(100),
            (false, true) => frame.min(Duration::from_secs(1)),
            (false, false) => {
                // Or a moment that has passed would wake the loop again and again.
                events.set_control_flow(ControlFlow::Wait);
                return live.screen.window.request_redraw();
            }
        };
        events.set_control_flow(ControlFlow::WaitUntil(Instant::now() + rest));
    }

    /// Dragging a picture looks around without locking the pointer.
    fn drag(&mut self, views: &ui::Views) {
        if views.dragged != egui::Vec2::ZERO && !self.pilot.captured() {
            let scale = self.live.as_ref().map_or(1.0, |live| live.screen.ctx.pixels_per_point());
            self.pilot.turn(-views.dragged.x * scale, -views.dragged.y * scale);
        }
    }

    fn model(&self) -> Model {
        model::fill(&model::Parts {
            desk: &self.desk,
            show: self.live.as_ref().map(|live| &live.show),
            bindings: &self.pilot.bindings,
            options: self.settings.options,
            comfort: self.comfort,
            arrangement: self.arrangement,
            chosen: self.chosen,
            panels: self.panels,
            captured: self.pilot.captured(),
            baking_here: self.baker.is_some(),
        })
    }

    /// Writes settings down if they changed.
    fn keep_settings(&mut self) {
        self.saved = Instant::now();
        let key = world_key(&self.start.source);
        let mut kept = self.settings.worlds.get(&key).cloned().unwrap_or_default();
        self.desk.keep(&mut kept);
        // Not at every step of a walk, or the file would be written for as long as it goes.
        if self.desk.world().is_some() {
            kept.place = self.pilot.rested_at().or(kept.place);
        }
        if kept != Default::default() || self.settings.worlds.contains_key(&key) {
            self.settings.worlds.insert(key, kept);
        }
        // Plain values always have words in RON.
        let _ = self.settings.comfort.set(&self.comfort);
        let _ = self.settings.bindings.set(&self.pilot.bindings);
        if let Some(live) = &self.live {
            let window = &live.screen.window;
            let size = window.inner_size().to_logical::<f32>(window.scale_factor());
            self.settings.window.maximized = window.is_maximized();
            if !window.is_maximized() {
                (self.settings.window.width, self.settings.window.height) = (size.width, size.height);
            }
        }
        let Some(file) = &mut self.settings_file else { return };
        if let Err(error) = file.save(&self.settings) {
            self.desk.settings_fault(error.to_string());
            // Told once; the person may have a reason to keep that file as it is.
            self.settings_file = None;
        }
    }
}

/// What a world's settings are kept under.
fn world_key(source: &Source) -> String {
    match source {
        Source::World(root) => {
            std::fs::canonicalize(root).unwrap_or_else(|_| root.clone()).display().to_string()
        }
        Source::Scenes(_) => "scenes".to_owned(),
    }
}

impl ApplicationHandler<Wake> for App {
    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { .. }, Some(live)) = (cause, &self.live) {
            live.screen.window.request_redraw();
        }
    }

    fn resumed(&mut self, events: &ActiveEventLoop) {
        events.set_control_flow(ControlFlow::Wait);
        if self.live.is_some() {
            return;
        }
        match self.enliven(events) {
            Ok(live) => self.live = Some(live),
            Err(failure) => {
                self.failure = Some(failure);
                events.exit();
            }
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, _: Wake) {
        if let Some(live) = &self.live {
            live.screen.window.request_redraw();
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(live) = &mut self.live else { return };
        let taken = if self.pilot.captured() && is_pointer(&event) {
            false
        } else {
            live.screen.input.on_window_event(&live.screen.window, &event).consumed
        };
        match event {
            WindowEvent::CloseRequested => self.dispatch(Event::Quit, events),
            WindowEvent::Resized(size) => live.screen.resize(size.width, size.height),
            WindowEvent::RedrawRequested => self.frame(events),
            WindowEvent::Focused(false) => {
                self.pilot.let_go();
                self.dispatch(Event::Capture(false), events);
            }
            // A key that was pressed before one began to type is released all the same.
            WindowEvent::KeyboardInput { event, .. }
                if !self.typing || event.state == ElementState::Released =>
            {
                let PhysicalKey::Code(code) = event.physical_key else { return };
                if taken && event.state == ElementState::Pressed && code == winit::keyboard::KeyCode::Tab {
                    return;
                }
                if let Some(action) = self.pilot.key(code, event.state, event.repeat) {
                    self.act(action);
                }
            }
            WindowEvent::MouseInput { state, button, .. } if self.pilot.captured() => {
                if let Some(action) = self.pilot.button(button, state) {
                    self.act(action);
                }
            }
            WindowEvent::MouseWheel { delta, .. } if self.pilot.captured() || self.free_pointer => {
                self.pilot.wheel(match delta {
                    MouseScrollDelta::LineDelta(_, lines) => lines,
                    MouseScrollDelta::PixelDelta(pixels) => pixels.y as f32 / 40.0,
                });
            }
            _ => {}
        }
    }

    fn device_event(&mut self, _: &ActiveEventLoop, _: DeviceId, event: DeviceEvent) {
        if let DeviceEvent::MouseMotion { delta: (x, y) } = event
            && self.pilot.captured()
        {
            self.pilot.turn(x as f32, y as f32);
        }
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        self.keep_settings();
        self.baker = None;
        self.log.note("end", json!({}));
    }
}

impl App {
    fn enliven(&mut self, events: &ActiveEventLoop) -> Result<Live> {
        let kept = self.settings.window;
        let [width, height] = self.start.size.unwrap_or([kept.width, kept.height]);
        let attributes = WindowAttributes::default()
            .with_title("Genescape")
            .with_maximized(kept.maximized && self.start.size.is_none())
            .with_inner_size(winit::dpi::LogicalSize::new(width.max(480.0), height.max(320.0)));
        let window = Arc::new(events.create_window(attributes).context("no window can be opened")?);
        let (screen, gpu) = Screen::open(window)?;
        if self.log.is_on() {
            screen.ctx.enable_accesskit();
        }
        self.log.note("start", json!({ "version": env!("CARGO_PKG_VERSION"), "adapter": gpu.name }));
        let shaders = match &self.start.shaders {
            Some(folder) => Shaders::from_folder(folder.clone()),
            None => Shaders::builtin(),
        };
        if !gpu.software && self.settings == Settings::default() {
            // Nobody has chosen yet, and a card can afford smooth edges.
            self.settings.options.samples = 4;
        }
        let show = Show::new(&gpu, shaders, &self.settings.options)?;
        let loader = Loader::start(&gpu, self.wake())?;
        screen.window.request_redraw();
        Ok(Live { screen, gpu, show, loader })
    }
}

fn is_pointer(event: &WindowEvent) -> bool {
    matches!(
        event,
        WindowEvent::CursorMoved { .. } | WindowEvent::MouseInput { .. } | WindowEvent::MouseWheel { .. }
    )
}
