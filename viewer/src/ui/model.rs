//! What the user interface shows, as plain values: filled by the application once a frame, read by the panels. No
//! handle to a device, a file or a clock; a picture is an [`egui::TextureId`], which only names it.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use egui::TextureId;
use genescape_schema::{
    Genome, INDIVIDUALS, Individual, Parameter, Parent, Population, Space, Strategy, Variety, Votes,
};

use crate::ballots::Ballots;
use crate::event::{Arrangement, Panel};
use crate::export_choice::ExportChoice;
use crate::input::{Bindings, Command};
use crate::options::Options;
use crate::questionnaire::Answers;
use crate::scene::Facts;
use crate::settings::Comfort;

/// Everything that is on the screen.
#[derive(Clone, Debug)]
pub struct Model {
    /// Whether there is anything to look at.
    pub situation: Situation,
    /// The generation that is shown.
    pub generation: u32,
    /// All generations that exist as files, rising.
    pub generations: Vec<u32>,
    /// What is being baked, if anything.
    pub baking: Option<Baking>,
    /// The step that [`crate::input::Command::Undo`] would take back, in a few words: "vote on trees".
    pub undo: Option<String>,
    /// The step that [`crate::input::Command::Redo`] would do again.
    pub redo: Option<String>,
    /// The four landscapes.
    pub views: [ViewModel; INDIVIDUALS],
    /// What was voted so far.
    pub ballots: Ballots,
    /// How the four share the window.
    pub arrangement: Arrangement,
    /// The landscape that the genome panel is about.
    pub chosen: usize,
    /// Genes of all four; `None` until a world is read.
    pub genes: Option<Genes>,
    /// What the last bake reused, in the order of its stages.
    pub bake_log: Vec<StageEntry>,
    /// Faults of the person's files.
    pub errors: Vec<FileError>,
    /// Times and counts of the last frames.
    pub stats: Stats,
    /// What the keys do.
    pub bindings: Arc<Bindings>,
    /// How many landscapes there are: fewer than four if scenes alone are shown.
    pub count: usize,
    /// They belong to a world, where votes lead on.
    pub votable: bool,
    /// A participant of a study looks at this: nothing tells levels of detail, and nothing changes the landscapes.
    pub studied: bool,
    /// What is shown is anyone's file, alone.
    pub file: Option<FileShown>,
    /// What generations were bred from, if from any.
    pub parents: BTreeMap<u32, Parent>,
    /// Names of the landscapes that those on show were bred from.
    pub ancestors: Option<[String; INDIVIDUALS]>,
    /// How different the next landscapes are to be from the best guess.
    pub variety: Variety,
    /// All generations that can be read, rising.
    pub family: Arc<Vec<Kin>>,
    /// Landscapes with a star: generation, and 0 to 3.
    pub favourites: BTreeSet<(u32, usize)>,
    /// Small pictures of landscapes that were looked at.
    pub thumbnails: BTreeMap<(u32, usize), TextureId>,
    /// Nobody has walked or voted yet.
    pub greets: bool,
    /// What is drawn, and how.
    pub options: Options,
    /// How the program handles.
    pub comfort: Comfort,
    /// Landscapes as files for other programs.
    pub export: ExportModel,
    /// What is answered of the questionnaire so far.
    pub answers: Answers,
    /// The panels that are shown.
    pub panels: Panels,
    /// The pointer is locked into the picture: nothing reacts to it.
    pub captured: bool,
}

impl Model {
    /// A tooltip with the key that does the same: "Settings (F2)".
    pub fn with_key(&self, text: &str, command: Command) -> String {
        match self.bindings.chords(command).next() {
            Some(chord) => format!("{text} ({chord})"),
            None => text.to_owned(),
        }
    }
}

/// One generation of the family tree.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kin {
    pub generation: u32,
    /// Generations that it was bred from, in rising order, and how.
    pub bred_from: Vec<u32>,
    pub strategy: Strategy,
    pub votes: Option<Votes>,
    /// What its landscapes are called, and what they have of whom.
    pub names: [String; INDIVIDUALS],
    pub descents: [String; INDIVIDUALS],
    /// Of which parents, counted from 1, they have trees, land and sky.
    pub parents: [[Vec<usize>; 3]; INDIVIDUALS],
}

impl Kin {
    pub fn of(population: &Population) -> Self {
        let of =
            |text: fn(&Individual) -> &String| population.individuals.each_ref().map(|one| text(one).clone());
        Self {
            generation: population.generation,
            bred_from: population.parent_generations(),
            strategy: population.strategy,
            votes: population.votes,
            names: of(|one| &one.name),
            descents: of(|one| &one.descent),
            parents: population.individuals.each_ref().map(Individual::parents),
        }
    }
}

/// A file that is no landscape of ours.
#[derive(Clone, Debug, PartialEq)]
pub struct FileShown {
    /// Without its folder.
    pub name: String,
    pub facts: Facts,
    /// Along x, y and z, in the file's metres.
    pub size_m: [f32; 3],
    /// Side of a square of the grid on the ground, in the file's metres.
    pub cell_m: f32,
}

/// Whether there is anything to look at, and if not, why.
#[derive(Clone, Debug, PartialEq, Eq, strum::IntoStaticStr)]
#[strum(serialize_all = "snake_case")]
pub enum Situation {
    /// Four views, each in its own state.
    Ready,
    /// No scene exists yet and none of the views has anything to show.
    Growing,
    /// Nothing can be shown until the person does something: in a few words, what was tried and what it said, and what
    /// to do about it.
    Stuck { title: String, what: String, remedy: String },
}

/// One landscape's picture and state.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewModel {
    /// The individual's name.
    pub name: String,
    /// What it has of which parent, in a few words; empty for one that was not bred.
    pub descent: String,
    /// The last good picture, if there ever was one. It fills the view.
    pub picture: Option<TextureId>,
    /// Whether that picture is the current generation's.
    pub state: ViewState,
}

/// Whether a view shows what it should.
#[derive(Clone, Debug, PartialEq)]
pub enum ViewState {
    /// The picture is right.
    Ready,
    /// No stage of it is computed yet.
    Waiting,
    /// The scene is being baked: `done` of `total` stages are finished, and `stage` ("terrain: erosion"; may be empty) is
    /// being computed.
    Baking { done: usize, total: usize, stage: String },
    /// It is baked, and is being read.
    Loading,
    /// Baking or reading failed; the picture, if any, is the last good one. What went wrong, and what to do about it.
    Failed { what: String, remedy: String },
}

impl ViewState {
    /// Another landscape is on its way.
    pub fn is_to_come(&self) -> bool {
        matches!(self, Self::Waiting | Self::Baking { .. } | Self::Loading)
    }
}

/// Progress of the bake of a whole generation.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Baking {
    /// Which generation.
    pub generation: u32,
    /// Stages that are finished, of all four scenes.
    pub done: usize,
    /// All stages; 0 while that is not known.
    pub total: usize,
}

impl Baking {
    /// How much of it is done, 0 to 1.
    pub fn part(&self) -> f32 {
        self.done as f32 / self.total.max(1) as f32
    }
}

/// Genes of the four landscapes.
#[derive(Clone, Debug)]
pub struct Genes {
    /// Which genes exist.
    pub space: Arc<Space>,
    /// As they are now, including a change that was not baked yet.
    pub now: [Genome; INDIVIDUALS],
    /// As the generation was bred or loaded: what "reset" returns to.
    pub bred: [Genome; INDIVIDUALS],
    /// Names of genes that are kept.
    pub locked: BTreeSet<String>,
    /// What the votes that these were bred from say of a gene, by its name.
    pub taught: Arc<BTreeMap<String, String>>,
    /// Categories that are kept as a whole, as in [`genescape_schema::Category::ALL`].
    pub locked_categories: [bool; 3],
}

impl Genes {
    /// Whether a gene may not change: by itself or with its category.
    pub fn is_locked(&self, parameter: &Parameter) -> bool {
        self.locked_categories[parameter.category as usize] || self.locked.contains(&parameter.name)
    }

    /// Whether the four landscapes do not agree on a gene.
    pub fn differ(&self, parameter: &Parameter) -> bool {
        self.now.iter().any(|genome| genome.code(parameter) != self.now[0].code(parameter))
    }
}

/// What became of one stage in the last bake.
#[derive(Clone, Debug, PartialEq)]
pub struct StageEntry {
    /// Its name.
    pub stage: String,
    /// Which landscape it was for; `None` if for several.
    pub scene: Option<usize>,
    /// True: taken from the cache.
    pub reused: bool,
    /// Time that it took, in milliseconds.
    pub ms: f64,
    /// Why it was built: which input differed. Empty if reused.
    pub why: String,
}

/// A fault of a file that the person can mend.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct FileError {
    /// In a few words: "population/g0003.ron: 2 errors".
    pub title: String,
    /// The whole report, as `genescape_schema::Report` prints it.
    pub report: String,
}

/// Times and counts of the last frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stats {
    /// Durations of the last frames, oldest first, in milliseconds.
    pub frames_ms: Vec<f32>,
    /// Time on the GPU: pass by pass, for each view; empty where the adapter has no timestamps.
    pub gpu: Vec<PassTime>,
    /// Time on the CPU to record one frame of all views, in milliseconds.
    pub cpu_record_ms: f32,
    /// Triangles drawn, by view.
    pub triangles: [u64; INDIVIDUALS],
    /// Draw calls, by view.
    pub draws: [u32; INDIVIDUALS],
    /// Trees drawn at each level, finest first, all views together.
    pub trees_per_level: Vec<u32>,
    /// Name of the adapter.
    pub adapter: String,
}

impl Stats {
    /// Counts what another view draws at each level.
    pub fn add_copies(&mut self, by_level: &[u32]) {
        let levels = &mut self.trees_per_level;
        levels.resize(levels.len().max(by_level.len()), 0);
        levels.iter_mut().zip(by_level).for_each(|(all, more)| *all += more);
    }
}

/// Time of one pass on the GPU.
#[derive(Clone, Debug, PartialEq)]
pub struct PassTime {
    /// The pass.
    pub name: String,
    /// In milliseconds, by view.
    pub ms: [f32; INDIVIDUALS],
}

/// What the export card shows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ExportModel {
    pub choice: ExportChoice,
    /// Where files go while no folder is chosen.
    pub default_folder: String,
    /// Files that are written, and all, while an export is on its way.
    pub progress: Option<(usize, usize)>,
    /// What the last export has written, in words.
    pub written: Option<String>,
}

/// Which panels are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Panels {
    /// Genes of the chosen landscape.
    pub genome: bool,
    /// Frame times and counts.
    pub stats: bool,
    /// Keys.
    pub help: bool,
    /// Options and comfort.
    pub settings: bool,
    /// Landscapes as files.
    pub export: bool,
    /// The family tree.
    pub family: bool,
    /// The questionnaire.
    pub questions: bool,
}

impl Panels {
    fn one(&mut self, panel: Panel) -> &mut bool {
        match panel {
            Panel::Genome => &mut self.genome,
            Panel::Stats => &mut self.stats,
            Panel::Help => &mut self.help,
            Panel::Settings => &mut self.settings,
            Panel::Export => &mut self.export,
            Panel::Family => &mut self.family,
            Panel::Questions => &mut self.questions,
        }
    }

    /// Whether a panel is shown.
    pub fn is_open(mut self, panel: Panel) -> bool {
        *self.one(panel)
    }

    /// Shows or hides a panel. Settings, export and questions have one place.
    pub fn set(&mut self, panel: Panel, open: bool) {
        let of_one_place = [Panel::Settings, Panel::Export, Panel::Questions];
        if open && of_one_place.contains(&panel) {
            of_one_place.into_iter().for_each(|other| *self.one(other) = false);
        }
        *self.one(panel) = open;
    }
}
