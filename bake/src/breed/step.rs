//! Mutation: some genes of a chromosome move a step along what they are allowed.

use genescape_schema::{Allowed, Bounds, Chromosome, Parameter, Space};

use crate::kinds::{Home, draw};
use crate::seed::Dice;

/// How much changes at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Chance that a gene changes; one always does.
    pub chance: f32,
    /// The longest step, as a part of what the gene is allowed.
    pub reach: f32,
}

impl Pace {
    /// Within a kind, whose members are all what was liked: steps that one can see.
    const KIN: Self = Self { chance: 0.5, reach: 0.5 };
    /// Where any value is allowed and most are not liked.
    const GENTLE: Self = Self { chance: 0.15, reach: 0.125 };
    /// For what is new and of no kind.
    pub const STRONG: Self = Self { chance: 0.3, reach: 0.125 };

    pub fn of(home: Home<'_>) -> Self {
        if home == Home::Wild { Self::GENTLE } else { Self::KIN }
    }
}

/// Chance that a changed gene gets any allowed value instead of one nearby, and that a choice changes.
const LEAP: f32 = 0.12;

/// A chromosome with some genes changed. Seeds never are: they say which individual it is, and it is still the same
/// one. Nor is what a person set to a value that is not allowed: it is meant.
pub fn stepped(space: &Space, from: &Chromosome, bounds: &Bounds, pace: Pace, dice: &mut Dice) -> Chromosome {
    let may_change = |(gene, allowed): &(&Parameter, &Allowed)| {
        !gene.is_seed() && !allowed.is_fixed() && allowed.contains(from.code(gene))
    };
    let genes: Vec<_> = bounds.genes(space).filter(may_change).collect();
    let mut child = from.clone();
    let certain = dice.below(genes.len() as u32) as usize;
    for (index, (gene, allowed)) in genes.into_iter().enumerate() {
        if dice.chance(pace.chance) || index == certain {
            child.set_code(gene, changed(from.code(gene), allowed, pace.reach, dice));
        }
    }
    child
}

/// Another allowed code, mostly a near one.
fn changed(code: u32, allowed: &Allowed, reach: f32, dice: &mut Dice) -> u32 {
    let (min, max) = allowed.ends();
    match allowed {
        Allowed::OneOf(_) if !dice.chance(LEAP) => code,
        Allowed::OneOf(codes) => *dice.one(codes).unwrap_or(&code),
        _ if dice.chance(LEAP) => draw::code(allowed, 1.0, dice),
        _ => near(code, min, max, reach, dice),
    }
}

/// A step up or down, short ones likelier, turned back at the ends.
fn near(code: u32, min: u32, max: u32, reach: f32, dice: &mut Dice) -> u32 {
    let longest = (((max - min) as f32 * reach) as u32).max(1);
    let step = 1 + dice.below(longest).min(dice.below(longest));
    let up = dice.chance(0.5) && code + step <= max || code < min + step;
    if up { (code + step).min(max) } else { code - step }
}
