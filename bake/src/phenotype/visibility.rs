//! How much each gene is seen in members of each kind: a palm's leaves do not change when a gene of branches does.
//!
//! Measured on phenotypes, which takes minutes, and kept in a table.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use genescape_schema::{Bounds, Category, Genome, GenomeError, Kinds, Parameter, Scale, Space};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::Phenotype;
use crate::kinds::draw;
use crate::seed::Dice;

/// Members of a kind of which each gene is changed once.
const MEMBERS: u64 = 6;
/// The same of what is like no kind.
const STRANGERS: u64 = 24;

/// The weight of what is not seen, as a part of the mean: it may be what is cared for all the same.
const HARDLY_SEEN: f32 = 0.01;

/// Of one kind: what each gene but seeds changes, over all of its range, in units in which two landscapes of a category by
/// chance differ by 1; of genes whose values are names, what another name changes.
pub type OfGenes = BTreeMap<String, f32>;

/// What stands for a kind's name where something is like none.
const WILD: &str = "*";

/// A point of a category, and the kind that it is like most.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    pub at: &'a [f32],
    pub kind: Option<&'a str>,
}

/// How much genes are seen. Written and read as JSON.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Visibility {
    /// By category and the kind's name in files.
    of: BTreeMap<String, BTreeMap<String, OfGenes>>,
}

impl Visibility {
    /// Of the kinds that ship, as [`Self::measure`] found.
    pub fn shipped() -> &'static Self {
        static SHIPPED: LazyLock<Visibility> =
            LazyLock::new(|| serde_json::from_str(include_str!("visibility.json")).unwrap_or_default());
        &SHIPPED
    }

    /// Takes minutes.
    ///
    /// # Errors
    /// A gene that `space` does not declare.
    pub fn measure(space: &Space, kinds: &Kinds) -> Result<Self, GenomeError> {
        let of_category = |category: Category| -> Result<_, GenomeError> {
            let wild = (WILD, Bounds::whole(space, category), STRANGERS);
            let all = kinds.of(category).map(|kind| (kind.id.as_str(), kind.bounds.clone(), MEMBERS));
            let all: Vec<_> = std::iter::once(wild).chain(all).collect();
            let one = |(name, bounds, members): (&str, Bounds, u64)| -> Result<_, GenomeError> {
                Ok((name.to_owned(), of(space, &bounds, name, members)?))
            };
            let all: BTreeMap<_, _> = all.into_par_iter().map(one).collect::<Result<_, _>>()?;
            Ok((category.name().to_owned(), all))
        };
        Ok(Self { of: Category::ALL.into_iter().map(of_category).collect::<Result<_, _>>()? })
    }

    /// About how different two points of a category look, genes but seeds as parts of their ranges: 1 is about what two landscapes by
    /// chance differ by. Of two kinds the one counts in which more is seen of what differs. A phenotype says it better, but takes
    /// a thousand times as long.
    pub fn distance(&self, space: &Space, category: Category, a: Seen<'_>, b: Seen<'_>) -> f32 {
        let of = |kind: Option<&str>| {
            let genes = self.of_kind(category, kind);
            let terms = space.traits(category).zip(a.at.iter().zip(b.at)).map(|(gene, (a, b))| {
                let seen = genes.and_then(|genes| genes.get(&gene.name)).copied().unwrap_or_default();
                let change = if gene.scale == Scale::Choice { f32::from(a != b) } else { a - b };
                seen * seen * change * change
            });
            terms.sum::<f32>().sqrt()
        };
        of(a.kind).max(of(b.kind))
    }

    fn of_kind(&self, category: Category, kind: Option<&str>) -> Option<&OfGenes> {
        let all = self.of.get(category.name())?;
        all.get(kind.unwrap_or(WILD)).or_else(|| all.get(WILD))
    }

    /// How much each gene but seeds would weigh for somebody who judges members of a kind by what is seen alone: logarithms,
    /// 0 on average. What is hardly seen weighs a hundredth of the mean, and what the table lacks as much as the mean.
    pub fn log_weights(&self, space: &Space, category: Category, kind: Option<&str>) -> Vec<f32> {
        let of = self.of_kind(category, kind);
        let seen = |gene: &Parameter| of.and_then(|of| of.get(&gene.name)).map(|seen| seen * seen);
        let squares: Vec<Option<f32>> = space.traits(category).map(seen).collect();
        let known = squares.iter().flatten();
        let mean = known.clone().sum::<f32>() / known.count().max(1) as f32;
        let log = |square: &Option<f32>| {
            square.map_or(0.0, |square| libm::logf((square / mean.max(1e-6)).max(HARDLY_SEEN)))
        };
        let logs: Vec<f32> = squares.iter().map(log).collect();
        let mean = logs.iter().sum::<f32>() / logs.len().max(1) as f32;
        logs.into_iter().map(|log| log - mean).collect()
    }
}

/// What genes of members within bounds change.
fn of(space: &Space, bounds: &Bounds, name: &str, members: u64) -> Result<OfGenes, GenomeError> {
    let category = bounds.category;
    let genes: Vec<_> = bounds.genes(space).filter(|(gene, _)| !gene.is_seed()).collect();
    let mut sums = vec![(0.0f32, 0.0f32); genes.len()];
    for member in 0..members {
        let mut dice = Dice::new(0u32, name, member);
        let mut genome = Genome::zero(space);
        *genome.chromosome_mut(category) = draw::member(space, bounds, &mut dice);
        let before = Phenotype::of_category(space, category, &genome)?;
        for ((gene, allowed), (seen, changed)) in genes.iter().zip(&mut sums) {
            let (was, is) = (genome.code(gene), draw::code(allowed, 1.0, &mut dice));
            if was == is {
                continue;
            }
            genome.set_code(gene, is);
            let distance = before.distance_in(&Phenotype::of_category(space, category, &genome)?, category);
            genome.set_code(gene, was);
            let change = change(gene, was, is);
            *seen += distance * distance;
            *changed += change * change;
        }
    }
    let of = |((gene, _), (seen, changed)): (&(&Parameter, _), &(f32, f32))| {
        let all = (seen / changed.max(1e-9)).sqrt();
        (gene.name.clone(), (1e3 * all).round() / 1e3)
    };
    Ok(genes.iter().zip(&sums).map(of).collect())
}

/// How far a gene goes from one code to another, as a part of its range; from one name to another it is all of it.
fn change(gene: &Parameter, was: u32, is: u32) -> f32 {
    if gene.scale == Scale::Choice { 1.0 } else { gene.part(is) - gene.part(was) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log_weight(category: Category, kind: &str, gene: &str) -> f32 {
        let space = Space::builtin();
        let place = space.traits(category).position(|one| one.name == gene).expect("a gene");
        Visibility::shipped().log_weights(&space, category, Some(kind))[place]
    }

    #[test]
    fn the_table_has_every_gene_of_every_kind() {
        let space = Space::builtin();
        let (kinds, _) = Kinds::shipped(&space);
        for category in Category::ALL {
            let all = &Visibility::shipped().of[category.name()];
            for id in kinds.of(category).map(|kind| kind.id.as_str()).chain([WILD]) {
                let lacks = space.traits(category).find(|gene| !all[id].contains_key(&gene.name));
                assert_eq!(lacks.map(|gene| &gene.name), None, "{id}: see bake bench --visibility");
            }
        }
    }

    #[test]
    fn relatives_are_as_far_apart_as_they_look() {
        let space = Space::builtin();
        let (kinds, _) = Kinds::shipped(&space);
        for category in Category::ALL {
            let all: Vec<_> = kinds.of(category).step_by(2).collect();
            let mut dice = Dice::new(7u32, "pairs", category as u64);
            let pairs = all.iter().map(|kind| {
                let mut genome = Genome::zero(&space);
                let mut member = || {
                    *genome.chromosome_mut(category) = draw::member(&space, &kind.bounds, &mut dice);
                    space
                        .category(category)
                        .filter(|gene| gene.is_seed())
                        .for_each(|gene| genome.set_code(gene, 0));
                    let at: Vec<f32> =
                        space.traits(category).map(|gene| gene.part(genome.code(gene))).collect();
                    (at, Phenotype::of_category(&space, category, &genome).expect("complete"))
                };
                let [(a, seen_a), (b, seen_b)] = [member(), member()];
                let [a, b] = [&a, &b].map(|at| Seen { at, kind: Some(&kind.id) });
                let told = Visibility::shipped().distance(&space, category, a, b);
                (told, seen_a.distance_in(&seen_b, category))
            });
            let (told, seen): (Vec<f32>, Vec<f32>) = pairs.unzip();
            let ratio = told.iter().sum::<f32>() / seen.iter().sum::<f32>();
            assert!((0.8..1.25).contains(&ratio), "{category}: {ratio}");
            let mean = |all: &[f32]| all.iter().sum::<f32>() / all.len() as f32;
            let (mean_told, mean_seen) = (mean(&told), mean(&seen));
            let sum = |f: &dyn Fn(f32, f32) -> f32| {
                told.iter().zip(&seen).map(|(a, b)| f(a - mean_told, b - mean_seen)).sum::<f32>()
            };
            let correlation = sum(&|a, b| a * b) / (sum(&|a, _| a * a) * sum(&|_, b| b * b)).sqrt();
            assert!(correlation > 0.6, "{category}: {correlation}");
        }
    }

    /// If this fails, `bake bench --visibility` makes the table anew.
    #[test]
    fn the_table_says_what_is_measured() {
        let space = Space::builtin();
        let (kinds, _) = Kinds::shipped(&space);
        for id in ["coconut_palm", "dunes", "golden_hour"] {
            let kind = kinds.iter().find(|kind| kind.id == id).expect("it ships");
            let measured = of(&space, &kind.bounds, id, MEMBERS).expect("complete");
            for (gene, told) in &Visibility::shipped().of[kind.category.name()][id] {
                let (low, high) = (0.75 * measured[gene] - 0.05, 1.33 * measured[gene] + 0.05);
                assert!((low..=high).contains(told), "{id}: {gene} is {} instead of {told}", measured[gene]);
            }
        }
    }

    #[test]
    fn what_is_not_seen_of_a_palm_weighs_less_than_of_an_oak() {
        for gene in ["segment_splits", "primary_branches", "down_angle_deg"] {
            let [palm, oak] = ["coconut_palm", "oak"].map(|kind| log_weight(Category::Tree, kind, gene));
            assert!(palm < oak - 1.0, "{gene}: {palm} and {oak}");
        }
        // A kind of somebody's own is judged as what is like none.
        let [own, wild] = ["my own", WILD].map(|kind| log_weight(Category::Tree, kind, "height_m"));
        assert_eq!(own, wild);
    }
}
