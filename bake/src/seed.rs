//! Random numbers that depend on what they are for, never on when or on which thread they are drawn.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A generator for one item of one stage: the same for the same (`seed`, `stage`, `item`) on every machine.
pub fn rng(seed: u64, stage: &str, item: u64) -> Pcg64Mcg {
    let mut hasher = blake3::Hasher::new_derive_key("genescape 2026 random stream");
    hasher.update(&seed.to_le_bytes());
    hasher.update(&(stage.len() as u64).to_le_bytes());
    hasher.update(stage.as_bytes());
    hasher.update(&item.to_le_bytes());
    let mut bytes = [0; 16];
    bytes.copy_from_slice(&hasher.finalize().as_bytes()[..16]);
    Pcg64Mcg::from_seed(bytes)
}

/// A 32-bit seed for lattice noise, by the same rule.
pub fn noise_seed(seed: u64, stage: &str, item: u64) -> u32 {
    rng(seed, stage, item).next_u32()
}

/// Random numbers drawn one after another in a fixed order.
pub struct Dice(Pcg64Mcg);

impl Dice {
    /// Those of one item of one stage, see [`rng`].
    pub fn new(seed: impl Into<u64>, stage: &str, item: u64) -> Self {
        Self(rng(seed.into(), stage, item))
    }

    /// Evenly in [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 * (1.0 / 16_777_216.0)
    }

    /// Evenly in [-1, 1).
    pub fn signed(&mut self) -> f32 {
        self.unit() * 2.0 - 1.0
    }

    /// In (-1, 1), most often near 0.
    pub fn around_zero(&mut self) -> f32 {
        self.unit() + self.unit() - 1.0
    }

    /// Of a normal distribution, mean 0 and standard deviation 1 (Box and Muller 1958).
    pub fn normal(&mut self) -> f32 {
        let (radius, turn) = (1.0 - self.unit(), std::f32::consts::TAU * self.unit());
        (-2.0 * libm::logf(radius)).sqrt() * libm::cosf(turn)
    }

    /// Evenly in 0 .. `count`.
    pub fn below(&mut self, count: u32) -> u32 {
        ((u64::from(self.0.next_u32()) * u64::from(count)) >> 32) as u32
    }

    pub fn chance(&mut self, chance: f32) -> bool {
        self.unit() < chance
    }

    /// The index of one of these weights, each as likely as it is heavy; 0 if none weighs anything.
    pub fn weighted(&mut self, weights: &[f32]) -> usize {
        let mut left = self.unit() * weights.iter().sum::<f32>();
        let chosen = weights.iter().position(|weight| {
            left -= weight;
            left < 0.0
        });
        chosen.unwrap_or(0)
    }

    /// One of them, all alike; `None` of nothing.
    pub fn one<'a, T>(&mut self, of: &'a [T]) -> Option<&'a T> {
        let count = u32::try_from(of.len()).unwrap_or(u32::MAX);
        of.get(self.below(count) as usize)
    }
}
