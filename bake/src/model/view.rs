//! Where a person first stands.

use glam::{Mat3, Quat, Vec3};
use serde::{Deserialize, Serialize};

/// A place to look from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StartView {
    /// The eye, in metres.
    pub position_m: Vec3,
    /// Unit vector of the look.
    pub direction: Vec3,
}

impl StartView {
    /// Rotation of a glTF camera, which looks along its own −z with +y up.
    pub fn rotation(&self) -> Quat {
        let back = -self.direction;
        let right = Vec3::Y.cross(back).normalize();
        Quat::from_mat3(&Mat3::from_cols(right, back.cross(right), back)).normalize()
    }
}
