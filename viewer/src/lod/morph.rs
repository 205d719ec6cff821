//! What a place's level of detail λ depends on, and with it where `terrain.wgsl` draws a sample. Metres. The rule of
//! Vlietinck's "Trilinear displacement mapping of a flat surface with a v1.1 vertex shader" (2003; thesis 3.2), except
//! that a vertex slides with its whole position to one parent instead of moving up or down to the middle of both.
//!
//! λ depends on the place alone: λ(x, z) = clamp(log₂(D/d₀), 0, top), D² = dx² + dz² + c², where c is how far the eye is
//! above the highest land. So D is at most the true distance of any land at (x, z), D grows at most as fast as one
//! walks, and all moves with the camera without a jump.
//!
//! A vertex v of level l has slid by t(v) = clamp((λ(v) − l)/(1 − [`GAP`]), 0, 1) to its parent a. Since d₀ ≥ 8√2 cells,
//! λ differs by less than log₂(9/8) < GAP between a vertex a of level m ≥ 1 with λ(a) > m and any sample of a cell of
//! 2^m around it. So before a begins to slide, all finer vertices around it have arrived (t = 1), and
//! - a vertex that has arrived *is* its parent, bit by bit: finer triangles vanish without leaving T-junctions;
//! - where a cell's corners stand still, its centre and edge middles slide along the cell's own edges and diagonal, the
//!   fan of its eight triangles keeps its order, and nothing folds. (Without the gap it would: a middle that has not yet
//!   arrived is overtaken by the edge between its parents when one of these leaves the line.)
//! - rounding in another machine's log₂ is harmless: it cannot eat the gap.

use genescape_schema::scene::bintree::Sample;
use glam::{Vec2, Vec3};

use crate::scene::Heightfield;

/// Part of each level's band of λ in which its vertices have arrived and the next level's still stand.
pub const GAP: f32 = 0.25;

/// The least d₀ in cells: 8√2. Makes λ span at most [i, i+2] in a block of level i, see [`super::quadtree`].
pub const MIN_UNIT_CELLS: f32 = 8.0 * std::f32::consts::SQRT_2;

/// λ as a function of the place, for one frame of one view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// Where the eye is: x and z in metres.
    pub eye_m: Vec2,
    /// c: the eye's height above the highest land, at least 0.
    pub above_m: f32,
    /// d₀: the distance in metres up to which every sample is drawn.
    pub unit_m: f32,
    /// The greatest λ, a whole number.
    pub top: f32,
}

impl Detail {
    /// D² at (x, z).
    #[inline]
    pub fn distance_squared_m2(&self, at_m: Vec2) -> f32 {
        at_m.distance_squared(self.eye_m) + self.above_m * self.above_m
    }
}

/// A sample's own place.
#[inline]
pub fn sample_m(field: &Heightfield, [i, j]: Sample) -> Vec3 {
    Vec3::new(field.place_m(i), field.at(i, j), field.place_m(j))
}
