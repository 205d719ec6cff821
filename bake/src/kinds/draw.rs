//! A member of a kind by chance: most genes near what is typical, none outside.

use genescape_schema::{Allowed, Bounds, Chromosome, Space};

use crate::seed::Dice;

/// How far from typical the plainest individuals may be, where the oddest may be anything that is allowed.
const PLAINEST: f32 = 0.3;

/// A chromosome within bounds. Its genes stray together, so that most members are plain and a few are odd throughout; each
/// by a triangular distribution, in codes.
pub fn member(space: &Space, bounds: &Bounds, dice: &mut Dice) -> Chromosome {
    let oddity = PLAINEST + (1.0 - PLAINEST) * dice.unit();
    let mut chromosome = Chromosome::zero(space, bounds.category);
    for (gene, allowed) in bounds.genes(space) {
        chromosome.set_code(gene, code(allowed, oddity, dice));
    }
    chromosome
}

/// One gene's code; `oddity` 0 is always typical, 1 may be at the ends.
pub fn code(allowed: &Allowed, oddity: f32, dice: &mut Dice) -> u32 {
    match allowed {
        Allowed::OneOf(codes) => dice.one(codes).copied().unwrap_or_default(),
        Allowed::Anywhere { min, max } => min + dice.below(max - min + 1),
        Allowed::Near { min, typical, max } => {
            let part = dice.around_zero() * oddity;
            let room = if part < 0.0 { typical - min } else { max - typical };
            (*typical as f32 + part * room as f32).round() as u32
        }
    }
}
