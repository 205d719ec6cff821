//! Where a walk starts. The bake chooses it, and writes it as the glTF camera that any viewer may look through; ours
//! reads it back from there.

use glam::{Mat3, Quat, Vec3};
use serde::{Deserialize, Serialize};

/// Name of the node with the camera.
pub const START_NODE: &str = "start";
/// Its field of view from the lower edge to the upper one, in degrees: what first looks are chosen for, and what the viewer shows.
pub const START_FOV_Y_DEG: f32 = 60.0;
/// Width over height of the picture that first looks are chosen for.
pub const START_ASPECT: f32 = 1.6;

/// A place to look from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StartView {
    /// The eye, in metres.
    pub position_m: Vec3,
    /// Unit vector of the look.
    pub direction: Vec3,
}

impl StartView {
    /// Height of a walker's eyes above the ground.
    pub const EYE_HEIGHT_M: f32 = 1.6;

    /// Rotation of a glTF camera, which looks along its own −z with +y up.
    pub fn rotation(&self) -> Quat {
        let back = -self.direction;
        let right = Vec3::Y.cross(back).normalize();
        unit_quaternion(Quat::from_mat3(&Mat3::from_cols(right, back.cross(right), back)).to_array())
    }

    /// The view of a glTF camera's node.
    pub fn of_camera(translation: [f32; 3], rotation: [f32; 4]) -> Self {
        let direction = Quat::from_array(rotation) * Vec3::NEG_Z;
        Self { position_m: translation.into(), direction }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_looks_where_it_was_turned_to() {
        for direction in [Vec3::NEG_Z, Vec3::X, Vec3::new(-0.6, 0.1, 0.7), Vec3::new(0.1, -0.15, 1.0)] {
            let view = StartView { position_m: Vec3::new(1.0, 2.0, 3.0), direction: direction.normalize() };
            let read = StartView::of_camera(view.position_m.to_array(), view.rotation().to_array());
            assert!(read.direction.distance(view.direction) < 1e-6, "{read:?}");
            assert_eq!(read.position_m, view.position_m);
        }
    }
}
