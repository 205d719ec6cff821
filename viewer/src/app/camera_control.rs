//! Keys, mouse and gamepad → where the one camera of all views is.

use winit::window::{CursorGrabMode, Window};

use crate::input::{Command, Held};
use crate::settings::{Bookmark, Comfort};
use crate::walk::{Feel, Land, Mode, Pose, Rig, start_pose};

/// What moves the camera.
pub struct CameraControl {
    pub rig: Rig,
    /// Keys and buttons that are down.
    pub held: Held,
    /// The pointer steers the view.
    captured: bool,
    /// A walk has begun: the person has chosen the place, and it is kept.
    begun: bool,
    /// Nothing was held at the last step.
    resting: bool,
    #[cfg(feature = "gamepad")]
    gamepads: crate::gamepad::Gamepads,
}

/// What came of one step.
pub struct Step {
    /// The camera moves, or is about to.
    pub moving: bool,
    /// What a gamepad asked for meanwhile.
    pub commands: Vec<Command>,
}

impl CameraControl {
    /// At rest in the middle. The text says why gamepads cannot be read, if so.
    pub fn new() -> (Self, Option<String>) {
        #[cfg(feature = "gamepad")]
        let (gamepads, problem) = crate::gamepad::Gamepads::open();
        #[cfg(not(feature = "gamepad"))]
        let problem = None;
        let control = Self {
            rig: Rig::new(Pose::default(), &[]),
            held: Held::default(),
            captured: false,
            begun: false,
            resting: true,
            #[cfg(feature = "gamepad")]
            gamepads,
        };
        (control, problem)
    }

    /// Whether the pointer steers the view.
    pub fn captured(&self) -> bool {
        self.captured
    }

    /// The landscapes have changed: a camera that has not moved yet goes to their start, any other steps out of trunks.
    pub fn lands_changed(&mut self, lands: &[&Land]) {
        if self.begun {
            self.rig.settle(lands);
        } else {
            self.go_to_start(lands);
        }
    }

    /// Goes to where every walk starts.
    pub fn go_to_start(&mut self, lands: &[&Land]) {
        self.rig.go(start_pose(lands), lands);
    }

    /// Moves for a frame of `dt_s` seconds.
    pub fn step(&mut self, dt_s: f32, comfort: &Comfort, lands: &[&Land]) -> Step {
        let controls = self.held.controls();
        #[cfg(feature = "gamepad")]
        let (controls, commands) = {
            let (of_gamepad, commands) = self.gamepads.poll();
            (controls.and(of_gamepad), commands)
        };
        #[cfg(not(feature = "gamepad"))]
        let commands = Vec::new();
        self.resting = controls == Default::default();
        self.begun |= !self.resting;
        let usual = Feel::default();
        let feel = Feel {
            mouse_rad: usual.mouse_rad * comfort.mouse_sensitivity,
            invert: comfort.invert_y,
            ..usual
        };
        let before = self.rig.clone();
        self.rig.step(dt_s, &controls, &feel, lands);
        Step { moving: !self.resting || self.rig != before, commands }
    }

    /// Goes on to the next of walk, fly and orbit, and returns it.
    pub fn next_mode(&mut self, lands: &[&Land]) -> Mode {
        self.begun = true;
        self.rig.cycle_mode(lands);
        self.rig.mode()
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

    /// The place to come back to at the next start, if the camera was moved and has come to rest.
    pub fn rested_at(&self) -> Option<Bookmark> {
        (self.begun && self.resting).then(|| self.bookmark())
    }

    /// Goes to a remembered place.
    pub fn go_to(&mut self, mark: &Bookmark, lands: &[&Land]) {
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
        self.rig.go(pose, lands);
    }

    /// Before landscapes are loaded: goes to where the last session ended. Without such a place the landscapes decide.
    pub fn return_to(&mut self, place: Option<&Bookmark>) {
        self.begun = false;
        if let Some(place) = place {
            self.go_to(place, &[]);
        }
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
