//! Genomes → whether somebody would want to look at the landscape, before it is baked; and populations without those that
//! nobody would: a landscape of which no good view exists is drawn again.
//!
//! What is asked is what the stage `start` asks, of sketches, so that it takes a fraction of a second. A person's own genomes
//! are never asked.

use std::fmt;

use genescape_schema::{Genome, GenomeError, Kind, Kinds, Population, Space};
use rayon::prelude::*;

use crate::breed::Breeder;
use crate::events::{Event, Listener};
use crate::random::{self, Drawn};
use crate::sketch::Sketch;
use crate::stages::start::{Appraisal, Want};

/// How often a landscape is drawn again at most; then the best of those drawn is taken.
const REDRAWS: u32 = 4;
/// The lowest score that is worth a look.
const BOUND: f32 = 0.6;

/// That a landscape was drawn again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Redrawn {
    /// Which of the four.
    pub landscape: usize,
    /// What the best view of the first one lacked most.
    pub lacked: Want,
}

impl fmt::Display for Redrawn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "landscape {} was drawn again: the first one had {}",
            self.landscape + 1,
            self.lacked.lack()
        )
    }
}

/// The score of a landscape's best view, or what that view lacks most if nobody would look at it.
///
/// # Errors
/// What it lacks.
pub fn is_worth_a_look(appraisal: &Appraisal) -> Result<f32, Want> {
    let score = appraisal.score();
    if score >= BOUND { Ok(score) } else { Err(appraisal.weakest()) }
}

/// What a genome's best view is worth; where one is worth `enough`, it may be that one.
///
/// # Errors
/// A gene that `space` does not declare.
pub fn appraise(space: &Space, genome: &Genome, enough: f32) -> Result<Appraisal, GenomeError> {
    Ok(Sketch::of(space, genome)?.any_good_look(enough))
}

/// A population of landscapes that somebody would look at, and which of them had to be drawn again for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Auditioned {
    pub population: Population,
    pub redrawn: Vec<Redrawn>,
}

/// `draw(0)`, but for those of its landscapes that nobody would look at: these come from `draw(1)` and so on.
pub fn audition(space: &Space, draw: impl Fn(u32) -> Population) -> Auditioned {
    let mut population = draw(0);
    let mut appraisals = appraise_all(space, &population);
    let mut redrawn = Vec::new();
    for attempt in 1..=REDRAWS {
        if appraisals.iter().all(|appraisal| lacking(appraisal).is_none()) {
            break;
        }
        let others = draw(attempt);
        for (landscape, one) in appraisals.iter_mut().enumerate() {
            let Some(lacked) = lacking(one) else { continue };
            let other = appraise(space, &others.individuals[landscape].genome, BOUND).ok();
            if score(&other) > score(one) {
                population.individuals[landscape] = others.individuals[landscape].clone();
                *one = other;
                if redrawn.iter().all(|one: &Redrawn| one.landscape != landscape) {
                    redrawn.push(Redrawn { landscape, lacked });
                }
            }
        }
    }
    Auditioned { population, redrawn }
}

/// Generation `next`, bred again where nobody would look at a child.
pub fn next_generation(breeder: &Breeder<'_>, next: u32) -> Auditioned {
    audition(breeder.space(), |attempt| bred(breeder, next, attempt))
}

/// Which landscapes of a population that [`audition`] took from `draw` were drawn again, and why. Drawing is
/// repeatable, so nobody has to keep notes.
pub fn redrawn(space: &Space, draw: impl Fn(u32) -> Population, population: &Population) -> Vec<Redrawn> {
    let draws: Vec<Population> = (0..=REDRAWS).map(draw).collect();
    let later = |&k: &usize| {
        let genome = &population.individuals[k].genome;
        let first = draws.iter().position(|draw| draw.individuals[k].genome == *genome);
        first.is_some_and(|attempt| attempt > 0)
    };
    let again = (0..population.individuals.len()).filter(later);
    let why = |landscape: usize| {
        let appraisal = appraise(space, &draws[0].individuals[landscape].genome, BOUND).ok();
        Some(Redrawn { landscape, lacked: lacking(&appraisal)? })
    };
    again.filter_map(why).collect()
}

fn lacking(appraisal: &Option<Appraisal>) -> Option<Want> {
    is_worth_a_look(appraisal.as_ref()?).err()
}

fn score(appraisal: &Option<Appraisal>) -> f32 {
    appraisal.as_ref().map_or(0.0, Appraisal::score)
}

/// A random population, as drawn at first or again: of these kinds or, if there are not enough of them, uniform.
pub fn drawn(
    space: &Space,
    kinds: &Kinds,
    wanted: &[&Kind],
    seed: u64,
    generation: u32,
    attempt: u32,
) -> Drawn {
    let again = seed_of(seed, attempt);
    let drawn = random::population(space, kinds, wanted, again, generation);
    let uniform = || Drawn { population: Population::random(space, again, generation), notices: Vec::new() };
    let Drawn { population, notices } = drawn.unwrap_or_else(uniform);
    Drawn { population: Population { seed, ..population }, notices }
}

/// Generation `next`, as bred at first or again.
pub fn bred(breeder: &Breeder<'_>, next: u32, attempt: u32) -> Population {
    breeder.bred(next, seed_of(breeder.seed(), attempt))
}

/// Says which landscapes were drawn again.
pub fn tell(listener: &dyn Listener, redrawn: &[Redrawn]) {
    redrawn.iter().for_each(|redrawn| listener.tell(&Event::Notice { message: redrawn.to_string() }));
}

/// The seed of a draw: the seed itself at first.
fn seed_of(seed: u64, attempt: u32) -> u64 {
    seed.wrapping_add(u64::from(attempt).wrapping_mul(0x9e37_79b9_7f4a_7c15))
}

/// `None` of a genome that cannot be baked at all, which others have to tell.
fn appraise_all(space: &Space, population: &Population) -> Vec<Option<Appraisal>> {
    population.individuals.par_iter().map(|one| appraise(space, &one.genome, BOUND).ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_landscape_without_a_view_is_drawn_again_and_it_is_told_why() {
        let space = Space::builtin();
        // No tree stands on the first of these.
        let (seed, landscape) = (0, 0);
        let draw = |attempt: u32| drawn(&space, &Kinds::default(), &[], seed, 0, attempt).population;
        let Auditioned { population, redrawn: mut told } = audition(&space, draw);
        assert!(told.iter().any(|one| one.landscape == landscape), "{told:?}");
        told.sort_by_key(|one| one.landscape);
        assert_eq!(told, redrawn(&space, draw, &population));
        let lacks =
            |population: &Population| appraise_all(&space, population).iter().filter_map(lacking).count();
        assert!(lacks(&population) < lacks(&draw(0)));
        // A population that is good as it is stays as it is, and is not said to be another.
        let starters = Population::load(&space, "starter.ron", genescape_world::STARTER_RON).expect("valid");
        let good = starters.population;
        let Auditioned { population, redrawn: told } =
            audition(&space, |attempt| if attempt == 0 { good.clone() } else { draw(attempt) });
        assert_eq!((population, told), (good.clone(), Vec::new()));
        assert_eq!(redrawn(&space, |_| good.clone(), &good), []);
    }
}
