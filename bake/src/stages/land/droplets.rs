//! Land → land with gullies and fans: raindrops run downhill, pick up soil where they are fast and lay it down where
//! they slow (Beyer, "Implementation of a method for hydraulic erosion", 2015). Heights in metres, positions in
//! samples.
//!
//! Drops fall one after another, each on land that those before it have changed; where they fall follows a
//! shuffled lattice, so that their count changes their density and not their pattern.

use super::LandParams;
use super::grid::Grid;
use super::thermal::settle;
use crate::noise::hash;
use crate::seed::noise_seed;

/// The longest path of a drop in steps of one sample.
const LIFE: u32 = 32;
/// Part of its direction that a drop keeps from step to step.
const INERTIA: f32 = 0.25;
/// Sediment that a drop of unit water holds per metre of descent and unit speed.
const CAPACITY: f32 = 2.2;
/// Part of the free capacity taken up per step.
const EROSION: f32 = 0.09;
/// Part of the surplus laid down per step.
const DEPOSITION: f32 = 0.12;
/// Part of the water that is left after a step.
const WETNESS: f32 = 0.965;
/// Greatest height in metres that one drop takes or gives at one step.
const MAX_M: f32 = 0.05;

/// Rains on the land; `loose` gains what is laid down.
pub(super) fn rain(land: &mut Grid, loose: &mut Grid, guard: &Grid, params: &LandParams) {
    let count = params.droplets.max(0.0) as u32;
    if count == 0 {
        return;
    }
    let seed = noise_seed(params.terrain_seed.into(), "land", 4);
    let before = land.clone();
    let mut ground = Ground { n: land.side as usize, heights: &mut land.values, guard: &guard.values };
    for k in 0..count {
        let (u, v) = start(seed, k, count);
        let last = (ground.n - 1) as f32;
        ground.run(u * last, v * last);
    }
    // The effect of one drop at one sample is noise and is smoothed away; gullies remain. Fans are smoother still.
    let cut = land.zip(&before, |after, before| (after - before).min(0.0)).smoothed();
    let laid = land.zip(&before, |after, before| (after - before).max(0.0));
    let laid = laid.smoothed().smoothed().smoothed();
    *land = before.zip(&cut, |before, cut| before + cut).zip(&laid, |height, laid| height + laid);
    settle(loose, &before, land);
}

/// Where drop `k` of `count` falls, in [0, 1)²: the drops walk the field block by block, so that memory stays warm,
/// four times over.
fn start(seed: u32, k: u32, count: u32) -> (f32, f32) {
    const BLOCKS: u32 = 32;
    let rounds = 4;
    let per_block = (count as f32 / (BLOCKS * BLOCKS * rounds) as f32).max(1e-6);
    let block = ((k as f32 / per_block) as u32) % (BLOCKS * BLOCKS);
    let h = hash(seed, k as i32, 0, 0);
    let (u, v) = ((h & 0xFFFF) as f32 / 65536.0, (h >> 16) as f32 / 65536.0);
    let size = 1.0 / BLOCKS as f32;
    (((block % BLOCKS) as f32 + u) * size, ((block / BLOCKS) as f32 + v) * size)
}

/// The land as drops see it.
struct Ground<'a> {
    n: usize,
    heights: &'a mut [f32],
    guard: &'a [f32],
}

impl Ground<'_> {
    /// Follows one drop from where it falls until it dries up or leaves.
    fn run(&mut self, mut x: f32, mut z: f32) {
        let (mut dx, mut dz, mut speed, mut water, mut load) = (0.0f32, 0.0f32, 1.0f32, 1.0f32, 0.0f32);
        let last = (self.n - 2) as f32;
        let (mut height, mut gx, mut gz) = self.surface(x.min(last), z.min(last));
        for _ in 0..LIFE {
            dx = dx * INERTIA - gx * (1.0 - INERTIA);
            dz = dz * INERTIA - gz * (1.0 - INERTIA);
            let length = (dx * dx + dz * dz).sqrt();
            if length < 1e-6 {
                break;
            }
            let (old_x, old_z) = (x, z);
            (dx, dz) = (dx / length, dz / length);
            (x, z) = (x + dx, z + dz);
            if x < 1.0 || z < 1.0 || x >= last || z >= last {
                break;
            }
            let (next, nx, nz) = self.surface(x, z);
            let rise = next - height;
            if rise > 0.0 {
                // It stands in a hollow: fill it, at most to the brim.
                let laid = load.min(rise).min(MAX_M);
                self.change(old_x, old_z, laid);
                load -= laid;
                speed = 0.3;
            } else {
                let capacity = -rise * speed * water * CAPACITY;
                let rate = if load > capacity { DEPOSITION } else { EROSION };
                let amount = ((load - capacity) * rate).clamp(-MAX_M, MAX_M).max(rise);
                self.change(old_x, old_z, amount);
                load -= amount;
                speed = (speed * speed * 0.9 - rise * 1.2).max(0.05).sqrt().min(4.0);
            }
            water *= WETNESS;
            (height, gx, gz) = (next, nx, nz);
        }
    }

    /// Bilinear height and its gradient per sample.
    #[inline]
    fn surface(&self, x: f32, z: f32) -> (f32, f32, f32) {
        let (i, j) = (x as usize, z as usize);
        let (u, v) = (x - i as f32, z - j as f32);
        let k = j * self.n + i;
        let (a, b, c, d) =
            (self.heights[k], self.heights[k + 1], self.heights[k + self.n], self.heights[k + self.n + 1]);
        let (gx, gz) = ((b - a) * (1.0 - v) + (d - c) * v, (c - a) * (1.0 - u) + (d - b) * u);
        (a + (b - a) * u + (c - a) * v + (a - b - c + d) * u * v, gx, gz)
    }

    /// Raises the four samples around a place by `amount` metres in all.
    #[inline]
    fn change(&mut self, x: f32, z: f32, amount: f32) {
        let (i, j) = (x as usize, z as usize);
        let (u, v) = (x - i as f32, z - j as f32);
        let k = j * self.n + i;
        let amount = amount * self.guard[k];
        self.heights[k] += amount * (1.0 - u) * (1.0 - v);
        self.heights[k + 1] += amount * u * (1.0 - v);
        self.heights[k + self.n] += amount * (1.0 - u) * v;
        self.heights[k + self.n + 1] += amount * u * v;
    }
}
