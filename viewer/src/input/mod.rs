//! Keys, mouse and gamepad → [`Controls`] that last as long as a key is held, and [`Command`]s that happen once. Which
//! key means what is a table that the person may change ([`Bindings`]).

mod bindings;
mod chord;
mod command;
mod held;

pub use bindings::{Bindings, KeyGroup};
pub use chord::{Chord, Input, Modifiers};
pub use command::{Best, Command};
pub use held::Held;

use glam::Vec2;

/// How the camera is steered during one frame; at rest by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Controls {
    /// −1 (back) to 1.
    pub forward: f32,
    /// −1 (left) to 1.
    pub right: f32,
    /// −1 (down) to 1.
    pub up: f32,
    /// Faster.
    pub run: bool,
    /// Counts of the mouse since the last frame: x to the right, y towards the person ("down").
    pub turn_px: Vec2,
    /// Deflection of a stick, each −1 to 1: x to the right, y up.
    pub turn_rate: Vec2,
    /// Lines of the wheel since the last frame; away from the person is positive.
    pub wheel: f32,
}

impl Controls {
    /// Both at once, keyboard and gamepad. What exceeds full deflection is cut.
    pub fn and(self, other: Self) -> Self {
        let axis = |one: f32, other: f32| (one + other).clamp(-1.0, 1.0);
        Self {
            forward: axis(self.forward, other.forward),
            right: axis(self.right, other.right),
            up: axis(self.up, other.up),
            run: self.run || other.run,
            turn_px: self.turn_px + other.turn_px,
            turn_rate: (self.turn_rate + other.turn_rate).clamp(Vec2::NEG_ONE, Vec2::ONE),
            wheel: self.wheel + other.wheel,
        }
    }
}
