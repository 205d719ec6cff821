//! Coarse land around the field → how much of the sun it leaves to what lies or stands on it, of which the light map doesn't tell.
//!
//! From a place a ray goes towards the sun over the land; the steepest slope up to what it passes is the horizon.

use glam::{Vec2, Vec3, Vec3Swizzles};

use crate::scene::{Apron, Heightfield};

/// Metres from height to height, as far as the apron's samples are apart.
const CELL_M: f32 = 64.0;
/// Metres from step to step of a ray: fewer, so that none passes a ridge's edge unseen; far away as many as are this part of the way.
const STEP_M: f32 = 0.5 * CELL_M;
const STEP: f32 = 1.0 / 32.0;
/// No land is looked for farther away than this.
const REACH_M: f32 = 8_000.0;
/// From so far below the horizon up to as far above it, as slopes, more and more of the sun is seen: several times as much as its disc
/// covers, for between vertices so far apart a sharper edge would be jagged.
const SOFTNESS: f32 = 0.03;

/// Height of land that nobody knows.
const UNKNOWN_M: f32 = -1e6;

/// The sun over a land.
pub struct FarSun {
    /// Mean heights of square cells, row by row from the north-west.
    heights_m: Vec<f32>,
    /// Cells a side.
    across: usize,
    /// Half the width of the field.
    field_half_m: f32,
    /// Metres from the middle of the land to that of the first cell, along x and z.
    half_m: f32,
    /// Height of the highest cell.
    top_m: f32,
    /// In plan towards the sun, of unit length.
    towards: Vec2,
    /// By how much the sun's rays rise in a metre; not above 0 if it is down.
    rise: f32,
}

impl FarSun {
    /// For a sun in that direction, of unit length.
    pub fn of(field: &Heightfield, apron: &Apron, sun: Vec3) -> Self {
        let places_m = || apron.positions_m.iter().map(|&place_m| Vec3::from(place_m));
        let farthest_m = places_m().map(|p| p.xz().abs().max_element()).fold(0.0, f32::max).min(REACH_M);
        let side = (farthest_m / CELL_M).ceil();
        let (across, half_m) = (2 * side as usize + 1, side * CELL_M);
        let mut sums = vec![Vec2::ZERO; across * across];
        let cell = |place_m: Vec2| {
            let [column, row] = ((place_m + half_m) / CELL_M).round().to_array();
            let is_inside = column.min(row) >= 0.0 && column.max(row) < across as f32;
            is_inside.then_some(row as usize * across + column as usize)
        };
        for place_m in places_m() {
            if let Some(cell) = cell(place_m.xz()) {
                sums[cell] += Vec2::new(place_m.y, 1.0);
            }
        }
        let field_half_m = 0.5 * field.extent_m();
        let height_m = |(n, sum): (usize, &Vec2)| {
            let middle_m = Vec2::new((n % across) as f32, (n / across) as f32) * CELL_M - half_m;
            match middle_m.abs().max_element() < field_half_m {
                true => field.height_m(middle_m.x, middle_m.y),
                false if sum.y > 0.0 => sum.x / sum.y,
                false => UNKNOWN_M,
            }
        };
        let heights_m: Vec<f32> = sums.iter().enumerate().map(height_m).collect();
        let top_m = heights_m.iter().copied().fold(UNKNOWN_M, f32::max);
        let level = sun.xz().length().max(1e-3);
        let (towards, rise) = (sun.xz() / level, sun.y / level);
        Self { heights_m, across, field_half_m, half_m, top_m, towards, rise }
    }

    /// The share that is left at a place, in [0, 1]; 1 within the field.
    pub fn left(&self, place_m: Vec3) -> f32 {
        if place_m.xz().abs().max_element() < self.field_half_m {
            return 1.0;
        }
        let (mut away_m, mut horizon) = (CELL_M, f32::NEG_INFINITY);
        while away_m < REACH_M && place_m.y + (self.rise - SOFTNESS) * away_m < self.top_m {
            let Some(height_m) = self.height_m(place_m.xz() + away_m * self.towards) else { break };
            horizon = horizon.max((height_m - place_m.y) / away_m);
            away_m += STEP_M.max(STEP * away_m);
        }
        let seen = ((self.rise - horizon) / (2.0 * SOFTNESS) + 0.5).clamp(0.0, 1.0);
        seen * seen * (3.0 - 2.0 * seen)
    }

    /// Bilinear; far below all land where some of it is unknown, and `None` beyond the last cells.
    fn height_m(&self, place_m: Vec2) -> Option<f32> {
        let at = (place_m + self.half_m) / CELL_M;
        let last = self.across as f32 - 1.0;
        if !(at.min_element() >= 0.0 && at.max_element() < last) {
            return None;
        }
        let (first, part) = (at.floor(), at.fract());
        let north_west = first.y as usize * self.across + first.x as usize;
        let along = |west: usize| {
            let [west_m, east_m] = [west, west + 1].map(|cell| self.heights_m[cell]);
            west_m + (east_m - west_m) * part.x
        };
        let (north_m, south_m) = (along(north_west), along(north_west + self.across));
        Some(north_m + (south_m - north_m) * part.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF_M: f32 = 2000.0;

    /// Level land with a ridge along z, 100 m high and 400 m wide, whose middle is at that x; nothing of it is in the field.
    fn ridge(x_m: f32) -> (Heightfield, Apron) {
        let height_m = |x: f32| (100.0 - 0.5 * (x - x_m).abs()).max(0.0);
        let lines = || (0..=125).map(|k| 32.0 * k as f32 - HALF_M);
        let positions_m: Vec<[f32; 3]> =
            lines().flat_map(|z| lines().map(move |x| [x, height_m(x), z])).collect();
        let field = Heightfield { side: 3, spacing_m: 64.0, heights_m: vec![0.0; 9] };
        let normals = vec![[0.0, 1.0, 0.0]; positions_m.len()];
        (field, Apron { positions_m, normals, ..Apron::default() })
    }

    #[test]
    fn a_ridge_throws_its_shadow_as_far_as_the_sun_is_low() {
        let (field, apron) = ridge(600.0);
        for rise in [0.1f32, 0.15, 0.25] {
            let sun = FarSun::of(&field, &apron, Vec3::new(1.0, rise, 0.0).normalize());
            let left = |x: f32| sun.left(Vec3::new(x, 0.0, 150.0));
            let shadow_m = 100.0 / rise;
            assert!(left(600.0 - 0.75 * shadow_m) < 0.25, "{rise}: it is dark behind the ridge");
            assert!(left(600.0 - 1.4 * shadow_m - 100.0) > 0.9, "{rise}: it is bright farther away");
            assert!(left(900.0) > 0.99, "{rise}: it is bright before the ridge");
        }
    }

    #[test]
    fn it_grows_steadily_from_dark_to_bright_and_no_number_is_too_wild() {
        let (field, apron) = ridge(600.0);
        let sun = FarSun::of(&field, &apron, Vec3::new(1.0, 0.2, 0.0).normalize());
        let along: Vec<f32> =
            (0..60).map(|k| sun.left(Vec3::new(450.0 - 10.0 * k as f32, 0.0, 0.0))).collect();
        assert!(along.windows(2).all(|pair| (-0.1..0.35).contains(&(pair[1] - pair[0]))), "{along:?}");
        for wild in [f32::NAN, f32::INFINITY, 1e30, -1e30] {
            assert!((0.0..=1.0).contains(&sun.left(Vec3::new(wild, wild, 0.0))), "{wild}");
        }
        let nothing = FarSun::of(&field, &Apron::default(), Vec3::Y);
        assert_eq!(nothing.left(Vec3::new(500.0, 0.0, 0.0)), 1.0);
    }
}
