//! What the user interface shows of the editor.

use genescape_schema::{Category, INDIVIDUALS};
use genescape_world::Source;

use super::{Editor, Fault};
use crate::ui::model::{FileError, Genes, ViewState};

impl Editor {
    /// The generation that is shown, and all that exist.
    pub fn generations(&self) -> (u32, &[u32]) {
        (self.generation, &self.generations)
    }

    pub fn errors(&self) -> Vec<FileError> {
        self.faults.values().cloned().collect()
    }

    /// The world's own files are wrong, and so nothing can be baked. It is the first of the errors.
    pub fn is_hindered(&self) -> bool {
        let faults = [Fault::Space, Fault::Population, Fault::Folder];
        faults.iter().any(|fault| self.faults.contains_key(fault))
    }

    /// A landscape's name, if a population says it.
    pub fn name(&self, view: usize) -> Option<&str> {
        Some(self.population.as_ref()?.individuals[view].name.as_str())
    }

    pub fn state(&self, view: usize) -> ViewState {
        let failed = |fault, remedy: &str| {
            let what = self.faults.get(&fault)?.report.clone();
            Some(ViewState::Failed { what, remedy: remedy.to_owned() })
        };
        if let Some(failed) = failed(Fault::Scene(view), "Bake it again, or mend what the message names") {
            return failed;
        }
        if self.loaded[view] {
            return ViewState::Ready;
        }
        let Some(baking) = &self.bake.baking else {
            return failed(Fault::Bake, "Try again, or run bake in a terminal to learn more")
                .unwrap_or(ViewState::Baking { done: 0, total: 0, stage: String::new() });
        };
        let (done, stage) = self.bake.scenes[view].clone();
        let total = if baking.total == 0 { 0 } else { (baking.total / INDIVIDUALS).max(done) };
        ViewState::Baking { done, total, stage }
    }

    /// Whether a view waits for a scene that is there to be read.
    pub fn awaits_scenes(&self) -> bool {
        let wanted = match &self.source {
            Source::World(_) => INDIVIDUALS,
            Source::Scenes(scenes) => scenes.len().min(INDIVIDUALS),
        };
        (0..wanted).any(|view| !self.loaded[view] && !self.faults.contains_key(&Fault::Scene(view)))
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
