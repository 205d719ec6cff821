//! Changes of genes and locks in the population's file, and the way back through these and the votes.

use genescape_schema::Category;

use super::Editor;
use crate::edit_history::Edit;
use crate::event::{Ballot, Ballots};
use crate::ui::Tone;

/// A step that can be taken back.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Step {
    /// A ballot was another one before.
    Ballot { category: Category, before: Ballot },
    /// A population file was changed.
    File { generation: u32 },
    /// A generation was asked for; `wrote`: votes were written into its parents' file.
    Bred { from: u32, ballots: Ballots, wrote: bool },
}

impl Editor {
    /// Changes genes of one landscape for good, except those that are locked.
    pub fn set_genes(&mut self, individual: usize, mut values: Vec<(String, f64)>) {
        let Some(population) = &self.population else { return };
        values.retain(|(name, _)| self.space.find(name).is_some_and(|gene| !population.is_locked(gene)));
        if !values.is_empty() {
            self.edit(&Edit::Genes { individual, values });
        }
    }

    /// Locks or frees a gene or, by its category's name, all genes of one: breeding leaves what is locked as it is.
    pub fn lock(&mut self, name: &str, locked: bool) {
        let Some(population) = &self.population else { return };
        let mut names = population.locked.clone();
        match locked {
            true => names.insert(name.to_owned()),
            false => names.remove(name),
        };
        self.edit(&Edit::Locked(names));
    }

    /// Writes a change into the file of the generation that is shown. Scenes alone have none, and no population either.
    fn edit(&mut self, edit: &Edit) {
        match self.history.apply(&self.world, &self.space, self.generation, edit) {
            Ok(true) => {
                self.steps.push(Step::File { generation: self.generation });
                self.read_population();
            }
            Ok(false) => {}
            Err(error) => self.tell(Tone::Error, format!("Nothing is changed: {error}")),
        }
    }

    /// Takes the latest step back.
    pub fn undo(&mut self) {
        match self.steps.pop() {
            None => self.tell(Tone::Info, "There is nothing to undo"),
            Some(Step::Ballot { category, before }) => self.ballots.set(category, before),
            Some(Step::File { generation }) => self.undo_file(generation),
            Some(Step::Bred { from, ballots, wrote }) => {
                if wrote {
                    self.undo_file(from);
                }
                self.visit(from);
                self.ballots = ballots;
                self.follows = false;
            }
        }
    }

    fn undo_file(&mut self, generation: u32) {
        match self.history.undo(&self.world, generation) {
            Ok(name) => self.tell(Tone::Info, format!("Taken back: {name}")),
            Err(error) => self.tell(Tone::Warning, error.to_string()),
        }
        if generation == self.generation {
            self.read_population();
        }
    }

    /// Makes again what was taken back last in the file of the generation that is shown.
    pub fn redo(&mut self) {
        match self.history.redo(&self.world, self.generation) {
            Ok(name) => {
                self.steps.push(Step::File { generation: self.generation });
                self.tell(Tone::Info, format!("Made again: {name}"));
                self.read_population();
            }
            Err(error) => self.tell(Tone::Info, error.to_string()),
        }
    }

    /// What redo would make again, in a few words.
    pub fn next_redo(&self) -> Option<String> {
        self.history.next_redo(self.generation).map(str::to_owned)
    }

    /// What undo would take back, in a few words.
    pub fn next_undo(&self) -> Option<String> {
        self.steps.last().map(|step| match step {
            Step::Ballot { category, .. } => format!("vote on {}", category.name()),
            Step::File { generation } => {
                self.history.next_undo(*generation).unwrap_or("change of genes").to_owned()
            }
            Step::Bred { from, .. } => format!("breeding from generation {from}"),
        })
    }
}
