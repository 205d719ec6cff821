//! The application: a window, and a loop that hands each event to its owner. What each does is in its own file: [`editor`]
//! (the person's work), [`background`] (files that change and bakes), [`viewports`] (the pictures), [`pace`] (when they are
//! drawn), [`camera_control`], [`screen`] (the window), [`log`] (what happened).

mod background;
mod camera_control;
mod dispatch;
mod drag_out;
mod editor;
mod exports;
mod layout;
mod lod_readback;
mod log;
mod model;
mod pace;
mod questions;
mod screen;
mod sharpness;
mod taught;
mod thumbnails;
mod ui_painter;
mod viewport;
mod viewports;
mod window_events;

use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use genescape_schema::{INDIVIDUALS, printable};
use genescape_world::{Change, Source, Watch, World};
use serde_json::json;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};

use crate::baker::Baker;
use crate::cli::Cli;
use crate::event::{Arrangement, Event};
use crate::gpu::Gpu;
use crate::input::Bindings;
use crate::loader::{Loader, Request};
use crate::options::FrameInput;
use crate::questionnaire::Answers;
use crate::settings::{Bookmark, Comfort, SettingsFile, WorldSettings};
use crate::ui::model::{Model, ViewState};
use crate::ui::{self, Tone};
use crate::upload::Exhibit;
use crate::walk::{Land, Mode};
use background::Background;
use camera_control::CameraControl;
use editor::{Editor, Task};
use exports::Exports;
use layout::Layout;
use log::{Log, Moment};
use pace::{Next, Pace, Shown};
use screen::Screen;
use sharpness::Sharpness;
use taught::Taught;
use thumbnails::Thumbnails;
use viewports::{Viewports, Wish};

/// Between two looks at whether settings have to be saved.
const SAVE_EVERY: Duration = Duration::from_secs(2);

/// Until the device is asked again for what is on its way, and a change told that came too soon after another.
const LOOK_AGAIN: Duration = Duration::from_millis(100);
/// Between two looks at the gamepad while nothing else happens.
const GAMEPAD_EVERY: Duration = Duration::from_millis(30);
/// A frame that follows sooner belongs to the same motion.
const CONTINUOUS: Duration = Duration::from_millis(50);

/// Wakes the loop: something is new somewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wake {
    Now,
    /// When there is time.
    Soon,
}

/// Opens the window with the landscapes of `source` and stays until it is closed.
pub fn run(cli: Cli, source: Source) -> Result<()> {
    let events = EventLoop::<Wake>::with_user_event().build().context(
        "no window can be opened; without a display `viewer --screenshot OUT.png` draws to a file",
    )?;
    let log = Log::create(cli.log.as_deref())?;
    explain_a_lost_display();
    let mut app = App::new(cli, source, log, events.create_proxy());
    events.run_app(&mut app)?;
    app.failure.map_or(Ok(()), Err)
}

/// winit panics when the display goes, at whatever it asks of it next; that is told in words, without a backtrace. What the
/// person made is in files already.
fn explain_a_lost_display() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if panic.location().is_some_and(|place| place.file().contains("winit")) {
            eprintln!("error: the display is gone, or no longer answers");
            std::process::exit(1);
        }
        usual(panic);
    }));
}

/// All parts of the application; each has one owner, and none owns the others.
struct App {
    cli: Cli,
    /// Where landscapes come from.
    source: Source,
    proxy: EventLoopProxy<Wake>,
    log: Log,
    file: SettingsFile,
    /// Those of the settings, which change only while the program is closed.
    bindings: Arc<Bindings>,
    layout: Layout,
    editor: Editor,
    camera: CameraControl,
    ui: ui::State,
    focus: Focus,
    background: Background,
    exports: Exports,
    thumbnails: Thumbnails,
    taught: Taught,
    /// What is answered of the questionnaire so far.
    answers: Answers,
    /// Answers that the window was opened for are kept.
    answered: bool,
    pace: Pace,
    /// When settings were saved last, if they had changed.
    last_save: Instant,
    /// A picture of the screen is to be saved as soon as one is drawn.
    screenshot: bool,
    live: Option<Live>,
    /// Why no window could be opened.
    failure: Option<anyhow::Error>,
}

/// What exists once there is a window.
struct Live {
    screen: Screen,
    gpu: Gpu,
    viewports: Viewports,
    loader: Loader,
}

/// Where keys and wheel go, as the user interface said in its last frame.
#[derive(Clone, Copy, Default)]
struct Focus {
    /// Into a text field: keys are no commands.
    typing: bool,
    /// Nothing lies between the pointer and a picture: the wheel is the camera's.
    on_picture: bool,
}

impl App {
    fn new(cli: Cli, source: Source, log: Log, proxy: EventLoopProxy<Wake>) -> Self {
        let (mut file, problems) = SettingsFile::open(cli.settings.clone().or_else(SettingsFile::usual_path));
        if cli.answers.is_some() {
            file.settings.options = cli.drawing;
        }
        let (mut camera, problem) = CameraControl::new();
        let kept = file.settings.world(&source);
        let editor = Editor::open(source.clone(), &kept);
        camera.return_to(place_to_return_to(&editor, &kept, &file.settings.comfort.value));
        let now = Instant::now();
        let mut app = Self {
            layout: Layout::of(editor.count(), Default::default()),
            bindings: Arc::new(file.settings.bindings.value.clone()),
            file,
            editor,
            camera,
            ui: ui::State::default(),
            focus: Focus::default(),
            background: Background::default(),
            exports: Exports::default(),
            thumbnails: Thumbnails::default(),
            taught: Taught::default(),
            answers: Answers::default(),
            answered: false,
            pace: Pace::new(now),
            last_save: now,
            screenshot: false,
            live: None,
            failure: None,
            log,
            proxy,
            source,
            cli,
        };
        problems.into_iter().for_each(|problem| app.tell(Tone::Warning, problem));
        problem.into_iter().for_each(|problem| app.tell(Tone::Info, problem));
        app.start_background();
        app
    }

    fn tell(&mut self, tone: Tone, text: impl Into<String>) {
        self.offer(tone, text, None);
    }

    /// Tells something; a click on the notice asks for `event`.
    fn offer(&mut self, tone: Tone, text: impl Into<String>, event: impl Into<Option<Event>>) {
        let text = text.into();
        self.log.note("told", json!({ "text": text }));
        self.ui.notify(tone, text, event.into());
        self.redraw();
    }

    /// Asks for another frame.
    fn redraw(&self) {
        if let Some(live) = &self.live {
            live.screen.window.request_redraw();
        }
    }

    fn wake(&self, wake: Wake) -> impl Fn() + Send + Sync + 'static {
        let proxy = self.proxy.clone();
        // The loop is gone only when the program ends.
        move || {
            let _ = proxy.send_event(wake);
        }
    }

    /// Shows another world or other scenes.
    fn open(&mut self, source: Source) {
        self.save_settings();
        let kept = self.file.settings.world(&source);
        self.editor = Editor::open(source.clone(), &kept);
        self.layout = Layout::of(self.editor.count(), self.layout.panels);
        (self.thumbnails, self.taught) = Default::default();
        self.source = source;
        let comfort = &self.file.settings.comfort.value;
        self.camera.return_to(place_to_return_to(&self.editor, &kept, comfort));
        if let Some(live) = &mut self.live {
            live.viewports.clear();
            live.screen.window.set_title(&title(&self.source));
        }
        self.start_background();
    }

    /// One frame.
    fn frame(&mut self, events: &ActiveEventLoop) {
        let passed = self.pace.begin(Instant::now());
        self.gather();
        self.share_processor();
        self.step_camera(passed, events);
        let model = self.model();
        let Some((output, shown)) = self.draw(&model) else { return };
        self.keep_thumbnails(&model, &shown);
        if std::mem::take(&mut self.screenshot) {
            self.save_screenshot();
        }
        self.focus = Focus { typing: output.typing, on_picture: output.views.free };
        self.drag(&output.views);
        output.events.into_iter().for_each(|event| self.dispatch(event, events));
        self.background.baker.iter().for_each(|baker| baker.cast(self.editor.ballots));
        if self.last_save.elapsed() > SAVE_EVERY {
            self.save_settings();
        }
        if self.answered {
            events.exit();
        }
        self.wait(events, shown);
    }

    /// Takes small pictures of a generation when all of it is shown, and reads those that the family tree shows.
    fn keep_thumbnails(&mut self, model: &Model, shown: &Shown) {
        let (Some(live), Some(root)) = (&self.live, self.editor.world()) else { return };
        let world = World::new(root);
        let is_ready =
            model.views.iter().all(|view| view.state == ViewState::Ready && view.picture.is_some());
        let is_whole = is_ready && !shown.blurred && !self.editor.is_busy();
        if is_whole
            && model.arrangement == Arrangement::Grid
            && self.thumbnails.wants(&world, model.generation)
            && let Ok(pictures) = live.viewports.pixels(&self.layout.shown())
            && pictures.len() == INDIVIDUALS
        {
            self.thumbnails.keep(&live.screen.ctx, &world, model.generation, pictures);
        }
        if model.panels.family && self.thumbnails.read(&live.screen.ctx, &world, &model.generations) {
            live.screen.ctx.request_repaint();
        }
    }

    /// Takes in what other threads have brought.
    fn gather(&mut self) {
        let baked: Vec<_> = self.background.baker.iter().flat_map(Baker::events).collect();
        baked.into_iter().for_each(|event| self.editor.baked(event));
        let changes: Vec<Change> = self.background.watch.iter().flat_map(Watch::changes).collect();
        for change in changes {
            if change == Change::Shaders {
                self.reload_shaders();
            }
            self.editor.changed(change);
        }
        self.show_loaded();
        self.hear_exports();
        self.hear_votes();
        if self.live.is_some() {
            self.editor.take_tasks().into_iter().for_each(|task| self.carry_out(task));
        }
        self.finish_shadows();
    }

    /// When no landscape is on its way, those on show get the rest of their shadows.
    fn finish_shadows(&mut self) {
        let Some(live) = &mut self.live else { return };
        live.loader.shadowed().for_each(|buffers| live.viewports.shadowed(&buffers));
        if !self.editor.is_busy() {
            let passes = live.viewports.passes();
            let lacking = live.viewports.ask_for_shadows();
            lacking.into_iter().for_each(|buffers| live.loader.finish_shadows(buffers, passes.clone()));
        }
    }

    /// Puts landscapes that were read meanwhile into the viewports.
    fn show_loaded(&mut self) {
        let Some(live) = &mut self.live else { return };
        let (mut changed, mut files, mut notes) = (false, None, Vec::new());
        for reply in live.loader.replies() {
            let told = reply.result.as_ref().map(|_| ()).map_err(String::as_str);
            if self.editor.loaded(reply.view, reply.generation, told)
                && let Ok(loaded) = reply.result
            {
                let notes_of = |exhibit: &Exhibit| exhibit.asset().map(|asset| asset.facts.notes.clone());
                let known = live.viewports.exhibit(reply.view).and_then(notes_of).unwrap_or_default();
                notes.extend(
                    notes_of(&loaded.exhibit).into_iter().flatten().filter(|note| !known.contains(note)),
                );
                files = (!loaded.files.is_empty()).then(|| loaded.files.clone());
                live.viewports.show(reply.view, loaded, reply.generation);
                changed = true;
            }
        }
        if changed {
            let of_generation = |view: &usize| self.editor.state(*view) == ViewState::Ready;
            let own = (0..INDIVIDUALS).filter(of_generation).filter_map(|view| live.viewports.land(view));
            self.camera.lands_changed(&live.viewports.lands(), &own.collect::<Vec<_>>());
        }
        if let Some(first) = notes.first() {
            let more = if notes.len() > 1 { "; more in “About this file”" } else { "" };
            self.tell(Tone::Info, format!("{first}{more}"));
        }
        if let Some(files) = files.filter(|files| *files != self.background.more_files) {
            self.watch_files(files);
        }
    }

    fn carry_out(&mut self, task: Task) {
        match task {
            Task::Tell(tone, text) => self.tell(tone, text),
            Task::Offer(text, event) => self.offer(Tone::Info, text, event),
            Task::BeginWalk if self.file.settings.comfort.value.stay => {}
            Task::BeginWalk => self.camera.await_landscapes(),
            Task::Load { view, generation, path } => {
                if let Some(live) = &self.live {
                    let (eye_m, anchor) = (self.camera.eye_m(), live.viewports.anchor(view, generation));
                    let passes = live.viewports.passes();
                    live.loader.ask(Request { view, generation, path, eye_m, anchor, passes });
                }
            }
        }
    }

    fn reload_shaders(&mut self) {
        let Some(live) = &mut self.live else { return };
        match live.viewports.reload_shaders(self.file.settings.options.samples) {
            Ok(()) => {
                self.editor.shaders(None);
                self.tell(Tone::Success, "Shaders are new");
            }
            Err(error) => self.editor.shaders(Some(error.to_string())),
        }
    }

    /// Where the processor draws, pictures leave it to what a person waits for.
    fn share_processor(&mut self) {
        let Some(live) = self.live.as_ref().filter(|live| live.gpu.software) else { return };
        self.pace
            .share(self.editor.is_busy() || self.editor.awaits_scenes() || live.viewports.awaits_shadows());
    }

    fn step_camera(&mut self, passed: Duration, events: &ActiveEventLoop) {
        let comfort = &self.file.settings.comfort.value;
        let step = self.camera.step(passed.as_secs_f32(), comfort, &lands(&self.live));
        self.file.settings.greeted |= self.camera.is_steered() && self.live.is_some();
        self.pace.camera(step.moving, &self.file.settings.options);
        step.commands.into_iter().for_each(|command| self.dispatch(command.into(), events));
    }

    /// Draws the landscapes and the user interface; what the person did there.
    fn draw(&mut self, model: &Model) -> Option<(ui::Output, Shown)> {
        let Live { screen, gpu, viewports, .. } = self.live.as_mut()?;
        let options = self.file.settings.options;
        let frame = FrameInput { options, time_s: self.pace.drifted_s(), ..FrameInput::default() };
        let sharpness = if self.screenshot { Sharpness::Full } else { self.pace.sharpness(&options) };
        if let Err(error) = viewports.set_samples(options.samples) {
            self.editor.shaders(Some(error.to_string()));
        }
        ui::theme::follow(&screen.ctx, &model.comfort);
        let input = screen.take_input();
        let ctx = screen.ctx.clone();
        let mut output = ui::Output::default();
        let full = ctx.run_ui(input, |ui| output = ui::show(ui, model, &mut self.ui));
        let accessible = full.platform_output.accesskit_update.as_ref();
        let accessible = accessible.filter(|_| self.log.wants_widgets());
        let widgets = accessible.map(|update| log::widgets(update, full.pixels_per_point));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let (slots, painter) = (&output.views.slots, &mut screen.painter);
        let is_outdated = |view: usize| self.pace.is_shared() && model.views[view].state.is_to_come();
        let refines = options.refine && self.pace.refines();
        let wish = Wish { frame, sharpness, refines, outdated: std::array::from_fn(is_outdated) };
        let shown = viewports.record(&mut encoder, painter, slots, &wish, &self.camera);
        let again = if (0..model.views.len()).any(|view| viewports.picture(view) != model.views[view].picture)
        {
            // A first picture, which the user interface did not know of yet.
            Some(Duration::ZERO)
        } else {
            full.viewport_output.get(&egui::ViewportId::ROOT).map(|viewport| viewport.repaint_delay)
        };
        let visible = screen.present(full, encoder);
        viewports.end_frame(self.layout.panels.stats);
        self.log.frame(Moment {
            model,
            landscapes: std::array::from_fn(|view| viewports.exhibit(view)),
            pose: self.camera.rig.pose(),
            size_px: screen.window.inner_size().into(),
            widgets,
        });
        if !visible {
            std::thread::sleep(Duration::from_millis(50));
        }
        Some((output, Shown { again, ..shown }))
    }

    /// Dragging a picture looks around without locking the pointer: what is grabbed follows it. Around what an orbit circles
    /// the eye goes the other way for that.
    fn drag(&mut self, views: &ui::Views) {
        if views.dragged != egui::Vec2::ZERO && !self.camera.captured() {
            let scale = self.live.as_ref().map_or(1.0, |live| live.screen.ctx.pixels_per_point());
            let way = if self.camera.rig.pose().mode == Mode::Orbit { scale } else { -scale };
            self.camera.held.mouse_moved(way * views.dragged.x, way * views.dragged.y);
            self.redraw();
        }
    }

    /// Waits for the next frame or the next event.
    fn wait(&mut self, events: &ActiveEventLoop, shown: Shown) {
        let Some(live) = &mut self.live else { return };
        let now = Instant::now();
        let next = self.pace.end(now, shown);
        if !matches!(next, Next::At(at) if at <= now + CONTINUOUS) {
            live.viewports.pause();
        }
        // What is not of this frame, but has to be done although nothing happens.
        let unsaved = (self.last_save < self.pace.frame_began()).then_some(self.last_save + SAVE_EVERY);
        let untold = (live.viewports.awaits_stats() || self.log.is_behind()).then_some(now + LOOK_AGAIN);
        let unheard = self.camera.has_gamepad().then_some(now + GAMEPAD_EVERY);
        let (is_due, refining) = (matches!(next, Next::At(_)), matches!(next, Next::Finer(_)));
        self.log.rest(!is_due && untold.is_none(), refining);
        let next = match next {
            Next::At(at) | Next::Finer(at) => Some(at),
            Next::OnEvent => None,
        };
        match [next, unsaved, untold, unheard].into_iter().flatten().min() {
            Some(at) if at <= now => {
                // Or a moment that has passed would wake the loop again and again.
                events.set_control_flow(ControlFlow::Wait);
                live.screen.window.request_redraw();
            }
            Some(at) => events.set_control_flow(ControlFlow::WaitUntil(at)),
            None => events.set_control_flow(ControlFlow::Wait),
        }
    }

    /// Writes settings down if they changed.
    fn save_settings(&mut self) {
        self.last_save = Instant::now();
        let (source, settings) = (&self.source, &mut self.file.settings);
        let mut kept = settings.world(source);
        self.editor.keep(&mut kept);
        // Not at every step of a walk, or the file would be written for as long as it goes.
        if self.editor.world().is_some() {
            kept.place = self.camera.rested_at().or(kept.place);
            kept.generation = Some(self.editor.generations().0);
        }
        if kept != settings.world(source) {
            *settings.world_mut(source) = kept;
        }
        if let Some(live) = &self.live {
            live.screen.keep(&mut settings.window);
        }
        if let Err(error) = self.file.save() {
            self.editor.settings_fault(error.to_string());
        }
    }
}

/// What the window is called.
fn title(source: &Source) -> String {
    match source {
        Source::Scenes(paths) if paths.len() == 1 => {
            let name = paths[0].file_name().unwrap_or_default().to_string_lossy();
            format!("{} – Genescape", printable(&name))
        }
        _ => "Genescape".to_owned(),
    }
}

/// Where the last session has ended, unless a generation was born since and has a start of its own.
fn place_to_return_to<'a>(
    editor: &Editor,
    kept: &'a WorldSettings,
    comfort: &Comfort,
) -> Option<&'a Bookmark> {
    let is_known = kept.generation.is_none_or(|generation| generation >= editor.generations().0);
    kept.place.as_ref().filter(|_| is_known || comfort.stay)
}

/// The lands that a walker is in.
fn lands(live: &Option<Live>) -> Vec<&Land> {
    live.as_ref().map(|live| live.viewports.lands()).unwrap_or_default()
}
