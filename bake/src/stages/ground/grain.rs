//! Texel → noise, at next to no cost: two tiles whose sizes share no factor, so that together they repeat
//! only far beyond the field, and a hash for the finest grain.

use rayon::prelude::*;

use super::cover::Noise;
use crate::noise::{fbm2_row, hash01};
use crate::seed::noise_seed;

/// Texels a side of the fine tile: 32 cells of 8 texels, in two octaves.
const FINE: usize = 256;
/// Texels a side of the broad tile.
const BROAD: usize = 351;

/// The tiles.
pub(super) struct Grain {
    seed: u32,
    fine: Vec<f32>,
    broad: Vec<f32>,
}

impl Grain {
    /// Tiles for a map of `side_px`: the finer the map, the finer its finest grain in metres.
    pub fn new(terrain_seed: u32, side_px: u32) -> Self {
        let seed = noise_seed(terrain_seed.into(), "ground grain", side_px.into());
        Self { seed, fine: tile(seed, FINE, 32, 2), broad: tile(seed ^ 0x5555, BROAD, 9, 3) }
    }

    /// The noise of texel (i, j).
    #[inline]
    pub fn at(&self, i: usize, j: usize) -> Noise {
        Noise {
            fine: self.fine[(j % FINE) * FINE + i % FINE],
            broad: self.broad[(j % BROAD) * BROAD + i % BROAD],
            grain: hash01(self.seed, i as i32, j as i32, 3) - 0.5,
        }
    }
}

/// A fractal tile of `cells` cells a side, about [-1, 1].
fn tile(seed: u32, side: usize, cells: i32, octaves: u32) -> Vec<f32> {
    let scale = cells as f32 / side as f32;
    let xs: Vec<f32> = (0..side).map(|i| i as f32 * scale).collect();
    let mut values = vec![0.0; side * side];
    values.par_chunks_mut(side).enumerate().for_each(|(j, row)| {
        fbm2_row(seed, &xs, j as f32 * scale, octaves, 0.65, cells, row);
        row.iter_mut().for_each(|v| *v *= 1.8);
    });
    values
}
