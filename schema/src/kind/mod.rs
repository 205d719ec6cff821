//! Kinds: what oaks, fjords or mackerel skies are like. A kind says of each gene of its category what is typical, how far
//! a member may stray, and which other kinds of landscape parts it goes with. `configs/kinds` has those that ship; people
//! add files of their own.

mod allowed;
mod bounds;
mod read;
mod set;

use std::ops::RangeInclusive;

use crate::genome::Chromosome;
use crate::parameter::Category;
use crate::space::Space;

pub use allowed::Allowed;
pub use bounds::Bounds;
pub use set::{Kinds, SHIPPED, ShippedKind};

/// A kind of trees, of land or of sky.
#[derive(Clone, Debug, PartialEq)]
pub struct Kind {
    /// The name of its file, without folder and ending: what a person types.
    pub id: String,
    pub category: Category,
    /// Whether it comes with Genescape, rather than from a person's own file.
    pub ships: bool,
    /// How a landscape's name says it: "Oaks", "on karst", "mackerel sky".
    pub name: String,
    /// Where its values come from.
    pub source: String,
    /// Groups of kinds within which two may be mixed.
    pub mixes: Vec<String>,
    /// What its members are like.
    pub bounds: Bounds,
    /// What genes of other categories must be.
    pub goes_with: Vec<Demand>,
}

/// A range of codes that a gene of another category must lie in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Demand {
    pub gene: String,
    pub category: Category,
    pub codes: RangeInclusive<u32>,
}

impl Demand {
    /// Whether a chromosome meets it; one of another category does.
    pub fn is_met(&self, space: &Space, category: Category, chromosome: &Chromosome) -> bool {
        let gene = space.find(&self.gene).filter(|gene| gene.category == category);
        gene.is_none_or(|gene| self.codes.contains(&chromosome.code(gene)))
    }
}

impl Kind {
    /// Whether genes of two kinds may be mixed one by one: they are of one category, and a group has both.
    pub fn mixes_with(&self, other: &Self) -> bool {
        self.category == other.category && self.mixes.iter().any(|group| other.mixes.contains(group))
    }

    /// Whether a chromosome of another category is what this kind goes with.
    pub fn goes_with(&self, space: &Space, category: Category, chromosome: &Chromosome) -> bool {
        self.goes_with.iter().all(|demand| demand.is_met(space, category, chromosome))
    }

    /// Whether it is meant by a word of a person: its id, or a word of its id ("oak" of `pedunculate_oak`).
    pub fn is_called(&self, word: &str) -> bool {
        let word = word.to_ascii_lowercase().replace([' ', '-'], "_");
        self.id == word || self.id.split('_').any(|part| part == word)
    }
}
