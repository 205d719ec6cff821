//! What a place's level of detail λ depends on where it follows the distance alone, and with it where `terrain.wgsl` draws a
//! sample. Metres. The rule of Vlietinck's "Trilinear displacement mapping of a flat surface with a v1.1 vertex shader" (2003;
//! thesis 3.2), except that a vertex slides with its whole position to one parent instead of moving up or down to the middle of
//! both.
//!
//! λ = log₂(D/d₀), at least 0, depends on the place alone: 2^λ is the number of samples between vertices. D² = dx² + dz² + c²,
//! where c is how far the eye is above the highest land. So D is at most the true distance of any land at (x, z), D grows at most
//! as fast as one walks, and all moves with the camera without a jump. A step along the land changes 2^λ by at most 1/d₀ of its
//! length; and because d₀ ≥ 8√2 cells, by at most 1 for 8√2 cells.
//!
//! A vertex v of level l has slid by t(v) = clamp((λ(v) − l)/(1 − [`GAP`]), 0, 1) to its parent a. By the last sentence
//! λ falls by less than log₂(8/7) < GAP between a vertex a of level m ≥ 1 with λ(a) > m and any sample of a cell of
//! 2^m around it. So before a begins to slide, all finer vertices around it have arrived (t = 1), and
//! - a vertex that has arrived *is* its parent, bit by bit: finer triangles vanish without leaving T-junctions;
//! - where a cell's corners stand still, its centre and edge middles slide along the cell's own edges and diagonal, the
//!   fan of its eight triangles keeps its order, and nothing folds. (Without the gap it would: a middle that has not yet
//!   arrived is overtaken by the edge between its parents when one of these leaves the line.)
//! - rounding in another machine's log₂ is harmless: it cannot eat the gap.

use genescape_schema::scene::bintree::{Sample, first_parent, level};
use glam::{Vec2, Vec3};

use crate::scene::Heightfield;

/// Part of each level's band of λ in which its vertices have arrived and the next level's still stand.
pub const GAP: f32 = 0.25;

/// d₀ is as many cells at least, and a little more for rounding.
const MIN_UNIT_CELLS: f32 = 1.03 * 8.0 * std::f32::consts::SQRT_2;
/// A level is used from so many times as far on as its error alone would ask, because it is there before λ has reached it.
const EARLY: f32 = 1.45;

/// What λ depends on, for one frame of one view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// Where the eye is: x and z in metres.
    pub eye_m: Vec2,
    /// c: the eye's height above the highest land, at least 0.
    pub above_m: f32,
    /// d₀: up to there λ is 0.
    pub unit_m: f32,
    /// What d₀ was made for: [`Sight::pixels`](super::nested::Sight::pixels).
    pub pixels: f32,
    /// The greatest λ, a whole number.
    pub top: f32,
}

/// d₀ by which no level looks farther from the land than one pixel, where `pixels` is how many a radian covers over the pixels of
/// error that are allowed, and `levels_m` the greatest error of each level's uniform triangulation from level 1 on, anywhere: the
/// land's roughest place speaks for all of it.
pub fn unit_m(field: &Heightfield, levels_m: &[f32], pixels: f32) -> f32 {
    let at_unit_m = (0..).zip(levels_m).map(|(finer, error_m)| error_m / (2u32 << finer) as f32);
    let worst_m = at_unit_m.fold(0.0, f32::max);
    (EARLY * pixels * worst_m).max(MIN_UNIT_CELLS * field.spacing_m)
}

impl Detail {
    /// D² at (x, z).
    #[inline]
    pub fn distance_squared_m2(&self, at_m: Vec2) -> f32 {
        at_m.distance_squared(self.eye_m) + self.above_m * self.above_m
    }

    /// λ at (x, z), as the shader has it.
    pub fn lambda(&self, at_m: Vec2) -> f32 {
        let distance_m = self.distance_squared_m2(at_m).sqrt();
        libm::log2f((distance_m / self.unit_m).max(1.0)).min(self.top)
    }

    /// The distance from which on a level may be drawn.
    pub fn from_m(&self, level: u32) -> f32 {
        self.unit_m * (1u32 << level) as f32
    }

    /// The way that a vertex has gone to its parent, 0 to 1, as the shader has it.
    pub fn slide(&self, field: &Heightfield, sample: Sample) -> f32 {
        let [x, z] = sample.map(|line| field.place_m(line));
        let lambda = self.lambda(Vec2::new(x, z));
        ((lambda - level(sample) as f32) * (1.0 / (1.0 - GAP))).clamp(0.0, 1.0)
    }

    /// Where a vertex of a block is drawn, as the shader has it. Two steps suffice: λ is at most two more than the block's level,
    /// and its vertices have no lower level.
    pub fn drawn_m(&self, field: &Heightfield, sample: Sample) -> Vec3 {
        let mut vertex = sample;
        for _ in 0..2 {
            if self.slide(field, vertex) >= 1.0 {
                vertex = first_parent(vertex);
            }
        }
        let (start, part) = (sample_m(field, vertex), self.slide(field, vertex));
        if part <= 0.0 { start } else { start + (sample_m(field, first_parent(vertex)) - start) * part }
    }
}

/// A sample's own place.
#[inline]
pub fn sample_m(field: &Heightfield, [i, j]: Sample) -> Vec3 {
    Vec3::new(field.place_m(i), field.at(i, j), field.place_m(j))
}
