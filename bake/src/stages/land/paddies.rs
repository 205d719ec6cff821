//! Land → slopes cut into level fields, as for rice: people's work, which follows contours as no erosion does.

use super::grid::{Grid, border_guard};
use super::{LandParams, into_field};
use crate::math::{lerp, smoothstep};
use crate::noise::gradient2;
use crate::raster::square;
use crate::seed::noise_seed;

/// Metres from one bank to the next where a slope is as steep as the land's are on the mean, and how high a step may be.
const FIELD_M: f32 = 13.0;
const STEP_M: [f32; 2] = [1.2, 4.0];
/// Part of the way from one field to the next that the bank between them takes.
const BANK: f32 = 0.42;
/// How often the land is smoothed whose contours fields follow: over some 8 m.
const SMOOTHINGS: usize = 16;
/// Tangents of slopes up to which all and from which on none are cut.
const SLOPES: [f32; 2] = [0.36, 0.52];
/// Metres above water where fields begin.
const SHORE_M: [f32; 2] = [0.8, 2.0];
/// Parts of the relief between which fields end and woods are left standing.
const CRESTS: [f32; 2] = [0.72, 0.9];
/// Metres from one farmed part of the land to the next.
const FARMS_M: f32 = 380.0;

/// The land that fields are cut into, and where.
pub(super) struct Paddies {
    /// Heights in metres whose contours fields follow.
    smooth: Grid,
    /// How much is cut, 0 to 1.
    part: Grid,
    /// Metres from one field up to the next.
    step_m: f32,
}

impl Paddies {
    /// Fields of a land without them; `None` if the genes want none.
    pub fn new(params: &LandParams, land: &Grid, water_m: Option<f32>) -> Option<Self> {
        if params.paddies <= 0.0 {
            return None;
        }
        let smooth = (0..SMOOTHINGS).fold(land.clone(), |land, _| land.smoothed());
        let guard = border_guard(land.side);
        let seed = noise_seed(params.terrain_seed.into(), "land", 30);
        let (lowest_m, highest_m) = smooth.range();
        let shore_m = water_m.unwrap_or(lowest_m - SHORE_M[1]);
        let side = land.side as usize;
        let field = into_field(smooth.clone());
        let slopes = square(side, |i, j| {
            let up = field.normal_at(i as u32, j as u32);
            up.with_y(0.0).length() / up.y
        });
        let mean = slopes.iter().map(|slope| slope.min(SLOPES[1])).sum::<f32>() / slopes.len() as f32;
        let values = square(side, |i, j| {
            let (k, x, z) = (j * side + i, land.place_m(i), land.place_m(j));
            let height_m = smooth.values[k];
            let farmed = gradient2(seed, x / FARMS_M, z / FARMS_M, 0) + 1.7 * params.paddies - 0.85;
            let gentle = 1.0 - smoothstep(SLOPES[0], SLOPES[1], slopes[k]);
            let crest = smoothstep(CRESTS[0], CRESTS[1], (height_m - lowest_m) / (highest_m - lowest_m));
            let dry = smoothstep(SHORE_M[0], SHORE_M[1], height_m - shore_m);
            smoothstep(-0.06, 0.06, farmed) * gentle * (1.0 - crest) * dry * guard.values[k]
        });
        let step_m = (FIELD_M * mean).clamp(STEP_M[0], STEP_M[1]);
        Some(Self { part: Grid { values, ..*land }, smooth, step_m })
    }

    /// Cuts the fields into the land; how much of each sample is farmed, 0 to 1.
    pub fn cut(&self, field: &mut Grid) -> Vec<f32> {
        let [smooth, part] = [&self.smooth, &self.part].map(|grid| grid.resized(field.side));
        let part = part.map(|part| part.clamp(0.0, 1.0)).values;
        for ((h, smooth_m), part) in field.values.iter_mut().zip(smooth.values).zip(&part) {
            let step = smooth_m / self.step_m;
            let bank = smoothstep(1.0 - BANK, 1.0, step - step.floor());
            *h = lerp(*h, (step.floor() + bank) * self.step_m, *part);
        }
        part
    }
}
