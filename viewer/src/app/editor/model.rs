//! What the user interface shows of the editor.

use std::collections::BTreeMap;
use std::sync::Arc;

use genescape_schema::{Category, INDIVIDUALS, Parent, Space, Variety};
use genescape_world::Source;

use super::{Editor, Fault};
use crate::ui::model::{FileError, Genes, ViewState};

impl Editor {
    /// The generation that is shown, and all that exist.
    pub fn generations(&self) -> (u32, &[u32]) {
        (self.generation, &self.generations)
    }

    /// Which genes there are.
    pub fn space(&self) -> Arc<Space> {
        self.space.clone()
    }

    /// What generations were bred from, if from any.
    pub fn parents(&self) -> &BTreeMap<u32, Parent> {
        &self.parents
    }

    /// Names of the landscapes that those on show were bred from.
    pub fn ancestors(&self) -> Option<&[String; INDIVIDUALS]> {
        self.ancestors.as_ref()
    }

    /// How different the next landscapes are to be from the best guess.
    pub fn variety(&self) -> Variety {
        self.population.as_ref().and_then(|population| population.variety).unwrap_or(Variety::USUAL)
    }

    /// How many landscapes there are, or are to come.
    pub fn count(&self) -> usize {
        match &self.source {
            Source::World(_) => INDIVIDUALS,
            Source::Scenes(scenes) => scenes.len().min(INDIVIDUALS),
        }
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

    /// What a landscape has of which parent; empty for one that was not bred.
    pub fn descent(&self, view: usize) -> &str {
        self.population.as_ref().map_or("", |population| &population.individuals[view].descent)
    }

    pub fn state(&self, view: usize) -> ViewState {
        let failed = |fault, remedy: &str| {
            let what = self.faults.get(&fault)?.report.clone();
            Some(ViewState::Failed { what, remedy: remedy.to_owned() })
        };
        let remedy = match self.world() {
            Some(_) => "Bake it again, or mend what the message names",
            None => "It is read again as soon as it changes",
        };
        if let Some(failed) = failed(Fault::Scene(view), remedy) {
            return failed;
        }
        if self.loaded[view] {
            return ViewState::Ready;
        }
        if self.asked[view] {
            return ViewState::Loading;
        }
        match self.bake.state(self.generation, view) {
            ViewState::Waiting if self.bake.baking.is_none() => {
                failed(Fault::Bake, "Try again, or run bake in a terminal to learn more")
                    .unwrap_or(ViewState::Waiting)
            }
            state => state,
        }
    }

    /// Whether a view waits for a scene that is there to be read.
    pub fn awaits_scenes(&self) -> bool {
        (0..self.count()).any(|view| !self.loaded[view] && !self.faults.contains_key(&Fault::Scene(view)))
    }

    /// Whether a landscape is being baked or read.
    pub fn is_busy(&self) -> bool {
        self.bake.baking.is_some() || self.asked.contains(&true)
    }

    /// Genes of the four landscapes; none before a population is read.
    pub fn genes(&self) -> Option<Genes> {
        let population = self.population.as_ref()?;
        let now = population.individuals.each_ref().map(|one| one.genome.clone());
        Some(Genes {
            space: self.space.clone(),
            bred: self.bred.clone().unwrap_or_else(|| now.clone()),
            now,
            taught: Arc::default(),
            locked: population.locked.clone(),
            locked_categories: Category::ALL.map(|category| population.locked.contains(category.name())),
        })
    }
}
