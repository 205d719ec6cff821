//! Changes of genes and locks in the population's file, and the way back through these and the votes.

use genescape_schema::Variety;

use super::Editor;
use crate::ballots::Ballots;
use crate::edit_history::{Change, Edit, Step, UndoError};
use crate::ui::Tone;

impl Editor {
    /// Changes genes of one landscape for good, except those that are locked.
    pub fn set_genes(&mut self, individual: usize, mut values: Vec<(String, f64)>) {
        let Some(population) = &self.population else { return };
        values.retain(|(name, _)| self.space.find(name).is_some_and(|gene| !population.is_locked(gene)));
        if !values.is_empty() {
            self.edit(&Edit::Genes { individual, values });
        }
    }

    /// How different the landscapes that are bred from here are to be from the best guess.
    pub fn set_variety(&mut self, variety: Variety) {
        if self.population.is_some() && self.variety() != variety {
            self.edit(&Edit::Variety(variety));
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
        match Change::make(&self.world, &self.space, self.generation, edit) {
            Ok(Some(change)) => {
                self.steps.push(Step::File(change));
                self.read_population();
            }
            Ok(None) => {}
            Err(error) => self.tell(Tone::Error, format!("Nothing is changed: {error}")),
        }
    }

    /// Takes the latest step back. One that cannot be is dropped, so that those before it can.
    pub fn undo(&mut self) {
        let Some(step) = self.steps.done.pop() else {
            return self.tell(Tone::Info, "There is nothing to undo");
        };
        match self.take_back(&step) {
            Ok(()) => self.steps.undone.push(step),
            Err(error) => self.tell(Tone::Warning, error.to_string()),
        }
    }

    fn take_back(&mut self, step: &Step) -> Result<(), UndoError> {
        match step {
            Step::Ballots { generation, before, .. } => self.show_ballots(*generation, *before),
            Step::File(change) => {
                change.undo(&self.world)?;
                self.show_change(change.generation, format!("Taken back: {}", change.name));
            }
            Step::Bred { from, ballots, change } => {
                let undone = change.as_ref().map_or(Ok(()), |change| change.undo(&self.world));
                self.show_ballots(*from, *ballots);
                self.follows = false;
                let stays = "What was bred stays, and redo shows it again";
                self.tell(Tone::Info, format!("Back to generation {from}. {stays}"));
                // Votes in a file that was changed since stay there. They are the wish for a child that is there.
                if let Err(error) = undone {
                    self.tell(Tone::Info, error.to_string());
                }
            }
        }
        Ok(())
    }

    /// Makes the step again that was taken back last. One that cannot be is dropped with all that came after it.
    pub fn redo(&mut self) {
        let Some(step) = self.steps.undone.pop() else {
            return self.tell(Tone::Info, "There is nothing to redo");
        };
        match self.make_again(step) {
            Ok(step) => self.steps.done.push(step),
            Err(error) => {
                self.steps.undone.clear();
                self.tell(Tone::Warning, error);
            }
        }
    }

    /// What was made then need not be the same: a file may say other things around a vote.
    fn make_again(&mut self, step: Step) -> Result<Step, String> {
        match &step {
            Step::Ballots { generation, after, .. } => self.show_ballots(*generation, *after),
            Step::File(change) => {
                change.redo(&self.world).map_err(|error| error.to_string())?;
                self.show_change(change.generation, format!("Made again: {}", change.name));
            }
            Step::Bred { from, ballots, .. } => {
                return self.breed_from(*from, *ballots).map_err(|error| error.to_string());
            }
        }
        Ok(step)
    }

    pub(super) fn show_ballots(&mut self, generation: u32, ballots: Ballots) {
        if generation != self.generation {
            self.visit(generation);
        }
        self.ballots = ballots;
    }

    fn show_change(&mut self, generation: u32, text: String) {
        if generation == self.generation {
            self.read_population();
        } else {
            self.visit(generation);
        }
        self.tell(Tone::Info, text);
    }

    /// What redo would make again, in a few words.
    pub fn next_redo(&self) -> Option<String> {
        self.steps.undone.last().map(Step::name)
    }

    /// What undo would take back, in a few words.
    pub fn next_undo(&self) -> Option<String> {
        self.steps.done.last().map(Step::name)
    }
}
