//! Presses and releases as they come from a window → what is held at a frame, and what was asked for once.

use glam::Vec2;
use winit::event::MouseButton;
use winit::keyboard::KeyCode;

use super::Controls;
use super::action::Action;
use super::bindings::Bindings;
use super::chord::{Chord, Input, Modifiers};

/// What is held down. Feed it every release, also those that a panel has taken, or keys stick.
#[derive(Clone, Debug, Default)]
pub struct Held {
    /// Held keys that last, with what they meant when they were pressed: so a key that is bound anew, or whose Ctrl is
    /// let go first, still ends what it began.
    lasting: Vec<(Input, Action)>,
    modifiers: Vec<KeyCode>,
    turn_px: Vec2,
    wheel: f32,
}

impl Held {
    /// A key goes down or up. Gives the action that this asks for once, if any; repeats of a held key ask for nothing.
    pub fn key(&mut self, bindings: &Bindings, code: KeyCode, pressed: bool, repeat: bool) -> Option<Action> {
        let asked = if repeat { None } else { self.input(bindings, Input::Key(code), pressed) };
        self.modifiers.retain(|&held| held != code);
        if pressed && is_modifier(code) {
            self.modifiers.push(code);
        }
        asked
    }

    /// The same for a button of the mouse.
    pub fn button(&mut self, bindings: &Bindings, button: MouseButton, pressed: bool) -> Option<Action> {
        self.input(bindings, Input::Mouse(button), pressed)
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

    /// The window is no longer the one that hears keys: all count as released.
    pub fn focus_lost(&mut self) {
        *self = Self::default();
    }

    /// This frame's wishes. What the mouse did is given out once.
    pub fn controls(&mut self) -> Controls {
        let axis = |plus: Action, minus: Action| self.part(plus) - self.part(minus);
        let controls = Controls {
            forward: axis(Action::Forward, Action::Back),
            right: axis(Action::Right, Action::Left),
            up: axis(Action::Up, Action::Down),
            run: self.part(Action::Run) > 0.0,
            turn_px: self.turn_px,
            turn_rate: Vec2::ZERO,
            wheel: self.wheel,
        };
        (self.turn_px, self.wheel) = (Vec2::ZERO, 0.0);
        controls
    }

    /// The keys held that change what others mean.
    pub fn modifiers(&self) -> Modifiers {
        let either = |left, right| self.modifiers.iter().any(|&code| code == left || code == right);
        Modifiers {
            ctrl: either(KeyCode::ControlLeft, KeyCode::ControlRight),
            alt: either(KeyCode::AltLeft, KeyCode::AltRight),
            shift: either(KeyCode::ShiftLeft, KeyCode::ShiftRight),
        }
    }

    fn input(&mut self, bindings: &Bindings, input: Input, pressed: bool) -> Option<Action> {
        self.lasting.retain(|(held, _)| *held != input);
        if !pressed {
            return None;
        }
        let action = bindings.action(Chord { input, with: self.modifiers() })?;
        if action.is_held() {
            self.lasting.push((input, action));
            return None;
        }
        Some(action)
    }

    /// 1 while an action is held, by one key or more.
    fn part(&self, action: Action) -> f32 {
        if self.lasting.iter().any(|(_, held)| *held == action) { 1.0 } else { 0.0 }
    }
}

fn is_modifier(code: KeyCode) -> bool {
    use KeyCode::*;
    matches!(code, ControlLeft | ControlRight | AltLeft | AltRight | ShiftLeft | ShiftRight)
}

#[cfg(test)]
mod tests {
    use super::super::chord::inputs;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn when_all_keys_are_up_nothing_is_held(
            presses in prop::collection::vec((0usize..500, any::<bool>(), any::<bool>()), 0..60), blur: bool
        ) {
            let (bindings, inputs) = (Bindings::default(), inputs().collect::<Vec<_>>());
            let mut held = Held::default();
            let feed = |held: &mut Held, input, pressed, repeat| match input {
                Input::Key(code) => held.key(&bindings, code, pressed, repeat),
                Input::Mouse(button) => held.button(&bindings, button, pressed),
            };
            for (input, pressed, repeat) in presses {
                let asked = feed(&mut held, inputs[input % inputs.len()], pressed, repeat && pressed);
                prop_assert!(asked.is_none_or(|action| pressed && !action.is_held()));
                let controls = held.controls();
                prop_assert!([controls.forward, controls.right, controls.up].iter().all(|v| v.abs() <= 1.0));
            }
            if blur {
                held.focus_lost();
            } else {
                for &input in &inputs {
                    feed(&mut held, input, false, false);
                }
            }
            prop_assert_eq!(held.controls(), Controls::default());
            prop_assert_eq!(held.modifiers(), Modifiers::NONE);
        }
    }

    #[test]
    fn two_keys_for_one_wish_let_go_one_after_the_other() {
        let (bindings, mut held) = (Bindings::default(), Held::default());
        held.key(&bindings, KeyCode::KeyW, true, false);
        held.key(&bindings, KeyCode::ArrowUp, true, false);
        held.key(&bindings, KeyCode::KeyW, false, false);
        assert_eq!(held.controls().forward, 1.0);
        held.key(&bindings, KeyCode::KeyS, true, false);
        assert_eq!(held.controls().forward, 0.0, "forward and back at once is neither");
    }

    #[test]
    fn chords_and_repeats() {
        let (bindings, mut held) = (Bindings::default(), Held::default());
        held.key(&bindings, KeyCode::ControlLeft, true, false);
        assert_eq!(held.key(&bindings, KeyCode::KeyZ, true, false), Some(Action::Undo));
        assert_eq!(held.key(&bindings, KeyCode::KeyZ, true, true), None, "a held key asks once");
        held.key(&bindings, KeyCode::ControlLeft, false, false);
        assert_eq!(held.key(&bindings, KeyCode::KeyZ, true, false), None);
        held.key(&bindings, KeyCode::ShiftLeft, true, false);
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
