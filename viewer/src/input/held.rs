//! Presses and releases as they come from a window → what is held at a frame, and what was asked for once.

use egui::Key;
use glam::Vec2;

use super::Controls;
use super::bindings::Bindings;
use super::chord::{Chord, Input, Modifiers};
use super::command::Command;

/// What is held down. Feed it every release, also those that a panel has taken, or keys stick.
#[derive(Clone, Debug, Default)]
pub struct Held {
    /// Keys and buttons that are down, with the held command that each meant when it was pressed: so a key that is bound
    /// anew, or whose Ctrl is let go first, still ends what it began.
    down: Vec<(Input, Option<Command>)>,
    turn_px: Vec2,
    wheel: f32,
}

impl Held {
    /// A key or button goes down. The command that this asks for once, if any; repeats of a held key ask for nothing.
    pub fn press(&mut self, bindings: &Bindings, input: Input) -> Option<Command> {
        if self.down.iter().any(|(down, _)| *down == input) {
            return None;
        }
        let command = bindings.command(Chord { input, with: self.modifiers() });
        self.down.push((input, command.filter(|command| command.is_held())));
        command.filter(|command| !command.is_held())
    }

    /// A key or button goes up.
    pub fn release(&mut self, input: Input) {
        self.down.retain(|(down, _)| *down != input);
    }

    /// The mouse moved by so many counts, x to the right, y towards the person. Only while it steers the view.
    pub fn mouse_moved(&mut self, x_px: f32, y_px: f32) {
        let moved = Vec2::new(x_px, y_px);
        if moved.is_finite() {
            self.turn_px += moved;
        }
    }

    /// The wheel turned by so many lines; away from the person is positive.
    pub fn wheel(&mut self, lines: f32) {
        if lines.is_finite() {
            self.wheel += lines;
        }
    }

    /// The window no longer has the keyboard: all count as released.
    pub fn focus_lost(&mut self) {
        *self = Self::default();
    }

    /// The controls of one frame. What the mouse did is given out once.
    pub fn controls(&mut self) -> Controls {
        let held = |command| self.down.iter().any(|(_, held)| *held == Some(command));
        let axis = |plus, minus| f32::from(u8::from(held(plus))) - f32::from(u8::from(held(minus)));
        Controls {
            forward: axis(Command::Forward, Command::Back),
            right: axis(Command::Right, Command::Left),
            up: axis(Command::Up, Command::Down),
            run: held(Command::Run),
            turn_px: std::mem::take(&mut self.turn_px),
            turn_rate: Vec2::ZERO,
            wheel: std::mem::take(&mut self.wheel),
        }
    }

    /// The keys held that change what others mean.
    pub fn modifiers(&self) -> Modifiers {
        let either = |keys: [Key; 2]| {
            self.down.iter().any(|(input, _)| keys.iter().any(|key| *input == Input::Key(*key)))
        };
        Modifiers {
            ctrl: either([Key::ControlLeft, Key::ControlRight]),
            alt: either([Key::AltLeft, Key::AltRight]),
            shift: either([Key::ShiftLeft, Key::ShiftRight]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn when_all_keys_are_up_nothing_is_held(
            presses in prop::collection::vec((0usize..500, any::<bool>()), 0..60), blur: bool
        ) {
            let (bindings, inputs) = (Bindings::default(), Input::all().collect::<Vec<_>>());
            let mut held = Held::default();
            for (input, pressed) in presses {
                let input = inputs[input % inputs.len()];
                if pressed {
                    let asked = held.press(&bindings, input);
                    prop_assert!(asked.is_none_or(|command| !command.is_held()));
                } else {
                    held.release(input);
                }
                let controls = held.controls();
                prop_assert!([controls.forward, controls.right, controls.up].iter().all(|v| v.abs() <= 1.0));
            }
            if blur {
                held.focus_lost();
            } else {
                inputs.iter().for_each(|input| held.release(*input));
            }
            prop_assert_eq!(held.controls(), Controls::default());
            prop_assert_eq!(held.modifiers(), Modifiers::NONE);
        }
    }

    fn key(name: &str) -> Input {
        name.parse().expect("a key")
    }

    #[test]
    fn two_keys_for_one_command_let_go_one_after_the_other() {
        let (bindings, mut held) = (Bindings::default(), Held::default());
        held.press(&bindings, key("W"));
        held.press(&bindings, key("Up"));
        held.release(key("W"));
        assert_eq!(held.controls().forward, 1.0);
        held.press(&bindings, key("S"));
        assert_eq!(held.controls().forward, 0.0, "forward and back at once is neither");
    }

    #[test]
    fn chords_and_repeats() {
        let (bindings, mut held) = (Bindings::default(), Held::default());
        held.press(&bindings, key("Left Ctrl"));
        assert_eq!(held.press(&bindings, key("Z")), Some(Command::Undo));
        assert_eq!(held.press(&bindings, key("Z")), None, "a held key asks once");
        held.release(key("Left Ctrl"));
        held.release(key("Z"));
        assert_eq!(held.press(&bindings, key("Z")), None);
        held.press(&bindings, key("Left Shift"));
        assert!(held.controls().run);
    }

    #[test]
    fn what_the_mouse_did_counts_once() {
        let mut held = Held::default();
        held.mouse_moved(3.0, -1.0);
        held.mouse_moved(2.0, 0.0);
        held.wheel(1.5);
        held.mouse_moved(f32::NAN, 0.0);
        let controls = held.controls();
        assert_eq!((controls.turn_px, controls.wheel), (Vec2::new(5.0, -1.0), 1.5));
        assert_eq!(held.controls(), Controls::default());
    }
}
