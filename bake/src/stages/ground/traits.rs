//! Landform → the traits of a place that decide its cover: height, slope, water, deposits and the patch it belongs
//! to. Precomputed on the grid of the field (at most 513², 2 m apart) and read between samples.

use std::ops::RangeInclusive;

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::woods::{Woods, stride};
use crate::math::{self, lerp_array};
use crate::model::{Heightfield, Landform};
use crate::noise::{fbm2, fbm2_row};
use crate::seed::noise_seed;

/// The direction that the wind blows to along x and z: that of clouds and grass in the viewer.
const WIND: [f32; 2] = [0.91, 0.41];
/// Metres upwind at which shelter is looked for.
const UPWIND_M: [f32; 4] = [6.0, 13.0, 25.0, 40.0];

/// The traits of one place.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Traits {
    pub height_m: f32,
    /// Tangent of the slope.
    pub slope: f32,
    /// Drained area, log-scaled to [0, 1].
    pub flow: f32,
    /// Loose material, [0, 1].
    pub deposit: f32,
    /// Above 0 in hollows, below 0 on crests, about [-1, 1].
    pub hollow: f32,
    /// Large patches of one kind of growth, about [-1, 1].
    pub patch: f32,
    /// Smaller patches, about [-1, 1].
    pub tuft: f32,
    /// Where rock shows more readily, about [-1, 1].
    pub outcrop: f32,
    /// How far the slope faces the noon sun in the south: 1 is a cliff in the sun, -1 one in the shade.
    pub sunny: f32,
    /// Above 0 in the lee of higher land, below 0 where the wind is let at it, [-1, 1].
    pub lee: f32,
    /// How much lies under crowns of trees, [0, 1].
    pub shade: f32,
    /// How much is farmed, [0, 1].
    pub farmed: f32,
}

impl Traits {
    /// [`lerp_array`] of each.
    fn lerp(self, other: Self, t: f32) -> Self {
        bytemuck::cast(lerp_array::<12>(bytemuck::cast(self), bytemuck::cast(other), t))
    }
}

/// The traits of the whole field.
pub(super) struct TraitsMap {
    side: usize,
    values: Vec<Traits>,
}

impl TraitsMap {
    /// Traits of the whole field, or only as far as rows between two v need them.
    pub fn new(patches: &Patches, land: &Landform, woods: &Woods, v: RangeInclusive<f32>) -> Self {
        let step = stride(land);
        let side = ((land.field.side - 1) / step + 1) as usize;
        let values = rows(side, v, |j, row| {
            for (i, out) in row.iter_mut().enumerate() {
                let traits = sample(patches, land, i as u32 * step, j as u32 * step, step);
                *out = Traits { shade: woods.shade(i, j), ..traits };
            }
        });
        Self { side, values }
    }

    /// The traits along a row of constant v.
    pub fn row(&self, v: f32) -> TraitsRow {
        let (j, f) = cell(v, self.side);
        let row = |j: usize| &self.values[j * self.side..][..self.side];
        TraitsRow(row(j).iter().zip(row(j + 1)).map(|(&a, &b)| a.lerp(b, f)).collect())
    }
}

/// A grid of `side`² values; `fill` makes only the rows that places between two v need.
fn rows<T: Pod + Send>(side: usize, v: RangeInclusive<f32>, fill: impl Fn(usize, &mut [T]) + Sync) -> Vec<T> {
    let mut values = vec![T::zeroed(); side * side];
    let (first, last) = (cell(*v.start(), side).0, cell(*v.end(), side).0 + 1);
    let rows = values.par_chunks_mut(side).enumerate().skip(first).take(last + 1 - first);
    rows.for_each(|(j, row)| fill(j, row));
    values
}

/// The cell of `side` samples that a place in 0..1 lies in.
fn cell(u: f32, side: usize) -> (usize, f32) {
    math::cell(u * (side - 1) as f32, side)
}

/// The traits between two rows of samples.
pub(super) struct TraitsRow(Vec<Traits>);

impl TraitsRow {
    /// Linear between the two samples around.
    #[inline]
    pub fn at(&self, u: f32) -> Traits {
        let (i, f) = cell(u, self.0.len());
        self.0[i].lerp(self.0[i + 1], f)
    }
}

/// Traits of the sample of the field nearest to (u, v) in 0..1.
pub(super) fn near(patches: &Patches, land: &Landform, u: f32, v: f32) -> Traits {
    let at = |u: f32| (u * (land.field.side - 1) as f32 + 0.5) as u32;
    sample(patches, land, at(u), at(v), stride(land))
}

/// Traits of sample (i, j) of the field.
fn sample(patches: &Patches, land: &Landform, i: u32, j: u32, step: u32) -> Traits {
    let at = (j * land.field.side + i) as usize;
    let [height_m, flow, deposit] = [&land.field.heights_m, &land.flow, &land.deposit].map(|grid| grid[at]);
    let Form { slope, hollow, sunny, lee } = form_at(&land.field, i, j, step);
    let last = (land.field.side - 1) as f32;
    let [patch, tuft, outcrop] = patches.at(i as f32 / last, j as f32 / last);
    Traits {
        height_m,
        slope,
        flow,
        deposit,
        hollow,
        patch,
        tuft,
        outcrop,
        sunny,
        lee,
        shade: 0.0,
        farmed: land.farmed(at),
    }
}

/// Traits of a sample of the apron, whose spacing hides much of the slope.
pub(super) fn far(patches: &Patches, land: &Landform, i: u32, j: u32) -> Traits {
    let Form { slope, hollow, sunny, lee } = form_at(&land.apron, i, j, 1);
    let seed = |k: usize| patches.seeds[k];
    let (x, z) = (i as f32 * land.apron.spacing_m, j as f32 * land.apron.spacing_m);
    Traits {
        height_m: land.apron.at(i, j),
        slope: slope * 1.25 + 0.05,
        flow: 0.3 + 0.2 * hollow.clamp(-1.0, 1.0),
        deposit: 0.3,
        hollow,
        patch: fbm2(seed(0), x / 700.0, z / 700.0, 3, 0.5, 0) * 1.6,
        tuft: fbm2(seed(1), x / 150.0, z / 150.0, 2, 0.5, 0),
        outcrop: fbm2(seed(2), x / 300.0, z / 300.0, 2, 0.5, 0),
        sunny,
        lee,
        shade: 0.0,
        farmed: 0.0,
    }
}

/// The form of the land at a sample, as [`Traits`] have it.
struct Form {
    slope: f32,
    hollow: f32,
    sunny: f32,
    lee: f32,
}

/// From neighbours `step` samples away.
fn form_at(field: &Heightfield, i: u32, j: u32, step: u32) -> Form {
    let last = field.side - 1;
    let (w, e) = (i.saturating_sub(step), (i + step).min(last));
    let (n, s) = (j.saturating_sub(step), (j + step).min(last));
    let (west, east, north, south) = (field.at(w, j), field.at(e, j), field.at(i, n), field.at(i, s));
    let dx = (east - west) / ((e - w) as f32 * field.spacing_m);
    let dz = (south - north) / ((s - n) as f32 * field.spacing_m);
    let rise = 0.25 * (west + east + north + south) - field.at(i, j);
    let steep = dx * dx + dz * dz;
    Form {
        slope: steep.sqrt(),
        hollow: (rise * 6.0 / (step as f32 * field.spacing_m)).clamp(-1.0, 1.0),
        sunny: -dz / (1.0 + steep).sqrt(),
        lee: lee(field, i, j),
    }
}

/// Greatest slope up to what stands upwind, from about 6 to 40 m away: the shelter that decides where drifts lie (Winstral, Elder and
/// Davis, "Spatial snow modeling of wind-redistributed snow using terrain-based parameters", 2002).
fn lee(field: &Heightfield, i: u32, j: u32) -> f32 {
    let here_m = field.at(i, j);
    let upwind = |reach_m: f32| {
        let steps = WIND.map(|part| (part * reach_m / field.spacing_m + 0.5) as u32);
        let away_m = ((steps[0] * steps[0] + steps[1] * steps[1]) as f32).sqrt() * field.spacing_m;
        if away_m > 0.0 {
            (field.at(i.saturating_sub(steps[0]), j.saturating_sub(steps[1])) - here_m) / away_m
        } else {
            -1.0
        }
    };
    UPWIND_M.map(upwind).into_iter().fold(-1.0, f32::max).min(1.0)
}

/// Three layers of noise on a coarse grid.
pub(super) struct Patches {
    seeds: [u32; 3],
    values: Vec<[f32; 3]>,
}

impl Patches {
    const SIDE: usize = 129;

    /// The layers of the whole field, or only as far as places between two v need them.
    pub fn new(terrain_seed: u32, extent_m: f32, v: RangeInclusive<f32>) -> Self {
        let seed = |item| noise_seed(terrain_seed.into(), "ground", item);
        let seeds = [seed(0), seed(1), seed(2)];
        let spacing_m = extent_m / (Self::SIDE - 1) as f32;
        // Wavelength in metres, octaves, gain, height.
        let layers = [(170.0, 4, 0.55, 1.8), (46.0, 3, 0.6, 1.6), (80.0, 3, 0.6, 1.6)];
        let place_m = |k: usize| k as f32 * spacing_m;
        let xs = layers.map(|layer| (0..Self::SIDE).map(|i| place_m(i) / layer.0).collect::<Vec<f32>>());
        let values = rows(Self::SIDE, v, |j, row: &mut [[f32; 3]]| {
            let mut line = [0.0; Self::SIDE];
            for (k, (wavelength_m, octaves, gain, height)) in layers.into_iter().enumerate() {
                fbm2_row(seeds[k], &xs[k], place_m(j) / wavelength_m, octaves, gain, 0, &mut line);
                row.iter_mut().zip(&line).for_each(|(out, value)| out[k] = height * value);
            }
        });
        Self { seeds, values }
    }

    fn at(&self, u: f32, v: f32) -> [f32; 3] {
        let ((i, f), (j, g)) = (cell(u, Self::SIDE), cell(v, Self::SIDE));
        let along = |k: usize| lerp_array(self.values[k], self.values[k + 1], f);
        lerp_array(along(j * Self::SIDE + i), along((j + 1) * Self::SIDE + i), g)
    }
}
