//! Events → their owners. The one place that knows who takes what.

use genescape_schema::Category;
use genescape_world::Source;
use winit::event_loop::ActiveEventLoop;
use winit::window::Fullscreen;

use super::exports::Then;
use super::{App, lands};
use crate::ballots::Ballot;
use crate::event::{Arrangement, Event, Panel};
use crate::image_file;
use crate::input::{Best, Command};
use crate::lod_mode::LodMode;
use crate::options::Options;
use crate::ui::Tone;

const NOT_IN_A_STUDY: &str = "Not in a study: walk, look, and answer (Q) when you have seen enough";

/// What would tell the levels of detail under study, change them, lead to other landscapes, or leave something in the world
/// that the next participant would see.
fn is_hidden(command: Command) -> bool {
    use Command::*;
    let of_laboratory = [NextTreeLod, NextTerrainLod, Wireframe, Tint, Overhead, Stats, Settings, Genome];
    let of_others = [NextGeneration, BreedAgain, OlderGeneration, NewerGeneration, Family, Export];
    let of_world = matches!(command, Vote(_) | Undo | Redo);
    of_world || of_laboratory.contains(&command) || of_others.contains(&command)
}

/// The same of what is pressed instead.
fn is_hidden_event(event: &Event) -> bool {
    match event {
        Event::Panel { panel, .. } => !matches!(panel, Panel::Help | Panel::Questions),
        Event::Options(_) | Event::Comfort(_) | Event::ResetSettings | Event::Genes { .. } => true,
        Event::GoToGeneration(_) | Event::BreedFrom { .. } | Event::MoreLike(_) | Event::OpenFolder(_) => {
            true
        }
        Event::Vote { .. } | Event::Star { .. } | Event::Variety(_) => true,
        Event::LockGene { .. } | Event::LockCategory { .. } => true,
        _ => false,
    }
}

impl App {
    pub(super) fn dispatch(&mut self, event: Event, events: &ActiveEventLoop) {
        self.redraw();
        if let Event::Command(command) = event {
            return self.command(command, events);
        }
        self.log.event(&event);
        if self.cli.answers.is_some() && is_hidden_event(&event) {
            return self.tell(Tone::Info, NOT_IN_A_STUDY);
        }
        let settings = &mut self.file.settings;
        match event {
            Event::Command(_) => {}
            Event::Vote { category, ballot } => self.vote(category, ballot),
            Event::GoToGeneration(generation) => self.editor.visit(generation),
            Event::Variety(variety) => self.editor.set_variety(variety),
            Event::MoreLike(view) => self.editor.breed_more_like(view),
            Event::Star { generation, landscape, starred } => {
                self.editor.star(generation, landscape, starred);
            }
            Event::BreedFrom { generation, landscape, category } => {
                self.editor.breed_with(generation, landscape, category);
            }
            Event::Arrange(arrangement) => self.layout.arrange(arrangement),
            Event::Choose(individual) => self.layout.chosen = individual,
            Event::Genes { individual, values } => self.editor.set_genes(individual, values),
            Event::LockGene { name, locked } => self.editor.lock(&name, locked),
            Event::LockCategory { category, locked } => self.editor.lock(category.name(), locked),
            Event::Options(options) => settings.options = options,
            Event::Comfort(comfort) => settings.comfort.value = comfort,
            Event::Answers(answers) => self.answers = answers,
            Event::KeepAnswers => self.keep_answers(),
            Event::ExportChoice(choice) => settings.export.value = choice,
            Event::Export(view) => self.export(view, Then::Tell),
            Event::DragOut(view) => self.drag_out(view),
            Event::ChooseExportFolder => self.exports.choose_folder(self.wake(super::Wake::Now)),
            Event::ShowExported => self.show_exported(),
            Event::CopyExported => self.copy_exported(),
            Event::ResetSettings => {
                settings.options = Options::default();
                settings.comfort = Default::default();
            }
            Event::Panel { panel, open } => self.layout.panels.set(panel, open),
            Event::OpenFolder(path) => match Source::of(&path) {
                Ok(source) => self.open(source),
                Err(error) => self.tell(Tone::Error, error.to_string()),
            },
            Event::Retry => self.editor.retry(),
            Event::DismissError(index) => self.editor.dismiss(index),
            Event::Capture(captured) => self.capture(captured),
        }
    }

    /// Whether what is shown is anyone's file.
    fn shows_file(&self) -> bool {
        lands(&self.live).iter().any(|land| land.subject.is_some())
    }

    fn command(&mut self, command: Command, events: &ActiveEventLoop) {
        self.log.event(&command);
        if self.cli.answers.is_some() && is_hidden(command) {
            return self.tell(Tone::Info, NOT_IN_A_STUDY);
        }
        let of_file = self.shows_file();
        let options = &mut self.file.settings.options;
        match command {
            // Held: the camera asks for them at each frame.
            Command::Forward | Command::Back | Command::Left | Command::Right => {}
            Command::Up | Command::Down | Command::Run => {}
            Command::WalkFlyOrbit => {
                let mode = self.camera.next_mode(&lands(&self.live));
                self.tell(Tone::Info, format!("{mode:?}"));
            }
            Command::ReleaseMouse => self.capture(false),
            Command::GoToStart => {
                self.live.iter_mut().for_each(|live| live.viewports.anchor_anew());
                self.camera.go_to_start(&lands(&self.live));
            }
            Command::Maximise(landscape) => self.layout.maximise(usize::from(landscape) - 1),
            Command::ShowAll => self.layout.arrange(Arrangement::Grid),
            Command::Compare => self.layout.compare(),
            Command::Vote(Best { category, landscape }) => self.vote_by_key(category, landscape),
            Command::NextGeneration => self.editor.breed(),
            Command::BreedAgain => self.editor.breed_again(),
            Command::Undo => self.editor.undo(),
            Command::Redo => self.editor.redo(),
            Command::OlderGeneration => self.step_generation(-1),
            Command::NewerGeneration => self.step_generation(1),
            Command::SetBookmark(number) => self.set_bookmark(number),
            Command::GoToBookmark(number) => self.go_to_bookmark(number),
            Command::Help => self.layout.toggle(Panel::Help),
            Command::Genome => self.layout.toggle(Panel::Genome),
            Command::Stats => self.layout.toggle(Panel::Stats),
            Command::Settings => self.layout.toggle(Panel::Settings),
            Command::Fullscreen => self.toggle_fullscreen(),
            Command::Screenshot => self.screenshot = true,
            Command::Export if of_file => {
                self.tell(Tone::Info, "Only landscapes are exported: this is a file already");
            }
            Command::Export => self.layout.toggle(Panel::Export),
            Command::Family => self.layout.toggle(Panel::Family),
            Command::Questions => self.layout.toggle(Panel::Questions),
            Command::Quit => events.exit(),
            Command::NextTreeLod => {
                let (chosen, whose) = match of_file {
                    true => (&mut options.mesh_lod, "Levels of detail"),
                    false => (&mut options.tree_lod, "Trees' levels of detail"),
                };
                *chosen = chosen.next();
                let mode = chosen.label();
                self.tell(Tone::Info, format!("{whose}: {mode}"));
            }
            Command::NextTerrainLod => {
                options.terrain_lod = options.terrain_lod.next();
                let mode = options.terrain_lod.label();
                self.tell(Tone::Info, format!("Terrain's levels of detail: {mode}"));
            }
            Command::Wireframe => options.wireframe ^= true,
            Command::Tint => options.tint_levels ^= true,
            Command::Overhead => options.overhead ^= true,
        }
    }

    fn capture(&mut self, captured: bool) {
        if let Some(live) = &self.live {
            let told = captured && !self.camera.captured();
            self.camera.capture(&live.screen.window, captured);
            if told {
                let keys = self.bindings.chords(Command::ReleaseMouse).next().map(|chord| chord.to_string());
                self.tell(Tone::Info, format!("{} gives the mouse back", keys.unwrap_or_default()));
            }
        }
    }

    fn vote(&mut self, category: Category, ballot: Ballot) {
        self.editor.vote(category, ballot);
        self.file.settings.greeted = true;
    }

    /// The same key again takes the vote back.
    fn vote_by_key(&mut self, category: Category, landscape: Option<u8>) {
        let ballot =
            landscape.map_or(Ballot::NoFavourite, |landscape| Ballot::For(usize::from(landscape) - 1));
        let known = self.editor.ballots.get(category);
        self.vote(category, if known == ballot { Ballot::Open } else { ballot });
    }

    fn step_generation(&mut self, by: isize) {
        match self.editor.neighbour(by) {
            Some(generation) => self.editor.visit(generation),
            None => self.tell(Tone::Info, if by < 0 { "This is the first" } else { "This is the newest" }),
        }
    }

    fn toggle_fullscreen(&self) {
        let Some(live) = &self.live else { return };
        let window = &live.screen.window;
        let next = if window.fullscreen().is_some() { None } else { Some(Fullscreen::Borderless(None)) };
        window.set_fullscreen(next);
    }

    fn set_bookmark(&mut self, number: u8) {
        let world = self.file.settings.world_mut(&self.source);
        world.bookmarks.insert(number, self.camera.bookmark());
        self.tell(Tone::Success, format!("This place is bookmark {number}"));
    }

    fn go_to_bookmark(&mut self, number: u8) {
        match self.file.settings.world(&self.source).bookmarks.get(&number) {
            Some(mark) => self.camera.go_to(mark, &lands(&self.live)),
            None => self.tell(Tone::Info, format!("Bookmark {number} is not set")),
        }
    }

    /// Saves the pictures that are on the screen, side by side as they are there.
    pub(super) fn save_screenshot(&mut self) {
        let Some(live) = &self.live else { return };
        let saved = live.viewports.pixels(&self.layout.shown()).and_then(|pictures| {
            let sheet = image_file::contact_sheet(&pictures, 2.min(pictures.len().max(1)));
            let sheet = sheet.ok_or_else(|| anyhow::anyhow!("there is no picture yet"))?;
            image_file::write_numbered(&self.cli.pictures, &sheet)
        });
        match saved {
            Ok(path) => self.tell(Tone::Success, format!("Saved {}", path.display())),
            Err(error) => self.tell(Tone::Error, format!("No picture was saved: {error:#}")),
        }
    }
}
