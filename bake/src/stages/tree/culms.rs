//! A clump of canes: where its culms stand, how they lean, and how long they are.
//!
//! Bamboos have no trunk that forks: each culm comes out of the ground by itself, from a rhizome, with all the thickness that
//! it will ever have. The oldest stand in the middle; those around them are younger and lean outwards.

use std::f32::consts::TAU;

use glam::Vec3;

use super::params::TreeParams;
use crate::math::lerp;
use crate::seed::Dice;

/// Culms that a fork near the base stands for.
const CULMS_A_SPLIT: u32 = 4;
/// Golden angle: successive culms around the middle.
const GOLDEN_RAD: f32 = 2.399_963;
/// Ground that one culm takes up, as a part of the square of the clump's height.
const ROOM: f32 = 0.0022;
/// Length of the shortest culm over the longest.
const SHORTEST: f32 = 0.5;
/// Radius of a culm over that of a single trunk of its length, youngest and oldest.
const SLENDER: [f32; 2] = [0.42, 0.62];
/// Metres that culms start below the ground, which may be a slope.
const SUNK_M: f32 = 0.3;

/// One culm.
pub(super) struct Culm {
    /// Where it starts, below the ground.
    pub at: Vec3,
    /// Unit vector along its first segment.
    pub along: Vec3,
    /// Unit axis around which it nods outwards.
    pub axis: Vec3,
    /// Length over that of the clump's longest.
    pub length: f32,
    /// Radius over that of a single trunk of its length.
    pub thickness: f32,
}

/// How many trunks a tree has: one, but for canes that fork near their base.
pub(super) fn count(params: &TreeParams) -> u32 {
    if params.is_cane() { 1 + CULMS_A_SPLIT * params.base_splits } else { 1 }
}

/// Sets out the culms of a clump that is `height_m` high, the oldest and longest first.
pub(super) fn set_out(params: &TreeParams, height_m: f32, dice: &mut Dice) -> Vec<Culm> {
    let count = count(params);
    let reach_m = height_m * (ROOM * count as f32 / std::f32::consts::PI).sqrt();
    let start = dice.unit() * TAU;
    let culm = |k: u32| {
        // Evenly over a disc (Vogel, "A better way to construct the sunflower head", 1979).
        let out = ((k as f32 + 0.3 * dice.unit()) / count as f32).sqrt();
        let (sin, cos) = libm::sincosf(start + GOLDEN_RAD * k as f32 + 0.5 * dice.signed());
        let outwards = Vec3::new(cos, 0.0, sin);
        let lean = params.split_angle_deg.to_radians() * (0.1 + 0.45 * out) * (0.3 + dice.unit());
        let (lean_sin, lean_cos) = libm::sincosf(lean);
        let youth = if k == 0 { 0.0 } else { dice.unit() };
        Culm {
            at: outwards * (reach_m * out) - Vec3::Y * SUNK_M,
            along: (Vec3::Y * lean_cos + outwards * lean_sin).normalize_or(Vec3::Y),
            axis: Vec3::Y.cross(outwards).normalize_or(Vec3::X),
            length: lerp(1.0, SHORTEST, youth * youth),
            thickness: lerp(SLENDER[1], SLENDER[0], dice.unit()),
        }
    };
    (0..count).map(culm).collect()
}

#[cfg(test)]
mod tests {
    use genescape_schema::{Population, Space};

    use super::super::tests::read;
    use super::super::{budget::Budget, skeleton, template};
    use super::*;

    /// Canes of any other genes, with that many splits.
    fn canes(base_splits: u32) -> impl Iterator<Item = TreeParams> {
        let space = Space::builtin();
        (0..12).map(move |seed| {
            let genome = &Population::random(&space, seed, 0).individuals[0].genome;
            TreeParams { radius_ratio: 0.008, base_splits, levels: 2, ..read(genome) }
        })
    }

    #[test]
    fn a_clump_has_many_culms_of_differing_height_and_lean() {
        for params in canes(3) {
            let culms = set_out(&params, params.height_m, &mut Dice::new(params.tree_seed, "tree", 0));
            assert!((8..=20).contains(&culms.len()), "{}", culms.len());
            let spread = |of: &dyn Fn(&Culm) -> f32| {
                let (low, high) =
                    culms.iter().map(of).fold((f32::MAX, f32::MIN), |(a, b), v| (a.min(v), b.max(v)));
                high - low
            };
            assert!(spread(&|culm| culm.length) > 0.15, "{params:?}");
            assert!(params.split_angle_deg < 10.0 || spread(&|culm| culm.along.y) > 0.001, "{params:?}");
            for (k, a) in culms.iter().enumerate() {
                assert!(a.at.y < 0.0 && a.along.y > 0.8 && (SHORTEST..=1.0).contains(&a.length));
                let apart_m = culms[..k].iter().map(|b| a.at.distance(b.at)).fold(f32::MAX, f32::min);
                assert!(apart_m > 0.006 * params.height_m, "{apart_m} m apart: {params:?}");
                assert!(a.at.length() < 0.12 * params.height_m + 2.0 * SUNK_M, "{params:?}");
            }
        }
    }

    #[test]
    fn clumps_grow_culms_alone_and_stay_within_the_budget() {
        for splits in 0..=3 {
            for params in canes(splits) {
                let mut dice = Dice::new(params.tree_seed, "tree", 0);
                let skeleton = skeleton::grow(&params, &Budget::new(&params), &mut dice);
                let trunks = skeleton.stems.iter().filter(|stem| stem.level == 0 && !stem.is_arm).count();
                assert_eq!(trunks as u32, count(&params), "{params:?}");
                let triangles = template(&params, 0).mesh.triangle_count();
                assert!(triangles <= 26_000, "{triangles}: {params:?}");
            }
        }
    }
}
