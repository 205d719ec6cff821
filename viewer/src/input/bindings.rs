//! Which key means what: the defaults, a person's changes from a settings file, and the help that lists them.
//!
//! In a file, bindings are a map from a command's name to its chords: `{"forward": ["W", "Up"], "undo": ["Ctrl+Z"]}`.
//! What is not named keeps its default. A key that the file gives to one command is taken from the command that has it
//! by default; a key that the file gives to two is an error that names both. All errors are reported at once.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use winit::event::MouseButton;

use super::chord::{Chord, Input, Modifiers};
use super::command::Command;

/// For each chord the one command that it means; a command may have several chords, or none.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "BTreeMap<String, Vec<String>>", into = "BTreeMap<String, Vec<String>>")]
pub struct Bindings {
    /// Sorted by command, a command's first chord first.
    pairs: Vec<(Chord, Command)>,
}

/// Lines of the help that belong together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyGroup {
    /// "Move".
    pub title: String,
    /// Keys ("W or Up"; "no key" if there is none) and what they do ("walk forward").
    pub keys: Vec<(String, String)>,
}

impl Default for Bindings {
    fn default() -> Self {
        let mut bindings = Self { pairs: Vec::new() };
        bindings.insert(defaults());
        bindings
    }
}

impl Bindings {
    /// What a chord means.
    ///
    /// Held commands listen to their key whatever is held with it, or a runner's Shift would stop the walk. Other commands
    /// want their chord exactly; except that Shift may be held where the chord with Shift means nothing else.
    pub fn command(&self, chord: Chord) -> Option<Command> {
        let exact =
            |chord: Chord| self.pairs.iter().find(|(known, _)| *known == chord).map(|(_, command)| *command);
        let unshifted = Chord { with: Modifiers { shift: false, ..chord.with }, ..chord };
        let alone = Chord::alone(chord.input);
        exact(chord).or_else(|| exact(unshifted)).or_else(|| exact(alone).filter(|command| command.is_held()))
    }

    /// The chords of a command, the first one first.
    pub fn chords(&self, command: Command) -> impl Iterator<Item = Chord> {
        self.pairs.iter().filter(move |(_, known)| *known == command).map(|(chord, _)| *chord)
    }

    /// Adds a chord to a command's.
    ///
    /// # Errors
    /// If it means something else already, or cannot mean this.
    pub fn bind(&mut self, chord: Chord, command: Command) -> Result<(), String> {
        check(chord, command)?;
        match self.pairs.iter().find(|(known, _)| *known == chord) {
            None => self.insert([(chord, command)]),
            Some((_, first)) if *first == command => {}
            Some((_, first)) => {
                let both = format!("{chord} is given to both {first} and {command}");
                return Err(format!("{both}; give one of them another key"));
            }
        }
        Ok(())
    }

    fn insert(&mut self, pairs: impl IntoIterator<Item = (Chord, Command)>) {
        self.pairs.extend(pairs);
        // Stable, so a command's first key stays first.
        self.pairs.sort_by_key(|(_, command)| *command);
    }

    /// Every command with its keys, group by group. Commands that differ by a number stand on one line.
    pub fn help(&self) -> Vec<KeyGroup> {
        let mut groups: Vec<KeyGroup> = Vec::new();
        let commands: Vec<Command> = Command::all().collect();
        for series in commands.chunk_by(|one, other| one.help() == other.help()) {
            if let Some(title) =
                series[0].group().filter(|title| groups.last().is_none_or(|g| g.title != *title))
            {
                groups.push(KeyGroup { title: title.to_owned(), keys: Vec::new() });
            }
            if let Some(group) = groups.last_mut() {
                group.keys.push((self.keys(series), series[0].help()));
            }
        }
        groups
    }

    /// "W or Up" for one command; for several the first key of each: "U I O P", "Ctrl+1 … Ctrl+9".
    fn keys(&self, series: &[Command]) -> String {
        if let [command] = series {
            let names: Vec<String> = self.chords(*command).map(|chord| chord.to_string()).collect();
            return match &names[..] {
                [] => "no key".into(),
                // "Shift", whichever.
                [left, right]
                    if left.strip_prefix("Left ").is_some_and(|key| right == &format!("Right {key}")) =>
                {
                    right["Right ".len()..].to_owned()
                }
                _ => names.join(" or "),
            };
        }
        let first =
            |command: &Command| self.chords(*command).next().map_or("–".into(), |chord| chord.to_string());
        match series {
            [from, .., to] if series.len() > 4 => format!("{} … {}", first(from), first(to)),
            _ => series.iter().map(first).collect::<Vec<_>>().join(" "),
        }
    }
}

impl From<Bindings> for BTreeMap<String, Vec<String>> {
    fn from(bindings: Bindings) -> Self {
        let written = |command: Command| bindings.chords(command).map(|chord| chord.to_string()).collect();
        Command::all().map(|command| (command.to_string(), written(command))).collect()
    }
}

impl TryFrom<BTreeMap<String, Vec<String>>> for Bindings {
    type Error = String;

    fn try_from(file: BTreeMap<String, Vec<String>>) -> Result<Self, String> {
        let mut problems = Vec::new();
        let mut named = Vec::new();
        let mut bindings = Self { pairs: Vec::new() };
        for (name, chords) in &file {
            let parsed: Result<Command, String> = name.parse();
            let Ok(command) = parsed.map_err(|problem| problems.push(problem)) else { continue };
            named.push(command);
            for text in chords {
                let chord = text.parse().map_err(|problem| format!("{name}: {problem}"));
                problems.extend(chord.and_then(|chord| bindings.bind(chord, command)).err());
            }
        }
        if !problems.is_empty() {
            return Err(problems.join("\n"));
        }
        let taken: Vec<Chord> = bindings.pairs.iter().map(|(chord, _)| *chord).collect();
        let kept = |(chord, command): &(Chord, Command)| !named.contains(command) && !taken.contains(chord);
        bindings.insert(defaults().filter(kept));
        Ok(bindings)
    }
}

/// Whether a chord can mean a command; the error says why not.
fn check(chord: Chord, command: Command) -> Result<(), String> {
    let why = if command.is_held() && chord.with != Modifiers::NONE {
        "what is held down must be one key, without Ctrl, Alt or Shift"
    } else if chord.input == Input::Mouse(MouseButton::Left) {
        "the left mouse button works panels and takes hold of the view; use another"
    } else {
        return Ok(());
    };
    Err(format!("{command}: {chord}: {why}"))
}

fn defaults() -> impl Iterator<Item = (Chord, Command)> {
    Command::all().flat_map(|command| {
        let keys = command.default_keys();
        // A test checks that all of them are chords.
        let chords: Vec<Chord> = keys.split(" or ").filter_map(|key| key.parse().ok()).collect();
        chords.into_iter().map(move |chord| (chord, command))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(text: &str) -> Result<Bindings, String> {
        ron::from_str(text).map_err(|error| error.to_string())
    }

    fn each_chord_once(bindings: &Bindings) -> bool {
        let chords: std::collections::BTreeSet<Chord> =
            bindings.pairs.iter().map(|(chord, _)| *chord).collect();
        chords.len() == bindings.pairs.len()
    }

    fn alone(name: &str) -> Chord {
        Chord::alone(name.parse().expect("a key"))
    }

    /// As the first version of the program wrote them.
    const FIRST_DEFAULTS: &str = r#"{
        "back": ["S", "Down"], "compare": ["Tab"], "down": ["C"], "forward": ["W", "Up"], "fullscreen": ["F11"],
        "genome": ["G"], "go_bookmark_1": ["Alt+1"], "go_bookmark_2": ["Alt+2"], "go_bookmark_3": ["Alt+3"],
        "go_bookmark_4": ["Alt+4"], "go_bookmark_5": ["Alt+5"], "go_bookmark_6": ["Alt+6"],
        "go_bookmark_7": ["Alt+7"], "go_bookmark_8": ["Alt+8"], "go_bookmark_9": ["Alt+9"], "help": ["F1"],
        "left": ["A", "Left"], "maximise_1": ["1"], "maximise_2": ["2"], "maximise_3": ["3"], "maximise_4": ["4"],
        "newer_generation": ["Page Down"], "next_generation": ["N"], "older_generation": ["Page Up"],
        "overhead": ["F9"], "quit": ["Ctrl+Q"], "redo": ["Ctrl+Y"], "release_mouse": ["Escape"],
        "right": ["D", "Right"], "run": ["Left Shift", "Right Shift"], "screenshot": ["F12"],
        "set_bookmark_1": ["Ctrl+1"], "set_bookmark_2": ["Ctrl+2"], "set_bookmark_3": ["Ctrl+3"],
        "set_bookmark_4": ["Ctrl+4"], "set_bookmark_5": ["Ctrl+5"], "set_bookmark_6": ["Ctrl+6"],
        "set_bookmark_7": ["Ctrl+7"], "set_bookmark_8": ["Ctrl+8"], "set_bookmark_9": ["Ctrl+9"],
        "settings": ["F2"], "show_all": ["0", "Backspace"], "start": ["Home"], "stats": ["F3"],
        "terrain_scheme": ["F6"], "tint": ["F8"], "tree_scheme": ["F5"], "undo": ["Ctrl+Z"], "up": ["Space"],
        "vote_sky_1": ["M"], "vote_sky_2": [","], "vote_sky_3": ["."], "vote_sky_4": ["/"], "vote_sky_none": ["\\"],
        "vote_terrain_1": ["J"], "vote_terrain_2": ["K"], "vote_terrain_3": ["L"], "vote_terrain_4": [";"],
        "vote_terrain_none": ["'"], "vote_tree_1": ["U"], "vote_tree_2": ["I"], "vote_tree_3": ["O"],
        "vote_tree_4": ["P"], "vote_tree_none": ["["], "walk_fly_orbit": ["F"], "wireframe": ["F7"],
    }"#;

    /// Commands that the first version did not have.
    const SINCE_THEN: [&str; 4] = ["breed_again", "export", "family", "questions"];

    #[test]
    fn the_first_versions_settings_are_read_and_are_still_the_defaults() {
        let bindings = read(FIRST_DEFAULTS).expect("valid");
        assert_eq!(bindings, Bindings::default());
        type File = BTreeMap<String, Vec<String>>;
        let file: File = ron::from_str(FIRST_DEFAULTS).expect("valid");
        let mut written = File::from(bindings);
        written.retain(|command, _| !SINCE_THEN.contains(&command.as_str()));
        assert_eq!(written, file, "they are written as they were read");
    }

    #[test]
    fn the_defaults_leave_no_command_without_a_key_and_no_key_with_two() {
        let bindings = Bindings::default();
        assert!(each_chord_once(&bindings));
        for command in Command::all() {
            let keys = bindings.chords(command).map(|chord| chord.to_string()).collect::<Vec<_>>();
            assert_eq!(keys.join(" or "), command.default_keys(), "{command}");
            let chord = bindings.chords(command).next().unwrap_or_else(|| panic!("{command} has no key"));
            assert_eq!(bindings.command(chord), Some(command));
        }
        for (chord, command) in &bindings.pairs {
            assert_eq!(check(*chord, *command), Ok(()));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]
        #[test]
        fn what_is_written_is_read_again(
            changes in prop::collection::vec((0usize..500, 0usize..500, 0u8..8, any::<bool>()), 0..40)
        ) {
            let (commands, inputs) = (Command::all().collect::<Vec<_>>(), Input::all().collect::<Vec<_>>());
            let mut bindings = Bindings::default();
            for (command, input, bits, unbind) in changes {
                let command = commands[command % commands.len()];
                let with = Modifiers { ctrl: bits & 1 > 0, alt: bits & 2 > 0, shift: bits & 4 > 0 };
                if unbind {
                    bindings.pairs.retain(|(_, known)| *known != command);
                }
                // Refused where it is taken: fine.
                let _ = bindings.bind(Chord { input: inputs[input % inputs.len()], with }, command);
            }
            prop_assert!(each_chord_once(&bindings));
            let text = ron::ser::to_string_pretty(&bindings, ron::ser::PrettyConfig::default()).expect("plain data");
            let again = read(&text).expect("as written");
            for &command in &commands {
                let chords = |bindings: &Bindings| bindings.chords(command).collect::<Vec<_>>();
                prop_assert_eq!(chords(&again), chords(&bindings), "{}", command);
            }
        }
    }

    #[test]
    fn a_file_changes_only_what_it_names() {
        let bindings = read(r#"{"forward": ["E"], "undo": []}"#).expect("sound");
        let chords = |command| bindings.chords(command).map(|chord| chord.to_string()).collect::<Vec<_>>();
        assert_eq!(chords(Command::Forward), ["E"]);
        assert!(chords(Command::Undo).is_empty());
        assert_eq!(chords(Command::Back), ["S", "Down"]);
    }

    #[test]
    fn a_key_that_the_file_takes_leaves_its_default() {
        let bindings = read(r#"{"screenshot": ["W"]}"#).expect("sound");
        assert_eq!(bindings.command(alone("W")), Some(Command::Screenshot));
        assert_eq!(bindings.keys(&[Command::Forward]), "Up");
    }

    #[test]
    fn all_that_is_wrong_is_told_at_once() {
        let told = read(
            r#"{"forward": ["E", "Spcae"], "back": ["E"], "jupm": ["J"], "left": ["Ctrl+A"],
                            "undo": ["Mouse Left"]}"#,
        )
        .expect_err("wrong in five ways");
        for part in [
            "E is given to both back and forward",
            "forward: \"Spcae\" is not a key; did you mean Space?",
            "jupm is not an action",
            "left: Ctrl+A: what is held down must be one key",
            "undo: Mouse Left: the left mouse button",
        ] {
            assert!(told.contains(part), "{part} is not in\n{told}");
        }
    }

    #[test]
    fn a_runner_can_press_keys_and_ctrl_does_not_stop_a_walk() {
        let bindings = Bindings::default();
        let with = |shift, ctrl| Modifiers { shift, ctrl, alt: false };
        let meaning = |key, with| bindings.command(Chord { with, ..alone(key) });
        assert_eq!(meaning("W", with(true, false)), Some(Command::Forward));
        assert_eq!(meaning("W", with(false, true)), Some(Command::Forward));
        assert_eq!(meaning("2", with(true, false)), Some(Command::Maximise(2)));
        assert_eq!(meaning("2", with(false, true)), Some(Command::SetBookmark(2)));
        assert_eq!(meaning("N", with(false, true)), None, "Ctrl+N is not N");
    }

    #[test]
    fn the_help_has_every_key() {
        let help = Bindings::default().help();
        let titles: Vec<&str> = help.iter().map(|group| group.title.as_str()).collect();
        assert_eq!(titles, ["Move", "Look", "Choose", "Bookmarks", "Window", "Laboratory"]);
        let lines: Vec<&(String, String)> = help.iter().flat_map(|group| &group.keys).collect();
        let keys = |meaning: &str| lines.iter().find(|line| line.1 == meaning).map(|line| line.0.as_str());
        assert_eq!(keys("walk forward"), Some("W or Up"));
        assert_eq!(keys("best tree: landscape 1 to 4"), Some("U I O P"));
        assert_eq!(keys("best sky: none of them"), Some("\\"));
        assert_eq!(keys("go to a bookmark"), Some("Alt+1 … Alt+9"));
        assert_eq!(lines.len(), 42);
    }
}
