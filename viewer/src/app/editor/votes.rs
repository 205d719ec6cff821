//! Votes: cast, written into the population's file, and kept between runs while they are not.

use std::collections::BTreeMap;

use genescape_schema::{Category, INDIVIDUALS, Parent};

use super::Editor;
use super::edits::Step;
use crate::edit_history::Edit;
use crate::event::{Ballot, Ballots};
use crate::settings::{RunningVotes, WorldSettings};
use crate::ui::Tone;

impl Editor {
    /// Changes the vote on one category, which is not written yet.
    pub fn vote(&mut self, category: Category, ballot: Ballot) {
        let before = self.ballots.get(category);
        if before != ballot {
            self.steps.push(Step::Ballot { category, before });
            self.ballots.set(category, ballot);
        }
    }

    /// Writes the votes down, for the bake to breed from them.
    pub fn breed(&mut self) {
        let Some(votes) = self.ballots.votes() else {
            let is_open = |category: &Category| self.ballots.get(*category) == Ballot::Open;
            let open: Vec<&str> = Category::ALL.into_iter().filter(is_open).map(Category::name).collect();
            let text = format!(
                "Vote first: who has the best {}? None of them is an answer, too.",
                open.join(" and ")
            );
            return self.tell(Tone::Info, text);
        };
        if self.world().is_none() {
            return self.tell(Tone::Warning, "Baked folders cannot breed: open a world to go on from here");
        }
        let (from, ballots) = (self.generation, self.ballots);
        // The same votes were cast before: their generation is there already.
        if let Ok(Some(child)) = self.world.child_of(&Parent { generation: from, votes }) {
            self.steps.push(Step::Bred { from, ballots, wrote: false });
            return self.visit(child);
        }
        match self.history.apply(&self.world, &self.space, from, &Edit::Votes(Some(votes))) {
            Ok(wrote) => {
                self.steps.push(Step::Bred { from, ballots, wrote });
                self.follows = true;
            }
            Err(error) => self.tell(Tone::Error, format!("The votes are not written: {error}")),
        }
    }

    /// What should be kept of this world between runs, besides bookmarks.
    pub fn keep(&self, kept: &mut WorldSettings) {
        let cast =
            |category: Category| Some((category.name().to_owned(), self.ballots.get(category).cast()?));
        let cast: BTreeMap<_, _> = Category::ALL.into_iter().filter_map(cast).collect();
        let generation = self.generation;
        kept.running_votes = (!cast.is_empty()).then_some(RunningVotes { generation, cast });
    }

    /// Takes up the votes that were kept, if they are on the generation that is shown.
    pub(super) fn resume_votes(&mut self, kept: &WorldSettings) {
        let Some(votes) = kept.running_votes.as_ref().filter(|votes| votes.generation == self.generation)
        else {
            return;
        };
        self.ballots = Ballots::default();
        for category in Category::ALL {
            if let Some(best) = votes.cast.get(category.name()) {
                let best = best.filter(|best| *best < INDIVIDUALS);
                self.ballots.set(category, best.map_or(Ballot::NoFavourite, Ballot::For));
            }
        }
    }
}
