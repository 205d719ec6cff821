//! Exports a landscape on a thread of its own, as `bake export` does, and tells how it goes.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread;

use anyhow::{Context, Error, Result};
use genescape_bake::events::{Event, Listener};
use genescape_bake::export as bake;

use super::{lower_priority, panic_text};
use crate::export_choice::{Audience, ExportChoice, Form};

/// A landscape to be written as files for other programs.
#[derive(Clone, Debug)]
pub struct Job {
    /// Its scene file.
    pub scene: PathBuf,
    /// The folder that gets the file, or the landscape's own folder.
    pub folder: PathBuf,
    /// What the name of either begins with, before the landscape's: "g0003-2-".
    pub prefix: String,
    pub choice: ExportChoice,
}

/// How an export goes.
#[derive(Debug)]
pub enum News {
    /// `done` of `files` files are written.
    Progress { done: usize, files: usize },
    /// The last news: what was written, or why nothing more is.
    End(Result<Exported>),
}

/// What an export has written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exported {
    /// The file, or the folder that holds all of them: full paths, to be handed on to another program.
    pub paths: Vec<PathBuf>,
    /// The folder to show to the person.
    pub folder: PathBuf,
    pub files: usize,
    pub bytes: u64,
}

/// Exports on a thread of its own. `wake` is called, from there, when there is news.
///
/// # Errors
/// If the system gives no thread.
pub fn start(job: Job, wake: impl Fn() + Send + Sync + 'static) -> io::Result<Receiver<News>> {
    let (sender, news) = channel();
    let exporter = Exporter { sender, wake: Box::new(wake), counts: Mutex::default() };
    thread::Builder::new().name("export".into()).spawn(move || {
        lower_priority();
        let run = AssertUnwindSafe(|| write_out(&job, &exporter));
        let end = catch_unwind(run).unwrap_or_else(|panic| {
            Err(Error::msg(format!(
                "a bug in Genescape ended the export; please report it: {}",
                panic_text(&*panic)
            )))
        });
        exporter.send(News::End(end));
    })?;
    Ok(news)
}

fn write_out(job: &Job, exporter: &Exporter) -> Result<Exported> {
    let Job { scene, folder, prefix, choice } = job;
    let name = format!("{prefix}{}", bake::stem(scene)?);
    let audience = match choice.audience {
        Audience::Viewers => bake::Audience::Viewers,
        Audience::Blender => bake::Audience::Blender,
    };
    let options = bake::Options { audience, apron: choice.apron, instancing: false };
    let (folder, written) = match choice.form {
        Form::File => {
            let file = folder.join(format!("{name}.glb"));
            (folder.clone(), bake::to_file(scene, &file, options, exporter)?)
        }
        Form::Folder => {
            let folder = folder.join(name);
            let written = bake::to_folder(scene, &folder, options, exporter)?;
            (folder, written)
        }
    };
    let full = |path: &Path| path.canonicalize().with_context(|| format!("cannot find {}", path.display()));
    let folder = full(&folder)?;
    let paths = match choice.form {
        Form::File => written.files.iter().map(|(path, _)| full(path)).collect::<Result<_>>()?,
        Form::Folder => vec![folder.clone()],
    };
    let bytes = written.files.iter().map(|(_, bytes)| bytes).sum();
    Ok(Exported { paths, folder, files: written.files.len(), bytes })
}

/// Turns an export's events into news.
struct Exporter {
    sender: Sender<News>,
    wake: Box<dyn Fn() + Send + Sync>,
    /// Files that are written, and all.
    counts: Mutex<(usize, usize)>,
}

impl Exporter {
    fn send(&self, news: News) {
        // The receiver is gone only when the window is.
        if self.sender.send(news).is_ok() {
            (self.wake)();
        }
    }
}

impl Listener for Exporter {
    fn tell(&self, event: &Event) {
        let (done, files) = {
            let mut counts = self.counts.lock().unwrap_or_else(PoisonError::into_inner);
            match event {
                Event::Exporting { files } => *counts = (0, *files),
                Event::Written { .. } => counts.0 += 1,
                _ => return,
            }
            *counts
        };
        self.send(News::Progress { done, files });
    }
}
