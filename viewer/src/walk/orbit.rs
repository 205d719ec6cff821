//! Orbiting: the eye on a sphere around a point on the ground, always looking down at it. The point's x and z are the
//! same in all views, its y is each landscape's own ground; so the eye's x and z are the same too, and its height above
//! the point. Where a hill would swallow the eye, that view's eye alone is lifted onto it and then sees the point a
//! little lower in its picture, because all views share the pitch.

use glam::Vec2;

use super::{Land, Pose, within};
use crate::input::Controls;

/// Distance from the point.
const MIN_DISTANCE_M: f32 = 2.0;
const MAX_DISTANCE_M: f32 = 5000.0;
/// The pitch of an orbit stays below this: looking along the ground or up, the circle would lie in the ground.
const MAX_PITCH_RAD: f32 = -4.0 * std::f32::consts::PI / 180.0;
/// An orbit that begins looks down at least this much, from at least this far.
const BEGIN_RAD: f32 = -12.0 * std::f32::consts::PI / 180.0;
const BEGIN_M: f32 = 15.0;
/// One line of the wheel, as a factor on the distance.
const WHEEL: f32 = 0.85;
/// Keys for up and down: factor e^(this) a second.
const ZOOM_PER_S: f32 = 1.2;
/// The point moves over the ground at this part of the distance a second.
const PAN_PER_S: f32 = 0.5;

/// A distance within its range.
pub(super) fn distance(wanted_m: f32) -> f32 {
    wanted_m.clamp(MIN_DISTANCE_M, MAX_DISTANCE_M)
}

/// The point that a pose looks at; the pose is put on the circle around it.
pub(super) fn aim(pose: &mut Pose, lands: &[&Land]) -> Vec2 {
    pose.pitch_rad = pose.pitch_rad.min(MAX_PITCH_RAD);
    let target_m = within(lands, pose.place_m() + offset_m(pose));
    circle(pose, target_m);
    target_m
}

/// Begins to circle what the eye looks at from where it is. `heights_m`: the eyes' heights so far, one a landscape.
pub(super) fn begin(pose: &mut Pose, lands: &[&Land], heights_m: &[f32]) -> Vec2 {
    let place_m = pose.place_m();
    let above = |(land, height_m): (&&Land, &f32)| height_m - land.ground_m(place_m);
    let mean_m = lands.iter().zip(heights_m).map(above).sum::<f32>() / lands.len().max(1) as f32;
    pose.pitch_rad = pose.pitch_rad.min(BEGIN_RAD);
    pose.distance_m = distance((mean_m / libm::sinf(-pose.pitch_rad)).max(BEGIN_M));
    // Nearer if the land ends first, so that the eye stays where it is.
    let target_m = place_m + offset_m(pose);
    let edge_m = within(lands, target_m);
    if edge_m != target_m {
        let level_m = place_m.distance(target_m) - edge_m.distance(target_m);
        pose.distance_m = distance(level_m / libm::cosf(pose.pitch_rad));
    }
    aim(pose, lands)
}

/// Nearer or farther by wheel and keys.
pub(super) fn zoom(pose: &mut Pose, controls: &Controls, dt_s: f32) {
    let factor = libm::powf(WHEEL, controls.wheel) * libm::expf(controls.up * ZOOM_PER_S * dt_s);
    if factor.is_finite() {
        pose.distance_m = distance(pose.distance_m * factor);
    }
}

/// Speed in m/s at which the point moves: what is seen from far moves faster.
pub(super) fn speed_mps(pose: &Pose, walk_mps: f32) -> f32 {
    walk_mps.max(PAN_PER_S * pose.distance_m)
}

/// Puts the eye where it looks at the point from the wished distance.
pub(super) fn circle(pose: &mut Pose, target_m: Vec2) {
    pose.pitch_rad = pose.pitch_rad.min(MAX_PITCH_RAD);
    pose.put(target_m - offset_m(pose));
}

/// Height of the eye in one landscape, in metres.
pub(super) fn height_m(pose: &Pose, target_m: Vec2, land: &Land) -> f32 {
    let circle_m = land.ground_m(target_m) - pose.distance_m * libm::sinf(pose.pitch_rad);
    circle_m.max(land.floor_m(pose.place_m()))
}

/// From eye to point, on the (x, z) plane.
fn offset_m(pose: &Pose) -> Vec2 {
    pose.ahead() * (pose.distance_m * libm::cosf(pose.pitch_rad))
}
