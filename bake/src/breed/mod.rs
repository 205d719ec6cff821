//! Votes → the next generation. The person says which landscape has the best trees, the best terrain, the best sky
//! (thesis, section 1), and each category is bred for itself.

mod account;
mod chances;
mod classic;
mod cross;
mod descent;
mod evidence;
mod learned;
mod likelihood;
mod locked;
mod pairing;
mod places;
mod prior;
mod spread;
mod step;
mod taste;
#[cfg(test)]
mod tests;
mod variety;
mod weights;

use genescape_schema::{Category, Kinds, Parent, Population, Space, Strategy, Votes};

pub use account::{Account, Settled};
pub use chances::likely_votes;
use learned::Learned;

/// Why there is no next generation.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "nobody has voted on generation {generation} yet: in its file, say which has the best of each, \
     as votes: Some((tree: Some(0), terrain: Some(2), sky: None)), where Some(0) is landscape 1 and None means none of them"
)]
pub struct NoVotes {
    pub generation: u32,
}

/// Parents that a person has chosen from anywhere: they are landscape 1 of a population, whose others only stand beside it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chosen {
    /// Where trees, land and sky come from, as population files say: "3.2", "fjord", "old.ron:1".
    pub names: [String; 3],
    /// The generation that all of them are of, if they are of one.
    pub parent: Option<Parent>,
}

/// Breeds from one population: what takes time is done once, for however many children.
pub struct Breeder<'a> {
    space: &'a Space,
    kinds: &'a Kinds,
    parents: &'a Population,
    chosen: Option<&'a Chosen>,
    learned: Option<Learned<'a>>,
}

impl<'a> Breeder<'a> {
    /// `past` holds all other populations that were voted on, in the order of generations.
    ///
    /// # Errors
    /// When votes on `parents` are `None`.
    pub fn new(
        space: &'a Space,
        kinds: &'a Kinds,
        strategy: Strategy,
        past: &[Population],
        parents: &'a Population,
    ) -> Result<Self, NoVotes> {
        let votes = parents.votes.ok_or(NoVotes { generation: parents.generation })?;
        let learned = match strategy {
            Strategy::Learned => Some(Learned::new(space, kinds, past, parents, votes, None)),
            Strategy::Classic => None,
        };
        Ok(Self { space, kinds, parents, chosen: None, learned })
    }

    /// Breeds from landscape 1 of `parents`, whatever their votes say: it is the best guess, and stays as it is.
    pub fn from_chosen(
        space: &'a Space,
        kinds: &'a Kinds,
        past: &[Population],
        parents: &'a Population,
        chosen: &'a Chosen,
    ) -> Self {
        let votes = Votes { tree: Some(0), terrain: Some(0), sky: Some(0) };
        let learned = Learned::new(space, kinds, past, parents, votes, Some(chosen));
        Self { space, kinds, parents, chosen: Some(chosen), learned: Some(learned) }
    }

    /// Generation `next` as four of what votes leave possible, by chance: for benchmarks. `None` where nothing is learned.
    pub fn sampled(&self, next: u32) -> Option<Population> {
        self.learned.as_ref().map(|learned| learned.sampled(next, self.seed()))
    }

    /// What votes have taught of each category; nothing where nothing is learned.
    pub fn accounts(&self) -> Vec<Account> {
        let learned = self.learned.iter();
        let of =
            |learned| Category::ALL.map(|category| Account::of(self.space, self.kinds, learned, category));
        learned.flat_map(of).collect()
    }

    pub fn space(&self) -> &Space {
        self.space
    }

    /// What chance depends on: the parents' seed.
    pub fn seed(&self) -> u64 {
        self.parents.seed
    }

    /// Generation `next`: the same genes for the same seed, generation, genes, votes and kinds. Its own seed is the
    /// parents'.
    pub fn bred(&self, next: u32, seed: u64) -> Population {
        let population = match &self.learned {
            Some(learned) => learned.bred(next, seed),
            None => classic::bred(self.space, self.kinds, &Population { seed, ..self.parents.clone() }, next),
        };
        let strategy = if self.learned.is_some() { Strategy::Learned } else { Strategy::Classic };
        let population = Population { seed: self.parents.seed, strategy, ..population };
        match self.chosen {
            Some(Chosen { names, parent }) => {
                Population { parent: *parent, bred_from: Some(names.clone()), ..population }
            }
            None => population,
        }
    }
}
