//! The settings in use, and the file in which they are kept.

use std::path::Path;
use std::time::{Duration, Instant};

use genescape_world::Source;

use crate::settings::{Settings, SettingsFile, WorldSettings};

/// Between two looks at whether settings have to be saved.
const SAVE_EVERY: Duration = Duration::from_secs(2);

pub struct Preferences {
    pub settings: Settings,
    /// `None`: nowhere, or no longer after an error.
    file: Option<SettingsFile>,
    saved: Instant,
}

impl Preferences {
    /// Reads them, and says what is wrong with the file. Without a path they are kept nowhere.
    pub fn open(path: Option<&Path>) -> (Self, Vec<String>) {
        let opened = path.map(SettingsFile::open);
        let (file, settings, problems) = match opened {
            Some(opened) => (Some(opened.file), opened.settings, opened.problems),
            None => Default::default(),
        };
        (Self { settings, file, saved: Instant::now() }, problems)
    }

    /// Whether nothing was kept by an earlier run.
    pub fn are_new(&self) -> bool {
        self.file.as_ref().is_none_or(SettingsFile::is_new)
    }

    /// What was kept of a world.
    pub fn world(&self, source: &Source) -> WorldSettings {
        self.settings.worlds.get(&world_key(source)).cloned().unwrap_or_default()
    }

    /// Keeps something of a world.
    pub fn world_mut(&mut self, source: &Source) -> &mut WorldSettings {
        self.settings.worlds.entry(world_key(source)).or_default()
    }

    /// Whether it is time to save.
    pub fn due(&self) -> bool {
        self.saved.elapsed() > SAVE_EVERY
    }

    /// Writes them if they changed. An error is told once: the person may have a reason to keep that file as it is.
    pub fn save(&mut self) -> Result<(), String> {
        self.saved = Instant::now();
        let Some(file) = &mut self.file else { return Ok(()) };
        let result = file.save(&self.settings).map_err(|error| error.to_string());
        if result.is_err() {
            self.file = None;
        }
        result
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
