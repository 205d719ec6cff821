//! Terrain genes → what one sees of a land.

use super::Trait;
use super::color::{mean_and_contrast, oklab};
use crate::model::{Heightfield, Landform};
use crate::stages::ground::{Glimpse, GroundParams, glimpse};
use crate::stages::land::{LandParams, sketch};

/// What [`traits`] gives, in this order.
pub const TRAITS: [Trait; 9] = [
    Trait { name: "relief", spread: 1.43 },
    Trait { name: "heights", spread: 0.36 },
    Trait { name: "steepness", spread: 0.36 },
    Trait { name: "roughness", spread: 0.85 },
    Trait { name: "ridges", spread: 1.11 },
    Trait { name: "water", spread: 0.30 },
    Trait { name: "ground", spread: 0.50 },
    Trait { name: "ground colour", spread: 0.11 },
    Trait { name: "ground contrast", spread: 0.031 },
];

/// Samples of the sketch between which heights are compared: 16 m, 64 m and 256 m.
const SCALES: [u32; 3] = [2, 8, 32];
/// Parts of the land below which the heights lie that are compared.
const DECILES: [f32; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];

pub fn traits(land: &LandParams, ground: &GroundParams) -> Vec<Vec<f32>> {
    let land = sketch(land);
    let field = &land.field;
    let [low, high] = field.range_m();
    let relief_m = (high - low).max(1.0);
    let mut heights = field.heights_m.clone();
    heights.sort_unstable_by(f32::total_cmp);
    let quantile = |sorted: &[f32], part: f32| sorted[(part * (sorted.len() - 1) as f32) as usize];
    let mut slopes = slopes(field);
    slopes.sort_unstable_by(f32::total_cmp);
    let rough = SCALES.map(|step| libm::log2f(unevenness(field, step).0.max(0.01)));
    let Glimpse { cover, colors_linear } = glimpse(ground, &land);
    let colors: Vec<[f32; 3]> = colors_linear.into_iter().map(oklab).collect();
    let (color, contrast) = mean_and_contrast(&colors);
    let [grass, rock, scree, snow, earth] = cover;
    vec![
        vec![libm::log2f(relief_m)],
        DECILES.map(|part| (quantile(&heights, part) - low) / relief_m).to_vec(),
        vec![quantile(&slopes, 0.5), quantile(&slopes, 0.9)],
        vec![rough[0] - rough[2], rough[1] - rough[2]],
        SCALES[1..].iter().map(|step| unevenness(field, *step).1).collect(),
        vec![water(&land).sqrt()],
        vec![grass, rock + scree, snow, earth],
        color.to_vec(),
        vec![contrast],
    ]
}

/// Angles of slope at all samples, in radians.
fn slopes(field: &Heightfield) -> Vec<f32> {
    let inner = 1..field.side - 1;
    let at = |i: u32, j: u32| {
        let across = field.at(i + 1, j) - field.at(i - 1, j);
        let along = field.at(i, j + 1) - field.at(i, j - 1);
        libm::atanf((across * across + along * along).sqrt() / (2.0 * field.spacing_m))
    };
    inner.clone().flat_map(|j| inner.clone().map(move |i| at(i, j))).collect()
}

/// How far samples lie above or below those so many steps around them: the root mean square in metres, and whether rather
/// crests (above 0) or hollows are sharp.
fn unevenness(field: &Heightfield, step: u32) -> (f32, f32) {
    let inner = (step..field.side - step).step_by(2);
    let (mut squares, mut cubes, mut count) = (0.0f32, 0.0f32, 0.0f32);
    for j in inner.clone() {
        for i in inner.clone() {
            let around =
                field.at(i - step, j) + field.at(i + step, j) + field.at(i, j - step) + field.at(i, j + step);
            let above = field.at(i, j) - 0.25 * around;
            squares += above * above;
            cubes += above * above * above;
            count += 1.0;
        }
    }
    let rms = (squares / count).sqrt();
    (rms, (cubes / count / (rms * rms * rms).max(1e-6)).clamp(-3.0, 3.0))
}

/// The part of the field that is under water.
fn water(land: &Landform) -> f32 {
    let Some(water_m) = land.water_level_m else { return 0.0 };
    let heights = &land.field.heights_m;
    heights.iter().filter(|height| **height < water_m).count() as f32 / heights.len() as f32
}
