//! Keys, mouse and gamepad → what the person wishes: [`Controls`] that last as long as a key is held, and [`Action`]s
//! that happen once. Which key means what is a table that the person may change ([`Bindings`]).

use glam::Vec2;

/// What lasts: one frame's wishes. All of it at rest by default.
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
