//! The land beyond the field: the same noise on a coarse grid out to the horizon, with hills that grow a little
//! with distance, in metres.

use super::grid::{Grid, smoothstep};
use super::shape::{Shape, distance_to_field_m};
use super::{FIELD_M, LandParams};
use crate::noise::fbm2;
use crate::seed::noise_seed;

/// Samples a side.
pub(super) const SIDE: u32 = 129;
/// Metres between samples: a sixteenth of the field, so that the field's border passes through samples.
pub(super) const SPACING_M: f32 = FIELD_M / 16.0;

/// Raw heights of the apron in metres.
pub(super) fn heights(shape: &Shape, params: &LandParams) -> Grid {
    let seed = noise_seed(params.terrain_seed.into(), "land", 10);
    // Far hills stand about as high as the land is, a little more over plains, so that these have a horizon too.
    let growth_m = 0.75 * params.relief_m + 25.0;
    Grid::from_square(SIDE, SPACING_M, |x, z| {
        let away_m = distance_to_field_m(x, z);
        let spacing_m = SPACING_M * smoothstep(0.0, 200.0, away_m);
        let rise = smoothstep(500.0, 3400.0, away_m);
        let hills = fbm2(seed, x / 1100.0, z / 1100.0, 4, 0.5, 0);
        let ridges = 1.0 - 2.2 * hills.abs();
        let far = 0.5 + 0.5 * (hills * 1.6 * (1.0 - params.ridged) + ridges * params.ridged);
        shape.height_m(x, z, spacing_m) + growth_m * rise * far.max(0.0)
    })
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
