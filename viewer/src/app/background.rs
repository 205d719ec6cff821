//! What goes on beside the window's loop: files are watched, and landscapes are baked.

use std::path::PathBuf;

use genescape_world::{Scope, Source, Watch, World};

use super::{App, Wake};
use crate::baker::Baker;
use crate::ui::Tone;

/// What goes on beside the loop for what is on show.
#[derive(Default)]
pub struct Background {
    pub baker: Option<Baker>,
    pub watch: Option<Watch>,
    /// Watched besides the source.
    pub more_files: Vec<PathBuf>,
}

impl App {
    /// Watches the source's files and lets them be baked.
    pub(super) fn start_background(&mut self) {
        self.background = Background::default();
        self.watch_files(Vec::new());
        let Source::World(root) = self.source.clone() else { return };
        if self.cli.no_bake {
            return;
        }
        match Baker::start(&root, self.cli.bake.clone(), self.wake(Wake::Soon)) {
            Ok(baker) => self.background.baker = Some(baker),
            Err(error) => self.tell(Tone::Error, format!("nothing can be baked: {error}")),
        }
    }

    /// Watches the source's files, and `more` that what is shown is made of.
    pub(super) fn watch_files(&mut self, more: Vec<PathBuf>) {
        let shaders = self.cli.shaders.clone();
        let scope = match &self.source {
            Source::World(root) => Scope { scenes: true, shaders, ..Scope::of(World::new(root)) },
            Source::Scenes(paths) => Scope { shaders, ..Scope::of_files([&paths[..], &more].concat()) },
        };
        match Watch::start(scope, self.cli.bake.poll, self.wake(Wake::Now)) {
            Ok(watch) => self.background.watch = Some(watch),
            Err(error) => self.tell(Tone::Error, format!("files cannot be watched: {error}")),
        }
        self.background.more_files = more;
    }
}
