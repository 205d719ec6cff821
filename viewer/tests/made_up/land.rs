//! Land of any height with its levels of detail, for tests within the crate and beside it.

use genescape_bake::stages::terrain_lod;
use genescape_schema::scene::{Heightfield, TerrainLod};

/// In [0, 1), of two coordinates and a seed.
pub fn hash(i: u32, j: u32, seed: u32) -> f32 {
    let mixed = i.wrapping_mul(0x9e37_79b9) ^ j.wrapping_mul(0x85eb_ca6b) ^ seed.wrapping_mul(0x27d4_eb2f);
    let mixed = (mixed ^ mixed >> 15).wrapping_mul(0xc2b2_ae35);
    ((mixed ^ mixed >> 13).wrapping_mul(0x27d4_eb2f) >> 8) as f32 / (1 << 24) as f32
}

/// The land whose sample (i, j) is `height_m(i, j)` high.
pub fn land(side: u32, spacing_m: f32, height_m: impl Fn(u32, u32) -> f32) -> TerrainLod {
    let heights_m = (0..side * side).map(|n| height_m(n % side, n / side)).collect();
    terrain_lod::lod(&Heightfield { side, spacing_m, heights_m })
}
