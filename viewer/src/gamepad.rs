//! A gamepad's sticks and buttons → the same [`Controls`] and [`Command`]s as keyboard and mouse give. With the cargo
//! feature `gamepad`, and never in the way: without a gamepad, or where gamepads cannot be read, all is at rest.
//!
//! Left stick walks, right stick looks, triggers fly up and down, pressing the left stick runs. Four things stand in a
//! diamond on the pad as they do in the window read row by row: up 1, right 2, left 3, down 4. The directional pad
//! shows one landscape alone; the four buttons vote for one while a shoulder is held (left: trees, right: terrain,
//! both: sky; the directional pad's down then says "none").

use genescape_schema::Category;
use gilrs::{Axis, Button, EventType, GamepadId, Gilrs};
use glam::Vec2;

use crate::input::{Best, Command, Controls};

/// Deflection of a stick that counts as none: worn sticks never quite come back.
pub const DEAD_ZONE: f32 = 0.18;

/// All gamepads; the one touched last steers.
#[derive(Debug, Default)]
pub struct Gamepads {
    gilrs: Option<Gilrs>,
    last: Option<GamepadId>,
}

impl Gamepads {
    /// Begins to listen. The text says why no gamepad will be heard, where that is so.
    pub fn open() -> (Self, Option<String>) {
        match Gilrs::new() {
            Ok(gilrs) => (Self { gilrs: Some(gilrs), last: None }, None),
            Err(error) => (Self::default(), Some(format!("gamepads cannot be read: {error}"))),
        }
    }

    /// Whether there is one to listen to.
    pub fn any(&self) -> bool {
        self.gilrs.as_ref().is_some_and(|gilrs| gilrs.gamepads().next().is_some())
    }

    /// What is held now, and the commands since the last call.
    pub fn poll(&mut self) -> (Controls, Vec<Command>) {
        let mut asked = Vec::new();
        let Some(gilrs) = &mut self.gilrs else { return (Controls::default(), asked) };
        while let Some(event) = gilrs.next_event() {
            match event.event {
                EventType::ButtonPressed(button, _) => {
                    self.last = Some(event.id);
                    let pad = gilrs.gamepad(event.id);
                    let shoulders =
                        [Button::LeftTrigger, Button::RightTrigger].map(|held| pad.is_pressed(held));
                    asked.extend(command(button, shoulders));
                }
                EventType::AxisChanged(_, value, _) if value.abs() > 2.0 * DEAD_ZONE => {
                    self.last = Some(event.id)
                }
                EventType::Disconnected if self.last == Some(event.id) => self.last = None,
                _ => {}
            }
        }
        let pad = self.last.and_then(|id| gilrs.connected_gamepad(id));
        let controls = pad.map_or(Controls::default(), |pad| {
            let pressed = |button| pad.button_data(button).map_or(0.0, |data| data.value());
            let sticks = [
                Vec2::new(pad.value(Axis::LeftStickX), pad.value(Axis::LeftStickY)),
                Vec2::new(pad.value(Axis::RightStickX), pad.value(Axis::RightStickY)),
            ];
            let triggers = [pressed(Button::RightTrigger2), pressed(Button::LeftTrigger2)];
            controls(sticks, triggers, pad.is_pressed(Button::LeftThumb))
        });
        (controls, asked)
    }
}

/// Sticks [left, right] with x to the right and y up; triggers [up, down], 0 to 1.
fn controls(sticks: [Vec2; 2], triggers: [f32; 2], run: bool) -> Controls {
    let [walk, look] = sticks.map(live);
    let [up, down] = triggers.map(|trigger| live(Vec2::new(trigger, 0.0)).x);
    // Squared, so that small deflections look finely.
    let turn_rate = look * look.length();
    Controls { forward: walk.y, right: walk.x, up: up - down, run, turn_rate, ..Controls::default() }
}

/// A deflection less the dead zone, from 0 just outside it to 1 at the rim; in the direction that it had.
fn live(stick: Vec2) -> Vec2 {
    let length = stick.length();
    if !length.is_finite() || length <= DEAD_ZONE {
        return Vec2::ZERO;
    }
    stick / length * ((length - DEAD_ZONE) / (1.0 - DEAD_ZONE)).min(1.0)
}

/// What a button asks for, while the shoulders [left, right] are held or not.
fn command(button: Button, shoulders: [bool; 2]) -> Option<Command> {
    use Button::*;
    let category = match shoulders {
        [true, false] => Category::Tree,
        [false, true] => Category::Terrain,
        [true, true] => Category::Sky,
        [false, false] => return command_without_shoulder(button),
    };
    let landscape = match button {
        North => Some(1),
        East => Some(2),
        West => Some(3),
        South => Some(4),
        DPadDown => None,
        _ => return None,
    };
    Some(Command::Vote(Best { category, landscape }))
}

fn command_without_shoulder(button: Button) -> Option<Command> {
    use Button::*;
    Some(match button {
        DPadUp => Command::Maximise(1),
        DPadRight => Command::Maximise(2),
        DPadLeft => Command::Maximise(3),
        DPadDown => Command::Maximise(4),
        South | RightThumb => Command::ShowAll,
        West => Command::Compare,
        North => Command::WalkFlyOrbit,
        East => Command::Undo,
        Start => Command::NextGeneration,
        Select => Command::Help,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_stick_is_at_rest_near_its_middle_and_whole_at_its_rim(x in -1f32..1., y in -1f32..1.) {
            let stick = Vec2::new(x, y);
            let got = live(stick);
            prop_assert!(got.length() <= 1.0 + 1e-6);
            prop_assert_eq!(got == Vec2::ZERO, stick.length() <= DEAD_ZONE);
            prop_assert!(got == Vec2::ZERO || got.normalize().distance(stick.normalize()) < 1e-5);
            prop_assert!(live(stick.normalize_or(Vec2::X) * 1.01).length() > 0.9999);
        }
    }

    #[test]
    fn every_vote_can_be_cast() {
        let shoulders = [[true, false], [false, true], [true, true]];
        let cast: std::collections::BTreeSet<Command> = shoulders
            .into_iter()
            .flat_map(|held| {
                [Button::North, Button::East, Button::South, Button::West, Button::DPadDown]
                    .into_iter()
                    .filter_map(move |button| command(button, held))
            })
            .collect();
        let votes: std::collections::BTreeSet<Command> =
            Command::all().filter(|command| matches!(command, Command::Vote(..))).collect();
        assert_eq!(cast, votes);
    }

    #[test]
    fn what_a_pad_that_is_not_there_does() {
        assert_eq!(Gamepads::default().poll(), (Controls::default(), Vec::new()));
        assert_eq!(controls([Vec2::NAN; 2], [f32::NAN; 2], false), Controls::default());
    }
}
