//! Orbiting: the eye on a sphere around a point on the ground, always looking down at it. The point's x and z are the
//! same in all views, its y is each landscape's own ground; so the eye's x and z are the same too, and its height above
//! the point. Where a hill would swallow the eye, that view's eye alone is lifted onto it and then sees the point a
//! little lower in its picture, because all views share the pitch.
//!
//! Around a [`Subject`], anyone's file that stands alone, the point is in the air, and the eye is wherever it is wanted.

use glam::{Vec2, Vec3, Vec3Swizzles};

use super::{Land, Pose, Subject, within};
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

/// Of the distance from a subject's middle, in its radii.
const SUBJECT_RADII: [f32; 2] = [0.02, 30.0];
/// No eye comes nearer to a point: the near plane would cut it.
const NEAREST_M: f32 = 0.15;

fn subject<'a>(lands: &[&'a Land]) -> Option<&'a Subject> {
    lands.iter().find_map(|land| land.subject.as_ref())
}

/// A distance within its range.
pub(super) fn distance(wanted_m: f32, lands: &[&Land]) -> f32 {
    let [min_m, max_m] = match subject(lands) {
        Some(subject) => SUBJECT_RADII.map(|radii| (radii * subject.radius_m).max(NEAREST_M)),
        None => [MIN_DISTANCE_M, MAX_DISTANCE_M],
    };
    wanted_m.clamp(min_m, max_m)
}

fn max_pitch_rad(lands: &[&Land]) -> f32 {
    if subject(lands).is_some() { super::MAX_PITCH_RAD } else { MAX_PITCH_RAD }
}

/// The point that a pose looks at; the pose is put on the circle around it.
pub(super) fn aim(pose: &mut Pose, lands: &[&Land]) -> Vec3 {
    pose.pitch_rad = pose.pitch_rad.min(max_pitch_rad(lands));
    let place_m = within(lands, pose.place_m() + offset_m(pose));
    let target_m =
        Vec3::new(place_m.x, pose.altitude_m + pose.distance_m * libm::sinf(pose.pitch_rad), place_m.y);
    circle(pose, target_m, lands);
    target_m
}

/// Begins to circle what the eye looks at from where it is, or the middle of a subject. `heights_m`: the eyes' heights so
/// far, one a landscape.
pub(super) fn begin(pose: &mut Pose, lands: &[&Land], heights_m: &[f32]) -> Vec3 {
    let place_m = pose.place_m();
    if let (Some(subject), Some(height_m)) = (subject(lands), heights_m.first()) {
        let eye_m = Vec3::new(place_m.x, *height_m, place_m.y);
        return face(pose, eye_m, Vec3::Y * subject.middle_m, lands);
    }
    let above = |(land, height_m): (&&Land, &f32)| height_m - land.ground_m(place_m);
    let mean_m = lands.iter().zip(heights_m).map(above).sum::<f32>() / lands.len().max(1) as f32;
    pose.pitch_rad = pose.pitch_rad.min(BEGIN_RAD);
    pose.distance_m = distance((mean_m / libm::sinf(-pose.pitch_rad)).max(BEGIN_M), lands);
    // Nearer if the land ends first, so that the eye stays where it is.
    let target_m = place_m + offset_m(pose);
    let edge_m = within(lands, target_m);
    if edge_m != target_m {
        let level_m = place_m.distance(target_m) - edge_m.distance(target_m);
        pose.distance_m = distance(level_m / libm::cosf(pose.pitch_rad), lands);
    }
    aim(pose, lands)
}

/// Turns to a point from where the eye is.
fn face(pose: &mut Pose, eye_m: Vec3, target_m: Vec3, lands: &[&Land]) -> Vec3 {
    let way_m = target_m - eye_m;
    let ahead = way_m.normalize_or(Vec3::NEG_Z);
    pose.distance_m = distance(way_m.length(), lands);
    pose.yaw_rad = libm::atan2f(-ahead.x, -ahead.z);
    pose.pitch_rad = libm::asinf(ahead.y.clamp(-1.0, 1.0)).clamp(-super::MAX_PITCH_RAD, super::MAX_PITCH_RAD);
    circle(pose, target_m, lands);
    target_m
}

/// Nearer or farther by wheel and keys.
pub(super) fn zoom(pose: &mut Pose, controls: &Controls, dt_s: f32, lands: &[&Land]) {
    let factor = libm::powf(WHEEL, controls.wheel) * libm::expf(controls.up * ZOOM_PER_S * dt_s);
    if factor.is_finite() {
        pose.distance_m = distance(pose.distance_m * factor, lands);
    }
}

/// Speed in m/s at which the point moves: what is seen from far moves faster.
pub(super) fn speed_mps(pose: &Pose, walk_mps: f32, lands: &[&Land]) -> f32 {
    let min_mps = if subject(lands).is_some() { 0.0 } else { walk_mps };
    min_mps.max(PAN_PER_S * pose.distance_m)
}

/// Puts the eye where it looks at the point from the wished distance.
pub(super) fn circle(pose: &mut Pose, target_m: Vec3, lands: &[&Land]) {
    pose.pitch_rad = pose.pitch_rad.min(max_pitch_rad(lands));
    pose.put(target_m.xz() - offset_m(pose));
    if subject(lands).is_some() {
        // For bookmarks, and to fly on from there.
        pose.altitude_m = target_m.y - pose.distance_m * libm::sinf(pose.pitch_rad);
    }
}

/// Height of the eye in one landscape, in metres.
pub(super) fn height_m(pose: &Pose, target_m: Vec3, land: &Land) -> f32 {
    let point_m = if land.subject.is_some() { target_m.y } else { land.ground_m(target_m.xz()) };
    let circle_m = point_m - pose.distance_m * libm::sinf(pose.pitch_rad);
    circle_m.max(land.floor_m(pose.place_m()))
}

/// From eye to point, on the (x, z) plane.
fn offset_m(pose: &Pose) -> Vec2 {
    pose.ahead() * (pose.distance_m * libm::cosf(pose.pitch_rad))
}
