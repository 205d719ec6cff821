//! Where a chromosome may be: what each of its genes is allowed. Of a kind, of what lies between two, or of as much of these
//! as the rest of the landscape leaves.

use std::ops::RangeInclusive;

use crate::genome::Chromosome;
use crate::kind::Allowed;
use crate::parameter::{Category, Parameter, Scale};
use crate::space::Space;

/// What each gene of a category is allowed, in the space's order; seeds may be anything.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bounds {
    pub category: Category,
    genes: Vec<Allowed>,
}

impl Bounds {
    /// `allowed` says what each gene but the seed may be; `None` if it does not know one.
    pub(crate) fn new(
        space: &Space,
        category: Category,
        mut allowed: impl FnMut(&Parameter) -> Option<Allowed>,
    ) -> Option<Self> {
        let of = |gene: &Parameter| match gene.is_seed() {
            true => Some(Allowed::Anywhere { min: 0, max: gene.last_code() }),
            false => allowed(gene),
        };
        let genes = space.category(category).map(of).collect::<Option<_>>()?;
        Some(Self { category, genes })
    }

    /// Every chromosome.
    pub fn whole(space: &Space, category: Category) -> Self {
        let any = |gene: &Parameter| match gene.scale {
            Scale::Choice => Allowed::OneOf((0..=gene.last_code()).collect()),
            _ => Allowed::Anywhere { min: 0, max: gene.last_code() },
        };
        Self { category, genes: space.category(category).map(any).collect() }
    }

    /// Each gene with what it is allowed.
    pub fn genes<'a>(&'a self, space: &'a Space) -> impl Iterator<Item = (&'a Parameter, &'a Allowed)> {
        space.category(self.category).zip(&self.genes)
    }

    /// What one gene is allowed; `None` for one of another category.
    pub fn gene<'a>(&'a self, space: &'a Space, name: &str) -> Option<&'a Allowed> {
        self.genes(space).find(|(gene, _)| gene.name == name).map(|(_, allowed)| allowed)
    }

    pub fn contains(&self, space: &Space, chromosome: &Chromosome) -> bool {
        self.genes(space).all(|(gene, allowed)| allowed.contains(chromosome.code(gene)))
    }

    /// How much of a chromosome is outside, from 0, all inside, to 1, every gene far away; see [`Allowed::excess`].
    pub fn excess(&self, space: &Space, chromosome: &Chromosome) -> f32 {
        self.mean(space, |gene, allowed| allowed.excess(chromosome.code(gene), gene.last_code()))
    }

    /// How unusual a chromosome is, in units of how far members stray.
    pub fn deviation(&self, space: &Space, chromosome: &Chromosome) -> f32 {
        self.mean(space, |gene, allowed| allowed.deviation(chromosome.code(gene), gene.last_code()))
    }

    fn mean(&self, space: &Space, of: impl Fn(&Parameter, &Allowed) -> f32) -> f32 {
        let traits = || self.genes(space).filter(|(gene, _)| !gene.is_seed());
        traits().map(|(gene, allowed)| of(gene, allowed)).sum::<f32>() / traits().count().max(1) as f32
    }

    /// Keeps of one gene what lies in a range of codes; `false` if that is nothing, and then all stays as it is.
    pub fn cut(&mut self, space: &Space, name: &str, codes: &RangeInclusive<u32>) -> bool {
        let Some(at) = space.category(self.category).position(|gene| gene.name == name) else { return true };
        let left = self.genes[at].cut(*codes.start(), *codes.end());
        let is_left = left.is_some();
        self.genes[at] = left.unwrap_or_else(|| self.genes[at].clone());
        is_left
    }

    /// What is in one of two or between them.
    pub fn hull(&self, other: &Self) -> Self {
        self.join(other, Allowed::hull)
    }

    /// What is between two, at a part 0 … ½ of the way from this one to the other.
    pub fn blend(&self, other: &Self, part: f32) -> Self {
        self.join(other, |a, b| a.blend(b, part))
    }

    fn join(&self, other: &Self, join: impl Fn(&Allowed, &Allowed) -> Allowed) -> Self {
        let genes = self.genes.iter().zip(&other.genes).map(|(a, b)| join(a, b)).collect();
        Self { category: self.category, genes }
    }
}
