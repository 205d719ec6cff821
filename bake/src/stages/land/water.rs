//! Land → the lake's surface in metres, chosen so that enough land stays dry, and gentle shores around it.

use super::LandParams;
use super::grid::Grid;
use crate::math::lerp;

/// Part of the field that stays dry at least.
const DRY: f32 = 0.5;
/// Part of the land around the middle that stays dry.
const DRY_MIDDLE: f32 = 0.62;
/// Radius in metres of the middle, where the walk begins.
const MIDDLE_M: f32 = 90.0;

/// The surface of the lake, if there is one.
pub(super) struct Level {
    /// Its height in metres.
    pub water_m: Option<f32>,
    /// Height in metres above and below it over which shores are gentle.
    shore_m: f32,
}

impl Level {
    /// Chooses the surface: where the gene says, unless too little of the land would stay dry.
    pub fn new(params: &LandParams, land: &Grid) -> Self {
        let shore_m = 0.9 + 0.012 * params.relief_m;
        if params.water_level <= 0.0 {
            return Self { water_m: None, shore_m };
        }
        let asked_m = params.water_level * params.relief_m;
        let everywhere = quantile(land.values.iter().copied(), 1.0 - DRY);
        let middle = quantile(middle(land), 1.0 - DRY_MIDDLE);
        // Never below the lowest ground: a lake covers some land.
        Self { water_m: Some(asked_m.min(everywhere).min(middle)), shore_m }
    }

    /// Flattens the slope of heights near the surface to a third, on both sides, and leaves others as they are.
    pub fn settle(&self, heights_m: &mut [f32]) {
        let Some(water_m) = self.water_m else { return };
        for h in heights_m {
            let depth = *h - water_m;
            let t = depth / self.shore_m;
            *h = water_m + depth * lerp(1.0, 0.32, 1.0 / (1.0 + t * t));
        }
    }
}

/// Heights within the middle.
fn middle(land: &Grid) -> impl Iterator<Item = f32> {
    let reach = (MIDDLE_M / land.spacing_m) as i32;
    let centre = (land.side as i32 - 1) / 2;
    (-reach..=reach).flat_map(move |j| {
        (-reach..=reach)
            .filter(move |i| i * i + j * j <= reach * reach)
            .map(move |i| land.values[((centre + j) * land.side as i32 + centre + i) as usize])
    })
}

/// The value that `part` of all values lie below.
fn quantile(values: impl Iterator<Item = f32>, part: f32) -> f32 {
    let mut values: Vec<f32> = values.collect();
    let k = ((values.len() - 1) as f32 * part) as usize;
    *values.select_nth_unstable_by(k, f32::total_cmp).1
}
