//! Keys and buttons and their names, as people read and write them: "W", "Ctrl+Z", "Mouse Middle", "Numpad 4".
//!
//! Keys are meant by place, not by letter, so that W A S D lie under the same fingers on every keyboard; names are those
//! of a US keyboard. Names do not come from winit's own list, whose "KeyW" and "BracketLeft" nobody would guess.

use std::fmt;
use std::str::FromStr;

use winit::event::MouseButton;
use winit::keyboard::KeyCode;

use super::action::nearest;

/// A key of the keyboard or a button of the mouse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Input {
    /// A key, by place.
    Key(KeyCode),
    /// A button.
    Mouse(MouseButton),
}

/// A key or button, with the keys that are held with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Chord {
    /// What is pressed last.
    pub input: Input,
    /// What is held meanwhile.
    pub with: Modifiers,
}

/// Keys that change what others mean; left and right are one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Modifiers {
    /// Control.
    pub ctrl: bool,
    /// Alt, Option.
    pub alt: bool,
    /// Shift.
    pub shift: bool,
}

impl Modifiers {
    /// None held.
    pub const NONE: Self = Self { ctrl: false, alt: false, shift: false };
    /// Control alone.
    pub const CTRL: Self = Self { ctrl: true, ..Self::NONE };
    /// Alt alone.
    pub const ALT: Self = Self { alt: true, ..Self::NONE };
}

impl Chord {
    /// A key alone.
    pub const fn key(code: KeyCode) -> Self {
        Self { input: Input::Key(code), with: Modifiers::NONE }
    }

    /// The same with other keys held.
    pub const fn with(self, with: Modifiers) -> Self {
        Self { with, ..self }
    }
}

impl fmt::Display for Input {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mouse(MouseButton::Other(number)) => write!(f, "Mouse {number}"),
            known => {
                f.write_str(NAMES.iter().find(|(_, input)| input == known).map_or("?", |(name, _)| name))
            }
        }
    }
}

impl fmt::Display for Chord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let held = [(self.with.ctrl, "Ctrl+"), (self.with.alt, "Alt+"), (self.with.shift, "Shift+")];
        for (_, name) in held.into_iter().filter(|(held, _)| *held) {
            f.write_str(name)?;
        }
        self.input.fmt(f)
    }
}

impl FromStr for Input {
    type Err = String;

    /// Case and blanks make no difference.
    fn from_str(name: &str) -> Result<Self, String> {
        let plain = |name: &str| name.replace([' ', '_'], "").to_lowercase();
        let wanted = plain(name);
        if let Some((_, input)) = NAMES.iter().find(|(known, _)| plain(known) == wanted) {
            return Ok(*input);
        }
        if let Some(number) = wanted.strip_prefix("mouse").and_then(|number| number.parse().ok()) {
            return Ok(Self::Mouse(MouseButton::Other(number)));
        }
        let hint = match nearest(name, NAMES.iter().map(|(known, _)| known.to_string())) {
            Some(near) => format!("did you mean {near}?"),
            None => "keys are written as on a US keyboard: W, 1, [, F5, Space, Left, Numpad 4, Mouse Middle"
                .into(),
        };
        Err(format!("{name:?} is not a key; {hint}"))
    }
}

impl FromStr for Chord {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut with = Modifiers::default();
        let mut rest = text.trim();
        // The key itself may be "+" only on the number pad, where it has a name; so every "+" joins.
        while let Some((held, key)) = rest.split_once('+') {
            match held.trim().to_lowercase().as_str() {
                "ctrl" | "control" => with.ctrl = true,
                "alt" => with.alt = true,
                "shift" => with.shift = true,
                other => {
                    return Err(format!(
                        "{text:?}: {other:?} cannot be held with a key; Ctrl, Alt and Shift can"
                    ));
                }
            }
            rest = key.trim();
        }
        Ok(Self { input: rest.parse()?, with })
    }
}

const fn key(name: &'static str, code: KeyCode) -> (&'static str, Input) {
    (name, Input::Key(code))
}

const fn mouse(name: &'static str, button: MouseButton) -> (&'static str, Input) {
    (name, Input::Mouse(button))
}

/// Every key and button that can be bound.
#[rustfmt::skip]
static NAMES: &[(&str, Input)] = &[
    key("A", KeyCode::KeyA), key("B", KeyCode::KeyB), key("C", KeyCode::KeyC), key("D", KeyCode::KeyD),
    key("E", KeyCode::KeyE), key("F", KeyCode::KeyF), key("G", KeyCode::KeyG), key("H", KeyCode::KeyH),
    key("I", KeyCode::KeyI), key("J", KeyCode::KeyJ), key("K", KeyCode::KeyK), key("L", KeyCode::KeyL),
    key("M", KeyCode::KeyM), key("N", KeyCode::KeyN), key("O", KeyCode::KeyO), key("P", KeyCode::KeyP),
    key("Q", KeyCode::KeyQ), key("R", KeyCode::KeyR), key("S", KeyCode::KeyS), key("T", KeyCode::KeyT),
    key("U", KeyCode::KeyU), key("V", KeyCode::KeyV), key("W", KeyCode::KeyW), key("X", KeyCode::KeyX),
    key("Y", KeyCode::KeyY), key("Z", KeyCode::KeyZ),
    key("0", KeyCode::Digit0), key("1", KeyCode::Digit1), key("2", KeyCode::Digit2), key("3", KeyCode::Digit3),
    key("4", KeyCode::Digit4), key("5", KeyCode::Digit5), key("6", KeyCode::Digit6), key("7", KeyCode::Digit7),
    key("8", KeyCode::Digit8), key("9", KeyCode::Digit9),
    key("F1", KeyCode::F1), key("F2", KeyCode::F2), key("F3", KeyCode::F3), key("F4", KeyCode::F4),
    key("F5", KeyCode::F5), key("F6", KeyCode::F6), key("F7", KeyCode::F7), key("F8", KeyCode::F8),
    key("F9", KeyCode::F9), key("F10", KeyCode::F10), key("F11", KeyCode::F11), key("F12", KeyCode::F12),
    key("`", KeyCode::Backquote), key("-", KeyCode::Minus), key("=", KeyCode::Equal),
    key("[", KeyCode::BracketLeft), key("]", KeyCode::BracketRight), key("\\", KeyCode::Backslash),
    key(";", KeyCode::Semicolon), key("'", KeyCode::Quote), key(",", KeyCode::Comma), key(".", KeyCode::Period),
    key("/", KeyCode::Slash), key("<", KeyCode::IntlBackslash),
    key("Up", KeyCode::ArrowUp), key("Down", KeyCode::ArrowDown),
    key("Left", KeyCode::ArrowLeft), key("Right", KeyCode::ArrowRight),
    key("Space", KeyCode::Space), key("Enter", KeyCode::Enter), key("Tab", KeyCode::Tab),
    key("Escape", KeyCode::Escape), key("Backspace", KeyCode::Backspace), key("Delete", KeyCode::Delete),
    key("Insert", KeyCode::Insert), key("Home", KeyCode::Home), key("End", KeyCode::End),
    key("Page Up", KeyCode::PageUp), key("Page Down", KeyCode::PageDown), key("Pause", KeyCode::Pause),
    key("Print Screen", KeyCode::PrintScreen), key("Caps Lock", KeyCode::CapsLock), key("Menu", KeyCode::ContextMenu),
    key("Left Shift", KeyCode::ShiftLeft), key("Right Shift", KeyCode::ShiftRight),
    key("Left Ctrl", KeyCode::ControlLeft), key("Right Ctrl", KeyCode::ControlRight),
    key("Left Alt", KeyCode::AltLeft), key("Right Alt", KeyCode::AltRight),
    key("Numpad 0", KeyCode::Numpad0), key("Numpad 1", KeyCode::Numpad1), key("Numpad 2", KeyCode::Numpad2),
    key("Numpad 3", KeyCode::Numpad3), key("Numpad 4", KeyCode::Numpad4), key("Numpad 5", KeyCode::Numpad5),
    key("Numpad 6", KeyCode::Numpad6), key("Numpad 7", KeyCode::Numpad7), key("Numpad 8", KeyCode::Numpad8),
    key("Numpad 9", KeyCode::Numpad9), key("Numpad Plus", KeyCode::NumpadAdd),
    key("Numpad Minus", KeyCode::NumpadSubtract), key("Numpad Times", KeyCode::NumpadMultiply),
    key("Numpad Divide", KeyCode::NumpadDivide), key("Numpad Point", KeyCode::NumpadDecimal),
    key("Numpad Enter", KeyCode::NumpadEnter),
    mouse("Mouse Left", MouseButton::Left), mouse("Mouse Right", MouseButton::Right),
    mouse("Mouse Middle", MouseButton::Middle), mouse("Mouse Back", MouseButton::Back),
    mouse("Mouse Forward", MouseButton::Forward),
];

/// Every key and button that has a name.
pub fn inputs() -> impl Iterator<Item = Input> {
    NAMES.iter().map(|(_, input)| *input)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_chord_is_read_as_it_is_written() {
        for input in inputs().chain([Input::Mouse(MouseButton::Other(8))]) {
            for bits in 0..8 {
                let with = Modifiers { ctrl: bits & 1 > 0, alt: bits & 2 > 0, shift: bits & 4 > 0 };
                let chord = Chord { input, with };
                assert_eq!(chord.to_string().parse(), Ok(chord), "{chord}");
            }
        }
    }

    #[test]
    fn people_write_keys_in_more_than_one_way() {
        let undo = Chord::key(KeyCode::KeyZ).with(Modifiers::CTRL);
        for text in ["Ctrl+Z", "ctrl + z", "Control+Z", " CTRL+z "] {
            assert_eq!(text.parse(), Ok(undo), "{text}");
        }
        assert_eq!("pageup".parse(), Ok(Chord::key(KeyCode::PageUp)));
    }

    #[test]
    fn what_is_no_key_is_told_what_would_be() {
        let told = |text: &str| text.parse::<Chord>().expect_err("not a chord");
        assert_eq!(told("Spcae"), "\"Spcae\" is not a key; did you mean Space?");
        assert!(told("Hyper+Q").contains("Ctrl, Alt and Shift can"));
        assert!(told("").contains("keys are written as on a US keyboard"));
        assert!(told("Ctrl+").contains("is not a key"));
    }
}
