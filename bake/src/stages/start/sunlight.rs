//! Land and light → how much of the light on what is seen is the sun's, on open ground and on crowns, from coarse grids. A
//! low sun leaves much of a land in shade, and gives its colour to trees and to slopes that face it.

use glam::{Vec2, Vec3, Vec3Swizzles};

use crate::math::{cell, ramp};
use crate::model::{Heightfield, Landform, SkyLight};
use crate::raster::square;

/// Points along a side of the field's grid, and of the one around it.
const SIDES: [usize; 2] = [96, 48];
/// The way to the sun is asked at so many points, square numbers of times this many metres away: 1.6 km in all.
const STEPS: u32 = 20;
const STEP_M: f32 = 4.0;
/// Ground this far above a ray lets it pass: the grid's points are metres apart.
const TOLERANCE_M: f32 = 0.5;
/// Cosine of the angle to the sun at which crowns stand, on the mean; and slopes that are well lit.
const CROWN: f32 = 0.5;
const WELL: f32 = 0.7;

/// A picture that shows the sun on less of what is seen looks dull, and what it loses if it shows none.
const ENOUGH: f32 = 0.4;
const DULL: f32 = 0.5;

/// What the sun reaches; parts of the light are told as parts of [`Self::most`].
pub(super) struct Sunlight {
    field: Grid,
    apron: Grid,
    /// The sun's part of the light on crowns that it reaches.
    crown: f32,
    /// The sun's part of the light on a slope that is well lit, 0 … 1.
    most: f32,
}

/// A square around the middle.
struct Grid {
    side: usize,
    spacing_m: f32,
    points: Vec<Point>,
}

#[derive(Clone, Copy, bytemuck::Zeroable)]
struct Point {
    /// Height from which up the sun is seen.
    shade_m: f32,
    /// The sun's part of the light on the ground.
    ground: f32,
}

impl Sunlight {
    /// That of a land on which nothing is higher than `highest_m`.
    pub fn of(land: &Landform, highest_m: f32, light: &SkyLight) -> Self {
        let [sun, sky] = [light.sun_irradiance_linear, light.sky_irradiance_linear].map(luminance);
        let part = |cosine: f32| sun * cosine / (sun * cosine + sky).max(1e-6);
        let most = part(WELL);
        let of_most = |cosine: f32| (part(cosine.max(0.0)) / most.max(1e-6)).min(1.0);
        let grid = |side: usize, heights: &Heightfield| {
            let spacing_m = heights.extent_m() / (side - 1) as f32;
            let place_m = |line: usize| spacing_m * line as f32 - 0.5 * heights.extent_m();
            let point = |i: usize, j: usize| {
                let place = Vec2::new(place_m(i), place_m(j));
                let ground_m = land.height_m(place);
                let shade_m = shade_m(land, light.sun_direction, place, highest_m - ground_m);
                let is_lit = ground_m + TOLERANCE_M >= shade_m;
                let cosine = normal(land, place, spacing_m).dot(light.sun_direction);
                Point { shade_m, ground: if is_lit { of_most(cosine) } else { 0.0 } }
            };
            Grid { side, spacing_m, points: square(side, point) }
        };
        let [near, around] = SIDES;
        Self { field: grid(near, &land.field), apron: grid(around, &land.apron), crown: of_most(CROWN), most }
    }

    /// How good a picture is that shows so much of it, 0 … 1. Where the sun gives little of the light, nothing is missed.
    pub fn suits(&self, shown: f32) -> f32 {
        1.0 - DULL * ramp(0.05, 0.4, self.most) * ramp(ENOUGH, 0.05, shown)
    }

    /// On the ground there.
    pub fn on_ground(&self, place: Vec2) -> f32 {
        self.at(place).ground
    }

    /// On a crown there whose middle is as high.
    pub fn on_crown(&self, place: Vec2, middle_m: f32) -> f32 {
        if middle_m >= self.at(place).shade_m { self.crown } else { 0.0 }
    }

    fn at(&self, place: Vec2) -> Point {
        let is_near = place.abs().max_element() <= 0.5 * self.field.extent_m();
        if is_near { self.field.at(place) } else { self.apron.at(place) }
    }
}

impl Grid {
    fn extent_m(&self) -> f32 {
        self.spacing_m * (self.side - 1) as f32
    }

    fn at(&self, place: Vec2) -> Point {
        let line = |along_m: f32| {
            let (line, part) = cell(along_m / self.spacing_m + 0.5 * (self.side - 1) as f32, self.side);
            line + usize::from(part >= 0.5)
        };
        self.points[line(place.y) * self.side + line(place.x)]
    }
}

/// Height above a place from which up no land hides the sun; nothing rises higher than `rise_m` above the ground there.
fn shade_m(land: &Landform, sun: Vec3, place: Vec2, rise_m: f32) -> f32 {
    let ways_m = (1..=STEPS).map(|step| STEP_M * (step * step) as f32);
    let below_highest = ways_m.take_while(|way_m| way_m * sun.y < rise_m);
    let shade_m = |way_m: f32| land.height_m(place + way_m * sun.xz()) - way_m * sun.y;
    below_highest.map(shade_m).fold(f32::MIN, f32::max)
}

/// Unit normal of the land over that many metres.
fn normal(land: &Landform, place: Vec2, across_m: f32) -> Vec3 {
    let fall = |step: Vec2| land.height_m(place - step) - land.height_m(place + step);
    let half = 0.5 * across_m;
    Vec3::new(fall(half * Vec2::X), across_m, fall(half * Vec2::Y)).normalize()
}

/// Of linear sRGB.
pub(super) fn luminance([r, g, b]: [f32; 3]) -> f32 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}
