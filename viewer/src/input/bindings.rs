//! Which key means what: the defaults, a person's changes from a settings file, and the help that lists them.
//!
//! In a file, bindings are a map from an action's name to its chords: `{"forward": ["W", "Up"], "undo": ["Ctrl+Z"]}`.
//! What is not named keeps its default. A key that the file gives to one action is taken from the action that has it by
//! default; a key that the file gives to two is an error that names both. All errors are told at once.

use std::collections::BTreeMap;

use genescape_schema::Category;
use serde::{Deserialize, Serialize};
use winit::keyboard::KeyCode;

use super::action::{Action, BOOKMARKS, Group, VIEWS};
use super::chord::{Chord, Input, Modifiers};

/// For each chord the one action that it means; an action may have several chords, or none.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "BTreeMap<String, Vec<String>>", into = "BTreeMap<String, Vec<String>>")]
pub struct Bindings {
    /// In the order in which the help lists an action's keys.
    pairs: Vec<(Chord, Action)>,
}

/// One chord that would mean two things.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{chord} is given to both {first} and {second}; give one of them another key")]
pub struct Conflict {
    /// The chord.
    pub chord: Chord,
    /// What it means already.
    pub first: Action,
    /// What it was to mean as well.
    pub second: Action,
}

/// What is wrong with bindings from a file, one line each.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", .0.join("\n"))]
pub struct BindingsError(pub Vec<String>);

/// One line of the help.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HelpLine {
    /// Its part of the help.
    pub group: Group,
    /// "W or Up"; "no key" if it has none.
    pub keys: String,
    /// What they do.
    pub meaning: String,
}

impl Default for Bindings {
    fn default() -> Self {
        Self { pairs: defaults() }
    }
}

impl Bindings {
    /// What a chord means.
    ///
    /// Held actions listen to their key whatever is held with it, or a runner's Shift would stop the walk. Other actions
    /// want their chord exactly; except that Shift may be held where the chord with Shift means nothing else.
    pub fn action(&self, chord: Chord) -> Option<Action> {
        let exact =
            |chord: Chord| self.pairs.iter().find(|(known, _)| *known == chord).map(|(_, action)| *action);
        let unshifted = Chord { with: Modifiers { shift: false, ..chord.with }, ..chord };
        let alone = chord.with(Modifiers::NONE);
        exact(chord).or_else(|| exact(unshifted)).or_else(|| exact(alone).filter(|action| action.is_held()))
    }

    /// The chords of an action, the first one first.
    pub fn chords(&self, action: Action) -> impl Iterator<Item = Chord> {
        self.pairs.iter().filter(move |(_, known)| *known == action).map(|(chord, _)| *chord)
    }

    /// Adds a chord to an action's; fails if it means something else, or if it cannot mean this.
    pub fn bind(&mut self, chord: Chord, action: Action) -> Result<(), BindingsError> {
        if let Some(problem) = unsuitable(chord, action) {
            return Err(BindingsError(vec![problem]));
        }
        match self.pairs.iter().find(|(known, _)| *known == chord) {
            Some((_, first)) if *first == action => Ok(()),
            Some((_, first)) => {
                Err(BindingsError(vec![Conflict { chord, first: *first, second: action }.to_string()]))
            }
            None => {
                self.pairs.push((chord, action));
                Ok(())
            }
        }
    }

    /// Takes all chords from an action.
    pub fn unbind(&mut self, action: Action) {
        self.pairs.retain(|(_, known)| *known != action);
    }

    /// All chords that mean two things; none can, however the bindings were made, but a test had better ask.
    pub fn conflicts(&self) -> Vec<Conflict> {
        let mut found = Vec::new();
        for (place, &(chord, first)) in self.pairs.iter().enumerate() {
            for &(other, second) in &self.pairs[place + 1..] {
                if other == chord && second != first {
                    found.push(Conflict { chord, first, second });
                }
            }
        }
        found
    }

    /// Every action with its keys, group by group. Actions that differ by a number stand on one line.
    pub fn help(&self) -> Vec<HelpLine> {
        let mut lines: Vec<HelpLine> = Vec::new();
        for action in Action::all() {
            match action {
                Action::Maximise(0) => {
                    lines.push(self.series(action, (0..VIEWS).map(Action::Maximise), "one landscape alone"))
                }
                Action::Vote(category, Some(0)) => {
                    let all = (0..VIEWS).map(|individual| Action::Vote(category, Some(individual)));
                    lines.push(self.series(action, all, &format!("best {category}: landscape 1 to {VIEWS}")));
                }
                Action::SetBookmark(1) => {
                    let all = (1..=BOOKMARKS).map(Action::SetBookmark);
                    lines.push(self.series(action, all, "keep this view as a bookmark"));
                }
                Action::GoBookmark(1) => {
                    let all = (1..=BOOKMARKS).map(Action::GoBookmark);
                    lines.push(self.series(action, all, "go to a bookmark"));
                }
                Action::Maximise(_)
                | Action::Vote(_, Some(_))
                | Action::SetBookmark(_)
                | Action::GoBookmark(_) => {}
                single => lines.push(HelpLine {
                    group: single.group(),
                    keys: self.keys(single),
                    meaning: single.meaning(),
                }),
            }
        }
        lines
    }

    /// "W or Up".
    fn keys(&self, action: Action) -> String {
        let names: Vec<String> = self.chords(action).map(|chord| chord.to_string()).collect();
        if names.is_empty() { "no key".into() } else { names.join(" or ") }
    }

    /// A line for actions that differ by a number: "U I O P", "Ctrl+1 … Ctrl+9".
    fn series(&self, first: Action, all: impl Iterator<Item = Action>, meaning: &str) -> HelpLine {
        let names: Vec<String> = all
            .map(|action| self.chords(action).next().map_or("–".into(), |chord| chord.to_string()))
            .collect();
        let keys = match (names.len(), names.first(), names.last()) {
            (5.., Some(from), Some(to)) => format!("{from} … {to}"),
            _ => names.join(" "),
        };
        HelpLine { group: first.group(), keys, meaning: meaning.into() }
    }
}

impl From<Bindings> for BTreeMap<String, Vec<String>> {
    fn from(bindings: Bindings) -> Self {
        let written = |action: Action| bindings.chords(action).map(|chord| chord.to_string()).collect();
        Action::all().map(|action| (action.to_string(), written(action))).collect()
    }
}

impl TryFrom<BTreeMap<String, Vec<String>>> for Bindings {
    type Error = BindingsError;

    fn try_from(file: BTreeMap<String, Vec<String>>) -> Result<Self, BindingsError> {
        let mut problems = Vec::new();
        let mut named = Vec::new();
        let mut bindings = Self { pairs: Vec::new() };
        for (name, chords) in &file {
            let action: Action = match name.parse() {
                Ok(action) => action,
                Err(problem) => {
                    problems.push(problem);
                    continue;
                }
            };
            named.push(action);
            for text in chords {
                match text.parse::<Chord>() {
                    Ok(chord) => {
                        problems.extend(bindings.bind(chord, action).err().into_iter().flat_map(|e| e.0))
                    }
                    Err(problem) => problems.push(format!("{name}: {problem}")),
                }
            }
        }
        if !problems.is_empty() {
            return Err(BindingsError(problems));
        }
        let taken: Vec<Chord> = bindings.pairs.iter().map(|(chord, _)| *chord).collect();
        let kept = |(chord, action): &(Chord, Action)| !named.contains(action) && !taken.contains(chord);
        bindings.pairs.extend(defaults().into_iter().filter(kept));
        // The order of the help, whatever the order of the file; stable, so an action's first key stays first.
        bindings.pairs.sort_by_key(|(_, action)| *action);
        Ok(bindings)
    }
}

/// Why a chord cannot mean an action.
fn unsuitable(chord: Chord, action: Action) -> Option<String> {
    if action.is_held() && chord.with != Modifiers::NONE {
        return Some(format!(
            "{action}: {chord}: what is held down must be one key, without Ctrl, Alt or Shift"
        ));
    }
    let steers = matches!(chord.input, Input::Mouse(winit::event::MouseButton::Left));
    steers.then(|| {
        format!("{action}: the left mouse button works panels and takes hold of the view; use another")
    })
}

/// Votes lie as they are seen, a row of four keys for each category with "none" at its end; so do none of the keys under
/// the left hand, which walks.
fn defaults() -> Vec<(Chord, Action)> {
    use Action::*;
    use KeyCode as K;
    let mut pairs: Vec<(Chord, Action)> = [
        (K::KeyW, Forward),
        (K::ArrowUp, Forward),
        (K::KeyS, Back),
        (K::ArrowDown, Back),
        (K::KeyA, Left),
        (K::ArrowLeft, Left),
        (K::KeyD, Right),
        (K::ArrowRight, Right),
        (K::Space, Up),
        (K::KeyC, Down),
        (K::ShiftLeft, Run),
        (K::ShiftRight, Run),
        (K::KeyF, ToggleWalkFlyOrbit),
        (K::Escape, ReleaseMouse),
        (K::Home, GoToStart),
        (K::Digit0, ShowAll),
        (K::Backspace, ShowAll),
        (K::Tab, CompareAB),
        (K::KeyN, NextGeneration),
        (K::PageUp, OlderGeneration),
        (K::PageDown, NewerGeneration),
        (K::F1, ToggleHelp),
        (K::KeyG, ToggleGenome),
        (K::F2, ToggleSettings),
        (K::F3, ToggleStats),
        (K::F11, ToggleFullscreen),
        (K::F12, Screenshot),
        (K::F5, CycleTreeScheme),
        (K::F6, CycleTerrainScheme),
        (K::F7, ToggleWireframe),
        (K::F8, ToggleTint),
        (K::F9, ToggleOverhead),
    ]
    .map(|(code, action)| (Chord::key(code), action))
    .into();
    pairs.push((Chord::key(K::KeyZ).with(Modifiers::CTRL), Undo));
    pairs.push((Chord::key(K::KeyY).with(Modifiers::CTRL), Redo));
    pairs.push((Chord::key(K::KeyQ).with(Modifiers::CTRL), Quit));
    let rows = [
        (Category::Tree, [K::KeyU, K::KeyI, K::KeyO, K::KeyP, K::BracketLeft]),
        (Category::Terrain, [K::KeyJ, K::KeyK, K::KeyL, K::Semicolon, K::Quote]),
        (Category::Sky, [K::KeyM, K::Comma, K::Period, K::Slash, K::Backslash]),
    ];
    for (category, keys) in rows {
        let choices = (0..VIEWS).map(Some).chain([None]);
        pairs.extend(
            keys.into_iter().zip(choices).map(|(code, best)| (Chord::key(code), Vote(category, best))),
        );
    }
    let digits =
        [K::Digit1, K::Digit2, K::Digit3, K::Digit4, K::Digit5, K::Digit6, K::Digit7, K::Digit8, K::Digit9];
    pairs.extend(digits.into_iter().zip(0..VIEWS).map(|(code, view)| (Chord::key(code), Maximise(view))));
    for (code, number) in digits.into_iter().zip(1..=BOOKMARKS) {
        pairs.push((Chord::key(code).with(Modifiers::CTRL), SetBookmark(number)));
        pairs.push((Chord::key(code).with(Modifiers::ALT), GoBookmark(number)));
    }
    pairs.sort_by_key(|(_, action)| *action);
    pairs
}

#[cfg(test)]
mod tests {
    use super::super::chord::inputs;
    use super::*;
    use proptest::prelude::*;

    fn read(text: &str) -> Result<Bindings, String> {
        ron::from_str(text).map_err(|error| error.to_string())
    }

    #[test]
    fn the_defaults_leave_no_action_without_a_key_and_no_key_with_two() {
        let bindings = Bindings::default();
        assert_eq!(bindings.conflicts(), []);
        for action in Action::all() {
            let chord = bindings.chords(action).next().unwrap_or_else(|| panic!("{action} has no key"));
            assert_eq!(bindings.action(chord), Some(action));
        }
        for (chord, action) in &bindings.pairs {
            assert_eq!(unsuitable(*chord, *action), None);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]
        #[test]
        fn what_is_written_is_read_again(
            changes in prop::collection::vec((0usize..500, 0usize..500, 0u8..8, any::<bool>()), 0..40)
        ) {
            let (actions, inputs) = (Action::all().collect::<Vec<_>>(), inputs().collect::<Vec<_>>());
            let mut bindings = Bindings::default();
            for (action, input, bits, unbind) in changes {
                let action = actions[action % actions.len()];
                let with = Modifiers { ctrl: bits & 1 > 0, alt: bits & 2 > 0, shift: bits & 4 > 0 };
                if unbind {
                    bindings.unbind(action);
                }
                // Refused where it is taken: fine.
                let _ = bindings.bind(Chord { input: inputs[input % inputs.len()], with }, action);
            }
            prop_assert_eq!(bindings.conflicts(), vec![]);
            let text = ron::ser::to_string_pretty(&bindings, ron::ser::PrettyConfig::default()).expect("plain data");
            let again = read(&text).expect("as written");
            for &action in &actions {
                let chords = |bindings: &Bindings| bindings.chords(action).collect::<Vec<_>>();
                prop_assert_eq!(chords(&again), chords(&bindings), "{}", action);
            }
        }
    }

    #[test]
    fn a_file_changes_only_what_it_names() {
        let bindings = read(r#"{"forward": ["E"], "undo": []}"#).expect("sound");
        let chords = |action| bindings.chords(action).map(|chord| chord.to_string()).collect::<Vec<_>>();
        assert_eq!(chords(Action::Forward), ["E"]);
        assert!(chords(Action::Undo).is_empty());
        assert_eq!(chords(Action::Back), ["S", "Down"]);
    }

    #[test]
    fn a_key_that_the_file_takes_leaves_its_default() {
        let bindings = read(r#"{"screenshot": ["W"]}"#).expect("sound");
        assert_eq!(bindings.action(Chord::key(KeyCode::KeyW)), Some(Action::Screenshot));
        assert_eq!(bindings.keys(Action::Forward), "Up");
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
            "undo: the left mouse button",
        ] {
            assert!(told.contains(part), "{part} is not in\n{told}");
        }
    }

    #[test]
    fn a_runner_can_press_keys_and_ctrl_does_not_stop_a_walk() {
        let bindings = Bindings::default();
        let with = |shift, ctrl| Modifiers { shift, ctrl, alt: false };
        let meaning = |code, with| bindings.action(Chord::key(code).with(with));
        assert_eq!(meaning(KeyCode::KeyW, with(true, false)), Some(Action::Forward));
        assert_eq!(meaning(KeyCode::KeyW, with(false, true)), Some(Action::Forward));
        assert_eq!(meaning(KeyCode::Digit2, with(true, false)), Some(Action::Maximise(1)));
        assert_eq!(meaning(KeyCode::Digit2, with(false, true)), Some(Action::SetBookmark(2)));
        assert_eq!(meaning(KeyCode::KeyN, with(false, true)), None, "Ctrl+N is not N");
    }

    #[test]
    fn the_help_has_every_key() {
        let help = Bindings::default().help();
        let line =
            |meaning: &str| help.iter().find(|line| line.meaning == meaning).map(|line| line.keys.as_str());
        assert_eq!(line("walk forward"), Some("W or Up"));
        assert_eq!(line("best tree: landscape 1 to 4"), Some("U I O P"));
        assert_eq!(line("best sky: none of them"), Some("\\"));
        assert_eq!(line("go to a bookmark"), Some("Alt+1 … Alt+9"));
        assert!(help.is_sorted_by_key(|line| line.group));
    }
}
