//! Where a generation comes from: draws and breeding are repeatable, so nobody has to keep notes.

use genescape_schema::{Kinds, Population, Space};
use genescape_world::World;

use crate::audition::{self, Redrawn};
use crate::breed::{Account, Breeder};
use crate::events::Untold;
use crate::session;

/// What can be told of it: nothing where parents are no longer to be read, or a person chose them.
#[derive(Debug, Default)]
pub struct Origin {
    /// Landscapes that were drawn again because nobody would have looked at the first draw; not where only some kinds were
    /// asked for.
    pub redrawn: Vec<Redrawn>,
    /// What the votes have taught that it was bred from.
    pub taught: Vec<Account>,
}

impl Origin {
    pub fn of(space: &Space, population: &Population, world: &World) -> Self {
        let Population { seed, generation, parent, .. } = *population;
        let kinds = world.kinds(space).kinds;
        if parent.is_none() && population.bred_from.is_none() {
            let of = |kinds: &Kinds| {
                let draw = |attempt| audition::drawn(space, kinds, &[], seed, generation, attempt).population;
                audition::redrawn(space, draw, population)
            };
            return Self { redrawn: [of(&kinds), of(&Kinds::default())].concat(), taught: Vec::new() };
        }
        let of = |breeder: &Breeder<'_>| {
            let bred = |attempt| audition::bred(breeder, generation, attempt);
            Self { redrawn: audition::redrawn(space, bred, population), taught: breeder.accounts() }
        };
        by_votes(space, &kinds, population, world, of).unwrap_or_default()
    }
}

/// What the votes have taught that a generation was bred from.
pub fn taught(space: &Space, population: &Population, world: &World) -> Vec<Account> {
    let kinds = world.kinds(space).kinds;
    by_votes(space, &kinds, population, world, |breeder| breeder.accounts()).unwrap_or_default()
}

/// What `tell` tells of the breeder of a generation that was bred from votes.
fn by_votes<T>(
    space: &Space,
    kinds: &Kinds,
    population: &Population,
    world: &World,
    tell: impl FnOnce(&Breeder<'_>) -> T,
) -> Option<T> {
    let parent = population.parent.filter(|_| population.bred_from.is_none())?;
    let parents = world.population(space, parent.generation).ok()?.population;
    let parents = Population { votes: Some(parent.votes), variety: parent.variety, ..parents };
    let past = session::votes_before(world, space, Some(parent.generation), population.generation, &Untold);
    Breeder::new(space, kinds, population.strategy, &past, &parents).ok().map(|breeder| tell(&breeder))
}
