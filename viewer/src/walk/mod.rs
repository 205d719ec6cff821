//! The camera that walks through four landscapes at once (thesis section 6): a person's wishes and the time that has
//! passed → one way for all views. Metres, radians, seconds; knows no window, device or disk.
//!
//! What all views share: where they have gone from where each began, and how they have turned ([`Anchor`] says where that is).
//! What each view has of its own: y, which follows its own ground. Walking keeps eyes 1.6 m above the bilinear ground and goes around trunks ([`steps`] says why around those of
//! all four landscapes); flying keeps one altitude in all views ([`fly`]); orbiting circles a point on the ground
//! ([`orbit`]). Around anyone's file, which stands alone, an orbit circles its middle.

mod anchor;
mod fly;
mod land;
mod orbit;
mod start;
mod steps;
#[cfg(test)]
pub mod testing;
#[cfg(test)]
mod tests;
mod trunks;

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3, Vec3Swizzles};
use serde::Serialize;

pub use anchor::Anchor;
pub use land::{BODY_RADIUS_M, EYE_HEIGHT_M, Land, MIN_HEIGHT_M, Subject, WADING_DEPTH_M, WALKABLE, within};
pub use start::{anchor_for, start_pose};
pub use steps::{advance, free, nearest_free};
pub use trunks::{Trunk, Trunks};

use crate::camera::Camera;
use crate::input::Controls;

/// Never straight up or down: there, left and right have no meaning.
pub const MAX_PITCH_RAD: f32 = 89.0 * PI / 180.0;
/// What is left of a longer frame is not walked: a window that hung must not make the walker jump.
pub const MAX_STEP_S: f32 = 0.25;
/// A change of mode moves the eyes up or down in this time.
const BLEND_S: f32 = 0.4;
/// Running and fast flying, as a multiple.
const RUN_FACTOR: f32 = 4.0;
/// Time in which the velocity comes within 1/e of the wish.
const SMOOTH_S: f32 = 0.12;
/// Turn at full deflection of a stick.
const STICK_RAD_PER_S: f32 = 2.2;

/// How the camera moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub enum Mode {
    /// On the ground, around trunks.
    #[default]
    Walk,
    /// At one altitude in all views, through trees.
    Fly,
    /// In a circle around a point on the ground.
    Orbit,
}

impl Mode {
    pub const ALL: [Self; 3] = [Self::Walk, Self::Fly, Self::Orbit];

    /// Walk, fly, orbit, and around again.
    pub fn next(self) -> Self {
        Self::ALL[(self as usize + 1) % Self::ALL.len()]
    }

    /// 1 for this mode, 0 for the others.
    fn alone(self) -> [f32; 3] {
        Self::ALL.map(|mode| if mode == self { 1.0 } else { 0.0 })
    }
}

/// A place and direction that can be kept: a bookmark, a command line's camera. Nothing in it depends on a landscape.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pose {
    /// The eye, east of the walk's middle.
    pub x_m: f32,
    /// The eye, south of the walk's middle.
    pub z_m: f32,
    /// As in [`Camera::yaw_rad`].
    pub yaw_rad: f32,
    /// As in [`Camera::pitch_rad`].
    pub pitch_rad: f32,
    /// How it moves.
    pub mode: Mode,
    /// Height of the eye above the walk's level when flying.
    pub altitude_m: f32,
    /// From the eye to the point that it circles when orbiting.
    pub distance_m: f32,
}

impl Default for Pose {
    fn default() -> Self {
        Self {
            x_m: 0.0,
            z_m: 0.0,
            yaw_rad: 0.0,
            pitch_rad: 0.0,
            mode: Mode::Walk,
            altitude_m: 0.0,
            distance_m: 30.0,
        }
    }
}

impl Pose {
    /// (x, z).
    pub fn place_m(&self) -> Vec2 {
        Vec2::new(self.x_m, self.z_m)
    }

    /// Level unit vector (x, z) of the direction of view.
    pub fn ahead(&self) -> Vec2 {
        let (sin, cos) = libm::sincosf(self.yaw_rad);
        Vec2::new(-sin, -cos)
    }

    /// Level unit vector (x, z) to the right.
    pub fn right(&self) -> Vec2 {
        let (sin, cos) = libm::sincosf(self.yaw_rad);
        Vec2::new(cos, -sin)
    }

    fn put(&mut self, place_m: Vec2) {
        (self.x_m, self.z_m) = (place_m.x, place_m.y);
    }
}

/// How moving and looking feel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feel {
    /// Walking speed in m/s.
    pub walk_mps: f32,
    /// Turn for one count of the mouse.
    pub mouse_rad: f32,
    /// Forward on the mouse or stick looks down.
    pub invert: bool,
}

impl Default for Feel {
    fn default() -> Self {
        Self { walk_mps: 3.0, mouse_rad: 0.0022, invert: false }
    }
}

/// The camera of all views: its pose and what moves it.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    pose: Pose,
    /// Follows the wish with a lag; x, y, z.
    velocity_mps: Vec3,
    /// Set by the wheel.
    fly_mps: f32,
    /// What an orbit circles; its height counts only around a [`Subject`].
    target_m: Vec3,
    /// Parts of walking, flying and orbiting in the eyes' height; their sum is 1, and soon the mode's own part is.
    parts: [f32; 3],
}

impl Rig {
    /// Begins at a pose. `lands`: those that are there yet, possibly none.
    pub fn new(pose: Pose, lands: &[&Land]) -> Self {
        let mut rig = Self {
            pose: Pose::default(),
            velocity_mps: Vec3::ZERO,
            fly_mps: fly::SPEED_MPS,
            target_m: Vec3::ZERO,
            parts: Mode::Walk.alone(),
        };
        rig.go(pose, lands);
        rig
    }

    /// What a bookmark keeps.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    pub fn mode(&self) -> Mode {
        self.pose.mode
    }

    /// Jumps to a pose. What no camera can have (not a number, off the land, inside a trunk) becomes the nearest that
    /// it can.
    pub fn go(&mut self, pose: Pose, lands: &[&Land]) {
        let finite = |value: f32, otherwise: f32| if value.is_finite() { value } else { otherwise };
        let usual = Pose::default();
        self.pose = Pose {
            x_m: finite(pose.x_m, 0.0),
            z_m: finite(pose.z_m, 0.0),
            yaw_rad: wrapped(finite(pose.yaw_rad, 0.0)),
            pitch_rad: finite(pose.pitch_rad, 0.0).clamp(-MAX_PITCH_RAD, MAX_PITCH_RAD),
            mode: pose.mode,
            altitude_m: finite(pose.altitude_m, 0.0),
            distance_m: orbit::distance(finite(pose.distance_m, usual.distance_m), lands),
        };
        (self.velocity_mps, self.parts) = (Vec3::ZERO, pose.mode.alone());
        match pose.mode {
            Mode::Walk => self.settle(lands),
            Mode::Fly => fly::keep_above(&mut self.pose, lands),
            Mode::Orbit => self.target_m = orbit::aim(&mut self.pose, lands),
        }
    }

    /// Changes to the next mode where the camera is; the eyes move up or down in a moment, not at once.
    pub fn cycle_mode(&mut self, lands: &[&Land]) {
        let mode = self.pose.mode.next();
        let heights_m: Vec<f32> = lands.iter().map(|land| self.height_m(land)).collect();
        (self.pose.mode, self.velocity_mps) = (mode, Vec3::ZERO);
        match mode {
            Mode::Walk => self.settle(lands),
            Mode::Fly => {
                self.pose.put(within(lands, self.pose.place_m()));
                // From the highest of the four, so that no view dives.
                self.pose.altitude_m = heights_m.into_iter().reduce(f32::max).unwrap_or(EYE_HEIGHT_M);
                fly::keep_above(&mut self.pose, lands);
            }
            Mode::Orbit => self.target_m = orbit::begin(&mut self.pose, lands, &heights_m),
        }
    }

    /// Makes a walker's place a free one, after a landscape was swapped: the nearest, or the same if there is none.
    pub fn settle(&mut self, lands: &[&Land]) {
        let place_m = self.pose.place_m();
        if self.pose.mode != Mode::Walk || (within(lands, place_m) == place_m && free(lands, place_m)) {
            return;
        }
        self.pose.put(nearest_free(lands, place_m).unwrap_or_else(|| within(lands, place_m)));
    }

    /// Moves on by a frame. Frames of any length lead to the same place; see [`MAX_STEP_S`].
    pub fn step(&mut self, dt_s: f32, controls: &Controls, feel: &Feel, lands: &[&Land]) {
        let dt_s = if dt_s.is_finite() { dt_s.clamp(0.0, MAX_STEP_S) } else { 0.0 };
        self.blend(dt_s);
        self.turn(dt_s, controls, feel);
        match self.pose.mode {
            Mode::Walk => self.walk(dt_s, controls, feel, lands),
            Mode::Fly => {
                self.fly_mps = fly::speed_mps(self.fly_mps, controls.wheel);
                let wish_mps = fly::wish(&self.pose, controls) * self.fly_mps * pace(controls);
                let moved_m = glide(&mut self.velocity_mps, wish_mps, dt_s);
                fly::advance(&mut self.pose, moved_m, lands);
            }
            Mode::Orbit => {
                orbit::zoom(&mut self.pose, controls, dt_s, lands);
                let speed_mps = orbit::speed_mps(&self.pose, feel.walk_mps, lands) * pace(controls);
                let wish_mps = level_wish(&self.pose, controls) * speed_mps;
                let moved_m = glide(&mut self.velocity_mps, wish_mps, dt_s);
                let place_m = within(lands, (self.target_m + moved_m).xz());
                self.target_m = Vec3::new(place_m.x, self.target_m.y, place_m.y);
                orbit::circle(&mut self.pose, self.target_m, lands);
            }
        }
    }

    /// The camera of the view of one landscape.
    pub fn camera(&self, land: &Land, fov_y_rad: f32) -> Camera {
        let (anchor, mode) = (&land.anchor, self.pose.mode);
        let place_m = match mode {
            // From beyond its edge, too, a landscape is looked at.
            Mode::Orbit => anchor.in_land(self.pose.place_m()),
            Mode::Walk | Mode::Fly => land.standing_m(self.pose.place_m()),
        };
        // Whoever circles a point looks at it.
        let tilt_rad = anchor.pitch_rad * (1.0 - self.parts[Mode::Orbit as usize]);
        Camera {
            position_m: Vec3::new(place_m.x, self.height_m(land) + anchor.level_m(), place_m.y),
            yaw_rad: wrapped(self.pose.yaw_rad + anchor.yaw_rad),
            pitch_rad: (self.pose.pitch_rad + tilt_rad).clamp(-MAX_PITCH_RAD, MAX_PITCH_RAD),
            fov_y_rad,
        }
    }

    /// Height of the eye in one landscape above the walk's level, in metres.
    fn height_m(&self, land: &Land) -> f32 {
        if self.parts == self.pose.mode.alone() {
            return self.height_in(self.pose.mode, land);
        }
        Mode::ALL.into_iter().zip(self.parts).map(|(mode, part)| part * self.height_in(mode, land)).sum()
    }

    /// Takes from the parts of other modes what the mode gains; so a change during a change goes on from there.
    fn blend(&mut self, dt_s: f32) {
        let own = self.parts[self.pose.mode as usize];
        let grown = own + dt_s / BLEND_S;
        if grown >= 1.0 - 1e-5 {
            self.parts = self.pose.mode.alone();
            return;
        }
        let others = (1.0 - grown) / (1.0 - own);
        self.parts = self.parts.map(|part| part * others);
        self.parts[self.pose.mode as usize] = grown;
    }

    fn height_in(&self, mode: Mode, land: &Land) -> f32 {
        let place_m = self.pose.place_m();
        match mode {
            Mode::Walk => land.footing_m(place_m) + EYE_HEIGHT_M,
            Mode::Fly => self.pose.altitude_m.max(land.floor_m(place_m)),
            Mode::Orbit => orbit::height_m(&self.pose, self.target_m, land),
        }
    }

    fn turn(&mut self, dt_s: f32, controls: &Controls, feel: &Feel) {
        // To the right and up are positive here; yaw turns left.
        let mouse = Vec2::new(controls.turn_px.x, -controls.turn_px.y) * feel.mouse_rad;
        let turn = mouse + controls.turn_rate * (STICK_RAD_PER_S * dt_s);
        if !turn.is_finite() {
            return;
        }
        let up = if feel.invert { -turn.y } else { turn.y };
        self.pose.yaw_rad = wrapped(self.pose.yaw_rad - turn.x);
        self.pose.pitch_rad = (self.pose.pitch_rad + up).clamp(-MAX_PITCH_RAD, MAX_PITCH_RAD);
    }

    fn walk(&mut self, dt_s: f32, controls: &Controls, feel: &Feel, lands: &[&Land]) {
        self.settle(lands);
        let wish_mps = level_wish(&self.pose, controls) * feel.walk_mps * pace(controls);
        let moved_m = glide(&mut self.velocity_mps, wish_mps, dt_s);
        self.pose.put(advance(lands, self.pose.place_m(), moved_m.xz()));
    }
}

fn pace(controls: &Controls) -> f32 {
    if controls.run { RUN_FACTOR } else { 1.0 }
}

/// The level direction of a wish, no longer than 1: two keys together are no faster than one.
fn level_wish(pose: &Pose, controls: &Controls) -> Vec3 {
    let wish = pose.ahead() * controls.forward + pose.right() * controls.right;
    if wish.is_finite() { wish.clamp_length_max(1.0).extend(0.0).xzy() } else { Vec3::ZERO }
}

/// Draws the velocity towards the wish, v' = (wish − v)/τ, and gives the way that this leads in dt, in metres: the
/// exact integral, so that one long step and many short ones lead to the same place.
fn glide(velocity_mps: &mut Vec3, wish_mps: Vec3, dt_s: f32) -> Vec3 {
    if !wish_mps.is_finite() {
        return Vec3::ZERO;
    }
    let lag_mps = *velocity_mps - wish_mps;
    // 1 − e^(−dt/τ), exact for short frames too.
    let passed = -libm::expm1f(-dt_s / SMOOTH_S);
    *velocity_mps = wish_mps + lag_mps * (1.0 - passed);
    // Below a millimetre a second nothing is seen to move.
    if wish_mps == Vec3::ZERO && velocity_mps.length_squared() < 1e-6 {
        *velocity_mps = Vec3::ZERO;
    }
    wish_mps * dt_s + lag_mps * (SMOOTH_S * passed)
}

/// The same angle within ±π.
fn wrapped(angle_rad: f32) -> f32 {
    if (-PI..=PI).contains(&angle_rad) {
        return angle_rad;
    }
    let turned = angle_rad - TAU * (angle_rad / TAU).round();
    turned.clamp(-PI, PI)
}
