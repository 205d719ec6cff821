//! Everything that a person can ask of the program, by pointer, key, gamepad or dropped file: one closed list, of which
//! [`Command`] is the part that keys can be bound to. The application's loop hands each event to its owner.

use std::path::PathBuf;

use genescape_schema::{Category, Variety};
use serde::{Deserialize, Serialize};

use crate::ballots::Ballot;
use crate::export_choice::ExportChoice;
use crate::input::Command;
use crate::options::Options;
use crate::questionnaire::Answers;
use crate::settings::Comfort;

#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// What keys can ask for, too.
    Command(Command),
    /// The person's opinion on a category is another one.
    Vote { category: Category, ballot: Ballot },
    /// Show an earlier generation again, or a later one that exists already.
    GoToGeneration(u32),
    /// The next landscapes are to be so different from the best guess.
    Variety(Variety),
    /// Vote for all of that landscape, and breed close variations of it.
    MoreLike(usize),
    /// A landscape of a generation gets a star, or loses it.
    Star { generation: u32, landscape: usize, starred: bool },
    /// Breed with one category of that landscape as a parent, whatever was voted on it.
    BreedFrom { generation: u32, landscape: usize, category: Category },
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
    /// What exports are like from now on, all of it.
    ExportChoice(ExportChoice),
    /// What is answered of the questionnaire so far, all of it.
    Answers(Answers),
    /// Keep the answers, in a file.
    KeepAnswers,
    /// Write that landscape as files for other programs.
    Export(usize),
    /// The same, for the program over which the pointer lets go.
    DragOut(usize),
    /// Choose the folder for exports in a dialogue of the desktop.
    ChooseExportFolder,
    /// Show the files of the last export in the desktop's file manager.
    ShowExported,
    /// Put them on the clipboard.
    CopyExported,
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
    /// Landscapes as files for other programs.
    Export,
    /// All generations, and which came from which.
    Family,
    /// What a person is asked after a walk.
    Questions,
}
