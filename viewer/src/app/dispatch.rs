//! Events and actions → their owners. The one place that knows who takes what.

use genescape_schema::Category;
use winit::event_loop::ActiveEventLoop;
use winit::window::Fullscreen;

use super::App;
use super::desk::Source;
use crate::event::{Arrangement, Ballot, Event, Panel, Phase};
use crate::frame::Options;
use crate::input::Action;
use crate::lod_mode::LodMode;
use crate::picture_file::{self, Pixels};
use crate::screenshot;
use crate::ui::Tone;

impl App {
    /// An event of the user interface.
    pub(super) fn dispatch(&mut self, event: Event, events: &ActiveEventLoop) {
        self.log.wish(&event);
        match event {
            Event::Quit => events.exit(),
            other => self.handle(other),
        }
    }

    fn handle(&mut self, event: Event) {
        match event {
            Event::Vote { category, ballot } => self.desk.vote(category, ballot),
            Event::NextGeneration => self.desk.breed(),
            Event::Undo => self.desk.undo(),
            Event::Redo => self.desk.redo(),
            Event::GoToGeneration(generation) => self.desk.visit(generation),
            Event::Arrange(arrangement) => self.arrangement = arrangement,
            Event::Choose(individual) => self.chosen = individual,
            // While it moves the panel shows it; it is baked when it rests.
            Event::Gene { phase: Phase::Dragging, .. } => {}
            Event::Gene { individual, name, value, phase: Phase::Committed } => {
                self.desk.set_genes(individual, vec![(name, value)]);
            }
            Event::Genes { individual, values } => self.desk.set_genes(individual, values),
            Event::LockGene { name, locked } => self.desk.lock(&name, locked),
            Event::LockCategory { category, locked } => self.desk.lock(category.name(), locked),
            Event::Options(options) => self.settings.options = options,
            Event::Comfort(comfort) => self.comfort = comfort,
            Event::ResetSettings => {
                self.settings.options = Options::default();
                self.comfort = Default::default();
            }
            Event::Panel { panel, open } => self.panels.set(panel, open),
            Event::Screenshot => self.screenshot_wanted = true,
            Event::SetBookmark(number) => self.set_bookmark(number),
            Event::GoToBookmark(number) => self.go_to_bookmark(number),
            Event::GoToStart => {
                let lands = self.lands();
                self.pilot.go_to_start(&lands, None);
            }
            Event::OpenFolder(path) => match Source::of(&path) {
                Ok(source) => self.open(source),
                Err(error) => self.ui.notify(Tone::Error, error),
            },
            Event::Retry => self.desk.retry(),
            Event::DismissError(index) => self.desk.dismiss(index),
            Event::Capture(captured) => self.capture(captured),
            // Only the loop can end itself.
            Event::Quit => {}
        }
    }

    /// An action of a key, a button or a gamepad.
    pub(super) fn act(&mut self, action: Action) {
        self.log.wish(&action);
        let options = &mut self.settings.options;
        match action {
            Action::Forward | Action::Back | Action::Left | Action::Right => {}
            Action::Up | Action::Down | Action::Run => {}
            Action::ToggleWalkFlyOrbit => {
                let lands = self.lands();
                self.pilot.cycle_mode(&lands);
                let mode = format!("{:?}", self.pilot.mode());
                self.ui.notify(Tone::Info, mode);
            }
            Action::ReleaseMouse => self.capture(false),
            Action::GoToStart => self.handle(Event::GoToStart),
            Action::Maximise(view) => self.maximise(usize::from(view)),
            Action::ShowAll => self.arrangement = Arrangement::Grid,
            Action::CompareAB => self.compare(),
            Action::Vote(category, best) => self.vote_by_key(category, best),
            Action::NextGeneration => self.desk.breed(),
            Action::Undo => self.desk.undo(),
            Action::Redo => self.desk.redo(),
            Action::OlderGeneration => self.step_generation(-1),
            Action::NewerGeneration => self.step_generation(1),
            Action::SetBookmark(number) => self.set_bookmark(number),
            Action::GoBookmark(number) => self.go_to_bookmark(number),
            Action::ToggleHelp => self.toggle(Panel::Help),
            Action::ToggleGenome => self.toggle(Panel::Genome),
            Action::ToggleStats => self.toggle(Panel::Stats),
            Action::ToggleSettings => self.toggle(Panel::Settings),
            Action::ToggleFullscreen => self.toggle_fullscreen(),
            Action::Screenshot => self.screenshot_wanted = true,
            Action::Quit => self.quit_wanted = true,
            Action::CycleTreeScheme => {
                options.tree_lod = options.tree_lod.next();
                let text = format!("Trees' levels of detail: {}", options.tree_lod.label());
                self.ui.notify(Tone::Info, text);
            }
            Action::CycleTerrainScheme => {
                options.terrain_lod = options.terrain_lod.next();
                let text = format!("Terrain's levels of detail: {}", options.terrain_lod.label());
                self.ui.notify(Tone::Info, text);
            }
            Action::ToggleWireframe => options.wireframe ^= true,
            Action::ToggleTint => options.tint_levels ^= true,
            Action::ToggleOverhead => options.overhead ^= true,
        }
    }

    fn lands(&self) -> Vec<std::sync::Arc<crate::walk::Land>> {
        self.live.as_ref().map(|live| live.show.lands()).unwrap_or_default()
    }

    fn capture(&mut self, captured: bool) {
        if let Some(live) = &self.live {
            self.pilot.capture(&live.screen.window, captured);
        }
    }

    fn maximise(&mut self, view: usize) {
        self.chosen = view;
        let one = Arrangement::One(view);
        self.arrangement = if self.arrangement == one { Arrangement::Grid } else { one };
    }

    /// The chosen landscape beside the next; again: beside the one after.
    fn compare(&mut self) {
        self.arrangement = match self.arrangement {
            Arrangement::Compare { left, right } => {
                let next = (right + 1) % genescape_schema::INDIVIDUALS;
                if next == left { Arrangement::Grid } else { Arrangement::Compare { left, right: next } }
            }
            _ => {
                let left = self.chosen;
                Arrangement::Compare { left, right: (left + 1) % genescape_schema::INDIVIDUALS }
            }
        };
    }

    /// The same key again takes the vote back.
    fn vote_by_key(&mut self, category: Category, best: Option<u8>) {
        let ballot = best.map_or(Ballot::Nobody, |best| Ballot::For(usize::from(best)));
        let known = self.desk.ballots().get(category);
        self.desk.vote(category, if known == ballot { Ballot::Open } else { ballot });
    }

    fn step_generation(&mut self, by: isize) {
        match self.desk.neighbour(by) {
            Some(generation) => self.desk.visit(generation),
            None => {
                self.ui.notify(Tone::Info, if by < 0 { "This is the first" } else { "This is the newest" })
            }
        }
    }

    fn toggle(&mut self, panel: Panel) {
        self.panels.set(panel, !self.panels.is_open(panel));
    }

    fn toggle_fullscreen(&self) {
        let Some(live) = &self.live else { return };
        let window = &live.screen.window;
        let next = if window.fullscreen().is_some() { None } else { Some(Fullscreen::Borderless(None)) };
        window.set_fullscreen(next);
    }

    fn set_bookmark(&mut self, number: u8) {
        let key = super::world_key(&self.start.source);
        let marks = &mut self.settings.worlds.entry(key).or_default().bookmarks;
        marks.insert(number, self.pilot.bookmark());
        self.ui.notify(Tone::Success, format!("This place is bookmark {number}"));
    }

    fn go_to_bookmark(&mut self, number: u8) {
        let world = self.settings.worlds.get(&super::world_key(&self.start.source));
        match world.and_then(|world| world.bookmarks.get(&number)).copied() {
            Some(mark) => {
                let lands = self.lands();
                self.pilot.go_to(&mark, &lands);
            }
            None => self.ui.notify(Tone::Info, format!("Bookmark {number} is not set")),
        }
    }

    /// Saves the pictures that are on the screen, side by side as they are there.
    pub(super) fn save_screenshot(&mut self) {
        let Some(live) = &self.live else { return };
        let shown: Vec<usize> = match self.arrangement {
            Arrangement::Grid => (0..genescape_schema::INDIVIDUALS).collect(),
            Arrangement::One(view) => vec![view],
            Arrangement::Compare { left, right } => vec![left, right],
        };
        let taken = live.show.pixels(&shown).and_then(|pictures: Vec<Pixels>| {
            let sheet = screenshot::sheet(&pictures, 2.min(pictures.len().max(1)));
            let sheet = sheet.ok_or_else(|| anyhow::anyhow!("there is no picture yet"))?;
            std::fs::create_dir_all(&self.start.pictures)?;
            let free = (1..10_000)
                .map(|number| self.start.pictures.join(format!("genescape-{number:04}.png")))
                .find(|path| !path.exists());
            let path = free.ok_or_else(|| anyhow::anyhow!("there are ten thousand pictures already"))?;
            picture_file::write_png(&path, &sheet)?;
            Ok(path)
        });
        match taken {
            Ok(path) => self.ui.notify(Tone::Success, format!("Saved {}", path.display())),
            Err(error) => self.ui.notify(Tone::Error, format!("No picture was saved: {error:#}")),
        }
    }
}
