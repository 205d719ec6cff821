//! What is kept between runs (options, comfort, keys, window; of each world places and steps to take back) ⇄ one RON file
//! for people, in the platform's folder for settings.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use etcetera::{AppStrategy, AppStrategyArgs};
use genescape_world::{Source, atomic_write};
use ron::value::RawValue;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize};

use crate::edit_history::Steps;
use crate::export_choice::ExportChoice;
use crate::input::Bindings;
use crate::options;

/// The file's first line.
const TITLE: &str =
    "// Settings of Genescape's viewer. It writes them when they change, so edit them while it is closed.\n";

/// How deep the file is indented: a bookmark, or a step, is one line.
const DEPTH: usize = 5;

/// Everything that is kept.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// What is drawn, and how.
    pub options: options::Options,
    pub comfort: Part<Comfort>,
    pub bindings: Part<Bindings>,
    /// How landscapes were exported last.
    pub export: Part<ExportChoice>,
    /// The window.
    pub window: Window,
    /// The person has walked or voted once.
    pub greeted: bool,
    /// By the world folder's full path.
    pub worlds: BTreeMap<String, WorldSettings>,
}

/// How the program handles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Comfort {
    /// Factor on the turn per pixel of the mouse: 0.1 to 5.
    pub mouse_sensitivity: f32,
    /// Mouse up looks down.
    pub invert_y: bool,
    pub theme: Theme,
    /// Factor on the desktop's own scale: 0.5 to 2.5.
    pub ui_scale: f32,
    /// A new generation is entered where one is, and not at its start.
    pub stay: bool,
}

impl Default for Comfort {
    fn default() -> Self {
        Self { mouse_sensitivity: 1.0, invert_y: false, theme: Theme::System, ui_scale: 1.0, stay: false }
    }
}

/// Light or dark.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Theme {
    /// As the desktop says.
    #[default]
    System,
    Light,
    Dark,
}

impl Settings {
    /// What is wrong with parts of them.
    fn faults(&self) -> Vec<String> {
        let steps = self.worlds.values().map(|world| ("steps", &world.steps.fault));
        let own = [
            ("comfort", &self.comfort.fault),
            ("bindings", &self.bindings.fault),
            ("export", &self.export.fault),
        ];
        own.into_iter()
            .chain(steps)
            .filter_map(|(part, fault)| Some((part, fault.as_ref()?)))
            .map(|(part, fault)| format!("{part} in the settings: {fault}; defaults are used"))
            .collect()
    }

    /// What was kept of a world.
    pub fn world(&self, source: &Source) -> WorldSettings {
        self.worlds.get(&key(source)).cloned().unwrap_or_default()
    }

    /// Keeps something of a world.
    pub fn world_mut(&mut self, source: &Source) -> &mut WorldSettings {
        self.worlds.entry(key(source)).or_default()
    }
}

/// What a world's settings are kept under.
fn key(source: &Source) -> String {
    match source {
        Source::World(root) => fs::canonicalize(root).unwrap_or_else(|_| root.clone()).display().to_string(),
        Source::Scenes(paths) if paths.len() == 1 => key(&Source::World(paths[0].clone())),
        Source::Scenes(_) => "scenes".to_owned(),
    }
}

/// The window as it was left.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Window {
    /// Width of the content in logical pixels.
    pub width: f32,
    /// Height of the content in logical pixels.
    pub height: f32,
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
    /// The generation that was shown last.
    pub generation: Option<u32>,
    /// Places to go back to, by the number of their key.
    pub bookmarks: BTreeMap<u8, Bookmark>,
    /// What can be taken back and made again, the ballots that are not yet written down among it.
    pub steps: Part<Steps>,
}

/// A place and a view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Bookmark {
    /// The eye in metres, from where each landscape is first seen.
    pub position_m: [f32; 3],
    /// As in [`crate::camera::Camera`].
    pub yaw_rad: f32,
    /// As in [`crate::camera::Camera`].
    pub pitch_rad: f32,
    /// In flight; otherwise on foot, at whatever height the ground is.
    #[serde(default)]
    pub flying: bool,
}

/// A part of the settings that is read by itself: a fault in it spoils nothing else.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Part<T> {
    pub value: T,
    #[serde(skip)]
    fault: Option<String>,
}

impl<'de, T: DeserializeOwned + Default> Deserialize<'de> for Part<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let raw = Box::<RawValue>::deserialize(deserializer)?;
        if raw.trim().get_ron() == "()" {
            return Ok(Self::default());
        }
        Ok(match raw.into_rust() {
            Ok(value) => Self { value, fault: None },
            Err(error) => Self { value: T::default(), fault: Some(error.code.to_string()) },
        })
    }
}

/// The settings in use, and the file in which they are kept.
#[derive(Clone, Debug, Default)]
pub struct SettingsFile {
    pub settings: Settings,
    /// `None`: nowhere, or no longer after an error.
    path: Option<PathBuf>,
    /// What the file says, as far as is known; `None` if there is none, or none that can be read.
    saved: Option<Settings>,
}

impl SettingsFile {
    /// Where settings are kept unless the person says otherwise; `None` without a home folder.
    pub fn usual_path() -> Option<PathBuf> {
        let args = AppStrategyArgs {
            top_level_domain: "org".into(),
            author: "Genescape".into(),
            app_name: "Genescape".into(),
        };
        let strategy = etcetera::app_strategy::choose_native_strategy(args).ok()?;
        Some(strategy.config_dir().join("viewer.ron"))
    }

    /// Reads the settings in `path`; without one they are kept nowhere. Never fails: a file that cannot be understood is
    /// renamed and kept, so that the person can mend it, and defaults are used. The texts say what was wrong, with file
    /// and line, and what became of the file.
    pub fn open(path: Option<PathBuf>) -> (Self, Vec<String>) {
        let mut file = Self { path, ..Self::default() };
        let problems = match &file.path {
            None => Vec::new(),
            Some(path) => match fs::read_to_string(path).map(|text| parse(&text)) {
                Ok(Ok(settings)) => {
                    file.saved = Some(settings.clone());
                    file.settings = settings;
                    file.settings.faults()
                }
                Ok(Err(fault)) => vec![format!("{}:{fault}\n{}", path.display(), set_aside(path))],
                Err(error) if error.kind() == io::ErrorKind::NotFound => Vec::new(),
                Err(error) => {
                    let path = path.display();
                    vec![format!("cannot read the settings in {path}: {error}; defaults are used")]
                }
            },
        };
        (file, problems)
    }

    /// Whether there is no settings file yet, or none that can be read.
    pub fn is_new(&self) -> bool {
        self.saved.is_none()
    }

    /// Saves the settings if they are not what the file says already: cheap enough to be called whenever something
    /// may have changed, but not every frame.
    ///
    /// # Errors
    /// A file that cannot be written; the old one is then untouched. It is reported once, for the person may have a reason to
    /// keep that file as it is.
    pub fn save(&mut self) -> Result<()> {
        let Some(path) = self.path.take_if(|_| self.saved.as_ref() != Some(&self.settings)) else {
            return Ok(());
        };
        let style = ron::ser::PrettyConfig::new().indentor("    ").struct_names(true).depth_limit(DEPTH);
        let text = format!("{TITLE}{}\n", ron::ser::to_string_pretty(&self.settings, style)?);
        atomic_write::replace(&path, &text).map_err(|error| {
            let path = path.display();
            anyhow!("cannot save the settings in {path}: {error}; --settings FILE keeps them elsewhere")
        })?;
        (self.path, self.saved) = (Some(path), Some(self.settings.clone()));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ballots::{Ballot, Ballots};
    use crate::edit_history::Step;
    use crate::input::Command;
    use crate::lod_mode::{TerrainLodMode, TreeLodMode};
    use genescape_schema::Category;
    use proptest::prelude::*;

    fn bindings() -> Bindings {
        let mut bindings = Bindings::default();
        bindings.bind("Mouse 3".parse().expect("a chord"), Command::Forward).expect("free");
        bindings
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
                let mut ballots = Ballots::default();
                ballots.set(Category::Sky, best.map_or(Ballot::NoFavourite, Ballot::For));
                let before = Ballots::default();
                world.steps.value.push(Step::Ballots { generation, before, after: ballots });
                world.steps.value.undone.push(Step::Bred { from: generation, ballots, change: None });
                settings.worlds.insert(name, world);
            }
            settings.comfort.value.invert_y = !maximized;
            settings.bindings.value = bindings();
            settings
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

        #[test]
        fn settings_survive_the_file(settings in settings()) {
            let folder = tempfile::tempdir().expect("a temporary folder");
            let path = folder.path().join("genescape/viewer.ron");
            let (mut file, _) = SettingsFile::open(Some(path.clone()));
            file.settings = settings.clone();
            file.save().expect("saved");
            let (mut file, problems) = SettingsFile::open(Some(path.clone()));
            prop_assert_eq!(problems, Vec::<String>::new());
            prop_assert_eq!(&file.settings, &settings);
            // Saved again, the text is the same, however often.
            let text = fs::read_to_string(&path).expect("there");
            file.saved = None;
            file.save().expect("saved");
            prop_assert_eq!(fs::read_to_string(&path).expect("there"), text);
        }
    }

    #[test]
    fn without_a_file_there_are_defaults_and_nothing_to_tell() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (file, problems) = SettingsFile::open(Some(folder.path().join("none.ron")));
        assert_eq!((file.settings, problems), (Settings::default(), Vec::new()));
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 0);
    }

    #[test]
    fn a_short_file_is_filled_up_and_a_newer_one_is_read() {
        let read = |text| parse(text).expect("valid");
        assert_eq!(read("()"), Settings::default());
        assert_eq!(read("(window: (width: 900))").window.width, 900.0);
        assert_eq!(read("Settings(telepathy: On(3), window: (height: 1))").window.height, 1.0);
        assert_eq!(read("(comfort: (), bindings: ())"), Settings::default());
        let partly = read("(bindings: nonsense, comfort: (invert_y: true))");
        assert_eq!(partly.bindings.value, Bindings::default());
        assert!(partly.comfort.value.invert_y, "a fault in one part spoils no other");
        let [fault] = &partly.faults()[..] else { panic!("{:?}", partly.faults()) };
        assert!(fault.contains("bindings in the settings"), "{fault}");
    }

    /// As the first version of the program wrote it.
    #[test]
    fn a_file_of_the_first_version_is_read() {
        let first = r#"Settings(
            options: Options(
                tree_scheme: Discrete, terrain_scheme: Roam, tree_error_px: 1.5, terrain_error_px: 2.0,
                wireframe: false, tint_levels: false, overhead: false, drift_clouds: true, draw_trees: true,
                grass: true, draw_terrain: true, exposure: 1.0, samples: 4, fov_y_deg: 60.0,
            ),
            comfort: (mouse_sensitivity: 2.0, invert_y: true, theme: Dark, ui_scale: 1.0),
            bindings: {"forward": ["W", "Numpad 8"], "screenshot": ["Print Screen"]},
            window: Window(width: 600.0, height: 440.0, maximized: false),
            worlds: {"world": WorldSettings(
                place: Some(Bookmark(position_m: (1.0, 2.0, 3.0), yaw_rad: 0.5, pitch_rad: 0.0, flying: false)),
                bookmarks: {},
                running_votes: Some(RunningVotes(generation: 1, cast: {"sky": None, "tree": Some(0)})),
            )},
        )"#;
        let settings = parse(first).expect("valid");
        assert_eq!(settings.faults(), Vec::<String>::new());
        assert_eq!(settings.options.tree_lod, TreeLodMode::Discrete);
        assert_eq!(settings.options.terrain_lod, TerrainLodMode::Roam);
        assert_eq!((settings.comfort.value.theme, settings.comfort.value.invert_y), (Theme::Dark, true));
        let chords = |command| settings.bindings.value.chords(command).map(|chord| chord.to_string());
        assert_eq!(chords(Command::Forward).collect::<Vec<_>>(), ["W", "Numpad 8"]);
        assert_eq!(chords(Command::Screenshot).collect::<Vec<_>>(), ["Print Screen"]);
        assert_eq!(settings.worlds["world"].place.map(|place| place.position_m), Some([1.0, 2.0, 3.0]));
    }

    #[test]
    fn a_ballot_for_a_fifth_landscape_spoils_the_steps_alone() {
        let text = r#"(worlds: {"world": (
            bookmarks: {1: (position_m: (1.0, 2.0, 3.0), yaw_rad: 0.5, pitch_rad: 0.0)},
            steps: (done: [Ballots(generation: 0, before: (Open, Open, Open), after: (Open, Open, For(4)))]),
        )})"#;
        let settings = parse(text).expect("valid");
        let [fault] = &settings.faults()[..] else { panic!("{:?}", settings.faults()) };
        assert!(fault.contains("steps in the settings") && fault.contains("0 to 3"), "{fault}");
        assert_eq!(settings.worlds["world"].bookmarks.len(), 1);
        let good = parse(&text.replace("For(4)", "For(3)")).expect("valid");
        assert_eq!(good.worlds["world"].steps.value.done.len(), 1);
    }

    #[test]
    fn a_broken_file_is_told_with_its_line_and_kept() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("viewer.ron");
        for count in 1..=2 {
            let broken = format!("(\n  window: (width: wide{count}),\n)");
            fs::write(&path, &broken).expect("written");
            let (mut file, problems) = SettingsFile::open(Some(path.clone()));
            let problem = problems.first().expect("told");
            assert!(problem.contains("viewer.ron:2:") && problem.contains("rename it back"), "{problem}");
            assert_eq!(file.settings, Settings::default());
            file.save().expect("saved");
            let aside = folder.path().join(format!("viewer.broken-{count}.ron"));
            assert_eq!(fs::read_to_string(aside).expect("kept"), broken);
        }
    }

    #[test]
    fn what_is_saved_already_is_not_written_again() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("viewer.ron");
        let (mut file, _) = SettingsFile::open(Some(path.clone()));
        file.save().expect("saved");
        fs::remove_file(&path).expect("removed");
        file.save().expect("nothing to do");
        assert!(!path.exists());
    }

    #[test]
    fn what_cannot_be_saved_is_told_once() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        fs::write(folder.path().join("file"), "").expect("written");
        let (mut file, _) = SettingsFile::open(Some(folder.path().join("file/viewer.ron")));
        assert!(file.save().is_err_and(|error| error.to_string().contains("--settings FILE")));
        file.save().expect("kept nowhere from now on");
    }
}
