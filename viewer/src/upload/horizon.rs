//! What the land around an eye hides: how steep it looks in each direction, up to each distance.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3, Vec3Swizzles};

use crate::lod::nested::Sight;
use crate::scene::Heightfield;

/// Directions all around in which the land is looked at: at 500 m they are 12 m apart.
const RAYS: usize = 256;
/// Distances at which that is done: the first in metres, and the ratio of each to the one before. Between them land counts as low.
const FIRST_M: f32 = 2.0;
const RATIO: f32 = 1.05;
const STEPS: usize = 160;
/// By so much land counts as lower than it is drawn at least: between its samples it is not quite what triangles make of it.
const MARGIN_M: f32 = 0.3;

/// Of one eye; directions are looked at when they are first asked for.
#[derive(Debug)]
pub struct Horizon<'a> {
    field: &'a Heightfield,
    eye_m: Vec3,
    /// By how much the land may be off as it is drawn, and counts as lower.
    drawn: Sight,
    distances_m: [f32; STEPS],
    /// The steepest slope upwards from the eye to land up to each distance.
    rays: [Option<Box<[f32; STEPS]>>; RAYS],
}

impl<'a> Horizon<'a> {
    pub fn new(field: &'a Heightfield, eye_m: Vec3, drawn: Sight) -> Self {
        let mut next_m = FIRST_M / RATIO;
        let distances_m = std::array::from_fn(|_| {
            next_m *= RATIO;
            next_m
        });
        Self { field, eye_m, drawn, distances_m, rays: [const { None }; RAYS] }
    }

    /// True if land stands before all of a level rectangle between two corners (x and z, the lower coordinates first). False where
    /// that is not sure.
    pub fn hides(&mut self, low_m: Vec2, high_m: Vec2, level_m: f32) -> bool {
        let eye_m = self.eye_m.xz();
        let nearest_m = eye_m.clamp(low_m, high_m).distance(eye_m);
        if nearest_m < FIRST_M {
            return false;
        }
        let middle = 0.5 * (low_m + high_m) - eye_m;
        let corners = [low_m, Vec2::new(high_m.x, low_m.y), high_m, Vec2::new(low_m.x, high_m.y)];
        let ways = corners.map(|corner_m| corner_m - eye_m);
        let farthest_m = ways.iter().map(|way| way.length()).fold(nearest_m, f32::max);
        let turns = ways.map(|way| middle.angle_to(way));
        let ray = |turn: f32| (middle.to_angle() + turn) / TAU * RAYS as f32;
        let first = ray(turns.into_iter().fold(0.0, f32::min)).floor() as i32;
        let last = ray(turns.into_iter().fold(0.0, f32::max)).ceil() as i32;
        let upwards_m = level_m - self.eye_m.y;
        let steepest = (upwards_m / nearest_m).max(upwards_m / farthest_m);
        let before = self.distances_m.partition_point(|&distance_m| distance_m < nearest_m);
        (first..=last).all(|ray| {
            let slopes = self.ray(ray.rem_euclid(RAYS as i32) as usize);
            before.checked_sub(1).is_some_and(|step| slopes[step] > steepest)
        })
    }

    fn ray(&mut self, number: usize) -> &[f32; STEPS] {
        let (field, eye_m, drawn, distances_m) = (self.field, self.eye_m, self.drawn, &self.distances_m);
        self.rays[number].get_or_insert_with(|| {
            let way = Vec2::from_angle(number as f32 / RAYS as f32 * TAU);
            let half_m = 0.5 * field.extent_m();
            let mut steepest = f32::NEG_INFINITY;
            let slope = |distance_m: f32| {
                let place_m = eye_m.xz() + way * distance_m;
                if place_m.abs().max_element() < half_m {
                    let height_m = field.height_m(place_m.x, place_m.y);
                    let place_m = Vec3::new(place_m.x, height_m, place_m.y);
                    let lowest_m = height_m - MARGIN_M - place_m.distance(drawn.eye_m) / drawn.pixels;
                    steepest = steepest.max((lowest_m - eye_m.y) / distance_m);
                }
                steepest
            };
            Box::new(distances_m.map(slope))
        })
    }
}
