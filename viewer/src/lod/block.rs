//! A heightfield → the blocks that it is drawn in: squares of 8 × 8 cells of each level's width, all with the same triangles.

use crate::scene::Heightfield;

/// log₂ of a block's cells a side.
pub const BLOCK_BITS: u32 = 3;

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

/// The coarsest level of a block: the whole field is one then.
pub fn top_level(field: &Heightfield) -> u32 {
    field.depth().saturating_sub(BLOCK_BITS)
}

/// Cells a side of every block: 8, or fewer if the whole field has fewer.
pub fn block_cells(field: &Heightfield) -> u32 {
    (field.side - 1).min(1 << BLOCK_BITS)
}

/// The place of a block in lists that have the coarsest first, then those of each finer level row by row, for a field of
/// `cells` a side, `block_cells` of them in a block.
pub fn block_number(cells: u32, block_cells: u32, block: Block) -> usize {
    let size = block_cells << block.level;
    let across = cells / size;
    let before = (across as usize * across as usize - 1) / 3;
    before + (block.j / size * across + block.i / size) as usize
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
