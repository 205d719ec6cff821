//! What a key, a button or a gamepad can ask for: one closed list. A variant's documentation is its line of help, its name
//! in snake case (or `to_string`) is its name in settings files, `keys` are its default bindings, and `group` begins
//! another part of the help.

use std::fmt;
use std::str::FromStr;

use genescape_schema::{Category, INDIVIDUALS};
use strum::{EnumMessage, EnumProperty, IntoEnumIterator};

/// Bookmarks that can be kept, numbered from 1.
const BOOKMARKS: u8 = 9;

/// What a chord is bound to. Landscapes and bookmarks count from 1.
#[derive(
    Clone,
    Copy,
    Debug,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    strum::Display,
    strum::EnumIter,
    strum::EnumMessage,
    strum::EnumProperty,
)]
#[strum(serialize_all = "snake_case")]
pub enum Command {
    /// walk forward
    #[strum(props(group = "Move", keys = "W or Up"))]
    Forward,
    /// walk back
    #[strum(props(keys = "S or Down"))]
    Back,
    /// step left
    #[strum(props(keys = "A or Left"))]
    Left,
    /// step right
    #[strum(props(keys = "D or Right"))]
    Right,
    /// fly up; orbit farther
    #[strum(props(keys = "Space"))]
    Up,
    /// fly down; orbit nearer
    #[strum(props(keys = "C"))]
    Down,
    /// run
    #[strum(props(keys = "Left Shift or Right Shift"))]
    Run,
    /// walk, fly or orbit
    #[strum(props(keys = "F"))]
    WalkFlyOrbit,
    /// let the mouse go
    #[strum(props(keys = "Escape"))]
    ReleaseMouse,
    /// to the first view of each landscape
    #[strum(to_string = "start", props(keys = "Home"))]
    GoToStart,
    /// one landscape alone
    #[strum(to_string = "maximise_{0}", props(group = "Look"))]
    Maximise(u8),
    /// all four landscapes
    #[strum(props(keys = "0 or Backspace"))]
    ShowAll,
    /// two over each other, with a splitter
    #[strum(props(keys = "Tab"))]
    Compare,
    #[strum(to_string = "vote_{0}", props(group = "Choose"))]
    Vote(Best),
    /// breed the next generation
    #[strum(props(keys = "N"))]
    NextGeneration,
    /// breed once more from the same votes
    #[strum(props(keys = "Shift+N"))]
    BreedAgain,
    /// family tree, favourites
    #[strum(props(keys = "T"))]
    Family,
    /// undo
    #[strum(props(keys = "Ctrl+Z"))]
    Undo,
    /// redo
    #[strum(props(keys = "Ctrl+Y"))]
    Redo,
    /// the generation before
    #[strum(props(keys = "Page Up"))]
    OlderGeneration,
    /// the generation after
    #[strum(props(keys = "Page Down"))]
    NewerGeneration,
    /// keep this view as a bookmark
    #[strum(to_string = "set_bookmark_{0}", props(group = "Bookmarks"))]
    SetBookmark(u8),
    /// go to a bookmark
    #[strum(to_string = "go_bookmark_{0}")]
    GoToBookmark(u8),
    /// this help
    #[strum(props(group = "Window", keys = "F1"))]
    Help,
    /// genes
    #[strum(props(keys = "G"))]
    Genome,
    /// frame times
    #[strum(props(keys = "F3"))]
    Stats,
    /// settings
    #[strum(props(keys = "F2"))]
    Settings,
    /// whole screen
    #[strum(props(keys = "F11"))]
    Fullscreen,
    /// save a picture
    #[strum(props(keys = "F12"))]
    Screenshot,
    /// export a landscape
    #[strum(props(keys = "E"))]
    Export,
    /// questions about the walk
    #[strum(props(keys = "Q"))]
    Questions,
    /// close the window
    #[strum(props(keys = "Ctrl+Q"))]
    Quit,
    /// trees' levels of detail
    #[strum(to_string = "tree_scheme", props(group = "Laboratory", keys = "F5"))]
    NextTreeLod,
    /// terrain's levels of detail
    #[strum(to_string = "terrain_scheme", props(keys = "F6"))]
    NextTerrainLod,
    /// edges only
    #[strum(props(keys = "F7"))]
    Wireframe,
    /// levels of detail as colours
    #[strum(props(keys = "F8"))]
    Tint,
    /// the land from above
    #[strum(props(keys = "F9"))]
    Overhead,
}

/// The best landscape of a category.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Best {
    pub category: Category,
    /// `None`: none of them is good.
    pub landscape: Option<u8>,
}

impl Default for Best {
    fn default() -> Self {
        Self { category: Category::Tree, landscape: None }
    }
}

impl fmt::Display for Best {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.landscape {
            Some(landscape) => write!(f, "{}_{landscape}", self.category),
            None => write!(f, "{}_none", self.category),
        }
    }
}

impl Command {
    /// Every command, in the order of the help.
    pub fn all() -> impl Iterator<Item = Self> {
        Self::iter().flat_map(|command| match command {
            Self::Maximise(_) => landscapes().map(Self::Maximise).collect(),
            Self::Vote(_) => votes().map(Self::Vote).collect(),
            Self::SetBookmark(_) => (1..=BOOKMARKS).map(Self::SetBookmark).collect(),
            Self::GoToBookmark(_) => (1..=BOOKMARKS).map(Self::GoToBookmark).collect(),
            single => vec![single],
        })
    }

    /// True for what lasts as long as its key is held.
    pub fn is_held(self) -> bool {
        self <= Self::Run
    }

    /// The heading in the help under which this command and those after it stand; `None` for that of the one before.
    pub fn group(self) -> Option<&'static str> {
        self.get_str("group")
    }

    /// A line of help. Commands that differ by a number only share it.
    pub fn help(self) -> String {
        match self {
            Self::Vote(Best { category, landscape: Some(_) }) => {
                format!("best {category}: landscape 1 to {INDIVIDUALS}")
            }
            Self::Vote(Best { category, landscape: None }) => format!("best {category}: none of them"),
            _ => self.get_documentation().unwrap_or_default().to_owned(),
        }
    }

    /// The chords that it is bound to by default, as in "W or Up". Votes lie as they are seen, a row of four keys for each
    /// category with "none" at its end, away from the keys of the left hand, which walks.
    pub fn default_keys(self) -> String {
        match self {
            Self::Maximise(landscape) => landscape.to_string(),
            Self::SetBookmark(number) => format!("Ctrl+{number}"),
            Self::GoToBookmark(number) => format!("Alt+{number}"),
            Self::Vote(Best { category, landscape }) => {
                let row = ["UIOP[", "JKL;'", "M,./\\"][category as usize];
                let column = landscape.map_or(INDIVIDUALS, |landscape| usize::from(landscape) - 1);
                row[column..=column].to_owned()
            }
            _ => self.get_str("keys").unwrap_or_default().to_owned(),
        }
    }
}

fn landscapes() -> impl Iterator<Item = u8> + Clone {
    1..=INDIVIDUALS as u8
}

fn votes() -> impl Iterator<Item = Best> {
    Category::ALL.into_iter().flat_map(|category| {
        let choices = landscapes().map(Some).chain([None]);
        choices.map(move |landscape| Best { category, landscape })
    })
}

impl FromStr for Command {
    type Err = String;

    /// The command of that name; the error says which name it may have been meant to be.
    fn from_str(name: &str) -> Result<Self, String> {
        let named = || Self::all().map(|command| (command.to_string(), command));
        named().find(|(known, _)| known == name).map(|(_, command)| command).ok_or_else(|| {
            let names: Vec<String> = named().map(|(known, _)| known).collect();
            match nearest(name, &names) {
                Some(near) => format!("{name} is not an action; did you mean {near}?"),
                None => format!("{name} is not an action; actions are {}", names.join(", ")),
            }
        })
    }
}

/// The known name that a mistyped one is nearest to, if any is near.
pub(super) fn nearest<'a>(name: &str, known: &'a [String]) -> Option<&'a str> {
    let lower = name.to_lowercase();
    let distance = |known: &str| strsim::osa_distance(&lower, &known.to_lowercase());
    let (distance, near) = known.iter().map(|known| (distance(known), known)).min()?;
    (distance <= name.chars().count() / 3).then_some(near)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_command_has_a_name_of_its_own_that_leads_back_to_it() {
        let names: BTreeSet<String> = Command::all().map(|command| command.to_string()).collect();
        assert_eq!(names.len(), Command::all().count());
        for command in Command::all() {
            assert_eq!(command.to_string().parse(), Ok(command));
            assert!(!command.help().is_empty());
        }
    }

    #[test]
    fn names_in_settings_files_stay() {
        let names: Vec<String> = Command::all().map(|command| command.to_string()).collect();
        let votes = |category| {
            (1..=4).map(move |n| format!("vote_{category}_{n}")).chain([format!("vote_{category}_none")])
        };
        let marks = |verb| (1..=9).map(move |n| format!("{verb}_bookmark_{n}"));
        let fixed = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
        let known = [
            fixed("forward back left right up down run walk_fly_orbit release_mouse start"),
            fixed("maximise_1 maximise_2 maximise_3 maximise_4 show_all compare"),
            ["tree", "terrain", "sky"].into_iter().flat_map(votes).collect(),
            fixed("next_generation breed_again family undo redo older_generation newer_generation"),
            marks("set").chain(marks("go")).collect(),
            fixed("help genome stats settings fullscreen screenshot export questions quit"),
            fixed("tree_scheme terrain_scheme wireframe tint overhead"),
        ];
        assert_eq!(names, known.concat());
    }

    #[test]
    fn a_mistyped_name_is_told_the_right_one() {
        let told = "fowrard".parse::<Command>().expect_err("no such command");
        assert_eq!(told, "fowrard is not an action; did you mean forward?");
        let told = "teleport".parse::<Command>().expect_err("no such command");
        assert!(told.contains("actions are forward, back"), "{told}");
    }
}
