//! Raw land and erosion → the apron, the land beyond the field: the same noise on a coarse grid out to the horizon,
//! with hills that grow a little with distance, in metres.

use super::grid::Grid;
use super::shape::{Shape, distance_to_field_m};
use super::{FIELD_M, LandParams};
use crate::math::smoothstep;
use crate::noise::fbm2;
use crate::seed::noise_seed;

/// Samples a side.
pub(super) const SIDE: u32 = 129;
/// Metres between samples: a sixteenth of the field, so that the field's border passes through samples.
pub(super) const SPACING_M: f32 = FIELD_M / 16.0;

/// Distance in metres from the field over which the apron returns to the raw noise.
const FOLLOW_M: f32 = 900.0;

/// Raw heights of the apron in metres.
pub(super) fn heights(shape: &Shape, params: &LandParams) -> Grid {
    let seed = noise_seed(params.terrain_seed.into(), "land", 10);
    // Far hills are about as high as the land, a little higher around plains, so that these have a horizon too.
    let growth_m = 0.75 * params.relief_m + 25.0;
    Grid::from_square(SIDE, SPACING_M, |x, z| {
        let away_m = distance_to_field_m(x, z);
        let spacing_m = SPACING_M * smoothstep(0.0, 200.0, away_m);
        let rise = smoothstep(500.0, 3400.0, away_m);
        let hills = fbm2(seed, x / 1500.0, z / 1500.0, 4, 0.45, 0);
        let ridges = 1.0 - 2.2 * hills.abs();
        let far = 0.5 + 0.5 * (hills * 1.6 * (1.0 - params.ridged) + ridges * params.ridged);
        let landward = 1.0 - shape.seaward(x, z);
        shape.height_m(x, z, spacing_m) + growth_m * rise * far.max(0.0) * landward
    })
}

/// Continues the erosion of the border into the apron, fading out over `FOLLOW_M`.
pub(super) fn follow(apron: &mut Grid, raw: &Grid, worn: &Grid) {
    let half = 0.5 * FIELD_M;
    for j in 0..SIDE {
        for i in 0..SIDE {
            let (x, z) = (apron.place_m(i as usize), apron.place_m(j as usize));
            let away_m = distance_to_field_m(x, z);
            if away_m > FOLLOW_M {
                continue;
            }
            // The farther out, the wider the part of the border that counts, so that a gully ends and a slope goes on.
            let (x, z) = (x.clamp(-half, half), z.clamp(-half, half));
            let mean: f32 = (-2..=2)
                .map(|k| {
                    let along = k as f32 * 0.35 * away_m;
                    let (x, z) = if x.abs() < half { (x + along, z) } else { (x, z + along) };
                    let at = |v: f32| ((v.clamp(-half, half) + half) / raw.spacing_m) as usize;
                    let sample = at(z) * raw.side as usize + at(x);
                    worn.values[sample] - raw.values[sample]
                })
                .sum::<f32>()
                * 0.2;
            apron.values[(j * SIDE + i) as usize] += mean * (1.0 - smoothstep(0.0, FOLLOW_M, away_m));
        }
    }
}

/// How far below the water's surface what was an island of a few samples lies.
const SHOAL_M: f32 = 1.5;
/// Islands of so many samples are sunk.
const SPECK: usize = 3;

/// Sinks islands of a few samples: these are so far apart that such islands are pyramids.
pub(super) fn sink_specks(apron: &mut Grid, water_m: f32) {
    let side = SIDE as usize;
    let mut is_dry: Vec<bool> = apron.values.iter().map(|&height_m| height_m > water_m).collect();
    let near = |at: usize| at.saturating_sub(1)..(at + 2).min(side);
    for first in 0..is_dry.len() {
        if !std::mem::take(&mut is_dry[first]) {
            continue;
        }
        let (mut island, mut next) = (vec![first], 0);
        while let Some(&at) = island.get(next) {
            for (z, x) in near(at / side).flat_map(|z| near(at % side).map(move |x| (z, x))) {
                if std::mem::take(&mut is_dry[z * side + x]) {
                    island.push(z * side + x);
                }
            }
            next += 1;
        }
        if island.len() <= SPECK {
            island.into_iter().for_each(|at| apron.values[at] = water_m - SHOAL_M);
        }
    }
}

/// Gives the apron's samples inside and on the border of the field the field's own heights.
pub(super) fn join(apron: &mut Grid, field: &Grid) {
    let middle = (SIDE - 1) / 2;
    for j in 0..=16 {
        for i in 0..=16 {
            let at = (middle - 8 + j) * SIDE + middle - 8 + i;
            let last = field.side - 1;
            // On fields of fewer than 17 samples a side several of the apron's samples share one of the field's.
            apron.values[at as usize] = field.values[(j * last / 16 * field.side + i * last / 16) as usize];
        }
    }
}
