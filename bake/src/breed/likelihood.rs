//! How likely somebody is to have chosen so who misses this much in each landscape: Luce's axiom, with slips.

use super::evidence::{Choice, SLOTS};
use crate::math::exp;

/// The chance that a vote means nothing: a slip, or a change of mind.
const LAPSE: f32 = 0.01;
/// Choices whose chances are multiplied before a logarithm is taken: more could underflow.
const TOGETHER: usize = 8;

/// Choices, by gene: a change of one gene reads one column.
pub struct Votes {
    /// Of each gene its values: of what was chosen in each choice, then of a rival in each, of the next one in each.
    pub columns: Vec<Vec<f32>>,
    /// A multiple of [`TOGETHER`], and 0 without votes: what fills up the last ones has no rivals.
    choices: usize,
    /// 0 where there is a point, infinite where there is none: what misses that much is never chosen.
    pub blanks: Vec<f32>,
}

impl Votes {
    pub fn new(genes: usize, choices: &[Choice]) -> Self {
        let slots = choices.iter().map(|choice| choice.points.len()).max().unwrap_or(1);
        let count = choices.len().next_multiple_of(TOGETHER);
        let mut blanks = vec![f32::INFINITY; slots * count];
        let mut columns = vec![vec![0.0; slots * count]; genes];
        blanks[..count].fill(0.0);
        for (number, choice) in choices.iter().enumerate() {
            let rivals = (0..choice.points.len()).filter(|slot| *slot != choice.chosen);
            for (slot, point) in std::iter::once(choice.chosen).chain(rivals).enumerate() {
                let at = slot * count + number;
                blanks[at] = 0.0;
                columns.iter_mut().zip(&choice.points[point]).for_each(|(column, x)| column[at] = *x);
            }
        }
        Self { columns, choices: count, blanks }
    }

    /// How likely the choices are, as a logarithm, where this is missed, squared. `chances` is room to reckon in.
    pub fn likelihood(&self, squares: &[f32], chances: &mut Chances) -> f32 {
        if self.choices == 0 {
            return 0.0;
        }
        let (chosen, rivals) = squares.split_at(self.choices);
        let Chances { least, sums } = chances;
        least.clear();
        least.extend(chosen.iter().map(|square| root(*square)));
        sums.clear();
        sums.resize(self.choices, 1.0);
        for rivals in rivals.chunks_exact(self.choices) {
            for ((sum, least), square) in sums.iter_mut().zip(least.iter()).zip(rivals) {
                *sum += exp(least - root(*square));
            }
        }
        sums.iter_mut().for_each(|sum| *sum = (1.0 - LAPSE) / *sum + LAPSE / SLOTS as f32);
        sums.chunks_exact(TOGETHER).map(|some| libm::logf(some.iter().product())).sum()
    }
}

/// Of each choice, what is missed in what was chosen, and the sum of what speaks for each alternative.
#[derive(Default)]
pub struct Chances {
    least: Vec<f32>,
    sums: Vec<f32>,
}

/// Differences of running sums may end below 0.
fn root(square: f32) -> f32 {
    if square > 0.0 { square.sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Choices among two to five points of one gene.
    fn choices() -> impl Strategy<Value = Vec<Choice>> {
        let points = prop::collection::vec(prop::collection::vec(0.0..1.0f32, 1), 2..=SLOTS);
        let one = (points, any::<prop::sample::Index>());
        let one = one.prop_map(|(points, chosen)| Choice { chosen: chosen.index(points.len()), points });
        prop::collection::vec(one, 0..20)
    }

    proptest! {
        #[test]
        fn it_is_the_product_of_what_each_choice_is_likely(choices in choices(), weight in 0.1..400.0f32) {
            let votes = Votes::new(1, &choices);
            let squares: Vec<f32> =
                votes.blanks.iter().zip(&votes.columns[0]).map(|(blank, x)| blank + weight * x * x).collect();
            let one = |choice: &Choice| {
                let speaks = |point: &Vec<f32>| libm::exp(-f64::from(weight.sqrt() * point[0]));
                let all: f64 = choice.points.iter().map(speaks).sum();
                let chance = speaks(&choice.points[choice.chosen]) / all;
                libm::log((1.0 - f64::from(LAPSE)) * chance + f64::from(LAPSE) / SLOTS as f64)
            };
            let expected: f64 = choices.iter().map(one).sum();
            let told = f64::from(votes.likelihood(&squares, &mut Chances::default()));
            // What fills up eight is as unlikely as no slip is, and always the same.
            let filled = (votes.choices - choices.len()) as f64;
            let filled = filled * libm::log(1.0 - f64::from(LAPSE) + f64::from(LAPSE) / SLOTS as f64);
            prop_assert!((told - filled - expected).abs() < 1e-3 * (1.0 + expected.abs()), "{told}, {expected}");
        }
    }
}
