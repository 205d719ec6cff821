//! Everything that a person can ask of the program, by pointer, key, gamepad or dropped file: one closed list, of which
//! [`Command`] is the part that keys can be bound to. The application's loop hands each event to its owner.

use std::path::PathBuf;

use genescape_schema::{Category, Votes};
use serde::{Deserialize, Serialize};

use crate::input::Command;
use crate::options::Options;
use crate::settings::Comfort;

#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// What keys can ask for, too.
    Command(Command),
    /// The person's opinion on a category is another one.
    Vote { category: Category, ballot: Ballot },
    /// Show an earlier generation again, or a later one that exists already.
    GoToGeneration(u32),
    /// The landscapes share the window in another way.
    Arrange(Arrangement),
    /// The landscape that the genome panel is about: 0 to 3.
    Choose(usize),
    /// Genes of one landscape change for good: names in `space.ron`, and values in the gene's unit, snapped to a code.
    Genes { individual: usize, values: Vec<(String, f64)> },
    /// A gene, by its name in `space.ron`, is kept from breeding and from its slider, or set free.
    LockGene { name: String, locked: bool },
    /// The same for a whole category.
    LockCategory { category: Category, locked: bool },
    /// The new options, all of them.
    Options(Options),
    /// The new comfort, all of it.
    Comfort(Comfort),
    /// Options and comfort as they were at the first start.
    ResetSettings,
    /// Show or hide a panel.
    Panel { panel: Panel, open: bool },
    /// Show another world or a baked folder: what was dropped on the window.
    OpenFolder(PathBuf),
    /// Try again what failed: baking a scene, finding an adapter.
    Retry,
    /// The error of that index in [`crate::ui::model::Model::errors`] was read.
    DismissError(usize),
    /// Give the pointer to the camera (true: hidden and locked) or take it back.
    Capture(bool),
}

impl From<Command> for Event {
    fn from(command: Command) -> Self {
        Self::Command(command)
    }
}

/// What the person thinks about one category.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ballot {
    /// Not voted yet.
    #[default]
    Open,
    /// None of the four pleases.
    NoFavourite,
    /// This one is the best: 0 to 3.
    For(usize),
}

impl Ballot {
    /// The best landscape, or `Some(None)` for none of them; `None` while this is open.
    pub fn cast(self) -> Option<Option<usize>> {
        match self {
            Self::Open => None,
            Self::NoFavourite => Some(None),
            Self::For(best) => Some(Some(best)),
        }
    }
}

/// The ballots of all three categories.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ballots([Ballot; 3]);

impl Ballots {
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
            votes.set(category, self.get(category).cast()?);
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
    Compare { left: usize, right: usize },
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn votes_are_complete_only_when_no_category_is_open_and_name_the_best_of_each() {
        let choices = [Ballot::Open, Ballot::NoFavourite, Ballot::For(0), Ballot::For(3)];
        for (tree, terrain, sky) in
            (0..64).map(|code: usize| (choices[code % 4], choices[code / 4 % 4], choices[code / 16]))
        {
            let ballots = Ballots([tree, terrain, sky]);
            let open = [tree, terrain, sky].contains(&Ballot::Open);
            assert_eq!(ballots.votes().is_none(), open);
            for (category, vote) in
                ballots.votes().into_iter().flat_map(|votes| Category::ALL.map(|c| (c, votes.get(c))))
            {
                assert_eq!(vote.map_or(Ballot::NoFavourite, Ballot::For), ballots.get(category));
            }
        }
    }
}
