//! Four landscapes, the votes cast on them, and the file types that hold genes.

use std::collections::BTreeSet;

use crate::genome::{Chromosome, Genome};
use crate::parameter::{Category, Parameter};
use crate::space::Space;
use crate::strategy::Strategy;
use crate::variety::Variety;

/// Landscapes in a population: what the four panes of the viewer show.
pub const INDIVIDUALS: usize = 4;

/// One landscape.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Individual {
    /// For people: what kind of place it is, or what a person calls it.
    pub name: String,
    /// For people: what it has of which parent, as "trees of 2 · land like 3 · new sky"; empty for one that was not bred.
    pub descent: String,
    /// Its genes.
    pub genome: Genome,
}

impl Individual {
    /// Between the parts of a descent.
    pub const SEPARATOR: &str = " · ";

    /// Of which of the four parents, counted from 1, it has trees, land and sky, as far as its descent says so.
    pub fn parents(&self) -> [Vec<usize>; 3] {
        let of = |part: &str| {
            let words = part.split([' ', ',']).filter_map(|word| word.parse().ok());
            words.filter(|parent| (1..=INDIVIDUALS).contains(parent)).collect()
        };
        let mut parts = self.descent.split(Self::SEPARATOR).map(of);
        std::array::from_fn(|_| parts.next().unwrap_or_default())
    }
}

/// The best individual (0 … 3) of each category; `None` where none of them pleased.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Votes {
    /// Who has the best trees.
    pub tree: Option<usize>,
    /// Who has the best land.
    pub terrain: Option<usize>,
    /// Who has the best sky.
    pub sky: Option<usize>,
}

impl Votes {
    /// The vote on one category.
    pub fn get(&self, category: Category) -> Option<usize> {
        [self.tree, self.terrain, self.sky][category as usize]
    }

    /// Who has the best of one category. A vote for an individual that is not there (the loader lets none pass)
    /// counts as none.
    pub fn favourite(&self, category: Category) -> Option<usize> {
        self.get(category).filter(|vote| *vote < INDIVIDUALS)
    }

    /// Changes the vote on one category.
    pub fn set(&mut self, category: Category, vote: Option<usize>) {
        *[&mut self.tree, &mut self.terrain, &mut self.sky][category as usize] = vote;
    }
}

/// What a population was bred from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parent {
    pub generation: u32,
    /// The votes on it at that time. They may be changed later; then another child is wanted.
    pub votes: Votes,
    /// How different the children were to be; `None` where nobody said.
    pub variety: Option<Variety>,
}

impl Parent {
    /// Whether a generation that was bred from `child` is what is wanted here: where nobody says how different the
    /// children are to be, any are.
    pub fn is_answered_by(&self, child: &Self) -> bool {
        let is_as_varied = self.variety.is_none() || self.variety == child.variety;
        (self.generation, self.votes) == (child.generation, child.votes) && is_as_varied
    }
}

/// One generation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Population {
    /// 0 is the first.
    pub generation: u32,
    /// What chance depends on when the next generation is bred.
    pub seed: u64,
    /// What it was bred from; `None` for one that was made otherwise.
    pub parent: Option<Parent>,
    /// How it was found; of one that was not bred the default.
    pub strategy: Strategy,
    /// Where a person chose parents from anywhere, those of trees, land and sky: "3.2" of a generation, "fjord", a kind, or
    /// "old.ron:1". If all are of one generation, `parent` says so as well.
    pub bred_from: Option<[String; 3]>,
    /// Four landscapes.
    pub individuals: [Individual; INDIVIDUALS],
    /// `None` until they are cast.
    pub votes: Option<Votes>,
    /// How different the next landscapes are to be from the best guess; `None` is as usual.
    pub variety: Option<Variety>,
    /// Names of genes and of whole categories that breeding leaves as they are: every child has those of the
    /// favourite or, where there is no favourite, of the individual in its place.
    pub locked: BTreeSet<String>,
}

impl Population {
    /// Four landscapes by chance: every code of every gene equally likely; the same for the same arguments.
    pub fn random(space: &Space, seed: u64, generation: u32) -> Self {
        let mut state = seed ^ (u64::from(generation) << 32 | u64::from(generation));
        let individuals = std::array::from_fn(|index| {
            let mut genome = Genome::zero(space);
            for parameter in space.parameters() {
                genome.set_code(parameter, (split_mix(&mut state) >> (64 - parameter.bits)) as u32);
            }
            Individual { name: format!("Random {seed}.{}", index + 1), descent: String::new(), genome }
        });
        Self::new(generation, seed, individuals)
    }

    /// Four landscapes that nobody has voted on, and that come from none.
    pub fn new(generation: u32, seed: u64, individuals: [Individual; INDIVIDUALS]) -> Self {
        let (parent, bred_from, votes, variety, locked) = (None, None, None, None, BTreeSet::new());
        let strategy = Strategy::default();
        Self { generation, seed, parent, strategy, bred_from, individuals, votes, variety, locked }
    }

    /// Generations that it was bred from and that its file names, in rising order: that of the votes, or of parents that a
    /// person chose.
    pub fn parent_generations(&self) -> Vec<u32> {
        if let Some(parent) = self.parent {
            return vec![parent.generation];
        }
        let named = self.bred_from.iter().flatten().filter_map(|name| landscape_named(name));
        let generations: BTreeSet<u32> = named.map(|(generation, _)| generation).collect();
        generations.into_iter().collect()
    }

    /// Whether breeding leaves a gene as it is: by itself or with its category.
    pub fn is_locked(&self, gene: &Parameter) -> bool {
        self.locked.contains(&gene.name) || self.locked.contains(gene.category.name())
    }
}

/// "3.2" → generation 3 and its landscape 2, which counts from 1; `None` of what is called otherwise.
pub fn landscape_named(name: &str) -> Option<(u32, usize)> {
    let (generation, landscape) = name.split_once('.')?;
    let landscape = landscape.parse().ok().filter(|landscape| (1..=INDIVIDUALS).contains(landscape))?;
    Some((generation.parse().ok()?, landscape))
}

/// SplitMix64 (Steele, Lea and Flood 2014).
fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (*state ^ *state >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ z >> 31
}

/// A kind of tree to start from (`configs/presets/*.ron`).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TreePreset {
    /// For people.
    pub name: String,
    /// The genes of category tree.
    pub tree: Chromosome,
}

/// A population as read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Loaded {
    pub population: Population,
    /// For people, with file, line and column: values that are not used exactly as they were written, and genes that
    /// the file lacks, with the defaults used instead.
    pub notices: Vec<String>,
}

/// A tree preset as read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoadedPreset {
    pub preset: TreePreset,
    /// As those of [`Loaded`].
    pub notices: Vec<String>,
}
