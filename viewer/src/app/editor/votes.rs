//! Votes: cast, and written into the population's file.

use anyhow::Error;
use genescape_schema::{Category, Lineage, Parent, Variety};
use genescape_world::WorldError;

use super::{Editor, Task};
use crate::baker::breed_another;
use crate::ballots::{Ballot, Ballots};
use crate::edit_history::{Change, Edit, Step};
use crate::input::Command;
use crate::ui::Tone;

impl Editor {
    /// Changes the vote on one category, which is not written yet.
    pub fn vote(&mut self, category: Category, ballot: Ballot) {
        if self.world().is_none() {
            return self.tell(Tone::Info, "Scenes alone cannot be voted on: open a world");
        }
        let before = self.ballots;
        self.ballots.set(category, ballot);
        if before != self.ballots {
            self.steps.push(Step::Ballots { generation: self.generation, before, after: self.ballots });
        }
    }

    /// Writes the votes down, for the bake to breed from them.
    pub fn breed(&mut self) {
        if self.world().is_none() {
            return self.tell(Tone::Warning, "Scenes alone cannot breed: open a world to go on from here");
        }
        let is_open = |category: &Category| self.ballots.get(*category) == Ballot::Open;
        let open: Vec<&str> = Category::ALL.into_iter().filter(is_open).map(Category::name).collect();
        if !open.is_empty() {
            let open = open.join(" and ");
            let text = format!("Vote first: who has the best {open}? None of them is an answer, too.");
            return self.tell(Tone::Info, text);
        }
        match self.breed_from(self.generation, self.ballots) {
            Ok(step) => self.steps.push(step),
            Err(error) => self.tell(Tone::Error, format!("The votes are not written: {error}")),
        }
    }

    /// Breeds once more from votes that were answered: those on the generation on show or, as long as there are none, those
    /// it was bred from itself.
    pub fn breed_again(&mut self) {
        let generation = self.generation;
        let here = self.ballots.votes().map(|votes| Parent {
            generation,
            votes,
            variety: self.asked_variety(generation),
        });
        let parent = here.or_else(|| self.parents.get(&generation).copied());
        let Some(parent) = parent.filter(|_| self.world().is_some()) else {
            return self
                .tell(Tone::Info, "Vote and breed first: then this breeds once more from the same votes");
        };
        let known = self.world.child_of(&parent);
        if let (Ok(None), Some(_)) = (&known, here) {
            return self.breed();
        }
        match known.map_err(Error::from).and_then(|_| breed_another(&self.world, &self.space, &parent)) {
            Ok(_) => self.follows = true,
            Err(error) => self.tell(Tone::Error, format!("Nothing is bred: {error:#}")),
        }
    }

    /// Votes for all of one landscape, and breeds close variations of it.
    pub fn breed_more_like(&mut self, view: usize) {
        if self.world().is_none() {
            return self.tell(Tone::Warning, "Scenes alone cannot breed: open a world to go on from here");
        }
        self.set_variety(Variety::CLOSE);
        Category::ALL.into_iter().for_each(|category| self.vote(category, Ballot::For(view)));
        self.breed();
    }

    /// What a generation's file says of the variety of its children.
    fn asked_variety(&self, generation: u32) -> Option<Variety> {
        let text = self.world.population_text(generation).ok()?;
        Lineage::read("", &text).ok()?.variety
    }

    /// Shows the generation bred from another by these ballots, all of which are cast, or asks for it.
    pub(super) fn breed_from(&mut self, from: u32, ballots: Ballots) -> Result<Step, WorldError> {
        let votes = ballots.votes().unwrap_or_default();
        let variety = self.asked_variety(from);
        let child = self.world.child_of(&Parent { generation: from, votes, variety })?;
        let change = Change::make(&self.world, &self.space, from, &Edit::Votes(Some(votes)))?;
        match child {
            Some(child) => {
                self.visit(child);
                self.tasks.push(Task::BeginWalk);
                let text =
                    format!("Generation {child} was bred from these votes. Click to breed four others");
                self.tasks.push(Task::Offer(text, Command::BreedAgain.into()));
            }
            None => {
                self.show_ballots(from, ballots);
                self.follows = true;
            }
        }
        Ok(Step::Bred { from, ballots, change })
    }
}
