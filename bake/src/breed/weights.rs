//! How much each gene matters to somebody before any vote: more or less as much as it is seen, for people judge by that, and
//! some genes more than others for no reason that is known.

use crate::seed::Dice;

/// What two landscapes that can just be told apart differ by, root mean square over genes of range 0 … 1.
const JUST_SEEN: f32 = 0.02;
/// How unsure that is, and by how much weights of genes differ: standard deviations of logarithms.
const SCALE_SPREAD: f32 = 1.5;
const WEIGHT_SPREAD: f32 = 0.8;
/// How much what is seen of genes says of their weights, and how unsure that is: 1 for somebody who judges by nothing else,
/// 0 for somebody who would see all alike.
const SIGHT: f32 = 0.4;
const SIGHT_SPREAD: f32 = 0.4;

/// The weights of somebody: logarithms are normally distributed around what is seen.
#[derive(Clone)]
pub struct Weights<'a> {
    /// Of each gene the logarithm of a weight that is as it is seen; 0 on average.
    seen: &'a [f32],
    /// How much that says.
    sight: f32,
    /// The mean of the weights' logarithms.
    scale: f32,
}

impl<'a> Weights<'a> {
    /// Of anybody.
    pub fn new(seen: &'a [f32]) -> Self {
        Self { seen, sight: SIGHT, scale: expected_scale(seen.len()) }
    }

    /// The logarithm of a gene's weight.
    pub fn draw(&self, gene: usize, dice: &mut Dice) -> f32 {
        self.expected(gene) + WEIGHT_SPREAD * dice.normal()
    }

    /// How likely this logarithm of a gene's weight is, as a logarithm, but for a constant.
    pub fn log_density(&self, gene: usize, log: f32) -> f32 {
        normal(log, self.expected(gene), WEIGHT_SPREAD)
    }

    /// How likely the scale is, in the same way.
    pub fn scale_log_density(&self) -> f32 {
        normal(self.scale, expected_scale(self.seen.len()), SCALE_SPREAD)
    }

    /// With all weights greater by a factor, whose logarithm this is.
    pub fn shifted(&self, shift: f32) -> Self {
        Self { scale: self.scale + shift, ..self.clone() }
    }

    /// What somebody's weights say of scale and sight, each drawn given the other (S. and D. Geman, 1984).
    pub fn redraw(&mut self, logs: &[f32], dice: &mut Dice) {
        let one = 1.0 / (WEIGHT_SPREAD * WEIGHT_SPREAD);
        let pairs = || logs.iter().zip(self.seen);
        let told: f32 = pairs().map(|(log, seen)| seen * (log - self.scale)).sum();
        let squares: f32 = self.seen.iter().map(|seen| seen * seen).sum();
        let sight = posterior((SIGHT, SIGHT_SPREAD), one * told, one * squares, dice);
        let told: f32 = pairs().map(|(log, seen)| log - sight * seen).sum();
        let genes = logs.len() as f32;
        self.scale = posterior((expected_scale(logs.len()), SCALE_SPREAD), one * told, one * genes, dice);
        self.sight = sight;
    }

    fn expected(&self, gene: usize) -> f32 {
        self.scale + self.sight * self.seen[gene]
    }
}

/// The mean logarithm of weights of somebody who can just tell apart what differs by [`JUST_SEEN`].
fn expected_scale(genes: usize) -> f32 {
    -libm::logf(JUST_SEEN * JUST_SEEN * genes as f32)
}

fn normal(x: f32, mean: f32, spread: f32) -> f32 {
    -0.5 * ((x - mean) / spread) * ((x - mean) / spread)
}

/// A number of which a mean and a spread are known before, and observations with this precision, which sum to `told`.
fn posterior((mean, spread): (f32, f32), told: f32, precision: f32, dice: &mut Dice) -> f32 {
    let before = 1.0 / (spread * spread);
    let all = before + precision;
    (mean * before + told) / all + dice.normal() / all.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whether_somebody_judges_by_what_is_seen_shows_in_the_weights() {
        let seen: Vec<f32> = (0..20).map(|gene| if gene % 2 == 0 { 2.0 } else { -2.0 }).collect();
        let sight = |by: f32| {
            let mut dice = Dice::new(1u32, "sight", 0);
            let logs: Vec<f32> =
                seen.iter().map(|seen| 5.0 + by * seen + WEIGHT_SPREAD * dice.normal()).collect();
            let mut weights = Weights::new(&seen);
            let draws = (0..200).map(|_| {
                weights.redraw(&logs, &mut dice);
                weights.sight
            });
            draws.sum::<f32>() / 200.0
        };
        let [blind, seeing] = [sight(0.0), sight(1.0)];
        assert!(blind < 0.3 && seeing > 0.7, "{blind} and {seeing}");
    }
}
