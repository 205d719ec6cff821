//! Keys, mouse and gamepad → where the one camera of all views is.

use std::sync::Arc;

use glam::Vec3;
use winit::event::{ElementState, MouseButton};
use winit::keyboard::KeyCode;
use winit::window::{CursorGrabMode, Window};

use crate::camera::Camera;
use crate::event::Comfort;
use crate::input::{Action, Bindings, Held};
use crate::settings::Bookmark;
use crate::walk::{Feel, Land, Mode, Pose, Rig, START_RADIUS_M, start_pose};

/// Whoever steers.
pub struct Pilot {
    rig: Rig,
    held: Held,
    /// What keys mean.
    pub bindings: Bindings,
    /// The pointer steers the view.
    captured: bool,
    /// A walk has begun: the place is the person's, no longer ours to choose.
    begun: bool,
    /// Nothing was held at the last step.
    resting: bool,
    #[cfg(feature = "gamepad")]
    gamepads: crate::gamepad::Gamepads,
}

impl Pilot {
    /// At rest in the middle. The text says why no gamepad is heard, where that is so.
    pub fn new(bindings: Bindings) -> (Self, Option<String>) {
        #[cfg(feature = "gamepad")]
        let (gamepads, problem) = crate::gamepad::Gamepads::open();
        #[cfg(not(feature = "gamepad"))]
        let problem = None;
        let pilot = Self {
            rig: Rig::new(Pose::default(), &[]),
            held: Held::default(),
            bindings,
            captured: false,
            begun: false,
            resting: true,
            #[cfg(feature = "gamepad")]
            gamepads,
        };
        (pilot, problem)
    }

    /// Whether the pointer steers the view.
    pub fn captured(&self) -> bool {
        self.captured
    }

    /// The landscapes are other ones: whoever has not moved yet goes to their best place, others step out of trunks.
    pub fn meet(&mut self, lands: &[Arc<Land>], sun: Option<Vec3>) {
        if self.begun {
            self.rig.settle(&borrowed(lands));
        } else {
            self.go_to_start(lands, sun);
        }
    }

    /// Goes to where every walk starts.
    pub fn go_to_start(&mut self, lands: &[Arc<Land>], sun: Option<Vec3>) {
        let lands = borrowed(lands);
        self.rig.go(start_pose(&lands, START_RADIUS_M, sun), &lands);
    }

    /// Moves for a frame of that many seconds; what a gamepad asked for on the way.
    pub fn step(&mut self, dt_s: f32, comfort: &Comfort, lands: &[Arc<Land>]) -> Vec<Action> {
        let controls = self.held.controls();
        #[cfg(feature = "gamepad")]
        let (controls, asked) = {
            let (of_gamepad, asked) = self.gamepads.poll();
            (controls.and(of_gamepad), asked)
        };
        #[cfg(not(feature = "gamepad"))]
        let asked = Vec::new();
        self.resting = controls == Default::default();
        self.begun |= !self.resting;
        let usual = Feel::default();
        let feel = Feel {
            mouse_rad: usual.mouse_rad * comfort.mouse_sensitivity,
            invert: comfort.invert_y,
            ..usual
        };
        self.rig.step(dt_s, &controls, &feel, &borrowed(lands));
        asked
    }

    /// The camera of a view with that land.
    pub fn camera(&self, land: &Land, fov_y_rad: f32) -> Camera {
        self.rig.camera(land, fov_y_rad)
    }

    /// Where all cameras are.
    pub fn pose(&self) -> Pose {
        self.rig.pose()
    }

    /// True while anything moves or is held.
    pub fn mode(&self) -> Mode {
        self.rig.mode()
    }

    /// Walk, fly, orbit.
    pub fn cycle_mode(&mut self, lands: &[Arc<Land>]) {
        self.begun = true;
        self.rig.cycle_mode(&borrowed(lands));
    }

    /// The place to remember; its height is that of a flight.
    pub fn bookmark(&self) -> Bookmark {
        let pose = self.rig.pose();
        Bookmark {
            position_m: [pose.x_m, pose.altitude_m, pose.z_m],
            yaw_rad: pose.yaw_rad,
            pitch_rad: pose.pitch_rad,
            flying: pose.mode == Mode::Fly,
        }
    }

    /// The place to come back to at the next start: where somebody who has moved came to rest.
    pub fn rested_at(&self) -> Option<Bookmark> {
        (self.begun && self.resting).then(|| self.bookmark())
    }

    /// Goes to a remembered place.
    pub fn go_to(&mut self, mark: &Bookmark, lands: &[Arc<Land>]) {
        self.begun = true;
        let [x_m, altitude_m, z_m] = mark.position_m;
        let pose = Pose {
            x_m,
            z_m,
            altitude_m,
            yaw_rad: mark.yaw_rad,
            pitch_rad: mark.pitch_rad,
            mode: if mark.flying { Mode::Fly } else { Mode::Walk },
            ..Pose::default()
        };
        self.rig.go(pose, &borrowed(lands));
    }

    /// Before landscapes are there: goes to where the person was last, if they were; else the place is ours to choose.
    pub fn return_to(&mut self, place: Option<&Bookmark>) {
        self.begun = false;
        if let Some(place) = place {
            self.go_to(place, &[]);
        }
    }

    /// A key went down or up.
    pub fn key(&mut self, code: KeyCode, state: ElementState, repeat: bool) -> Option<Action> {
        self.held.key(&self.bindings, code, state == ElementState::Pressed, repeat)
    }

    /// A button of the mouse went down or up.
    pub fn button(&mut self, button: MouseButton, state: ElementState) -> Option<Action> {
        self.held.button(&self.bindings, button, state == ElementState::Pressed)
    }

    /// The mouse moved while it steers.
    pub fn turn(&mut self, x_px: f32, y_px: f32) {
        self.held.mouse_moved(x_px, y_px);
    }

    /// The wheel turned.
    pub fn wheel(&mut self, lines: f32) {
        self.held.wheel(lines);
    }

    /// Keys go elsewhere now.
    pub fn let_go(&mut self) {
        self.held.focus_lost();
    }

    /// Gives the pointer to the view or takes it back. Where it cannot be locked in place it is kept within the window,
    /// and where not even that, it is only hidden.
    pub fn capture(&mut self, window: &Window, captured: bool) {
        if captured {
            let locked = window.set_cursor_grab(CursorGrabMode::Locked);
            if locked.is_err() {
                let _ = window.set_cursor_grab(CursorGrabMode::Confined);
            }
        } else {
            let _ = window.set_cursor_grab(CursorGrabMode::None);
        }
        window.set_cursor_visible(!captured);
        self.captured = captured;
    }
}

fn borrowed(lands: &[Arc<Land>]) -> Vec<&Land> {
    lands.iter().map(Arc::as_ref).collect()
}
