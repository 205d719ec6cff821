//! Population files with votes → what was chosen from what, of each category.

use std::collections::BTreeSet;

use genescape_schema::{Category, Chromosome, INDIVIDUALS, Kinds, Population, Space};

use crate::kinds::Home;

/// Older votes than the last so many say little of what somebody wants now, and cost time.
const REMEMBERED: usize = 60;

/// Alternatives of a choice at most: the four, and an older favourite that was better than all of them.
pub const SLOTS: usize = 5;

/// What was to choose from, and what was chosen. Genes are 0 … 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// At most [`SLOTS`] points.
    pub points: Vec<Vec<f32>>,
    pub chosen: usize,
}

/// What is known of one category.
pub struct Evidence {
    /// In the order of generations.
    pub choices: Vec<Choice>,
    /// What was chosen, each once, the latest last.
    pub chosen: Vec<Chromosome>,
    /// The part of all that was shown that is like no kind.
    pub wild: f32,
    /// Kinds that were shown when none of the four pleased, and of which nothing was ever chosen.
    pub rejected: BTreeSet<String>,
}

impl Evidence {
    /// Of populations in the order of generations; those without votes say nothing. Where none of four pleased, an older
    /// favourite was better, if there is one.
    pub fn of(space: &Space, kinds: &Kinds, category: Category, populations: &[&Population]) -> Self {
        let mut evidence =
            Self { choices: Vec::new(), chosen: Vec::new(), wild: 0.0, rejected: BTreeSet::new() };
        let home = |one: &Chromosome| Home::of(space, kinds, category, one);
        let (mut shown, mut wild) = (0usize, 0usize);
        let voted = populations.iter().filter_map(|one| Some((one, one.votes?)));
        for (population, votes) in voted {
            let four: [&Chromosome; INDIVIDUALS] =
                population.individuals.each_ref().map(|one| one.genome.chromosome(category));
            shown += INDIVIDUALS;
            let homes = four.map(home);
            wild += homes.iter().filter(|home| **home == Home::Wild).count();
            let mut points: Vec<Vec<f32>> = four.iter().map(|one| point(space, category, one)).collect();
            match votes.favourite(category) {
                Some(vote) => {
                    evidence.choices.push(Choice { points, chosen: vote });
                    evidence.chosen.retain(|one| one != four[vote]);
                    evidence.chosen.push(four[vote].clone());
                }
                None => {
                    let kinds = homes.into_iter().filter_map(Home::main);
                    evidence.rejected.extend(kinds.map(|kind| kind.id.clone()));
                    let Some(better) = evidence.chosen.last() else { continue };
                    points.push(point(space, category, better));
                    evidence.choices.push(Choice { points, chosen: INDIVIDUALS });
                }
            }
        }
        let forgotten = evidence.choices.len().saturating_sub(REMEMBERED);
        evidence.choices.drain(..forgotten);
        for kind in evidence.chosen.iter().flat_map(|one| home(one).kinds()) {
            evidence.rejected.remove(&kind.id);
        }
        evidence.wild = wild as f32 / shown.max(1) as f32;
        evidence
    }
}

/// A chromosome's genes but its seed, each 0 … 1.
pub fn point(space: &Space, category: Category, chromosome: &Chromosome) -> Vec<f32> {
    space.traits(category).map(|gene| gene.part(chromosome.code(gene))).collect()
}
