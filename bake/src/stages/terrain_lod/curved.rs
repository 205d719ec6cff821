//! The apron's samples → heights and normals between them, and how finely each of its edges is cut. Samples are so far apart
//! that hills next to the field would be pyramids.
//!
//! Between samples the land is Catmull and Rom's bicubic surface (1974), which goes through all of them. Along a line of
//! samples it depends on this line alone, so that both cells of an edge see the same.

use std::array::from_fn;

use glam::Vec3;

use crate::math::lerp;
use crate::model::{Heightfield, Landform};

/// The most parts into which an edge is cut: a power of two.
pub(super) const PARTS: u32 = 4;

/// A chord of an edge may be off by so many metres for each metre that the edge is away from the field: at 1080p, about
/// two pixels.
const OFF: f32 = 0.002;
/// Whoever looks at an edge is so many metres farther away than the field's border.
const BACK_M: f32 = 150.0;
/// Land rises so many metres above the water where its edges are cut: beside it, a curve might dip below.
const ABOVE_WATER_M: f32 = 1.5;

/// A place in parts of the apron's cells: a sample where both are multiples of [`PARTS`].
pub(super) type Fine = [u32; 2];

pub(super) struct Curved<'a> {
    apron: &'a Heightfield,
    /// Half of the field's width.
    half_m: f32,
    /// Below it, land is as its samples are.
    dry_m: f32,
}

impl<'a> Curved<'a> {
    pub fn of(land: &'a Landform) -> Self {
        let dry_m = land.water_level_m.map_or(f32::MIN, |level_m| level_m + ABOVE_WATER_M);
        Self { apron: &land.apron, half_m: 0.5 * land.field.extent_m(), dry_m }
    }

    /// Into how many equal parts the edge from a sample to the next along x (0) or z (1) is cut.
    pub fn parts(&self, [i, j]: [u32; 2], axis: usize) -> u32 {
        let heights_m: [f32; 4] = match axis {
            0 => from_fn(|k| self.apron.at(self.line(i, k), j)),
            _ => from_fn(|k| self.apron.at(i, self.line(j, k))),
        };
        let middle_m = cubic(heights_m, 0.5);
        if heights_m[1].min(heights_m[2]).min(middle_m) < self.dry_m {
            return 1;
        }
        let off_m = (middle_m - 0.5 * (heights_m[1] + heights_m[2])).abs();
        let place_m = |line: u32| (self.apron.place_m(line).abs() - self.half_m).max(0.0);
        let allowed_m = OFF * (place_m(i).max(place_m(j)) + BACK_M);
        // A parabola's chords are off by a quarter if they are half as long.
        match off_m / allowed_m {
            off if off > 4.0 => PARTS,
            off if off > 1.0 => PARTS / 2,
            _ => 1,
        }
    }

    /// Position and normal.
    pub fn vertex(&self, fine: Fine) -> ([f32; 3], [f32; 3]) {
        let [(i, u), (j, v)] = fine.map(|along| (along / PARTS, (along % PARTS) as f32 / PARTS as f32));
        let rows: [[f32; 4]; 4] =
            from_fn(|row| from_fn(|column| self.apron.at(self.line(i, column), self.line(j, row))));
        let across = rows.map(|row| cubic(row, u));
        let east = cubic(rows.map(|row| slope(row, u)), v) / self.apron.spacing_m;
        let south = slope(across, v) / self.apron.spacing_m;
        let (height_m, normal) = (cubic(across, v), Vec3::new(-east, 1.0, -south).normalize());
        let place_m =
            |along: u32, part: f32| lerp(self.apron.place_m(along), self.apron.place_m(along + 1), part);
        ([place_m(i, u), height_m, place_m(j, v)], normal.to_array())
    }

    /// The kth of four lines of samples, of which the second is this one; beyond the last is the last.
    fn line(&self, line: u32, k: usize) -> u32 {
        (line + k as u32).saturating_sub(1).min(self.apron.side - 1)
    }
}

/// Catmull and Rom's curve from the second of four heights to the third.
fn cubic([a, b, c, d]: [f32; 4], t: f32) -> f32 {
    b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)))
}

/// Its derivative.
fn slope([a, b, c, d]: [f32; 4], t: f32) -> f32 {
    0.5 * (c - a) + t * (2.0 * a - 5.0 * b + 4.0 * c - d + 1.5 * t * (3.0 * (b - c) + d - a))
}
