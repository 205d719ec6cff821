//! What the user interface shows of the desk.

use genescape_schema::{Category, INDIVIDUALS};

use super::{Desk, Fault, Source};
use crate::event::Ballots;
use crate::ui::model::{Baking, FileError, Genes, StageEntry, ViewState};

impl Desk {
    /// The generation on show, and all that exist.
    pub fn generations(&self) -> (u32, &[u32]) {
        (self.generation, &self.generations)
    }

    /// What was voted so far.
    pub fn ballots(&self) -> Ballots {
        self.ballots
    }

    /// How the bake gets on.
    pub fn baking(&self) -> Option<Baking> {
        self.baking.clone()
    }

    /// What became of each stage.
    pub fn bake_log(&self) -> &[StageEntry] {
        &self.bake_log
    }

    /// What is wrong.
    pub fn errors(&self) -> Vec<FileError> {
        self.faults.values().cloned().collect()
    }

    /// The world's own files are wrong: nobody can bake them. It is the first of the errors.
    pub fn is_hindered(&self) -> bool {
        let faults = [Fault::Space, Fault::Population, Fault::Folder];
        faults.iter().any(|fault| self.faults.contains_key(fault))
    }

    /// A landscape's name, if a population says it.
    pub fn name(&self, view: usize) -> Option<&str> {
        Some(self.population.as_ref()?.individuals[view].name.as_str())
    }

    /// How a view stands.
    pub fn state(&self, view: usize) -> ViewState {
        if let Some(fault) = self.faults.get(&Fault::Scene(view)) {
            let remedy = "Bake it again, or mend what the message names".to_owned();
            return ViewState::Failed { what: fault.report.clone(), remedy };
        }
        let complete = self.shown[view] == Some(self.generation);
        match (&self.baking, self.faults.get(&Fault::Bake)) {
            (_, _) if complete => ViewState::Ready,
            (Some(baking), _) => {
                let (done, stage) = &self.scene_progress[view];
                let total = if baking.total == 0 { 0 } else { (baking.total / INDIVIDUALS).max(*done) };
                ViewState::Baking { done: *done, total, stage: stage.clone() }
            }
            (None, Some(fault)) => ViewState::Failed {
                what: fault.report.clone(),
                remedy: "Try again, or run bake in a terminal to learn more".to_owned(),
            },
            (None, None) => ViewState::Baking { done: 0, total: 0, stage: String::new() },
        }
    }

    /// Whether a view waits for a scene that is there to be read.
    pub fn awaits_scenes(&self) -> bool {
        let wanted = match &self.source {
            Source::World(_) => INDIVIDUALS,
            Source::Scenes(scenes) => scenes.len().min(INDIVIDUALS),
        };
        (0..wanted).any(|view| {
            self.shown[view] != Some(self.generation) && !self.faults.contains_key(&Fault::Scene(view))
        })
    }

    /// Genes of the four landscapes; none before a population is read.
    pub fn genes(&self) -> Option<Genes> {
        let population = self.population.as_ref()?;
        let now = population.individuals.each_ref().map(|one| one.genome.clone());
        Some(Genes {
            space: self.space.clone(),
            bred: self.bred.clone().unwrap_or_else(|| now.clone()),
            now,
            locked: population.locked.clone(),
            locked_categories: Category::ALL.map(|category| population.locked.contains(category.name())),
        })
    }
}
