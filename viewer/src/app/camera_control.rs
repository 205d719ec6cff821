//! Keys, mouse and gamepad → where the one camera of all views is.

use glam::Vec2;
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
    /// It doesn't matter where it is: the first landscape of a generation that is to come begins the walk.
    awaits: bool,
    /// What is shown is anyone's file, which stands alone.
    around_subject: bool,
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
            awaits: true,
            around_subject: false,
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

    /// A generation is born: the walk begins anew with its first landscape.
    pub fn await_landscapes(&mut self) {
        self.awaits = true;
    }

    /// Landscapes have changed. `own`: those of the generation on show, of `all` that are walked in. A new walk begins with
    /// the first of them; each of the others is laid under it when it comes.
    pub fn lands_changed(&mut self, all: &[&Land], own: &[&Land]) {
        self.around_subject = all.iter().any(|land| land.subject.is_some());
        if self.awaits && !own.is_empty() {
            self.rig.go(start_pose(own), own);
            self.awaits = false;
        } else {
            self.rig.settle(all);
        }
    }

    /// From where landscapes that are to come will be seen, x and z of the walk in metres.
    pub fn eye_m(&self) -> Vec2 {
        if self.awaits { Vec2::ZERO } else { self.rig.pose().place_m() }
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

    /// A gamepad may steer, whose presses wake no window: somebody has to look.
    pub fn has_gamepad(&self) -> bool {
        #[cfg(feature = "gamepad")]
        let any = self.gamepads.any();
        #[cfg(not(feature = "gamepad"))]
        let any = false;
        any
    }

    /// Something was held, or turned, at the last step.
    pub fn is_steered(&self) -> bool {
        !self.resting
    }

    /// Goes on to the next of walk, fly and orbit, and returns it.
    pub fn next_mode(&mut self, lands: &[&Land]) -> Mode {
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
            flying: pose.mode == Mode::Fly || self.around_subject && pose.mode == Mode::Orbit,
        }
    }

    /// The place to come back to at the next start, if there is one and the camera has come to rest.
    pub fn rested_at(&self) -> Option<Bookmark> {
        (!self.awaits && self.resting).then(|| self.bookmark())
    }

    /// Goes to a remembered place.
    pub fn go_to(&mut self, mark: &Bookmark, lands: &[&Land]) {
        self.awaits = false;
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

    /// Before landscapes are loaded: goes to where the last session ended. Without such a place the walk begins with them.
    pub fn return_to(&mut self, place: Option<&Bookmark>) {
        self.awaits = true;
        if let Some(mark) = place {
            self.go_to(mark, &[]);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walk::testing::land_with;

    fn control() -> CameraControl {
        CameraControl::new().0
    }

    fn gone_m(control: &CameraControl) -> f32 {
        control.rig.pose().place_m().length()
    }

    /// A second of walking forward.
    fn walk(control: &mut CameraControl, lands: &[&Land]) {
        let bindings = crate::input::Bindings::default();
        control.held.press(&bindings, "W".parse().expect("a key"));
        (0..4).for_each(|_| drop(control.step(0.25, &Comfort::default(), lands)));
        control.held.focus_lost();
    }

    #[test]
    fn a_new_generation_is_entered_once_with_its_first_landscape() {
        let [old, first, second] = [(); 3].map(|()| land_with([]));
        let mut control = control();
        control.lands_changed(&[&old], &[&old]);
        walk(&mut control, &[&old]);
        assert!(gone_m(&control) > 1.0);
        control.await_landscapes();
        walk(&mut control, &[&old]);
        control.lands_changed(&[&first, &old], &[&first]);
        assert_eq!(gone_m(&control), 0.0, "whoever walked while it grew is taken along");
        walk(&mut control, &[&first, &old]);
        let before = control.rig.pose();
        control.lands_changed(&[&first, &second], &[&first, &second]);
        assert_eq!(control.rig.pose(), before, "whoever walks on in it is left alone");
    }

    #[test]
    fn an_edit_moves_nobody_and_a_place_is_returned_to() {
        let [before, after] = [(); 2].map(|()| land_with([]));
        let mut control = control();
        assert_eq!(control.rested_at(), None, "nothing was there yet");
        control.lands_changed(&[&before], &[&before]);
        walk(&mut control, &[&before]);
        let pose = control.rig.pose();
        control.lands_changed(&[&after], &[&after]);
        assert_eq!(control.rig.pose(), pose);
        control.step(0.25, &Comfort::default(), &[&after]);
        let mark = control.rested_at().expect("it rests");
        let mut again = self::control();
        again.return_to(Some(&mark));
        again.lands_changed(&[&after], &[&after]);
        assert_eq!(again.rig.pose().place_m(), control.rig.pose().place_m());
        again.go_to_start(&[&after]);
        assert_eq!(gone_m(&again), 0.0);
    }
}
