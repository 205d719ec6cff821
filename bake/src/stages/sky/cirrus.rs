//! Genes → a tiling layer of cirrus: noise drawn out along a curved wind (line integral convolution, Cabral and
//! Leedom 1993), thinned out to patches. The layer is so thin that its light is scattered once.

use glam::{Vec3A, Vec4};
use rayon::prelude::*;

use super::SkyParams;
use super::clear::ClearSky;
use super::clouds::{Marched, distance_to_height, through_air};
use super::math::{bilinear, dot, exp, henyey_greenstein};
use crate::math::{lerp, smoothstep};
use crate::noise;
use crate::raster::square;
use crate::seed::noise_seed;

/// Texels a side of the layer in images; a power of two, as for any other side.
pub const SIDE: usize = 512;
/// Height above the ground in metres.
pub const ALTITUDE_M: f32 = 9000.0;
/// Metres after which the layer repeats.
pub const TILE_M: f32 = 36_000.0;

/// Cells a side in which the wind has one direction; a divisor of every side.
const WIND: usize = 32;

/// The layer: optical depth seen vertically, at full and at an eighth of the resolution.
pub struct Cirrus {
    side: usize,
    fine: Vec<f32>,
    coarse: Vec<f32>,
    sun: Vec3A,
    sun_light: Vec3A,
    sky_light: Vec3A,
}

impl Cirrus {
    /// The layer of these genes with `side` texels a side, or `None` when there is none.
    pub fn new(params: &SkyParams, sky: &ClearSky, side: usize) -> Option<Self> {
        let amount = params.cirrus.clamp(0.0, 1.0);
        if amount < 0.01 {
            return None;
        }
        let seed = noise_seed(u64::from(params.sky_seed), "sky.cirrus", 0);
        let fine = optical_depths(seed, amount, side);
        let sky_light = sky.irradiance() * std::f32::consts::FRAC_1_PI;
        let sun_light = sky.sun_at(ALTITUDE_M * 0.001);
        Some(Self { side, coarse: blurred(&fine, side), fine, sun: sky.sun, sun_light, sky_light })
    }

    /// Optical depth at a texel, seen vertically.
    pub fn depth_at(&self, column: usize, row: usize) -> f32 {
        self.fine[row * self.side + column]
    }

    /// Light of the layer where it is dense, seen at an angle to the sun of cosine `cosine`.
    pub fn source(&self, cosine: f32) -> Vec3A {
        let phase = 0.045 + 0.55 * henyey_greenstein(0.7, cosine).min(1.2);
        self.sun_light * phase + self.sky_light * 0.35
    }

    /// Light and transparency of the layer, through the air, in a unit direction with y > 0.
    pub fn seen(&self, direction: Vec3A, sky: &ClearSky) -> Vec4 {
        let t = distance_to_height(direction.y, ALTITUDE_M);
        let texels = self.side as f32 / TILE_M;
        let (u, v) = (direction.x * t * texels, direction.z * t * texels);
        // Far away a pixel covers many texels.
        let far = smoothstep(25_000.0, 90_000.0, t);
        let fine = bilinear(&self.fine, self.side, u, v);
        let coarse = bilinear(&self.coarse, self.side / 8, (u - 3.5) / 8.0, (v - 3.5) / 8.0);
        let slant = (t / ALTITUDE_M).min(3.5).sqrt();
        let through = exp(-lerp(fine, coarse, far) * slant);
        if through > 0.9995 {
            return Vec4::new(0.0, 0.0, 0.0, 1.0);
        }
        let light = self.source(dot(direction, self.sun));
        let marched = Marched { light: light * (1.0 - through), through, distance_m: t };
        through_air(&marched, direction, ALTITUDE_M, sky)
    }
}

fn optical_depths(seed: u32, amount: f32, side: usize) -> Vec<f32> {
    let unit = 1.0 / side as f32;
    let heading = noise::hash01(seed, 1, 2, 3) * std::f32::consts::TAU;
    // The wind on a coarse grid; its direction turns by up to a radian.
    let bearing = square(WIND, |i, j| {
        let (x, y) = (i as f32 / WIND as f32, j as f32 / WIND as f32);
        heading + 0.9 * noise::fbm2(seed, x * 2.0, y * 2.0, 2, 0.5, 2)
    });
    let wind: Vec<(f32, f32)> = bearing.iter().map(|&a| (libm::cosf(a), libm::sinf(a))).collect();
    let grain = square(side, |i, j| {
        let (x, y) = (i as f32 * unit, j as f32 * unit);
        0.7 * noise::gradient2(seed ^ 0x55, x * 64.0, y * 64.0, 64)
            + 0.6 * (noise::hash01(seed ^ 0xAA, i as i32 / 2, j as i32 / 2, 5) - 0.5)
    });
    let texel = side as f32 / SIDE as f32;
    let short = drawn_out(&grain, side, &wind, 3.0 * texel);
    let long = drawn_out(&short, side, &wind, 11.0 * texel);
    const PATCHES: usize = 64;
    let patches = square(PATCHES, |i, j| {
        let (x, y) = (i as f32 / PATCHES as f32, j as f32 / PATCHES as f32);
        noise::fbm2(seed ^ 0x99, x * 3.0, y * 3.0, 3, 0.5, 3)
    });
    square(side, |i, j| {
        let zoom = PATCHES as f32 * unit;
        let patch = bilinear(&patches, PATCHES, i as f32 * zoom, j as f32 * zoom);
        let at = j * side + i;
        let streak = 0.5 + 1.9 * long[at] + 0.35 * short[at];
        let here = smoothstep(0.42 - 0.75 * amount, 0.8 - 0.55 * amount, patch + 0.55 * (streak - 0.5));
        0.75 * (0.3 + 0.7 * amount) * here * streak.clamp(0.0, 1.3) * (0.35 + 0.65 * here)
    })
}

/// Mean of nine samples along the wind, four on either side; `step` is the distance between them in texels.
fn drawn_out(texels: &[f32], side: usize, wind: &[(f32, f32)], step: f32) -> Vec<f32> {
    let (mask, run) = (side - 1, side / WIND);
    let mut sums = vec![0.0; side * side];
    sums.par_chunks_exact_mut(side).enumerate().for_each(|(row, sums)| {
        // In a cell of the wind every texel reads the same nine places beside it: whole runs are added at once.
        for (cell, sums) in sums.chunks_exact_mut(run).enumerate() {
            let (dx, dy) = wind[row / run * WIND + cell];
            for k in -4..=4 {
                let along = k as f32 * step;
                let offset = |d: f32| ((d * along + 64.5) as usize).wrapping_sub(64);
                let (x, y) =
                    ((cell * run).wrapping_add(offset(dx)) & mask, row.wrapping_add(offset(dy)) & mask);
                let line = &texels[y * side..(y + 1) * side];
                let (before, beyond) = (&line[x..side.min(x + run)], &line[..(x + run).saturating_sub(side)]);
                for (sum, texel) in sums.iter_mut().zip(before.iter().chain(beyond)) {
                    *sum += texel;
                }
            }
            sums.iter_mut().for_each(|sum| *sum /= 9.0);
        }
    });
    sums
}

fn blurred(fine: &[f32], side: usize) -> Vec<f32> {
    square(side / 8, |i, j| {
        let block = (0..8).flat_map(|y| &fine[(j * 8 + y) * side + i * 8..][..8]);
        block.sum::<f32>() / 64.0
    })
}
