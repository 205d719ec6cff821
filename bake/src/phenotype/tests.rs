use std::sync::LazyLock;

use genescape_schema::{Chromosome, Kind, Kinds, Population};

use super::*;
use crate::kinds::draw;
use crate::random;
use crate::seed::Dice;

static SPACE: LazyLock<Space> = LazyLock::new(Space::builtin);

fn kinds() -> Kinds {
    Kinds::shipped(&SPACE).0
}

fn drawn(kinds: &Kinds, seed: u64) -> Population {
    random::population(&SPACE, kinds, &[], seed, 0).expect("kinds").population
}

fn seen(genome: &Genome) -> Phenotype {
    Phenotype::of(&SPACE, genome).expect("complete")
}

/// What a member of a kind looks like, and how different two look.
struct Members<'a> {
    category: Category,
    base: &'a Genome,
}

impl Members<'_> {
    fn traits(&self, chromosome: &Chromosome) -> Phenotype {
        let mut genome = self.base.clone();
        *genome.chromosome_mut(self.category) = chromosome.clone();
        Phenotype::of_category(&SPACE, self.category, &genome).expect("complete")
    }

    fn distance(&self, a: &Phenotype, b: &Phenotype) -> f32 {
        a.distance_in(b, self.category)
    }
}

#[test]
fn what_is_the_same_looks_the_same_and_differences_go_both_ways() {
    let kinds = kinds();
    let four = drawn(&kinds, 3).individuals.map(|one| seen(&one.genome));
    for a in &four {
        assert_eq!(a.distance(a), 0.0);
        for b in &four {
            assert_eq!(a.distance(b), b.distance(a));
            assert!(a.distance(b).is_finite());
            assert!(std::ptr::eq(a, b) || a.distance(b) > 0.3, "four of different kinds");
        }
    }
}

#[test]
fn a_category_is_compared_by_its_own_genes_alone() {
    let [a, b, ..] = drawn(&kinds(), 5).individuals;
    for category in Category::ALL {
        let mut changed = a.genome.clone();
        *changed.chromosome_mut(category) = b.genome.chromosome(category).clone();
        for other in Category::ALL {
            let distance = seen(&a.genome).distance_in(&seen(&changed), other);
            assert_eq!(distance > 0.0, other == category, "{other} where {category} is another");
        }
    }
}

/// How often two members of a kind are compared, for one may be the exception.
const LITTERS: usize = 8;

/// Two members of each of some kinds, and one of them as another individual of the same genes.
#[test]
fn relatives_look_more_alike_than_strangers() {
    let kinds = kinds();
    let base = drawn(&kinds, 1).individuals[0].genome.clone();
    for category in Category::ALL {
        let members = Members { category, base: &base };
        let mut dice = Dice::new(1u32, "relatives", category as u64);
        let all: Vec<&Kind> = kinds.of(category).collect();
        let some: Vec<&Kind> = all.iter().copied().step_by(all.len().div_ceil(12)).collect();
        let mut triples = Vec::new();
        for kind in some.iter().cycle().take(LITTERS * some.len()) {
            let first = draw::member(&SPACE, &kind.bounds, &mut dice);
            let mut twin = first.clone();
            let seed = SPACE.category(category).find(|gene| gene.is_seed()).expect("a seed");
            twin.set_code(seed, (first.code(seed) + 71) % (seed.last_code() + 1));
            let second = draw::member(&SPACE, &kind.bounds, &mut dice);
            triples.push([first, twin, second].map(|one| members.traits(&one)));
        }
        let mean = |distances: Vec<f32>| distances.iter().sum::<f32>() / distances.len() as f32;
        let twins = mean(triples.iter().map(|[a, twin, _]| members.distance(a, twin)).collect());
        let kin = mean(triples.iter().map(|[a, _, b]| members.distance(a, b)).collect());
        let next = triples.iter().zip(triples.iter().cycle().skip(1));
        let strangers = mean(next.map(|([a, ..], [b, ..])| members.distance(a, b)).collect());
        // Of a land its seed decides nearly as much as its genes.
        assert!(twins < 1.1 * kin, "{category}: twins {twins}, kin {kin}");
        assert!(kin < 0.75 * strangers, "{category}: kin {kin}, strangers {strangers}");
    }
}

/// If this fails, the measured values are to be written into the tables.
#[test]
fn spreads_are_those_of_landscapes_by_chance() {
    const POPULATIONS: u64 = 40;
    let kinds = kinds();
    let all: Vec<Phenotype> = (0..POPULATIONS)
        .flat_map(|seed| drawn(&kinds, 100 + seed).individuals.map(|one| seen(&one.genome)))
        .collect();
    let mut faults = Vec::new();
    for category in Category::ALL {
        let mut sums = vec![0.0f32; table(category).len()];
        let pairs = || (1..8).flat_map(|step| all.iter().zip(all.iter().cycle().skip(4 * step + 1)));
        for (a, b) in pairs() {
            let all = a.differences(b, category);
            sums.iter_mut().zip(all).for_each(|(sum, (_, one))| *sum += one * one);
        }
        for (one, sum) in table(category).iter().zip(sums) {
            let measured = (sum / pairs().count() as f32).sqrt() * one.spread;
            if !(0.8..1.25).contains(&(measured / one.spread)) {
                faults.push(format!("{category}: {}: {measured:.3} instead of {}", one.name, one.spread));
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}
