//! Flying: one altitude above zero in all views, and through trees. Where one landscape's ground is higher than that, its
//! view alone is lifted over it; so a valley can be flown through in one view although a mountain stands there in
//! another.

use glam::{Vec2, Vec3};

use super::{Land, Pose, within};
use crate::input::Controls;

/// Speed at the start, in m/s.
pub(super) const SPEED_MPS: f32 = 12.0;
/// What the wheel sets, in m/s.
const MIN_SPEED_MPS: f32 = 0.5;
const MAX_SPEED_MPS: f32 = 400.0;
/// One line of the wheel, as a factor.
const WHEEL: f32 = 1.2;
/// The eye never rises above this.
const MAX_ALTITUDE_M: f32 = 10_000.0;

/// The speed after a turn of the wheel, in m/s.
pub(super) fn speed_mps(before_mps: f32, wheel: f32) -> f32 {
    if !wheel.is_finite() {
        return before_mps;
    }
    (before_mps * libm::powf(WHEEL, wheel)).clamp(MIN_SPEED_MPS, MAX_SPEED_MPS)
}

/// Direction of a wish, no longer than 1: forward goes where one looks, up goes straight up.
pub(super) fn wish(pose: &Pose, controls: &Controls) -> Vec3 {
    let (sin, cos) = libm::sincosf(pose.pitch_rad);
    let (ahead, right) = (pose.ahead() * cos, pose.right());
    let wish = Vec3::new(ahead.x, sin, ahead.y) * controls.forward
        + Vec3::new(right.x, 0.0, right.y) * controls.right
        + Vec3::Y * controls.up;
    if wish.is_finite() { wish.clamp_length_max(1.0) } else { Vec3::ZERO }
}

/// Moves over the land; its edge is a wall.
pub(super) fn advance(pose: &mut Pose, by_m: Vec3, lands: &[&Land]) {
    pose.put(within(lands, pose.place_m() + Vec2::new(by_m.x, by_m.z)));
    pose.altitude_m += by_m.y;
    keep_above(pose, lands);
}

/// Keeps the altitude no lower than at least one view shows, so that a press of "up" is seen at once.
pub(super) fn keep_above(pose: &mut Pose, lands: &[&Land]) {
    let place_m = pose.place_m();
    let lowest_m = lands.iter().map(|land| land.floor_m(place_m)).fold(f32::INFINITY, f32::min);
    if lowest_m.is_finite() {
        pose.altitude_m = pose.altitude_m.max(lowest_m);
    }
    pose.altitude_m = pose.altitude_m.min(MAX_ALTITUDE_M.max(lowest_m.min(f32::MAX)));
}
