//! Tree genes → what one sees of the trees, and of how they stand on an even meadow.

use super::Trait;
use super::color::oklab;
use crate::math::lerp_array;
use crate::model::{Heightfield, Instance, Landform, TreeFootprint};
use crate::stages::placement::{PlacementParams, place};
use crate::stages::tree::{TreeMeasures, TreeParams, measure};

/// What [`traits`] gives, in this order.
pub const TRAITS: [Trait; 13] = [
    Trait { name: "height", spread: 0.93 },
    Trait { name: "crown width", spread: 0.93 },
    Trait { name: "crown base", spread: 0.25 },
    Trait { name: "crown shape", spread: 0.44 },
    Trait { name: "density of leaves", spread: 1.51 },
    Trait { name: "colour of crown", spread: 0.10 },
    Trait { name: "size of leaves", spread: 1.11 },
    Trait { name: "kind of leaves", spread: 1.03 },
    Trait { name: "droop", spread: 0.50 },
    Trait { name: "trunk", spread: 0.47 },
    Trait { name: "number", spread: 0.71 },
    Trait { name: "groves", spread: 0.12 },
    Trait { name: "where they grow", spread: 0.155 },
];

/// Dark, brown and pale bark, linear.
const BARKS: [[f32; 3]; 3] = [[0.09, 0.074, 0.058], [0.15, 0.10, 0.07], [0.48, 0.46, 0.42]];
/// Trees whose neighbours are looked for.
const LOOKED_AT: usize = 160;

pub fn traits(tree: &TreeParams, placement: &PlacementParams) -> Vec<Vec<f32>> {
    let measures = measure(tree);
    let TreeMeasures { height_m, crown_radius_m, density, trunk_radius_m, .. } = measures;
    let leafy = 1.0 - libm::expf(-density);
    // Bark is seen where leaves and twigs are not.
    let crown = oklab(lerp_array(bark(tree.bark_tone), measures.foliage_linear, measures.veil));
    let trunk = oklab(bark(tree.bark_tone));
    let standing = standing(placement, &measures);
    vec![
        vec![libm::log2f(height_m)],
        vec![libm::log2f(2.0 * crown_radius_m / height_m)],
        vec![measures.crown_base],
        measures.profile.to_vec(),
        vec![leafy, libm::log2f(1.0 + density)],
        vec![crown[0], crown[1], crown[2], 0.3 * measures.blossom],
        vec![leafy * libm::log2f(tree.leaf_size_m / 0.03)],
        measures.habit.map(|one| one * leafy).to_vec(),
        vec![measures.upward * leafy],
        vec![0.5 * libm::log2f(trunk_radius_m / height_m), trunk[0], trunk[1], trunk[2]],
        vec![libm::log2f(1.0 + standing.len() as f32)],
        vec![evenness(&standing), placement.height_variation],
        vec![placement.altitude_limit, 0.01 * placement.steepest_slope_deg, 0.01 * placement.hardiness_c],
    ]
}

fn bark(tone: f32) -> [f32; 3] {
    let place = 2.0 * tone.clamp(0.0, 1.0);
    let k = usize::from(place > 1.0);
    lerp_array(BARKS[k], BARKS[k + 1], place - k as f32)
}

/// The trees on a level meadow where it is warm: so it depends on no land.
fn standing(placement: &PlacementParams, measures: &TreeMeasures) -> Vec<Instance> {
    let params = PlacementParams {
        terrain_seed: 0,
        temperature_c: 25.0,
        rain_mm: 1800.0,
        // Level land has no height at which trees could end.
        altitude_limit: 1.0,
        ..placement.clone()
    };
    let level = |side: u32, spacing_m: f32| Heightfield {
        side,
        spacing_m,
        heights_m: vec![0.0; (side * side) as usize],
    };
    let meadow = Landform::bare(level(33, 32.0), level(3, 4096.0));
    let footprint = TreeFootprint {
        height_m: measures.height_m,
        trunk_radius_m: measures.trunk_radius_m,
        crown_radius_m: measures.crown_radius_m,
        root_depth_m: 0.02 * measures.height_m,
        clear_trunk: measures.crown_base,
    };
    place(&params, &meadow, None, &[footprint]).instances
}

/// How far the nearest neighbour is on average, as a part of what it would be by chance (Clark and Evans, "Distance to
/// nearest neighbor as a measure of spatial relationships in populations", 1954): below 1 in groves, above it in rows.
fn evenness(trees: &[Instance]) -> f32 {
    if trees.len() < 2 {
        return 1.0;
    }
    let place = |tree: &Instance| [tree.trunk_cylinder_m[0], tree.trunk_cylinder_m[1]];
    let looked_at = trees.iter().step_by(trees.len().div_ceil(LOOKED_AT)).map(place);
    let nearest = |[x, z]: [f32; 2]| {
        let squares = trees.iter().map(place).map(|[x2, z2]| (x2 - x) * (x2 - x) + (z2 - z) * (z2 - z));
        squares.filter(|square| *square > 1e-6).fold(f32::MAX, f32::min).sqrt()
    };
    let (sum, count) = looked_at.map(nearest).fold((0.0, 0.0), |(sum, count), one| (sum + one, count + 1.0));
    let per_m2 = trees.len() as f32 / (1024.0 * 1024.0);
    2.0 * per_m2.sqrt() * sum / count
}
