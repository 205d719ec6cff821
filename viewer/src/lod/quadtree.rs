//! A view of a heightfield → the blocks to draw, all by one instanced draw (thesis 3.2, the vertex-program algorithm).
//! Metres, pixels.
//!
//! A block of level i is 8 × 8 cells of 2^i samples' distance, whatever i; its vertices move by [`super::morph`]. It is
//! drawn if D ≥ 2^i·d₀, so λ ≥ i, all over its closed square; else its four quarters are looked at. Then:
//! - *λ ≤ i+2 in it.* Its parent of level i+1 ≤ top was refused, so the least D in the parent's square is less than 2^(i+1)·d₀.
//!   Across the parent's diagonal, 16√2·2^i cells, D changes by at most that, so at each point of the block
//!   D < 2^(i+1)·d₀ + 16√2·2^i cells ≤ 2^(i+2)·d₀. And where there is no parent (top), λ ≤ top = i.
//! - *It draws what is within it.* A vertex of level < i+3 has its parents in the block's closed square; the corners'
//!   levels are ≥ i+3 > λ, they stand.
//! - *Neighbours fit.* On the edge shared with a block of level j > i, λ ≥ j. So vertices of levels < j have arrived at
//!   their parents, which lie on the edge as well, and both blocks draw the same points.
//! - *No pop.* When a block gives way to its quarters, or they to it, λ ≥ i all over it, and their vertices of level i−1 sit
//!   on their parents.

use glam::{Vec2, Vec3};

use super::block::{Block, block_cells, block_indices, block_number, top_level};
use super::morph::{Detail, unit_m};
use crate::camera::Frustum;
use crate::scene::{Heightfield, TerrainLod};

/// What λ depends on for a view from `eye_m`; `levels_m` and `pixels` as [`unit_m`] has them. `exact`: every sample is drawn; `max_block_m`: no block is wider, so that
/// enough can be culled.
pub fn detail(
    lod: &TerrainLod,
    levels_m: &[f32],
    pixels: f32,
    eye_m: Vec3,
    exact: bool,
    max_block_m: f32,
) -> Detail {
    let field = &lod.field;
    let width_m = block_cells(field) as f32 * field.spacing_m;
    let fits = |level: &u32| width_m * (1u32 << level) as f32 <= max_block_m;
    let top = if exact { 0 } else { (0..=top_level(field)).rev().find(fits).unwrap_or(0) };
    Detail {
        eye_m: Vec2::new(eye_m.x, eye_m.z),
        above_m: (eye_m.y - lod.range_m()[1]).max(0.0),
        unit_m: unit_m(field, levels_m, pixels),
        pixels,
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

/// Where the shader draws the corners of blocks' triangles, those that have vanished included.
pub fn drawn(field: &Heightfield, detail: &Detail, blocks: &[Block]) -> Vec<[Vec3; 3]> {
    let cells = block_cells(field);
    let indices = block_indices(cells);
    let of_block = |block: &Block| {
        let vertex = |number: u32| {
            let (column, row) = (number % (cells + 1), number / (cells + 1));
            detail.drawn_m(field, [block.i + (column << block.level), block.j + (row << block.level)])
        };
        let vertices: Vec<Vec3> = (0..(cells + 1) * (cells + 1)).map(vertex).collect();
        let corners = indices.as_chunks::<3>().0.iter();
        corners.map(|all| all.map(|corner| vertices[usize::from(corner)])).collect::<Vec<_>>()
    };
    blocks.iter().flat_map(of_block).collect()
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
        if block.level == 0 || self.is_far_enough(block, low_m, high_m) {
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

    /// Whether D ≥ 2^level·d₀ all over its square.
    fn is_far_enough(&self, block: Block, low_m: Vec3, high_m: Vec3) -> bool {
        let eye_m = self.detail.eye_m;
        let nearest_m = eye_m.clamp(Vec2::new(low_m.x, low_m.z), Vec2::new(high_m.x, high_m.z));
        let from_m = self.detail.from_m(block.level);
        block.level as f32 <= self.detail.top && self.detail.distance_squared_m2(nearest_m) >= from_m * from_m
    }

    /// The box of what may be drawn of a block of `size` cells.
    fn bounds_m(&self, block: Block, size: u32) -> (Vec3, Vec3) {
        let field = &self.lod.field;
        let number = block_number(field.side - 1, block_cells(field), block);
        let [lowest_m, highest_m] =
            self.lod.block_ranges_m.get(number).copied().unwrap_or(self.lod.range_m());
        let corner = |i, height_m, j| Vec3::new(field.place_m(i), height_m, field.place_m(j));
        (corner(block.i, lowest_m, block.j), corner(block.i + size, highest_m, block.j + size))
    }
}
