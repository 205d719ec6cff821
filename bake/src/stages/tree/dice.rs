//! A stream of random numbers for one individual tree.

use rand::Rng;
use rand_pcg::Pcg64Mcg;

use crate::seed;

/// Draws in a fixed order: the same tree on every machine.
pub(super) struct Dice(Pcg64Mcg);

impl Dice {
    /// The stream of the `index`th template of a species.
    pub fn new(tree_seed: u32, index: u32) -> Self {
        Self(seed::rng(u64::from(tree_seed), "tree", u64::from(index)))
    }

    /// A stream for the textures of a species.
    pub fn for_texture(tree_seed: u32, item: u64) -> Self {
        Self(seed::rng(u64::from(tree_seed), "tree texture", item))
    }

    /// Evenly in [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 * (1.0 / 16_777_216.0)
    }

    /// Evenly in [-1, 1).
    pub fn signed(&mut self) -> f32 {
        self.unit() * 2.0 - 1.0
    }

    /// Evenly in [from, to).
    #[cfg(test)]
    pub fn between(&mut self, from: f32, to: f32) -> f32 {
        from + (to - from) * self.unit()
    }
}
