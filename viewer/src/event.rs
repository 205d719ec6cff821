//! Everything that a person can ask of the program, by pointer, key, gamepad or dropped file: one closed list. Panels
//! and bindings make events; the application's loop hands each to its owner. Plain values: nothing here acts.

use std::path::PathBuf;

use genescape_schema::{Category, INDIVIDUALS, Votes};
use serde::{Deserialize, Serialize};

use crate::frame::Options;

/// One wish of the person.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// The ballot of one category becomes this.
    Vote {
        /// Which category is voted on.
        category: Category,
        /// Its ballot from now on.
        ballot: Ballot,
    },
    /// Write the votes down and breed; sent only when all three ballots are cast.
    NextGeneration,
    /// Take back the latest step: a vote, a changed gene, a generation.
    Undo,
    /// Do again what was taken back.
    Redo,
    /// Look at an earlier generation again (or at a later one that exists already).
    GoToGeneration(u32),
    /// How the four landscapes share the window.
    Arrange(Arrangement),
    /// The landscape that the genome panel is about; less than [`INDIVIDUALS`].
    Choose(usize),
    /// A gene is being changed or was changed.
    Gene {
        /// Whose gene.
        individual: usize,
        /// The gene's name in `space.ron`.
        name: String,
        /// In the gene's unit, already snapped to one of its codes.
        value: f64,
        /// Whether the value is final.
        phase: Phase,
    },
    /// Several genes change at once and for good: resetting a category, taking over another's.
    Genes {
        /// Whose genes.
        individual: usize,
        /// Names and snapped values.
        values: Vec<(String, f64)>,
    },
    /// A gene is kept from breeding and from its slider, or set free.
    LockGene {
        /// The gene's name in `space.ron`.
        name: String,
        /// True: kept.
        locked: bool,
    },
    /// The same for a whole category.
    LockCategory {
        /// Which one.
        category: Category,
        /// True: kept.
        locked: bool,
    },
    /// What is drawn, and how.
    Options(Options),
    /// How the program feels in the hand.
    Comfort(Comfort),
    /// Options and comfort as they were at the first start.
    ResetSettings,
    /// Show or hide a panel.
    Panel {
        /// Which one.
        panel: Panel,
        /// True: show.
        open: bool,
    },
    /// Save what the views show as a PNG file.
    Screenshot,
    /// Remember the camera's place under a number, 0 to 9.
    SetBookmark(u8),
    /// Go to a place that was remembered.
    GoToBookmark(u8),
    /// Back to the place where every walk starts.
    GoToStart,
    /// Show another world or a baked folder: what was dropped on the window.
    OpenFolder(PathBuf),
    /// Try again what failed: baking a scene, finding an adapter.
    Retry,
    /// The error of that index in [`crate::ui::model::Model::errors`] was read.
    DismissError(usize),
    /// Give the pointer to the camera (true: hidden and locked) or take it back.
    Capture(bool),
    /// End the program.
    Quit,
}

/// Whether a value is still moving under the pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// More changes follow: show it, don't bake it.
    Dragging,
    /// Final: write the file, bake.
    Committed,
}

/// What the person thinks about one category.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ballot {
    /// Not voted yet.
    #[default]
    Open,
    /// None of the four pleases.
    Nobody,
    /// This one is the best; less than [`INDIVIDUALS`].
    For(usize),
}

/// The ballots of all three categories.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ballots([Ballot; 3]);

impl Ballots {
    /// Votes that were cast in an earlier session.
    pub fn from_votes(votes: Votes) -> Self {
        let ballot = |category| match votes.get(category) {
            Some(best) if best < INDIVIDUALS => Ballot::For(best),
            _ => Ballot::Nobody,
        };
        Self(Category::ALL.map(ballot))
    }

    /// One category's ballot.
    pub fn get(&self, category: Category) -> Ballot {
        self.0[category as usize]
    }

    /// Changes one category's ballot.
    pub fn set(&mut self, category: Category, ballot: Ballot) {
        self.0[category as usize] = ballot;
    }

    /// The votes for the population's file; `None` while a category is open.
    pub fn votes(&self) -> Option<Votes> {
        let mut votes = Votes::default();
        for category in Category::ALL {
            match self.get(category) {
                Ballot::Open => return None,
                Ballot::Nobody => {}
                Ballot::For(best) => votes.set(category, Some(best)),
            }
        }
        Some(votes)
    }
}

/// How the four landscapes share the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Arrangement {
    /// Two by two.
    #[default]
    Grid,
    /// One alone.
    One(usize),
    /// Two over each other with a splitter between.
    Compare {
        /// Seen left of the splitter.
        left: usize,
        /// Seen right of it.
        right: usize,
    },
}

/// What can be shown and hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Panel {
    /// Genes of the chosen landscape.
    Genome,
    /// Frame times and counts.
    Stats,
    /// Keys.
    Help,
    /// Options and comfort.
    Settings,
}

/// Light or dark.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Theme {
    /// As the desktop says.
    #[default]
    System,
    /// Dark text on light ground.
    Light,
    /// Light text on dark ground.
    Dark,
}

/// How the program feels in the hand; kept between runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Comfort {
    /// Factor on the turn per pixel of the mouse: 0.1 to 5.
    pub mouse_sensitivity: f32,
    /// Mouse up looks down.
    pub invert_y: bool,
    /// Light or dark.
    pub theme: Theme,
    /// Factor on the desktop's own scale: 0.5 to 2.5.
    pub ui_scale: f32,
}

impl Default for Comfort {
    fn default() -> Self {
        Self { mouse_sensitivity: 1.0, invert_y: false, theme: Theme::System, ui_scale: 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn votes_are_complete_only_when_no_category_is_open_and_survive_the_file() {
        let choices = [Ballot::Open, Ballot::Nobody, Ballot::For(0), Ballot::For(3)];
        for (tree, terrain, sky) in
            (0..64).map(|code: usize| (choices[code % 4], choices[code / 4 % 4], choices[code / 16]))
        {
            let ballots = Ballots([tree, terrain, sky]);
            let open = [tree, terrain, sky].contains(&Ballot::Open);
            assert_eq!(ballots.votes().is_none(), open);
            if let Some(votes) = ballots.votes() {
                assert_eq!(Ballots::from_votes(votes), ballots);
            }
        }
    }
}
