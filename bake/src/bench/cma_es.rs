//! What CMA-ES (Hansen and Ostermeier, "Completely Derandomized Self-Adaptation in Evolution Strategies", 2001) comes to with
//! four candidates a round. It is told more than a vote tells: how far each of the four is, as unsurely as the person chooses.

use anyhow::{Result, anyhow};
use cmaes::{CMAESOptions, DVector};
use genescape_schema::{Category, INDIVIDUALS, Space};

use super::person::Person;
use crate::seed::Dice;

/// Standard deviation of the first candidates: most of 0 … 1.
const FIRST_STEP: f64 = 0.3;

/// How far the best of the four is after each round, a mean over categories; the first four are round 0.
pub fn distances(
    space: &Space,
    person: &Person<'_>,
    temperature: f32,
    seed: u64,
    rounds: u32,
) -> Result<Vec<f32>> {
    let mut sums = vec![0.0; rounds as usize + 1];
    for category in Category::ALL {
        let genes = space.traits(category).count();
        let mut dice = Dice::new(seed, "cma-es", category as u64);
        let within = |x: &DVector<f64>| -> Vec<f32> { x.iter().map(|x| x.clamp(0.0, 1.0) as f32).collect() };
        let judged = |x: &DVector<f64>| {
            // The least of several with such noise is what softmax chooses (Gumbel).
            let noise = -libm::logf(-libm::logf(dice.unit().clamp(1e-6, 1.0 - 1e-6)));
            let beyond: f64 = x.iter().map(|x| (x - x.clamp(0.0, 1.0)).abs()).sum();
            f64::from(person.distance(category, &within(x)) - temperature * noise) + beyond
        };
        let options = CMAESOptions::new(vec![0.5; genes], FIRST_STEP)
            .population_size(INDIVIDUALS)
            .tol_stagnation(usize::MAX)
            .seed(seed);
        let mut state = options.build(judged).map_err(|error| anyhow!("CMA-ES: {error:?}"))?;
        for sum in &mut sums {
            // It may say that it is done, and goes on all the same.
            let _ = state.next();
            let best = state.current_best_individual().map(|best| best.point.clone());
            *sum += best.map_or(0.0, |best| person.distance(category, &within(&best))) / 3.0;
        }
    }
    Ok(sums)
}
