//! Exports from the window: starts them, hears of them, and hands their files on to the desktop.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

use anyhow::Result;
use genescape_world::Source;

use super::App;
use super::drag_out::{self, Offer};
use crate::baker::export::{self, Exported, Job, News};
use crate::event::Event;
use crate::export_choice::ExportChoice;
use crate::ui::Tone;
use crate::ui::model::{ExportModel, ViewState};

/// The folder beside a world that exports go into unless another is chosen.
const FOLDER: &str = "exports";

/// A dialogue that is gone so soon was never there.
const NOBODY_CANCELS_WITHIN: Duration = Duration::from_millis(300);

/// What becomes of the files when they are written, besides being told.
pub enum Then {
    Tell,
    /// The program gets them over which the pointer lets go.
    Drop(Offer),
    Copy,
}

/// Exports, and what they gave.
#[derive(Default)]
pub struct Exports {
    running: Option<Running>,
    last: Option<Last>,
    /// The folder that the person chooses in the desktop's dialogue, and since when.
    folder: Option<(Instant, Receiver<Option<PathBuf>>)>,
    /// As long as it lives, other programs can paste what was copied.
    clipboard: Option<arboard::Clipboard>,
}

struct Running {
    news: Receiver<News>,
    view: usize,
    done: usize,
    files: usize,
    then: Then,
}

struct Last {
    exported: Exported,
    /// In words.
    told: String,
}

impl Exports {
    pub fn model(&self, choice: &ExportChoice, source: &Source) -> ExportModel {
        ExportModel {
            choice: choice.clone(),
            default_folder: default_folder(source).display().to_string(),
            progress: self.running.as_ref().map(|running| (running.done, running.files)),
            written: self.last.as_ref().map(|last| last.told.clone()),
        }
    }

    /// Asks for a folder in the desktop's dialogue, whose window stays open beside ours.
    pub fn choose_folder(&mut self, wake: impl Fn() + Send + 'static) {
        // macOS wants it made on this thread, and waited for on another.
        let dialogue = rfd::AsyncFileDialog::new().set_title("Export into").pick_folder();
        let (sender, folder) = channel();
        self.folder = Some((Instant::now(), folder));
        std::thread::spawn(move || {
            let chosen = pollster::block_on(dialogue).map(|folder| folder.path().to_owned());
            if sender.send(chosen).is_ok() {
                wake();
            }
        });
    }

    fn copy(&mut self) -> Result<()> {
        let Some(last) = &self.last else { return Ok(()) };
        let clipboard = match self.clipboard.take() {
            Some(clipboard) => clipboard,
            None => arboard::Clipboard::new()?,
        };
        self.clipboard.insert(clipboard).set().file_list(&last.exported.paths)?;
        Ok(())
    }
}

impl App {
    /// Writes a landscape as files for other programs.
    pub(super) fn export(&mut self, view: usize, then: Then) {
        if self.exports.running.is_some() {
            return self.tell(Tone::Info, "An export is on its way: wait until it is done");
        }
        let Some(scene) = self.editor.scene(view).filter(|_| self.editor.state(view) == ViewState::Ready)
        else {
            return self.tell(Tone::Info, format!("Landscape {} is not there yet", view + 1));
        };
        let choice = self.file.settings.export.value.clone();
        let folder = match choice.folder.trim() {
            "" => default_folder(&self.source),
            folder => in_home(folder),
        };
        let prefix = match &self.source {
            Source::World(_) => format!("g{:04}-{}-", self.editor.generations().0, view + 1),
            Source::Scenes(_) => String::new(),
        };
        match export::start(Job { scene, folder, prefix, choice }, self.wake(super::Wake::Now)) {
            Ok(news) => self.exports.running = Some(Running { news, view, done: 0, files: 1, then }),
            Err(error) => self.tell(Tone::Error, format!("Nothing is exported: {error}")),
        }
    }

    /// Exports a landscape for the program over which the pointer lets go; where the desktop knows no such thing, for the
    /// clipboard.
    pub(super) fn drag_out(&mut self, view: usize) {
        let offer = self.live.as_ref().and_then(|live| drag_out::begin(&live.screen.window));
        self.export(view, offer.map_or(Then::Copy, Then::Drop));
    }

    /// Takes in what exports have to tell, and the folder that was chosen for them.
    pub(super) fn hear_exports(&mut self) {
        if let Some((since, Ok(chosen))) =
            self.exports.folder.as_ref().map(|(since, it)| (*since, it.try_recv()))
        {
            self.exports.folder = None;
            match chosen {
                Some(folder) => self.file.settings.export.value.folder = folder.display().to_string(),
                None if since.elapsed() < NOBODY_CANCELS_WITHIN => {
                    self.tell(Tone::Info, "This desktop has no dialogue for folders: type the folder's name");
                }
                None => {}
            }
        }
        while let Some(mut running) = self.exports.running.take() {
            match running.news.try_recv() {
                Ok(News::Progress { done, files }) => (running.done, running.files) = (done, files),
                Ok(News::End(Ok(exported))) => return self.exported(running.view, exported, running.then),
                Ok(News::End(Err(error))) => {
                    let text = format!("Landscape {} is not exported: {error:#}", running.view + 1);
                    return self.tell(Tone::Error, text);
                }
                Err(TryRecvError::Empty) => {
                    self.exports.running = Some(running);
                    return;
                }
                Err(TryRecvError::Disconnected) => return,
            }
            self.exports.running = Some(running);
        }
    }

    fn exported(&mut self, view: usize, exported: Exported, then: Then) {
        let told = in_words(view, &exported);
        self.exports.last = Some(Last { exported: exported.clone(), told: told.clone() });
        match then {
            Then::Tell => {}
            Then::Drop(offer) => offer.hand_over(exported.paths),
            Then::Copy => {
                self.offer(Tone::Success, told, Event::ShowExported);
                return self.copy_exported();
            }
        }
        self.offer(Tone::Success, format!("{told}. Click to see it."), Event::ShowExported);
    }

    pub(super) fn show_exported(&mut self) {
        let Some(last) = &self.exports.last else { return };
        let folder = last.exported.folder.clone();
        if let Err(error) = open::that_detached(&folder) {
            self.tell(Tone::Warning, format!("{} cannot be shown: {error}", folder.display()));
        }
    }

    pub(super) fn copy_exported(&mut self) {
        match self.exports.copy() {
            Ok(()) => self.tell(Tone::Success, "Copied: paste it into a folder, or into another program"),
            Err(error) => self.tell(Tone::Warning, format!("Nothing is copied: {error}")),
        }
    }
}

/// "Landscape 2 is exported: 8 files, 63.2 MB, in exports/g0000-2-oak-valley-in-june".
fn in_words(view: usize, exported: &Exported) -> String {
    let megabytes = exported.bytes as f64 / 1e6;
    let what = match &exported.paths[..] {
        [file] if *file != exported.folder => {
            file.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
        }
        _ if exported.files == 1 => "1 file".to_owned(),
        _ => format!("{} files", exported.files),
    };
    format!("Landscape {} is exported: {what}, {megabytes:.1} MB, in {}", view + 1, exported.folder.display())
}

fn default_folder(source: &Source) -> PathBuf {
    let beside = match source {
        Source::World(root) => root.parent(),
        Source::Scenes(_) => None,
    };
    beside.unwrap_or(Path::new("")).join(FOLDER)
}

/// A path as people write it, with `~` for their home.
fn in_home(path: &str) -> PathBuf {
    let home = path.strip_prefix('~').filter(|rest| rest.is_empty() || rest.starts_with(['/', '\\']));
    match home.zip(etcetera::home_dir().ok()) {
        Some((rest, home)) => home.join(rest.trim_start_matches(['/', '\\'])),
        None => path.into(),
    }
}
