//! Keys and buttons and their names, as people read and write them: "W", "Ctrl+Z", "Mouse Middle", "Numpad 4".
//!
//! Keys are meant by place, not by letter, so that W A S D lie under the same fingers on every keyboard; names are those
//! of a US keyboard.

use std::fmt;
use std::str::FromStr;

use egui::Key;
use winit::event::MouseButton;
use winit::keyboard::KeyCode;

use super::command::nearest;

/// A key of the keyboard or a button of the mouse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Input {
    /// A key, by place.
    Key(Key),
    /// A key of the number pad, by its index in [`NUMPAD`]: egui takes these for the keys with the same sign.
    Numpad(usize),
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
    pub ctrl: bool,
    pub alt: bool,
    pub shift: bool,
}

impl Modifiers {
    pub const NONE: Self = Self { ctrl: false, alt: false, shift: false };
}

/// Keys of the number pad: winit's names, less "Numpad".
const NUMPAD_CODES: [&str; 16] = [
    "0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "Add", "Subtract", "Multiply", "Divide", "Decimal",
    "Enter",
];
/// Keys of the number pad: our names, less "Numpad ".
const NUMPAD: [&str; 16] =
    ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "Plus", "Minus", "Times", "Divide", "Point", "Enter"];

/// Buttons of the mouse that have a name.
const BUTTONS: [MouseButton; 5] = {
    use MouseButton::*;
    [Left, Right, Middle, Back, Forward]
};

impl Input {
    /// Every key and button that has a name.
    pub fn all() -> impl Iterator<Item = Self> {
        use Key::*;
        // These signs have no key of their own on a US keyboard.
        let absent = [Colon, Plus, Pipe, Questionmark, Exclamationmark, OpenCurlyBracket, CloseCurlyBracket];
        let keys = Key::ALL.iter().filter(move |key| !absent.contains(key)).map(|key| Self::Key(*key));
        let buttons = BUTTONS.map(Self::Mouse);
        keys.chain((0..NUMPAD.len()).map(Self::Numpad)).chain(buttons)
    }

    /// The key of that code; `None` if it has no name. Both winit and egui know keys by the names of the W3C's "UI Events".
    pub fn from_code(code: KeyCode) -> Option<Self> {
        let name = format!("{code:?}");
        match name.strip_prefix("Numpad") {
            Some(name) => NUMPAD_CODES.iter().position(|known| *known == name).map(Self::Numpad),
            None => Key::from_name(&name).map(Self::Key),
        }
    }
}

impl Chord {
    /// A key or button alone.
    pub const fn alone(input: Input) -> Self {
        Self { input, with: Modifiers::NONE }
    }
}

impl fmt::Display for Input {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Key(key) => f.write_str(&key_name(*key)),
            Self::Numpad(index) => write!(f, "Numpad {}", NUMPAD[*index]),
            Self::Mouse(MouseButton::Other(number)) => write!(f, "Mouse {number}"),
            Self::Mouse(button) => write!(f, "Mouse {button:?}"),
        }
    }
}

/// What is printed on a key, or its name in words.
fn key_name(key: Key) -> String {
    let fixed = match key {
        Key::Minus => "-",
        Key::Quote => "'",
        Key::IntlBackslash => "<",
        Key::ShiftLeft => "Left Shift",
        Key::ShiftRight => "Right Shift",
        Key::ControlLeft => "Left Ctrl",
        Key::ControlRight => "Right Ctrl",
        Key::AltLeft => "Left Alt",
        Key::AltRight => "Right Alt",
        // One sign where there is one that is on the keyboard, too.
        _ if key.symbol_or_name().is_ascii() => key.symbol_or_name(),
        _ => key.name(),
    };
    let mut words = String::new();
    for letter in fixed.chars() {
        if letter.is_uppercase() && words.ends_with(char::is_lowercase) {
            words.push(' ');
        }
        words.push(letter);
    }
    words
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
        if let Some(input) = Self::all().find(|known| plain(&known.to_string()) == wanted) {
            return Ok(input);
        }
        if let Some(number) = wanted.strip_prefix("mouse").and_then(|number| number.parse().ok()) {
            return Ok(Self::Mouse(MouseButton::Other(number)));
        }
        let names: Vec<String> = Self::all().map(|known| known.to_string()).collect();
        let hint = match nearest(name, &names) {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_chord_is_read_as_it_is_written() {
        for input in Input::all().chain([Input::Mouse(MouseButton::Other(8))]) {
            for bits in 0..8 {
                let with = Modifiers { ctrl: bits & 1 > 0, alt: bits & 2 > 0, shift: bits & 4 > 0 };
                let chord = Chord { input, with };
                assert_eq!(chord.to_string().parse(), Ok(chord), "{chord}");
            }
        }
    }

    #[test]
    fn people_write_keys_in_more_than_one_way() {
        let undo = Chord { input: Input::Key(Key::Z), with: Modifiers { ctrl: true, ..Modifiers::NONE } };
        for text in ["Ctrl+Z", "ctrl + z", "Control+Z", " CTRL+z "] {
            assert_eq!(text.parse(), Ok(undo), "{text}");
        }
        assert_eq!("pageup".parse(), Ok(Chord::alone(Input::Key(Key::PageUp))));
    }

    /// The names that settings files have had since the first version.
    #[test]
    fn names_in_settings_files_stay_and_each_is_a_key_that_can_be_pressed() {
        use KeyCode as K;
        let named = [
            ("A", K::KeyA),
            ("Z", K::KeyZ),
            ("0", K::Digit0),
            ("9", K::Digit9),
            ("F1", K::F1),
            ("F12", K::F12),
            ("`", K::Backquote),
            ("-", K::Minus),
            ("=", K::Equal),
            ("[", K::BracketLeft),
            ("]", K::BracketRight),
            ("\\", K::Backslash),
            (";", K::Semicolon),
            ("'", K::Quote),
            (",", K::Comma),
            (".", K::Period),
            ("/", K::Slash),
            ("<", K::IntlBackslash),
            ("Up", K::ArrowUp),
            ("Down", K::ArrowDown),
            ("Left", K::ArrowLeft),
            ("Right", K::ArrowRight),
            ("Space", K::Space),
            ("Enter", K::Enter),
            ("Tab", K::Tab),
            ("Escape", K::Escape),
            ("Backspace", K::Backspace),
            ("Delete", K::Delete),
            ("Insert", K::Insert),
            ("Home", K::Home),
            ("End", K::End),
            ("Page Up", K::PageUp),
            ("Page Down", K::PageDown),
            ("Pause", K::Pause),
            ("Print Screen", K::PrintScreen),
            ("Caps Lock", K::CapsLock),
            ("Menu", K::ContextMenu),
            ("Left Shift", K::ShiftLeft),
            ("Right Shift", K::ShiftRight),
            ("Left Ctrl", K::ControlLeft),
            ("Right Ctrl", K::ControlRight),
            ("Left Alt", K::AltLeft),
            ("Right Alt", K::AltRight),
            ("Numpad 0", K::Numpad0),
            ("Numpad 9", K::Numpad9),
            ("Numpad Plus", K::NumpadAdd),
            ("Numpad Minus", K::NumpadSubtract),
            ("Numpad Times", K::NumpadMultiply),
            ("Numpad Divide", K::NumpadDivide),
            ("Numpad Point", K::NumpadDecimal),
            ("Numpad Enter", K::NumpadEnter),
        ];
        for (name, code) in named {
            let input = Input::from_code(code).unwrap_or_else(|| panic!("{code:?} has no name"));
            assert_eq!(name.parse(), Ok(input), "{name}");
            assert_eq!(input.to_string(), name);
        }
        let names: std::collections::BTreeSet<String> = Input::all().map(|input| input.to_string()).collect();
        assert_eq!(names.len(), Input::all().count(), "two keys have one name");
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
