//! A view of a heightfield → the blocks to draw, all by one instanced draw (thesis 3.2, the vertex-program algorithm).
//! Metres, pixels.
//!
//! A block of level i is 8 × 8 cells of 2^i samples' distance, whatever i; its vertices move by [`super::morph`]. It is
//! drawn if λ ≥ i all over its closed square; else its four quarters are looked at. Then:
//! - *λ ≤ i+2 in it.* Its parent of level i+1 ≤ top was refused, so it has a point with D < d₀·2^(i+1); a point of the
//!   block lies at most the parent's diagonal of 16√2·2^i cells away, so D < d₀·2^(i+1) + 16√2·2^i cells ≤ d₀·2^(i+2) as
//!   d₀ ≥ 8√2 cells. And where there is no parent (top), λ ≤ top = i.
//! - *It draws what is within it.* A vertex of level < i+3 has its parents in the block's closed square; the corners'
//!   levels are ≥ i+3 > λ, they stand.
//! - *Neighbours fit.* On the edge shared with a block of level j > i, λ ≥ j. So vertices of levels < j have arrived at
//!   their parents, which lie on the edge as well, and both blocks draw the same points.
//! - *No pop.* A block is split when somewhere λ < i; then the new vertices, of level i−1, still sit on their parents.

use genescape_schema::scene::bintree::parents;
use glam::{Vec2, Vec3};

use super::morph::{Detail, MIN_UNIT_CELLS};
use crate::camera::Frustum;
use crate::scene::{Heightfield, TerrainLod};

/// log₂ of a block's cells a side.
pub const BLOCK_BITS: u32 = 3;

/// As many as a field of 2^15+1 samples a side has.
const MAX_LEVELS: usize = 12;

/// A block: an instance of the mesh of [`block_indices`]. Fit for an instance buffer (Uint32x3).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Block {
    /// Its north-west sample, counted eastwards.
    pub i: u32,
    /// Its north-west sample, counted southwards.
    pub j: u32,
    /// Its vertices are 2^level samples apart.
    pub level: u32,
}

/// How far the uniform triangulations of a field are from it: the root of the mean square over all samples of their
/// vertical distance. To be computed once a field.
///
/// Not the greatest distance: λ is blind to where the land is rough, so one sharp bank would ask for every sample up to
/// the horizon (on 2 m lands of 60 to 300 m relief the greatest is 5 to 13 times this, d₀ for one pixel wider than the
/// land). The mean square is what the thesis compares pictures by (7), and what moves does so without a pop.
/// [`super::roam`] bounds the error everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Of level l, in metres; entry 0 is 0. Never decreases.
    levels_m: [f32; MAX_LEVELS],
}

impl Errors {
    /// Those of each level up to [`top_level`].
    pub fn of(field: &Heightfield) -> Self {
        let mut levels_m = [0.0f32; MAX_LEVELS];
        let top = top_level(field) as usize;
        let mut drawn_m = Vec::new();
        for level in 1..=top.min(MAX_LEVELS - 1) {
            let error_m = uniform_error_m(field, level as u32, &mut drawn_m);
            levels_m[level] = error_m.max(levels_m[level - 1]);
        }
        Self { levels_m }
    }

    /// d₀ in metres, such that each level's error looks like `error_px` at most in the middle of the band of λ in which
    /// the level before dissolves into it: from there on it is in use.
    fn unit_m(&self, focal_px: f32, error_px: f32) -> f32 {
        let at_unit_m = |level: usize| self.levels_m[level] / (1u32 << level) as f32;
        let worst_m = (1..MAX_LEVELS).map(at_unit_m).fold(0.0, f32::max) * std::f32::consts::SQRT_2;
        worst_m * focal_px / error_px
    }
}

/// The coarsest level of a block: the whole field is one then.
pub fn top_level(field: &Heightfield) -> u32 {
    field.depth().saturating_sub(BLOCK_BITS)
}

/// Cells a side of every block: 8, or fewer if the whole field has fewer.
pub fn block_cells(field: &Heightfield) -> u32 {
    (field.side - 1).min(1 << BLOCK_BITS)
}

/// λ for a view from `eye_m`. `focal_px`: pixels a radian in the middle of the picture, ½·height/tan(½·fov);
/// `error_px`: what may be seen of the simplification, 0 for every sample; `max_block_m`: no block is wider, so that
/// enough can be culled.
pub fn detail(
    lod: &TerrainLod,
    errors: &Errors,
    eye_m: Vec3,
    focal_px: f32,
    error_px: f32,
    max_block_m: f32,
) -> Detail {
    let field = &lod.field;
    let width_m = block_cells(field) as f32 * field.spacing_m;
    let fits = |level: &u32| width_m * (1u32 << level) as f32 <= max_block_m;
    let exact = error_px.is_nan() || error_px <= 0.0;
    let top = if exact { 0 } else { (0..=top_level(field)).rev().find(fits).unwrap_or(0) };
    let unit_m = if exact { 0.0 } else { errors.unit_m(focal_px, error_px) };
    Detail {
        eye_m: Vec2::new(eye_m.x, eye_m.z),
        above_m: (eye_m.y - lod.range_m()[1]).max(0.0),
        unit_m: unit_m.clamp(MIN_UNIT_CELLS * field.spacing_m, f32::MAX),
        top: top as f32,
    }
}

/// Replaces `blocks` by those to draw, those that `frustum` doesn't see left out; none is hidden by a later one.
pub fn select(lod: &TerrainLod, detail: &Detail, frustum: Option<&Frustum>, blocks: &mut Vec<Block>) {
    blocks.clear();
    Selection { lod, detail, frustum, blocks }.visit(Block { i: 0, j: 0, level: top_level(&lod.field) });
}

/// Triangles in blocks, those that have vanished included.
pub fn triangles(field: &Heightfield, blocks: &[Block]) -> u32 {
    blocks.len() as u32 * 2 * block_cells(field).pow(2)
}

/// Triangles of a block of `cells` × `cells` cells, counter-clockwise from above: vertex row·(cells+1) + column, with
/// diagonals that alternate as the bintree's do. `cells` is at most 254.
pub fn block_indices(cells: u32) -> Vec<u16> {
    let mut indices = Vec::with_capacity((6 * cells * cells) as usize);
    for row in 0..cells {
        for column in 0..cells {
            let north_west = (row * (cells + 1) + column) as u16;
            let (north_east, south_west) = (north_west + 1, north_west + cells as u16 + 1);
            let south_east = south_west + 1;
            indices.extend(if (row + column) & 1 == 0 {
                [north_west, south_west, south_east, north_west, south_east, north_east]
            } else {
                [north_west, south_west, north_east, south_west, south_east, north_east]
            });
        }
    }
    indices
}

struct Selection<'a> {
    lod: &'a TerrainLod,
    detail: &'a Detail,
    frustum: Option<&'a Frustum>,
    blocks: &'a mut Vec<Block>,
}

impl Selection<'_> {
    fn visit(&mut self, block: Block) {
        let size = block_cells(&self.lod.field) << block.level;
        let (low_m, high_m) = self.bounds_m(block, size);
        if self.frustum.is_some_and(|frustum| !frustum.sees_box(low_m, high_m)) {
            return;
        }
        if block.level == 0 || self.is_far_enough(block.level, low_m, high_m) {
            self.blocks.push(block);
            return;
        }
        // The nearest first, so that what it hides costs no light.
        let (middle_m, eye_m) = (0.5 * (low_m + high_m), self.detail.eye_m);
        let nearest = u32::from(eye_m.x > middle_m.x) | u32::from(eye_m.y > middle_m.z) << 1;
        for quarter in (0..4).map(|turn| nearest ^ turn) {
            let (i, j) = (block.i + (quarter & 1) * size / 2, block.j + (quarter >> 1) * size / 2);
            self.visit(Block { i, j, level: block.level - 1 });
        }
    }

    /// Whether λ ≥ `level` all over a square.
    fn is_far_enough(&self, level: u32, low_m: Vec3, high_m: Vec3) -> bool {
        let eye_m = self.detail.eye_m;
        let nearest_m = eye_m.clamp(Vec2::new(low_m.x, low_m.z), Vec2::new(high_m.x, high_m.z));
        let from_m = self.detail.unit_m * (1u32 << level) as f32;
        level as f32 <= self.detail.top && self.detail.distance_squared_m2(nearest_m) >= from_m * from_m
    }

    /// The box of what may be drawn of a block of `size` cells.
    fn bounds_m(&self, block: Block, size: u32) -> (Vec3, Vec3) {
        let field = &self.lod.field;
        let across = (field.side - 1) / size;
        let before = (across as usize * across as usize - 1) / 3;
        let number = before + (block.j / size * across + block.i / size) as usize;
        let [lowest_m, highest_m] =
            self.lod.block_ranges_m.get(number).copied().unwrap_or(self.lod.range_m());
        let corner = |i, height_m, j| Vec3::new(field.place_m(i), height_m, field.place_m(j));
        (corner(block.i, lowest_m, block.j), corner(block.i + size, highest_m, block.j + size))
    }
}

/// The root mean square of the distances between the land and its uniform triangulation of a level. `drawn_m`:
/// room to work in.
fn uniform_error_m(field: &Heightfield, level: u32, drawn_m: &mut Vec<f32>) -> f32 {
    drawn_m.clear();
    drawn_m.extend_from_slice(&field.heights_m);
    let mut sum_m2 = 0.0f64;
    for finer in (0..level).rev() {
        let step = 1u32 << finer;
        for j in (0..field.side).step_by(step as usize) {
            // Samples of this very level: all in an odd row, every other in an even one.
            let (first, by) = if j & step == 0 { (step, 2 * step) } else { (0, step) };
            for i in (first..field.side).step_by(by as usize) {
                let entry = |[i, j]: [u32; 2]| (j * field.side + i) as usize;
                let [a, b] = parents([i, j]);
                let here = entry([i, j]);
                drawn_m[here] = 0.5 * (drawn_m[entry(a)] + drawn_m[entry(b)]);
                let off_m = f64::from(drawn_m[here] - field.heights_m[here]);
                sum_m2 += off_m * off_m;
            }
        }
    }
    (sum_m2 / field.heights_m.len() as f64).sqrt() as f32
}
