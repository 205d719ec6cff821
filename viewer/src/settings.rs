//! What is kept between runs, as one RON file for people in the platform's folder for settings: options, window,
//! bookmarks, votes that were not yet written down.
//!
//! What other modules keep here in types of their own (keys, comfort) passes through as [`Opaque`] text, so that a
//! fault in one of them spoils nothing else.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use etcetera::{AppStrategy, AppStrategyArgs};
use ron::value::RawValue;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::frame;
use crate::save::save;

/// The file's first line.
const TITLE: &str =
    "// Settings of Genescape's viewer. It writes them when they change, so edit them while it is closed.\n";

/// Everything that is kept.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// What is drawn, and how.
    pub options: frame::Options,
    /// How the program feels in the hand.
    pub comfort: Opaque,
    /// What keys, mouse and gamepad do.
    pub bindings: Opaque,
    /// The window.
    pub window: Window,
    /// By the world folder's full path.
    pub worlds: BTreeMap<String, WorldSettings>,
}

/// The window as it was left.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Window {
    /// Width of the content in logical pixels.
    pub width: f32,
    /// Height of the content in logical pixels.
    pub height: f32,
    /// It filled the screen.
    pub maximized: bool,
}

impl Default for Window {
    fn default() -> Self {
        Self { width: 1280.0, height: 800.0, maximized: false }
    }
}

/// What belongs to one world.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct WorldSettings {
    /// Where the person was last.
    pub place: Option<Bookmark>,
    /// Places to go back to, by the number of their key.
    pub bookmarks: BTreeMap<u8, Bookmark>,
    /// Votes that were cast and not yet written into the population's file.
    pub running_votes: Option<RunningVotes>,
}

/// A place and a view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Bookmark {
    /// The eye in metres.
    pub position_m: [f32; 3],
    /// As in [`crate::camera::Camera`].
    pub yaw_rad: f32,
    /// As in [`crate::camera::Camera`].
    pub pitch_rad: f32,
    /// In flight; otherwise on foot, at whatever height the ground is.
    #[serde(default)]
    pub flying: bool,
}

/// Votes in the making.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct RunningVotes {
    /// The generation that they are on.
    pub generation: u32,
    /// By category ("tree", "terrain", "sky") the best individual, or `None` for none of them; categories that are not
    /// voted on yet are absent.
    pub cast: BTreeMap<String, Option<usize>>,
}

/// RON that only its owner understands.
#[derive(Clone, Debug, Default)]
pub struct Opaque(Option<Box<RawValue>>);

impl Opaque {
    /// The value; `None` if there is none yet.
    ///
    /// # Errors
    /// Text that is no `T`: what is wrong with it.
    pub fn get<T: DeserializeOwned>(&self) -> Result<Option<T>, String> {
        let Some(raw) = &self.0 else { return Ok(None) };
        raw.into_rust().map(Some).map_err(|error| error.code.to_string())
    }

    /// Another value.
    ///
    /// # Errors
    /// What RON cannot write.
    pub fn set<T: Serialize>(&mut self, value: &T) -> Result<(), String> {
        let text =
            ron::ser::to_string_pretty(value, style().struct_names(false)).map_err(|e| e.to_string())?;
        self.0 = Some(RawValue::from_boxed_ron(text.into()).map_err(|error| error.to_string())?);
        Ok(())
    }
}

impl PartialEq for Opaque {
    fn eq(&self, other: &Self) -> bool {
        let text = |opaque: &Self| opaque.0.as_ref().map(|raw| raw.trim().get_ron().to_owned());
        text(self) == text(other)
    }
}

impl Serialize for Opaque {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.0 {
            Some(raw) => raw.trim().serialize(serializer),
            None => serializer.serialize_unit(),
        }
    }
}

impl<'de> Deserialize<'de> for Opaque {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let raw = Box::<RawValue>::deserialize(deserializer)?;
        Ok(Self((raw.trim().get_ron() != "()").then_some(raw)))
    }
}

/// Where settings are kept, and what was last known to be there.
#[derive(Clone, Debug)]
pub struct SettingsFile {
    path: PathBuf,
    saved: Option<Settings>,
}

/// What was found, and what the person should know about it.
#[derive(Debug)]
pub struct Opened {
    /// Where they are kept.
    pub file: SettingsFile,
    /// The settings; defaults if there are none, or none that can be read.
    pub settings: Settings,
    /// What was wrong, with file and line, and what became of the file.
    pub problem: Option<String>,
}

/// Why settings could not be saved.
#[derive(Debug, thiserror::Error)]
pub enum SettingsError {
    /// The system refused.
    #[error("cannot save the settings in {}: {source}; --settings FILE keeps them elsewhere", path.display())]
    Write {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// RON has no words for it: a bug.
    #[error("the settings cannot be written as RON: {0}")]
    Format(#[from] ron::Error),
}

impl SettingsFile {
    /// Where settings are kept unless the person says otherwise; `None` for somebody without a home.
    pub fn usual_path() -> Option<PathBuf> {
        let args = AppStrategyArgs {
            top_level_domain: "org".into(),
            author: "Genescape".into(),
            app_name: "Genescape".into(),
        };
        let strategy = etcetera::app_strategy::choose_native_strategy(args).ok()?;
        Some(strategy.config_dir().join("viewer.ron"))
    }

    /// Reads the settings in `path`. Never fails: a file that cannot be understood is renamed and kept, so that the
    /// person can mend it, and defaults are used.
    pub fn open(path: impl Into<PathBuf>) -> Opened {
        let path = path.into();
        match fs::read_to_string(&path) {
            Ok(text) => match parse(&text) {
                Ok(settings) => {
                    let file = Self { path, saved: Some(settings.clone()) };
                    Opened { file, settings, problem: None }
                }
                Err(fault) => {
                    let problem = format!("{}:{fault}\n{}", path.display(), set_aside(&path));
                    Self::defaults(path, Some(problem))
                }
            },
            Err(error) if error.kind() == io::ErrorKind::NotFound => Self::defaults(path, None),
            Err(error) => {
                let told = path.display();
                let problem = format!("cannot read the settings in {told}: {error}; defaults are used");
                Self::defaults(path, Some(problem))
            }
        }
    }

    fn defaults(path: PathBuf, problem: Option<String>) -> Opened {
        Opened { file: Self { path, saved: None }, settings: Settings::default(), problem }
    }

    /// Where they are kept.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Saves the settings if they are not what the file says already: cheap enough to be called whenever something
    /// may have changed, but not every frame.
    ///
    /// # Errors
    /// A file that cannot be written; the old one is then untouched.
    pub fn save(&mut self, settings: &Settings) -> Result<(), SettingsError> {
        if self.saved.as_ref() == Some(settings) {
            return Ok(());
        }
        let text = format!("{TITLE}{}\n", ron::ser::to_string_pretty(settings, style().struct_names(true))?);
        save(&self.path, &text).map_err(|source| SettingsError::Write { path: self.path.clone(), source })?;
        self.saved = Some(settings.clone());
        Ok(())
    }
}

/// The settings, or line, column and what is wrong there.
fn parse(text: &str) -> Result<Settings, String> {
    ron::from_str(text).map_err(|error| {
        let at = error.span.end;
        let line = text.lines().nth(at.line.saturating_sub(1)).unwrap_or_default().trim_end();
        format!("{}:{}: {}\n    {line}", at.line, at.col, error.code)
    })
}

/// Renames a broken file so that saving doesn't replace it; what to tell.
fn set_aside(path: &Path) -> String {
    let free = (1..1000).map(|number| path.with_extension(format!("broken-{number}.ron")));
    let aside = free.into_iter().find(|path| !path.exists());
    match aside.map(|aside| (fs::rename(path, &aside), aside)) {
        Some((Ok(()), aside)) => format!(
            "Defaults are used. Your file is kept as {}: mend that line and rename it back while the viewer is closed.",
            aside.display()
        ),
        _ => "Defaults are used, and the file will be replaced when they change: mend it now, or save it elsewhere."
            .into(),
    }
}

fn style() -> ron::ser::PrettyConfig {
    ron::ser::PrettyConfig::new().indentor("    ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    enum Key {
        KeyW,
        Button { number: u8 },
    }

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    struct Bindings {
        forward: Vec<Key>,
        run: Option<Key>,
    }

    prop_compose! {
        fn settings()(
            names in prop::collection::btree_map(".*", any::<u8>(), 0..3), turn in any::<f32>(), maximized: bool,
            exposure in 0.1f32..9.0, best in prop::option::of(0..4usize), generation: u32,
        ) -> Settings {
            let mut settings = Settings::default();
            settings.options.exposure = exposure;
            settings.window.maximized = maximized;
            for (name, number) in names {
                let mut world = WorldSettings::default();
                if !turn.is_nan() {
                    let mark = Bookmark { position_m: [turn, 1.5, -0.25], yaw_rad: turn, pitch_rad: 0.1, flying: maximized };
                    world.bookmarks.insert(number, mark);
                }
                let cast = BTreeMap::from([("sky".to_owned(), best), ("tree".to_owned(), None)]);
                world.running_votes = Some(RunningVotes { generation, cast });
                settings.worlds.insert(name, world);
            }
            let bindings = Bindings { forward: vec![Key::KeyW, Key::Button { number: 3 }], run: None };
            settings.bindings.set(&bindings).expect("RON");
            settings
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

        #[test]
        fn settings_survive_the_file(settings in settings()) {
            let folder = tempfile::tempdir().expect("a temporary folder");
            let path = folder.path().join("genescape/viewer.ron");
            SettingsFile::open(&path).file.save(&settings).expect("saved");
            let Opened { settings: found, problem, mut file } = SettingsFile::open(&path);
            prop_assert_eq!(problem, None);
            prop_assert_eq!(&found, &settings);
            let bindings = found.bindings.get::<Bindings>().expect("RON").expect("some");
            prop_assert_eq!(bindings.forward, [Key::KeyW, Key::Button { number: 3 }]);
            // Saved again, the text is the same, however often.
            let text = fs::read_to_string(&path).expect("there");
            file.saved = None;
            file.save(&found).expect("saved");
            prop_assert_eq!(fs::read_to_string(&path).expect("there"), text);
        }
    }

    #[test]
    fn without_a_file_there_are_defaults_and_nothing_to_tell() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let opened = SettingsFile::open(folder.path().join("none.ron"));
        assert_eq!((opened.settings, opened.problem), (Settings::default(), None));
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 0);
    }

    #[test]
    fn a_short_file_is_filled_up_and_a_newer_one_is_read() {
        let read = |text| parse(text).expect("valid");
        assert_eq!(read("()"), Settings::default());
        assert_eq!(read("(window: (width: 900))").window.width, 900.0);
        assert_eq!(read("Settings(telepathy: On(3), window: (height: 1))").window.height, 1.0);
        assert!(
            read("(bindings: nonsense)").bindings.get::<Bindings>().is_err(),
            "which spoils nothing else"
        );
    }

    #[test]
    fn a_broken_file_is_told_with_its_line_and_kept() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("viewer.ron");
        for count in 1..=2 {
            let broken = format!("(\n  window: (width: wide{count}),\n)");
            fs::write(&path, &broken).expect("written");
            let Opened { mut file, settings, problem } = SettingsFile::open(&path);
            let problem = problem.expect("told");
            assert!(problem.contains("viewer.ron:2:") && problem.contains("rename it back"), "{problem}");
            assert_eq!(settings, Settings::default());
            file.save(&settings).expect("saved");
            let aside = folder.path().join(format!("viewer.broken-{count}.ron"));
            assert_eq!(fs::read_to_string(aside).expect("kept"), broken);
        }
    }

    #[test]
    fn what_is_saved_already_is_not_written_again() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut file = SettingsFile::open(folder.path().join("viewer.ron")).file;
        file.save(&Settings::default()).expect("saved");
        fs::remove_file(file.path()).expect("removed");
        file.save(&Settings::default()).expect("nothing to do");
        assert!(!file.path().exists());
    }
}
