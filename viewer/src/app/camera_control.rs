//! Keys, mouse and gamepad → where the one camera of all views is.

use glam::Vec2;
use winit::window::{CursorGrabMode, Window};

use crate::input::{Command, Held};
use crate::settings::{Bookmark, Comfort, WorldSettings};
use crate::walk::{Feel, Land, Mode, Pose, Rig, start_pose, suits_all};

/// How the camera came to be where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// It doesn't matter: the first landscape of a generation that is to come says where the walk begins.
    Awaited,
    /// At the start of the first landscapes that were there.
    Start,
    /// Where the person has gone.
    Chosen,
}

/// What moves the camera.
pub struct CameraControl {
    pub rig: Rig,
    /// Keys and buttons that are down.
    pub held: Held,
    /// The pointer steers the view.
    captured: bool,
    place: Place,
    /// The generation whose landscapes were all asked about the start.
    asked: Option<u32>,
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
            place: Place::Awaited,
            asked: None,
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
        (self.place, self.asked) = (Place::Awaited, None);
    }

    /// Landscapes have changed. `own`: those of the generation on show, of `all` that are walked in; `complete`: no more
    /// are to come.
    ///
    /// A new walk begins with the first landscape, whose start is known then, and not with the last: that may be half a
    /// minute later, spent in a lake. Each of the others might know a better start, but a person who looks around must
    /// not be moved again and again. So that is asked once, when all are known, of someone who has not moved, and only
    /// if the place is bad for one of them.
    pub fn lands_changed(&mut self, all: &[&Land], own: &[&Land], generation: u32, complete: bool) {
        self.around_subject = all.iter().any(|land| land.subject.is_some());
        let begins = self.place == Place::Awaited && !own.is_empty();
        let asks = complete && self.place == Place::Start && self.asked != Some(generation);
        if begins || asks && !suits_all(own, &self.rig.pose()) {
            self.rig.go(start_pose(own), own);
            self.place = Place::Start;
        } else {
            self.rig.settle(all);
        }
        if complete {
            self.asked = Some(generation);
        }
    }

    /// From where landscapes that are to come will be seen, x and z in metres, unless they decide that themselves.
    pub fn eye_m(&self) -> Option<Vec2> {
        (self.place != Place::Awaited).then(|| self.rig.pose().place_m())
    }

    /// Goes to where every walk starts.
    pub fn go_to_start(&mut self, lands: &[&Land]) {
        self.rig.go(start_pose(lands), lands);
        self.leave(Place::Start);
    }

    /// While landscapes are awaited, a walk in the old ones changes nothing.
    fn leave(&mut self, place: Place) {
        if self.place != Place::Awaited {
            self.place = place;
        }
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
        if !self.resting {
            self.leave(Place::Chosen);
        }
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
        self.leave(Place::Chosen);
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

    /// The place to come back to at the next start, if there is one and the camera has come to rest; and whether it is
    /// where landscapes begin.
    pub fn rested_at(&self) -> Option<(Bookmark, bool)> {
        let rests = self.place != Place::Awaited && self.resting;
        rests.then(|| (self.bookmark(), self.place == Place::Start))
    }

    /// Goes to a remembered place.
    pub fn go_to(&mut self, mark: &Bookmark, lands: &[&Land]) {
        self.place = Place::Chosen;
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
    /// At a start, those of another generation than the last may say that there is a better one.
    pub fn return_to(&mut self, place: Option<&Bookmark>, last: &WorldSettings) {
        self.place = Place::Awaited;
        if let Some(mark) = place {
            self.go_to(mark, &[]);
            if last.at_start {
                (self.place, self.asked) = (Place::Start, last.generation);
            }
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
    use genescape_schema::scene::{Lookout, Lookouts, Prospect};

    /// Level land, as good as each number says from the lookout of that number.
    fn land(scores: &[(usize, u8)]) -> Land {
        let mut prospects = vec![Prospect::default(); Lookout::COUNT];
        scores.iter().for_each(|&(lookout, score)| prospects[lookout].score = score);
        Land { lookouts: Lookouts::new(prospects).map(std::sync::Arc::new), ..land_with([]) }
    }

    fn x_of(lookout: usize) -> f32 {
        Lookout::all().nth(lookout).expect("one of the list").place_m(128.0).x
    }

    fn control() -> CameraControl {
        CameraControl::new().0
    }

    fn x_m(control: &CameraControl) -> f32 {
        control.rig.pose().x_m
    }

    /// A second of walking forward.
    fn walk(control: &mut CameraControl, lands: &[&Land]) {
        let bindings = crate::input::Bindings::default();
        control.held.press(&bindings, "W".parse().expect("a key"));
        (0..4).for_each(|_| drop(control.step(0.25, &Comfort::default(), lands)));
        control.held.focus_lost();
    }

    #[test]
    fn a_new_generation_is_entered_once_and_corrected_only_where_it_must() {
        let (old, first) = (land(&[(24, 200)]), land(&[(48, 200), (72, 90)]));
        for (score, expected) in [(150, 48), (20, 72)] {
            let second = land(&[(48, score), (72, 90)]);
            let mut control = control();
            control.lands_changed(&[&old], &[&old], 1, true);
            walk(&mut control, &[&old]);
            control.await_landscapes();
            walk(&mut control, &[&old]);
            control.lands_changed(&[&first, &old], &[&first], 1, false);
            assert_eq!(x_m(&control), x_of(48), "whoever walked while it grew is taken along");
            control.lands_changed(&[&first, &second], &[&first, &second], 1, false);
            assert_eq!(x_m(&control), x_of(48), "not before the last is there");
            control.lands_changed(&[&first, &second], &[&first, &second], 1, true);
            assert_eq!(
                x_m(&control),
                x_of(expected),
                "which the second scores {score} from the first's place"
            );
        }
    }

    #[test]
    fn an_edit_moves_nobody() {
        let (good, bad) = (land(&[(48, 200), (72, 90)]), land(&[(48, 20), (72, 90)]));
        let mut control = control();
        control.lands_changed(&[&good], &[&good], 1, true);
        control.lands_changed(&[&bad], &[&bad], 1, true);
        assert_eq!(x_m(&control), x_of(48), "the walk has begun");
        control.go_to_start(&[&bad]);
        assert_eq!(x_m(&control), x_of(72), "as the person wanted");
        control.lands_changed(&[&good], &[&good], 1, true);
        assert_eq!(x_m(&control), x_of(72));
    }

    #[test]
    fn a_place_that_is_a_start_gives_way_to_a_better_one_after_a_restart_and_in_another_generation() {
        let (good, bad) = (land(&[(48, 200), (72, 90)]), land(&[(48, 20), (72, 90)]));
        let mut control = control();
        control.lands_changed(&[&good], &[&good], 1, true);
        control.step(0.25, &Comfort::default(), &[&good]);
        let (mark, is_start) = control.rested_at().expect("it rests");
        for (at_start, generation, expected) in [(is_start, 0, 72), (is_start, 1, 48), (false, 0, 48)] {
            let mut again = self::control();
            let last = WorldSettings { at_start, generation: Some(1), ..WorldSettings::default() };
            again.return_to(Some(&mark), &last);
            again.lands_changed(&[&bad], &[&bad], generation, true);
            assert_eq!(x_m(&again), x_of(expected), "generation {generation}, at a start: {at_start}");
        }
        control.lands_changed(&[&bad], &[&bad], 0, true);
        assert_eq!(x_m(&control), x_of(72), "another generation");
    }

    #[test]
    fn whoever_walks_on_in_the_new_generation_is_left_alone_and_so_is_whoever_stays() {
        let (old, first, wall) = (land(&[(24, 200)]), land(&[(48, 200)]), land(&[(72, 200)]));
        let mut control = control();
        control.lands_changed(&[&old], &[&old], 1, true);
        walk(&mut control, &[&old]);
        let before = control.rig.pose();
        control.lands_changed(&[&first, &old], &[&first], 1, false);
        assert_eq!(control.rig.pose(), before, "nothing was awaited");
        control.await_landscapes();
        control.lands_changed(&[&first], &[&first], 1, false);
        walk(&mut control, &[&first]);
        let before = control.rig.pose();
        control.lands_changed(&[&first, &wall], &[&first, &wall], 1, true);
        assert_eq!(control.rig.pose(), before);
    }
}
