//! Everything that a person can ask for with a key, a button or a gamepad, each with a name for files and a line of help.

use std::fmt;
use std::str::FromStr;

use genescape_schema::Category;

/// Landscapes that are shown at once.
pub const VIEWS: u8 = 4;
/// Bookmarks that can be kept, numbered from 1.
pub const BOOKMARKS: u8 = 9;

/// What a key means. Views and individuals count from 0 here and from 1 in names and help.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Action {
    /// Held: move where one looks.
    Forward,
    /// Held.
    Back,
    /// Held: sideways.
    Left,
    /// Held: sideways.
    Right,
    /// Held: flying up, orbiting farther.
    Up,
    /// Held: flying down, orbiting nearer.
    Down,
    /// Held: faster.
    Run,
    /// Walk, fly, orbit, and around again.
    ToggleWalkFlyOrbit,
    /// Lets the mouse go from the window.
    ReleaseMouse,
    /// Back to where walks start.
    GoToStart,
    /// One landscape fills the window; the same again shows all.
    Maximise(u8),
    /// All four.
    ShowAll,
    /// Two landscapes side by side with a splitter.
    CompareAB,
    /// The best of four in a category; `None` says that none is good.
    Vote(Category, Option<u8>),
    /// Breed from the votes.
    NextGeneration,
    /// Take back the last vote or generation.
    Undo,
    /// Make again what was taken back.
    Redo,
    /// Show the generation before.
    OlderGeneration,
    /// Show the generation after.
    NewerGeneration,
    /// Keep the camera's pose: 1 to [`BOOKMARKS`].
    SetBookmark(u8),
    /// Jump to a kept pose.
    GoBookmark(u8),
    /// The overlay of keys.
    ToggleHelp,
    /// The panel of genes.
    ToggleGenome,
    /// Frame times and counts.
    ToggleStats,
    /// The panel of settings.
    ToggleSettings,
    /// The whole screen.
    ToggleFullscreen,
    /// The picture into a file.
    Screenshot,
    /// Close the window.
    Quit,
    /// The next way of choosing trees' levels of detail.
    CycleTreeScheme,
    /// The next way of choosing the terrain's levels of detail.
    CycleTerrainScheme,
    /// Edges only.
    ToggleWireframe,
    /// Colours that tell levels of detail.
    ToggleTint,
    /// The land from above.
    ToggleOverhead,
}

/// Part of the help that an action belongs to, in the order of the help.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Group {
    /// The camera.
    Move,
    /// Which landscape is shown.
    Look,
    /// Votes and generations.
    Choose,
    /// Kept poses.
    Bookmarks,
    /// Panels, screen, files.
    Window,
    /// Levels of detail made visible.
    Laboratory,
}

impl Group {
    /// Heading in the help.
    pub fn title(self) -> &'static str {
        match self {
            Self::Move => "Move",
            Self::Look => "Look",
            Self::Choose => "Choose",
            Self::Bookmarks => "Bookmarks",
            Self::Window => "Window",
            Self::Laboratory => "Laboratory",
        }
    }
}

impl Action {
    /// Every action, in the order of the help.
    pub fn all() -> impl Iterator<Item = Self> {
        use Action::*;
        let votes = Category::ALL.into_iter().flat_map(|category| {
            (0..VIEWS).map(Some).chain([None]).map(move |individual| Vote(category, individual))
        });
        [Forward, Back, Left, Right, Up, Down, Run, ToggleWalkFlyOrbit, ReleaseMouse, GoToStart]
            .into_iter()
            .chain((0..VIEWS).map(Maximise))
            .chain([ShowAll, CompareAB])
            .chain(votes)
            .chain([NextGeneration, Undo, Redo, OlderGeneration, NewerGeneration])
            .chain((1..=BOOKMARKS).map(SetBookmark))
            .chain((1..=BOOKMARKS).map(GoBookmark))
            .chain([
                ToggleHelp,
                ToggleGenome,
                ToggleStats,
                ToggleSettings,
                ToggleFullscreen,
                Screenshot,
                Quit,
            ])
            .chain([CycleTreeScheme, CycleTerrainScheme, ToggleWireframe, ToggleTint, ToggleOverhead])
    }

    /// True for what lasts as long as its key is held.
    pub fn is_held(self) -> bool {
        self <= Self::Run
    }

    /// Where the help lists it.
    pub fn group(self) -> Group {
        use Action::*;
        match self {
            Forward | Back | Left | Right | Up | Down | Run | ToggleWalkFlyOrbit | ReleaseMouse
            | GoToStart => Group::Move,
            Maximise(_) | ShowAll | CompareAB => Group::Look,
            Vote(..) | NextGeneration | Undo | Redo | OlderGeneration | NewerGeneration => Group::Choose,
            SetBookmark(_) | GoBookmark(_) => Group::Bookmarks,
            ToggleHelp | ToggleGenome | ToggleStats | ToggleSettings | ToggleFullscreen | Screenshot
            | Quit => Group::Window,
            CycleTreeScheme | CycleTerrainScheme | ToggleWireframe | ToggleTint | ToggleOverhead => {
                Group::Laboratory
            }
        }
    }

    /// A line of help.
    pub fn meaning(self) -> String {
        use Action::*;
        let fixed = match self {
            Forward => "walk forward",
            Back => "walk back",
            Left => "step left",
            Right => "step right",
            Up => "fly up; orbit farther",
            Down => "fly down; orbit nearer",
            Run => "run",
            ToggleWalkFlyOrbit => "walk, fly or orbit",
            ReleaseMouse => "let the mouse go",
            GoToStart => "back to the start",
            Maximise(view) => return format!("landscape {} alone, or all again", u32::from(view) + 1),
            ShowAll => "all four landscapes",
            CompareAB => "two side by side",
            Vote(category, Some(individual)) => {
                return format!("best {category}: landscape {}", u32::from(individual) + 1);
            }
            Vote(category, None) => return format!("best {category}: none of them"),
            NextGeneration => "breed the next generation",
            Undo => "undo",
            Redo => "redo",
            OlderGeneration => "the generation before",
            NewerGeneration => "the generation after",
            SetBookmark(number) => return format!("keep this view as bookmark {number}"),
            GoBookmark(number) => return format!("go to bookmark {number}"),
            ToggleHelp => "this help",
            ToggleGenome => "genes",
            ToggleStats => "frame times",
            ToggleSettings => "settings",
            ToggleFullscreen => "whole screen",
            Screenshot => "save a picture",
            Quit => "close the window",
            CycleTreeScheme => "trees' levels of detail",
            CycleTerrainScheme => "terrain's levels of detail",
            ToggleWireframe => "edges only",
            ToggleTint => "levels of detail as colours",
            ToggleOverhead => "the land from above",
        };
        fixed.to_string()
    }
}

/// Its name in a settings file.
impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use Action::*;
        let fixed = match *self {
            Forward => "forward",
            Back => "back",
            Left => "left",
            Right => "right",
            Up => "up",
            Down => "down",
            Run => "run",
            ToggleWalkFlyOrbit => "walk_fly_orbit",
            ReleaseMouse => "release_mouse",
            GoToStart => "start",
            Maximise(view) => return write!(f, "maximise_{}", u32::from(view) + 1),
            ShowAll => "show_all",
            CompareAB => "compare",
            Vote(category, Some(individual)) => {
                return write!(f, "vote_{}_{}", category.name(), u32::from(individual) + 1);
            }
            Vote(category, None) => return write!(f, "vote_{}_none", category.name()),
            NextGeneration => "next_generation",
            Undo => "undo",
            Redo => "redo",
            OlderGeneration => "older_generation",
            NewerGeneration => "newer_generation",
            SetBookmark(number) => return write!(f, "set_bookmark_{number}"),
            GoBookmark(number) => return write!(f, "go_bookmark_{number}"),
            ToggleHelp => "help",
            ToggleGenome => "genome",
            ToggleStats => "stats",
            ToggleSettings => "settings",
            ToggleFullscreen => "fullscreen",
            Screenshot => "screenshot",
            Quit => "quit",
            CycleTreeScheme => "tree_scheme",
            CycleTerrainScheme => "terrain_scheme",
            ToggleWireframe => "wireframe",
            ToggleTint => "tint",
            ToggleOverhead => "overhead",
        };
        f.write_str(fixed)
    }
}

impl FromStr for Action {
    type Err = String;

    /// The action of that name; the error says which name it may have been meant to be.
    fn from_str(name: &str) -> Result<Self, String> {
        Self::all().find(|action| action.to_string() == name).ok_or_else(|| {
            let known = Self::all().map(|action| action.to_string());
            match nearest(name, known) {
                Some(near) => format!("{name} is not an action; did you mean {near}?"),
                None => {
                    let names: Vec<String> = Self::all().map(|action| action.to_string()).collect();
                    format!("{name} is not an action; actions are {}", names.join(", "))
                }
            }
        })
    }
}

/// The known name that a mistyped one is nearest to, if any is near.
pub(super) fn nearest(name: &str, known: impl Iterator<Item = String>) -> Option<String> {
    let lower = name.to_lowercase();
    let limit = name.chars().count() / 3;
    known
        .map(|known| (strsim::osa_distance(&lower, &known.to_lowercase()), known))
        .filter(|(distance, _)| *distance <= limit)
        .min()
        .map(|(_, known)| known)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_action_has_a_name_of_its_own_that_leads_back_to_it() {
        let names: BTreeSet<String> = Action::all().map(|action| action.to_string()).collect();
        assert_eq!(names.len(), Action::all().count());
        for action in Action::all() {
            assert_eq!(action.to_string().parse(), Ok(action));
            assert!(!action.meaning().is_empty());
        }
    }

    #[test]
    fn the_help_lists_groups_one_after_the_other() {
        let groups: Vec<Group> = Action::all().map(Action::group).collect();
        assert!(groups.is_sorted());
    }

    #[test]
    fn a_mistyped_name_is_told_the_right_one() {
        let told = "fowrard".parse::<Action>().expect_err("no such action");
        assert_eq!(told, "fowrard is not an action; did you mean forward?");
        let told = "teleport".parse::<Action>().expect_err("no such action");
        assert!(told.contains("actions are forward, back"), "{told}");
    }
}
