//! Constants → a tiling volume of billows for clouds: inverted cellular noise (Worley 1996) summed over three sizes,
//! as in Schneider, "The Real-time Volumetric Cloudscapes of Horizon Zero Dawn" (2015). Values lie in [0, 1]: 1 in
//! the middle of a billow, 0 in the creases between.

use std::sync::LazyLock;

use crate::math::{lerp, split};
use crate::noise::hash;

use super::math::range;

/// The one volume there is: a constant, but one that is computed rather than stored.
pub static BILLOWS: LazyLock<Billows> = LazyLock::new(Billows::new);

/// Voxels a side; a power of two.
pub const SIDE: usize = 64;
const MASK: i32 = SIDE as i32 - 1;

/// A tiling cube of SIDE³ bytes.
pub struct Billows {
    voxels: Vec<u8>,
}

impl Billows {
    fn new() -> Self {
        let mut sum = vec![0.0f32; SIDE * SIDE * SIDE];
        for (octave, (cells, weight)) in [(4, 0.6), (8, 0.27), (16, 0.13)].into_iter().enumerate() {
            add_cells(&mut sum, 0x51AB + octave as u32, cells, weight);
        }
        let (low, high) = range(&sum);
        let scale = 255.0 / (high - low);
        Self { voxels: sum.iter().map(|v| ((v - low) * scale + 0.5) as u8).collect() }
    }

    /// The value at a point in units of the whole tile, interpolated.
    #[inline]
    pub fn sample(&self, x: f32, y: f32, z: f32) -> f32 {
        let (x, y, z) = (x * SIDE as f32, y * SIDE as f32, z * SIDE as f32);
        let ((ix, dx), (iy, dy), (iz, dz)) = (split(x), split(y), split(z));
        let (x0, x1) = ((ix & MASK) as usize, ((ix + 1) & MASK) as usize);
        let (y0, y1) = ((iy & MASK) as usize * SIDE, ((iy + 1) & MASK) as usize * SIDE);
        let (z0, z1) = ((iz & MASK) as usize * SIDE * SIDE, ((iz + 1) & MASK) as usize * SIDE * SIDE);
        let voxels = &self.voxels[..SIDE * SIDE * SIDE];
        let row = |base: usize| lerp(f32::from(voxels[base + x0]), f32::from(voxels[base + x1]), dx);
        let layer = |z: usize| lerp(row(z + y0), row(z + y1), dy);
        lerp(layer(z0), layer(z1), dz) * (1.0 / 255.0)
    }
}

/// Adds weight × (1 − distance to the nearest of one point a cell), with `cells` cells a side.
fn add_cells(sum: &mut [f32], seed: u32, cells: i32, weight: f32) {
    let side = SIDE / cells as usize;
    let size = side as f32;
    let mut nearest = vec![0.0f32; side * side * side];
    for cell in 0..cells * cells * cells {
        let cell = [cell % cells, cell / cells % cells, cell / (cells * cells)];
        nearest.fill(f32::MAX);
        for point in neighbours(seed, cells, cell) {
            splat(&mut nearest, side, point.map(|p| p * size));
        }
        let [x0, y0, z0] = cell.map(|c| c as usize * side);
        for (i, squared) in nearest.iter().enumerate() {
            let (x, y, z) = (x0 + i % side, y0 + i / side % side, z0 + i / (side * side));
            sum[(z * SIDE + y) * SIDE + x] += weight * (1.0 - (squared.sqrt() / size).min(1.0));
        }
    }
}

/// The 27 feature points around a cell, relative to its corner, in cells.
fn neighbours(seed: u32, cells: i32, cell: [i32; 3]) -> [[f32; 3]; 27] {
    let mut points = [[0.0; 3]; 27];
    for (i, point) in points.iter_mut().enumerate() {
        let offset = [i as i32 % 3 - 1, i as i32 / 3 % 3 - 1, i as i32 / 9 - 1];
        let at = [0, 1, 2].map(|axis: usize| (cell[axis] + offset[axis]).rem_euclid(cells));
        let h = hash(seed, at[0], at[1], at[2]);
        *point =
            [0, 1, 2].map(|axis: usize| offset[axis] as f32 + ((h >> (10 * axis)) & 1023) as f32 / 1024.0);
    }
    points
}

/// Lowers each voxel's squared distance to that from one point.
fn splat(nearest: &mut [f32], side: usize, point: [f32; 3]) {
    for (row, voxels) in nearest.chunks_exact_mut(side).enumerate() {
        let dy = (row % side) as f32 + 0.5 - point[1];
        let dz = (row / side) as f32 + 0.5 - point[2];
        let off_axis = dy * dy + dz * dz;
        for (x, voxel) in voxels.iter_mut().enumerate() {
            let dx = x as f32 + 0.5 - point[0];
            *voxel = voxel.min(dx * dx + off_axis);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_without_a_seam_and_spans_its_range() {
        let billows = Billows::new();
        let (mut low, mut high) = (1.0f32, 0.0f32);
        for i in 0..4000 {
            let p = [0.371, 0.713, 0.127].map(|k: f32| (i as f32 * k).fract());
            let here = billows.sample(p[0], p[1], p[2]);
            let there = billows.sample(p[0] - 1.0, p[1] + 2.0, p[2] + 1.0);
            assert!((here - there).abs() < 2e-3);
            let step = billows.sample(p[0] + 1.0 / 512.0, p[1], p[2]);
            assert!((here - step).abs() < 0.06, "jumps at {p:?}");
            (low, high) = (low.min(here), high.max(here));
        }
        assert!(low < 0.15 && high > 0.8, "{low} {high}");
    }
}
