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
        unit_quaternion(Quat::from_mat3(&Mat3::from_cols(right, back.cross(right), back)).to_array())
    }
}

/// The shortest rotation that turns +z into the unit vector `direction`.
pub fn rotation_from_z(direction: Vec3) -> Quat {
    let half = 1.0 + direction.z;
    if half < 1e-6 {
        return Quat::from_array([1.0, 0.0, 0.0, 0.0]);
    }
    unit_quaternion([-direction.y, direction.x, 0.0, half])
}

/// A quaternion of length 1, of that direction. Not by glam: the order of its sum is that of the machine's vectors.
fn unit_quaternion([x, y, z, w]: [f32; 4]) -> Quat {
    let length = (x * x + y * y + z * z + w * w).sqrt();
    Quat::from_array([x, y, z, w].map(|part| part / length))
}
