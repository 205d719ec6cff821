//! What a place's level of detail λ depends on, and with it where `terrain.wgsl` draws a sample. Metres. The rule of
//! Vlietinck's "Trilinear displacement mapping of a flat surface with a v1.1 vertex shader" (2003; thesis 3.2), except
//! that a vertex slides with its whole position to one parent instead of moving up or down to the middle of both, and that λ
//! follows the land's roughness as well as the distance.
//!
//! λ depends on the place alone: 2^λ is the number of samples between vertices. It is 2^l from D = d_l(x, z) on, for the
//! [`Reach`] d, D² = dx² + dz² + c², where c is how far the eye is above the highest land; and grows in a straight line of D
//! to 2^(l+1) while D goes the last w·2^l to d_{l+1}(x, z), where d_{l+1} − d_l ≥ w·2^l. The shorter w, the longer the land
//! stays what it is from near by; by distance alone w·2^l is all of d_{l+1} − d_l, as in the thesis. So D is at most the true
//! distance of any land at (x, z), D grows at most as fast as one walks, and all moves with the camera without a jump. With σ
//! the steepness of all d_l, a step along the land changes 2^λ by at most (1 + σ)/w of its length; and because w ≥
//! (1 + σ)·8√2 cells, by at most 1 for 8√2 cells.
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

use super::reach::Reach;
use crate::scene::Heightfield;

/// Part of each level's band of λ in which its vertices have arrived and the next level's still stand.
pub const GAP: f32 = 0.25;

/// What λ depends on besides the [`Reach`], for one frame of one view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// Where the eye is: x and z in metres.
    pub eye_m: Vec2,
    /// c: the eye's height above the highest land, at least 0.
    pub above_m: f32,
    /// How far one goes while level 0 becomes level 1, as [`Reach::morph_m`].
    pub morph_m: f32,
    /// The greatest λ, a whole number.
    pub top: f32,
}

impl Detail {
    /// D² at (x, z).
    #[inline]
    pub fn distance_squared_m2(&self, at_m: Vec2) -> f32 {
        at_m.distance_squared(self.eye_m) + self.above_m * self.above_m
    }

    /// λ at (x, z), as the shader has it: of a vertex of a block of level `from`, where λ lies between that and two more.
    pub fn lambda(&self, reach: &Reach, from: u32, at_m: Vec2) -> f32 {
        let distance_m = self.distance_squared_m2(at_m).sqrt();
        let d = reach.at(from, at_m.to_array());
        let band = usize::from(distance_m >= d[1]) + usize::from(distance_m >= d[2]);
        let level = from + band as u32;
        let morph_m = self.morph_m * (1u32 << level) as f32;
        let part = (1.0 + (distance_m - d[band + 1]) / morph_m).clamp(0.0, 1.0);
        (level as f32 + libm::log2f(1.0 + part)).min(self.top)
    }

    /// The way that a vertex has gone to its parent, 0 to 1, as the shader has it.
    pub fn slide(&self, reach: &Reach, field: &Heightfield, from: u32, sample: Sample) -> f32 {
        let [x, z] = sample.map(|line| field.place_m(line));
        let lambda = self.lambda(reach, from, Vec2::new(x, z));
        ((lambda - level(sample) as f32) * (1.0 / (1.0 - GAP))).clamp(0.0, 1.0)
    }

    /// Where a vertex of a block of level `from` is drawn, as the shader has it. Two steps suffice: λ ≤ `from` + 2, and
    /// vertices have levels ≥ `from`.
    pub fn drawn_m(&self, reach: &Reach, field: &Heightfield, from: u32, sample: Sample) -> Vec3 {
        let mut vertex = sample;
        for _ in 0..2 {
            if self.slide(reach, field, from, vertex) >= 1.0 {
                vertex = first_parent(vertex);
            }
        }
        let (start, part) = (sample_m(field, vertex), self.slide(reach, field, from, vertex));
        if part <= 0.0 { start } else { start + (sample_m(field, first_parent(vertex)) - start) * part }
    }
}

/// A sample's own place.
#[inline]
pub fn sample_m(field: &Heightfield, [i, j]: Sample) -> Vec3 {
    Vec3::new(field.place_m(i), field.at(i, j), field.place_m(j))
}
