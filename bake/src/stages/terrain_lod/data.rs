//! Heightfield → wedgies and block height ranges (thesis 3.2.1 and 3.2.2), in metres.
//!
//! Wedgies after Duchaineau et al., "ROAMing terrain" (1997), equation 1; displacements after Vlietinck,
//! "Trilinear displacement mapping of a flat surface with a v1.1 vertex shader" (2003).

use std::sync::Arc;

use genescape_schema::scene::bintree::parents;

use crate::model::{Heightfield, TerrainLod};
use crate::raster::square;

/// What the run-time levels of detail of a heightfield of (2^k+1)² samples, k ≥ 1, need.
pub fn lod(field: &Heightfield) -> TerrainLod {
    let displacements_m = displacements_m(field);
    // A wedgie's half thickness is its triangle's own deviation and the greatest among its halves'.
    let wedgies_m = nested(field.side, &displacements_m, |deviation, below| deviation + below);
    TerrainLod {
        wedgies_m,
        block_ranges_m: block_ranges(field, &displacements_m),
        field: Arc::new(field.clone()),
    }
}

/// ½(h(a) + h(b)) − h in metres for each sample with parents a and b: from the sample to its place in the uniform
/// triangulation of the next level, diagonals alternating as in the bintree. 0 for the four corners.
pub(super) fn displacements_m(field: &Heightfield) -> Vec<f32> {
    let last = field.side - 1;
    square(field.side as usize, |i, j| {
        let (i, j) = (i as u32, j as u32);
        if i % last == 0 && j % last == 0 {
            return 0.0;
        }
        let [a, b] = parents([i, j]);
        0.5 * (field.at(a[0], a[1]) + field.at(b[0], b[1])) - field.at(i, j)
    })
}

/// Per splitting sample, `combine(|displacement|, greatest value among the samples that split the halves)`. The
/// corners, which split nothing, hold the value of the whole field.
pub(super) fn nested(side: u32, displacements_m: &[f32], combine: impl Fn(f32, f32) -> f32) -> Vec<f32> {
    let (n, last) = (side as usize, side as usize - 1);
    let mut values: Vec<f32> = displacements_m.iter().map(|d| d.abs()).collect();
    let mut step = 1;
    while step < last {
        for j in (0..n).step_by(step) {
            // The middles of edges: j an odd multiple of step and i an even one, or the other way round.
            let first = if (j / step) % 2 == 0 { step } else { 0 };
            for i in (first..n).step_by(2 * step) {
                let below = if step > 1 { greatest_around(&values, n, i, j, step / 2, true) } else { 0.0 };
                values[j * n + i] = combine(values[j * n + i], below);
            }
        }
        for j in (step..n).step_by(2 * step) {
            for i in (step..n).step_by(2 * step) {
                let below = greatest_around(&values, n, i, j, step, false);
                values[j * n + i] = combine(values[j * n + i], below);
            }
        }
        step *= 2;
    }
    let whole = values[last / 2 * n + last / 2];
    for corner in [0, last, last * n, last * n + last] {
        values[corner] = whole;
    }
    values
}

/// The greatest of the four values at distance `by`, diagonally or along the axes, that lie in the field.
#[inline]
fn greatest_around(values: &[f32], n: usize, i: usize, j: usize, by: usize, diagonal: bool) -> f32 {
    let (west, east) = (i.checked_sub(by), (i + by < n).then_some(i + by));
    let (north, south) = (j.checked_sub(by), (j + by < n).then_some(j + by));
    let at = |i: Option<usize>, j: Option<usize>| i.zip(j).map_or(0.0, |(i, j)| values[j * n + i]);
    let four = if diagonal {
        [at(west, north), at(east, north), at(west, south), at(east, south)]
    } else {
        [at(west, Some(j)), at(east, Some(j)), at(Some(i), north), at(Some(i), south)]
    };
    four[0].max(four[1]).max(four[2].max(four[3]))
}

/// Ranges of all blocks, coarsest first; each block counts its border, and its corners also as morphed.
fn block_ranges(field: &Heightfield, displacements_m: &[f32]) -> Vec<[f32; 2]> {
    let across = (field.side as usize - 1) / 2;
    let mut pyramid = vec![square(across, |i, j| cells_range(field, displacements_m, 2 * i, 2 * j))];
    let mut across = across / 2;
    while across > 0 {
        let fine = &pyramid[pyramid.len() - 1];
        let pair = |i: usize, j: usize| union(fine[j * 2 * across + i], fine[j * 2 * across + i + 1]);
        pyramid.push(square(across, |i, j| union(pair(2 * i, 2 * j), pair(2 * i, 2 * j + 1))));
        across /= 2;
    }
    pyramid.into_iter().rev().flatten().collect()
}

/// The range of 2×2 cells from sample (i, j): nine samples, and the four corners fully displaced. The other five
/// move between these when displaced.
fn cells_range(field: &Heightfield, displacements_m: &[f32], i: usize, j: usize) -> [f32; 2] {
    let side = field.side as usize;
    let mut range = [f32::MAX, f32::MIN];
    for z in j..=j + 2 {
        for x in i..=i + 2 {
            let height = field.heights_m[z * side + x];
            range = union(range, [height, height]);
            if (x | z) & 1 == 0 {
                let moved = height + displacements_m[z * side + x];
                range = union(range, [moved, moved]);
            }
        }
    }
    range
}

fn union(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}
