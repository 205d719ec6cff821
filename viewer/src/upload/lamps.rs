//! Where light comes from in the room that anyone's file is shown in: a key light, and a sky that is a number of lamps.

use glam::{Mat4, Vec3, Vec4};

/// The key light, then [`SKY_LAMPS`].
pub const LAMPS: usize = 1 + SKY_LAMPS;
/// Rings above the horizon, each with as many lamps: `asset.wgsl` looks at one lamp of each quarter of the compass.
pub const RINGS: usize = 4;
const SKY_LAMPS: usize = RINGS * RINGS;
/// Towards the key light of a file that has no sun: at the right of whoever looks at the front. Also in `asset.wgsl`.
const KEY: Vec3 = Vec3::new(0.48, 0.64, 0.6);
/// Part of a lamp's depths, beside a half, that what is shown takes; nothing is drawn where there is nothing.
pub const HALF_DEPTH: f32 = 0.49;

/// Parallel light. As `Lamp` of `asset.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Lamp {
    /// Unit vectors: towards the lamp, and to the right of what it sees.
    pub towards: [f32; 4],
    pub right: [f32; 4],
}

impl Lamp {
    fn new(towards: Vec3) -> Self {
        let towards = towards.normalize_or(Vec3::Y);
        let right = towards.any_orthonormal_vector();
        Self { towards: towards.extend(0.0).to_array(), right: right.extend(0.0).to_array() }
    }

    /// What it sees of a sphere: x and y in [−1, 1], depth in [0, 1] away from it.
    pub fn clip_from_world(&self, middle_m: Vec3, radius_m: f32) -> Mat4 {
        let (towards, right) = (Vec4::from(self.towards).truncate(), Vec4::from(self.right).truncate());
        let row = |axis: Vec3, shift: f32| axis.extend(shift - axis.dot(middle_m));
        let rows = [
            row(right / radius_m, 0.0),
            row(towards.cross(right) / radius_m, 0.0),
            row(towards * (-HALF_DEPTH / radius_m), 0.5),
        ];
        Mat4::from_cols(rows[0], rows[1], rows[2], Vec4::W).transpose()
    }
}

/// `sun`: towards the file's own, which is the key light if there is one. Of the sky each quarter of the compass has one lamp of each
/// ring, and rings are as high as each other: so all stand for as much of it (Archimedes).
pub(super) fn lamps(sun: Option<Vec3>) -> [Lamp; LAMPS] {
    std::array::from_fn(|number| {
        let Some(number) = number.checked_sub(1) else { return Lamp::new(sun.unwrap_or(KEY)) };
        let (quarter, ring) = (number / RINGS, number % RINGS);
        let up = (ring as f32 + 0.5) / RINGS as f32;
        // Those of one quarter are spread over it.
        let beside = [0.125, 0.625, 0.375, 0.875][ring];
        let (sin, cos) = libm::sincosf((quarter as f32 + beside) * std::f32::consts::FRAC_PI_2);
        let flat = libm::sqrtf(1.0 - up * up);
        Lamp::new(Vec3::new(flat * cos, up, flat * sin))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sky_is_as_bright_all_around_and_lamps_see_all_of_what_is_shown() {
        let lamps = lamps(None);
        let [_, sky @ ..] = lamps;
        let mean: Vec4 = sky.iter().map(|lamp| Vec4::from(lamp.towards)).sum::<Vec4>() / SKY_LAMPS as f32;
        assert!((mean - Vec4::new(0.0, 0.5, 0.0, 0.0)).length() < 0.04, "{mean}");
        let (middle_m, radius_m) = (Vec3::new(1.0, 7.0, -2.0), 3.0);
        for lamp in lamps {
            let clip = lamp.clip_from_world(middle_m, radius_m);
            let towards = Vec4::from(lamp.towards).truncate();
            let [near, far] =
                [1.0, -1.0].map(|side| clip.project_point3(middle_m + side * radius_m * towards));
            assert!((near - Vec3::new(0.0, 0.0, 0.01)).length() < 1e-4, "{near}");
            assert!((far - Vec3::new(0.0, 0.0, 0.99)).length() < 1e-4, "{far}");
            let side = middle_m + radius_m * Vec4::from(lamp.right).truncate();
            assert!((clip.project_point3(side) - Vec3::new(1.0, 0.0, 0.5)).length() < 1e-4);
        }
    }
}
