//! Landscapes made up for tests.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

use super::{Anchor, Land, Trunk, Trunks};
use crate::scene::{Heightfield, StartView};

/// A trunk.
pub fn trunk(center_m: Vec2, radius_m: f32) -> Trunk {
    Trunk { center_m, radius_m }
}

/// 128 m × 128 m of level land.
pub fn land_with(trunks: impl IntoIterator<Item = Trunk>) -> Land {
    land(|_, _| 0.0, trunks)
}

/// 128 m × 128 m of hills of up to 20 m, different for each seed.
pub fn hilly(seed: u64, trunks: impl IntoIterator<Item = Trunk>) -> Land {
    let mut rng = Pcg32::seed_from_u64(seed);
    let [a, b, c, d]: [f32; 4] = std::array::from_fn(|_| rng.random_range(0.02..0.2));
    let height = move |x: f32, z: f32| 10.0 * (libm::sinf(a * x + 30.0 * b) + libm::sinf(c * z + d * x));
    land(height, trunks)
}

/// `count` trunks of many sizes, not farther than `extent_m` from the middle in x and z.
pub fn forest(seed: u64, count: u32, extent_m: f32) -> Vec<Trunk> {
    let mut rng = Pcg32::seed_from_u64(seed);
    let mut place = || rng.random_range(-1.0f32..1.0);
    (0..count)
        .map(|_| {
            let (x, z, size) = (place(), place(), place());
            trunk(extent_m * Vec2::new(x, z), 0.25 + 0.2 * size)
        })
        .collect()
}

fn land(height_m: impl Fn(f32, f32) -> f32, trunks: impl IntoIterator<Item = Trunk>) -> Land {
    let mut field = Heightfield { side: 33, spacing_m: 4.0, ..Heightfield::default() };
    let places: Vec<f32> = (0..field.side).map(|line| field.place_m(line)).collect();
    field.heights_m = places
        .iter()
        .flat_map(|&z| places.iter().map(move |&x| (x, z)))
        .map(|(x, z)| height_m(x, z))
        .collect();
    let [_, top_m] = field.range_m();
    let start = StartView { position_m: Vec3::ZERO, direction: Vec3::NEG_Z };
    let (field, trunks) = (Arc::new(field), Trunks::new(trunks));
    let anchor = Anchor::default();
    Land { field, top_m, water_level_m: None, trunks, start, anchor, subject: None }
}
