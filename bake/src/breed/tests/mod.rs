//! What both ways of breeding promise, and what each promises for itself.

mod classic;
mod learned;
mod variety;

use genescape_schema::{Category, INDIVIDUALS, Individual, Kinds, Population, Space, Votes};

use super::*;
use crate::kinds::Home;
use crate::kinds::testing::drawn;
use crate::seed::Dice;

/// Four landscapes of which some are voted for.
fn voted(space: &Space, kinds: &Kinds, seed: u64, generation: u32, votes: [Option<usize>; 3]) -> Population {
    let [tree, terrain, sky] = votes;
    let votes = Some(Votes { tree, terrain, sky });
    Population { votes, ..drawn(space, kinds, seed, generation) }
}

/// The same of genes that belong to no kind.
fn wild(space: &Space, seed: u64, generation: u32, votes: [Option<usize>; 3]) -> Population {
    let [tree, terrain, sky] = votes;
    let votes = Some(Votes { tree, terrain, sky });
    Population { votes, ..Population::random(space, seed, generation) }
}

fn home<'a>(space: &Space, kinds: &'a Kinds, category: Category, one: &Individual) -> Home<'a> {
    Home::of(space, kinds, category, one.genome.chromosome(category))
}

/// Votes as a person might cast them who likes now this, now that, and sometimes nothing.
fn random_votes(seed: u64, generation: u32) -> Votes {
    let mut dice = Dice::new(seed, "votes", u64::from(generation));
    let mut vote = || Some(dice.below(5) as usize).filter(|vote| *vote < INDIVIDUALS);
    Votes { tree: vote(), terrain: vote(), sky: vote() }
}

/// Chromosomes of a lineage that are in no kind and between no two that mix.
fn strays(
    strategy: Strategy,
    space: &Space,
    (kinds, bred_by): (&Kinds, &Kinds),
    seed: u64,
    generations: u32,
) -> usize {
    let mut history = vec![drawn(space, kinds, seed, 0)];
    let mut strays = 0;
    for generation in 0..generations {
        let (parents, past) = history.split_last_mut().expect("a first one");
        parents.votes = Some(random_votes(seed, generation));
        let breeder = Breeder::new(space, bred_by, strategy, past, parents).expect("votes");
        let population = breeder.bred(generation + 1, seed);
        for (one, category) in population.individuals.iter().flat_map(|one| Category::ALL.map(|c| (one, c))) {
            let genes = one.genome.chromosome(category);
            let bounds = Home::of(space, kinds, category, genes).bounds();
            strays += usize::from(!bounds.is_some_and(|bounds| bounds.contains(space, genes)));
        }
        history.push(population);
    }
    strays
}
