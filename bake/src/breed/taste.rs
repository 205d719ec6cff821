//! Votes → what a person wants of one category: where the ideal lies, and how much each gene matters.
//!
//! The model is that of ideal points (Coombs, "Psychological scaling without a unit of measurement", 1950), chosen from by
//! Luce's axiom (Luce, "Individual Choice Behavior", 1959): who wants t and weighs gene i by a_i misses
//! √(Σ a_i (x_i − t_i)²) in x, and chooses x of several with a probability that falls as e to the power of what is missed.
//! The scale of a says how sure choices are. Nothing is fitted: samples of t and a are drawn from what the votes leave
//! possible, by Markov chains (Metropolis and others 1953) that change one gene at a time, so that what nobody has
//! shown to matter stays open.

use rayon::prelude::*;

use super::evidence::Choice;
use super::likelihood::{Chances, Votes};
use super::prior::Prior;
use super::weights::Weights;
use crate::seed::Dice;

/// The squared difference of two values of a gene whose values are names.
const OTHER_CHOICE: f32 = 0.15;

/// Chains, sweeps over all genes of each, and samples that each gives, from its last two thirds.
const CHAINS: usize = 4;
const SWEEPS: usize = 300;
const SAMPLES: usize = 25;
/// Starts that a chain chooses from, and jumps to another kind that it tries in a sweep; where there is but one, it soon
/// stays.
const STARTS: usize = 48;
const JUMPS: usize = 4;

/// What a person may want: one sample of it.
#[derive(Clone, Debug)]
pub struct Ideal {
    pub at: Vec<f32>,
    pub weights: Vec<f32>,
    /// Which of the prior's components it belongs to.
    pub component: usize,
}

impl Ideal {
    /// What somebody who wants this misses in a point, in units in which choices between 0 and 1 are 1 to e.
    pub fn missed(&self, prior: &Prior<'_>, point: &[f32]) -> f32 {
        let terms = point.iter().zip(&self.at).zip(&self.weights).enumerate();
        terms.map(|(gene, ((x, t), a))| a * squared(prior.is_choice(gene), *x, *t)).sum::<f32>().sqrt()
    }

    /// What is missed where every gene differs by all of its range.
    pub fn unit(&self) -> f32 {
        self.weights.iter().sum::<f32>().sqrt()
    }
}

fn squared(is_choice: bool, x: f32, t: f32) -> f32 {
    match is_choice {
        // Choices are equal to the bit or are not: both come from codes.
        true if (x - t).abs() < 1e-3 => 0.0,
        true => OTHER_CHOICE,
        false => (x - t) * (x - t),
    }
}

/// Samples of what a person wants who chose so: the same for the same choices. `seen` says how much each gene is seen.
pub fn ideals(prior: &Prior<'_>, choices: &[Choice], seen: &[f32]) -> Vec<Ideal> {
    let genes = prior.genes();
    let votes = Votes::new(genes, choices);
    let chains = (0..CHAINS).into_par_iter().map(|chain| {
        let dice = Dice::new(0u32, "taste", chain as u64);
        Chain::start(prior, &votes, Weights::new(seen), dice).run()
    });
    chains.collect::<Vec<_>>().concat()
}

/// One Markov chain.
struct Chain<'a> {
    prior: &'a Prior<'a>,
    votes: &'a Votes,
    dice: Dice,
    ideal: Ideal,
    /// What is missed in each point, squared.
    squares: Vec<f32>,
    likelihood: f32,
    /// What weights are before any vote.
    weights: Weights<'a>,
    scratch: Vec<f32>,
    chances: Chances,
}

impl<'a> Chain<'a> {
    /// Begins at the likeliest of some that the prior gives.
    fn start(prior: &'a Prior<'a>, votes: &'a Votes, weights: Weights<'a>, mut dice: Dice) -> Self {
        let genes = prior.genes();
        let mut chances = Chances::default();
        let best = (0..STARTS).map(|_| {
            let component = prior.any(&mut dice);
            let at = (0..genes).map(|gene| prior.draw(component, gene, &mut dice)).collect();
            let weights = (0..genes).map(|gene| libm::expf(weights.draw(gene, &mut dice))).collect();
            let ideal = Ideal { at, weights, component };
            let squares = all_squares(prior, votes, &ideal);
            (votes.likelihood(&squares, &mut chances), squares, ideal)
        });
        let best = best.reduce(|best, one| if one.0 > best.0 { one } else { best });
        let (likelihood, squares, ideal) = best.unwrap_or_else(|| unreachable!("there are starts"));
        let scratch = vec![0.0; squares.len()];
        Self { prior, votes, dice, ideal, squares, likelihood, weights, scratch, chances }
    }

    fn run(mut self) -> Vec<Ideal> {
        const EVERY: usize = SWEEPS * 2 / 3 / SAMPLES;
        let mut samples = Vec::with_capacity(SAMPLES);
        for left in (0..SWEEPS).rev() {
            self.sweep();
            if left % EVERY == 0 && left / EVERY < SAMPLES {
                samples.push(self.ideal.clone());
            }
        }
        samples
    }

    fn sweep(&mut self) {
        // Running sums drift.
        self.squares = all_squares(self.prior, self.votes, &self.ideal);
        self.likelihood = self.votes.likelihood(&self.squares, &mut self.chances);
        let jumps = if self.prior.is_one() { 1 } else { JUMPS };
        for _ in 0..jumps {
            self.jump();
        }
        for gene in 0..self.prior.genes() {
            self.move_ideal(gene);
            self.move_weight(gene);
        }
        self.ideal.component = self.prior.component_of(&self.ideal.at, &mut self.dice);
        self.rescale();
    }

    /// To another kind, with some of its members' genes.
    fn jump(&mut self) {
        let component = self.prior.any(&mut self.dice);
        let mut other = Ideal { component, ..self.ideal.clone() };
        for gene in 0..self.prior.genes() {
            other.at[gene] = self.prior.draw(component, gene, &mut self.dice);
        }
        let squares = all_squares(self.prior, self.votes, &other);
        let likelihood = self.votes.likelihood(&squares, &mut self.chances);
        if self.accepts(likelihood - self.likelihood) {
            (self.ideal, self.squares, self.likelihood) = (other, squares, likelihood);
        }
    }

    fn move_ideal(&mut self, gene: usize) {
        const STEP: f32 = 0.2;
        let (component, from, weight) = (self.ideal.component, self.ideal.at[gene], self.ideal.weights[gene]);
        let is_drawn = self.prior.is_choice(gene) || self.dice.chance(0.4);
        let (to, prior) = if is_drawn {
            (self.prior.draw(component, gene, &mut self.dice), 0.0)
        } else {
            let to = reflected(from + STEP * self.dice.normal());
            let density = |at| self.prior.log_density(component, gene, at);
            (to, density(to) - density(from))
        };
        self.change(gene, to, weight, prior);
    }

    fn move_weight(&mut self, gene: usize) {
        const STEP: f32 = 0.9;
        let (at, from) = (self.ideal.at[gene], libm::logf(self.ideal.weights[gene]));
        let to = from + STEP * self.dice.normal();
        let density = |log: f32| self.weights.log_density(gene, log);
        self.change(gene, at, libm::expf(to), density(to) - density(from));
    }

    /// Metropolis' step for one gene; `prior` is the logarithm of how much likelier it is before any vote.
    fn change(&mut self, gene: usize, at: f32, weight: f32, prior: f32) {
        let (old_at, old_weight) = (self.ideal.at[gene], self.ideal.weights[gene]);
        let is_choice = self.prior.is_choice(gene);
        let column = &self.votes.columns[gene];
        let all = self.scratch.iter_mut().zip(&self.squares).zip(column);
        // Told apart here, each is a loop of vectors.
        match is_choice {
            true => all.for_each(|((new, old), x)| {
                *new = old + weight * squared(true, *x, at) - old_weight * squared(true, *x, old_at);
            }),
            false => all.for_each(|((new, old), x)| {
                *new = old + weight * squared(false, *x, at) - old_weight * squared(false, *x, old_at);
            }),
        }
        let likelihood = self.votes.likelihood(&self.scratch, &mut self.chances);
        if self.accepts(likelihood - self.likelihood + prior) {
            std::mem::swap(&mut self.squares, &mut self.scratch);
            self.likelihood = likelihood;
            (self.ideal.at[gene], self.ideal.weights[gene]) = (at, weight);
        }
    }

    /// What is so of all weights: first given these weights, then their scale together with them.
    fn rescale(&mut self) {
        let logs: Vec<f32> = self.ideal.weights.iter().map(|weight| libm::logf(*weight)).collect();
        self.weights.redraw(&logs, &mut self.dice);
        let shift = 0.3 * self.dice.normal();
        let factor = libm::expf(shift);
        self.scratch.iter_mut().zip(&self.squares).for_each(|(new, old)| *new = old * factor);
        let likelihood = self.votes.likelihood(&self.scratch, &mut self.chances);
        let shifted = self.weights.shifted(shift);
        let prior = shifted.scale_log_density() - self.weights.scale_log_density();
        if self.accepts(likelihood - self.likelihood + prior) {
            std::mem::swap(&mut self.squares, &mut self.scratch);
            self.likelihood = likelihood;
            self.weights = shifted;
            self.ideal.weights.iter_mut().for_each(|weight| *weight *= factor);
        }
    }

    fn accepts(&mut self, log_ratio: f32) -> bool {
        libm::logf(self.dice.unit().max(1e-9)) < log_ratio
    }
}

fn all_squares(prior: &Prior<'_>, votes: &Votes, ideal: &Ideal) -> Vec<f32> {
    let mut squares = votes.blanks.clone();
    for (gene, column) in votes.columns.iter().enumerate() {
        let (is_choice, at, weight) = (prior.is_choice(gene), ideal.at[gene], ideal.weights[gene]);
        squares.iter_mut().zip(column).for_each(|(sum, x)| *sum += weight * squared(is_choice, *x, at));
    }
    squares
}

/// Back into 0 … 1 from beyond its ends.
fn reflected(x: f32) -> f32 {
    let x = if x < 0.0 { -x } else { x };
    let x = if x > 1.0 { 2.0 - x } else { x };
    x.clamp(0.0, 1.0)
}
