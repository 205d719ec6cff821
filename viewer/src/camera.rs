//! A camera's place and view → the matrices and planes that drawing needs. Right-handed, y up, metres, radians;
//! reversed depth with the far plane at infinity (thesis 5.2).

use glam::camera::rh::{proj::directx, view};
use glam::{Mat4, Vec3, Vec4};

/// Distance of the near plane in metres: half of what keeps an eye from a trunk that it touches.
pub const NEAR_M: f32 = 0.1;

/// Where one view's eye is and where it looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The eye in metres.
    pub position_m: Vec3,
    /// Turn about the vertical: 0 looks north (−z), positive turns left (counter-clockwise from above).
    pub yaw_rad: f32,
    /// Positive looks up.
    pub pitch_rad: f32,
    /// Vertical field of view.
    pub fov_y_rad: f32,
}

impl Camera {
    /// Unit vector of the direction of view.
    pub fn forward(&self) -> Vec3 {
        let (sin_yaw, cos_yaw) = libm::sincosf(self.yaw_rad);
        let (sin_pitch, cos_pitch) = libm::sincosf(self.pitch_rad);
        Vec3::new(-sin_yaw * cos_pitch, sin_pitch, -cos_yaw * cos_pitch)
    }

    /// Unit vector to the right, always level.
    pub fn right(&self) -> Vec3 {
        let (sin_yaw, cos_yaw) = libm::sincosf(self.yaw_rad);
        Vec3::new(cos_yaw, 0.0, -sin_yaw)
    }

    /// Pixels that one radian covers in the middle of a picture `height_px` high.
    pub fn focal_px(&self, height_px: f32) -> f32 {
        0.5 * height_px / libm::tanf(0.5 * self.fov_y_rad)
    }

    /// View space (looking along −z) from the world.
    pub fn view_from_world(&self) -> Mat4 {
        let forward = self.forward();
        view::look_to_mat4(self.position_m, forward, self.right().cross(forward))
    }

    /// Clip space from view space: depth 1 at the near plane, 0 at infinity. `aspect`: width over height.
    pub fn clip_from_view(&self, aspect: f32) -> Mat4 {
        directx::perspective_infinite_reverse(self.fov_y_rad, aspect, NEAR_M)
    }

    /// Clip space from the world.
    pub fn clip_from_world(&self, aspect: f32) -> Mat4 {
        self.clip_from_view(aspect) * self.view_from_world()
    }

    /// The planes that bound what is seen.
    pub fn frustum(&self, aspect: f32) -> Frustum {
        Frustum::of(self.clip_from_world(aspect))
    }
}

/// The five planes of a view without a far plane: left, right, bottom, top, near. A point p is inside a plane (n, d)
/// if n·p + d ≥ 0; n has unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    /// (n, d) of each.
    pub planes: [Vec4; 5],
}

impl Frustum {
    /// The planes of a clip space (Gribb & Hartmann 2001).
    pub fn of(clip_from_world: Mat4) -> Self {
        let rows = clip_from_world.transpose();
        let (x, y, z, w) = (rows.x_axis, rows.y_axis, rows.z_axis, rows.w_axis);
        // Reversed depth: the near plane is z ≤ w.
        let planes = [w + x, w - x, w + y, w - y, w - z];
        Self { planes: planes.map(|plane| plane / plane.truncate().length()) }
    }

    /// False only if nothing of the sphere can be seen.
    pub fn sees_sphere(&self, center_m: Vec3, radius_m: f32) -> bool {
        self.planes.iter().all(|plane| plane.dot(center_m.extend(1.0)) >= -radius_m)
    }

    /// False only if nothing of the box can be seen.
    pub fn sees_box(&self, low_m: Vec3, high_m: Vec3) -> bool {
        self.planes.iter().all(|plane| {
            let farthest = Vec3::select(plane.truncate().cmpge(Vec3::ZERO), high_m, low_m);
            plane.dot(farthest.extend(1.0)) >= 0.0
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    prop_compose! {
        fn camera()(x in -500f32..500., y in 0f32..300., z in -500f32..500., yaw in -7f32..7., pitch in -1.5f32..1.5)
            -> Camera {
            Camera { position_m: Vec3::new(x, y, z), yaw_rad: yaw, pitch_rad: pitch, fov_y_rad: 1.0 }
        }
    }

    proptest! {
        #[test]
        fn what_lies_ahead_is_in_the_middle_of_the_picture(camera in camera(), distance in 0.2f32..5000.) {
            let ahead = camera.position_m + camera.forward() * distance;
            let clip = camera.clip_from_world(1.5) * ahead.extend(1.0);
            let ndc = clip / clip.w;
            prop_assert!(ndc.x.abs() < 2e-3 && ndc.y.abs() < 2e-3, "{ndc}");
            prop_assert!(ndc.z > 0.0 && ndc.z <= 1.0, "{ndc}");
            prop_assert!((ndc.z * distance / NEAR_M - 1.0).abs() < 5e-3, "depth is near over distance");
        }

        #[test]
        fn a_point_is_seen_exactly_if_it_projects_into_the_picture(
            camera in camera(), x in -900f32..900., y in -200f32..400., z in -900f32..900.
        ) {
            let point = Vec3::new(x, y, z);
            let clip = camera.clip_from_world(1.5) * point.extend(1.0);
            let margin = (clip.w.abs() - clip.x.abs()).abs().min((clip.w.abs() - clip.y.abs()).abs());
            prop_assume!(margin > 0.05 && (clip.w - NEAR_M).abs() > 0.05);
            let inside = clip.x.abs() < clip.w && clip.y.abs() < clip.w && clip.z < clip.w;
            prop_assert_eq!(camera.frustum(1.5).sees_sphere(point, 0.0), inside);
            prop_assert_eq!(camera.frustum(1.5).sees_box(point, point), inside);
        }
    }

    #[test]
    fn yaw_turns_left_and_pitch_looks_up() {
        let look = |yaw_rad, pitch_rad| {
            Camera { position_m: Vec3::ZERO, yaw_rad, pitch_rad, fov_y_rad: 1.0 }.forward()
        };
        assert_eq!(look(0.0, 0.0), -Vec3::Z);
        assert!(look(0.5, 0.0).x < 0.0, "west is to the left of north");
        assert!(look(0.0, 0.5).y > 0.0);
    }
}
