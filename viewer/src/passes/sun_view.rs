//! What parallel light reaches: the sun's view of a landscape, orthographic, across its light.

use glam::{Mat4, Vec2, Vec3, Vec4};

use super::layouts::SUN_VIEW;
use super::{Binding, Layouts, bind};
use crate::gpu::Gpu;
use crate::upload::SceneBuffers;

/// Trees reach no higher above the land: what throws shadows lies below.
const MAX_TREE_HEIGHT_M: f32 = 60.0;
/// However low the sun, shadows of trees on what is near come from no farther.
const MAX_SHADOW_M: f32 = 1000.0;

/// A box along the sun's rays: x to the right as the sun sees it, y up, z away from the sun; metres from the world's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunView {
    axes: [Vec3; 3],
    min: Vec3,
    max: Vec3,
}

impl SunView {
    /// Of the whole field, trees included.
    pub fn of_field(scene: &SceneBuffers) -> Self {
        let half = 0.5 * scene.ground.field.extent_m();
        let [low, high] = scene.ground.lod.range_m();
        Self::of_box(scene, [Vec2::splat(-half), Vec2::splat(half)], [low - 5.0, high + MAX_TREE_HEIGHT_M])
    }

    /// Of the ground within a distance of a place, as x and z, and of all trees that may shade it.
    pub fn of_ground(scene: &SceneBuffers, middle_m: Vec2, reach_m: f32) -> Self {
        let field = &scene.ground.field;
        let line = |at_m: f32| {
            (at_m / field.spacing_m + 0.5 * (field.side - 1) as f32).clamp(0.0, (field.side - 1) as f32)
        };
        let lines = |at_m: f32| line(at_m - reach_m) as usize..line(at_m + reach_m).ceil() as usize + 1;
        let rows =
            lines(middle_m.y).map(|row| &field.heights_m[row * field.side as usize..][lines(middle_m.x)]);
        let (low, high) = rows
            .flatten()
            .fold((f32::MAX, f32::MIN), |(low, high), &height_m| (low.min(height_m), high.max(height_m)));
        let ground = Self::of_box(scene, [middle_m - reach_m, middle_m + reach_m], [low, high]);
        // To its sides a disc is all that counts.
        let [right, ..] = ground.axes;
        let across = right.dot(Vec3::new(middle_m.x, 0.0, middle_m.y));
        let shadow_m = (MAX_TREE_HEIGHT_M / scene.sky.sun_direction.y.max(1e-3)).min(MAX_SHADOW_M);
        Self {
            min: Vec3::new(across - reach_m, ground.min.y, ground.min.z - shadow_m),
            max: Vec3::new(across + reach_m, ground.max.y, ground.max.z),
            ..ground
        }
    }

    fn of_box(scene: &SceneBuffers, [from_m, to_m]: [Vec2; 2], [low_m, high_m]: [f32; 2]) -> Self {
        let to_sun = scene.sky.sun_direction.normalize_or(Vec3::Y);
        // Any direction that is never parallel to the sun's.
        let aside = if to_sun.y.abs() < 0.9 { Vec3::Y } else { Vec3::X };
        let right = aside.cross(to_sun).normalize();
        let axes = [right, to_sun.cross(right), -to_sun];
        let (mut min, mut max) = (Vec3::MAX, Vec3::MIN);
        for corner in 0..8 {
            let one_of = |bit: u32, low: f32, high: f32| if corner >> bit & 1 == 1 { high } else { low };
            let place =
                Vec3::new(one_of(0, from_m.x, to_m.x), one_of(1, low_m, high_m), one_of(2, from_m.y, to_m.y));
            let seen = Vec3::from_array(axes.map(|axis| axis.dot(place)));
            (min, max) = (min.min(seen), max.max(seen));
        }
        Self { axes, min, max }
    }

    /// x and y in [−1, 1], depth in [0, 1] away from the sun.
    pub fn clip_from_world(&self) -> Mat4 {
        let size = self.max - self.min;
        let scale = Vec3::new(2.0 / size.x, 2.0 / size.y, 1.0 / size.z);
        let offset = Vec3::new(-1.0, -1.0, 0.0) - self.min * scale;
        let [x, y, z] = std::array::from_fn(|k| (self.axes[k] * scale[k]).extend(offset[k]));
        Mat4::from_cols(x, y, z, Vec4::W).transpose()
    }

    /// Across the light: two directions, and from where to where along each, in metres.
    pub fn sides(&self) -> [(Vec3, [f32; 2]); 2] {
        [0, 1].map(|k| (self.axes[k], [self.min[k], self.max[k]]))
    }

    /// How wide a texel is of a map that so many texels cover from left to right.
    pub fn texel_m(&self, texels: u32) -> f32 {
        (self.max.x - self.min.x) / texels as f32
    }
}

/// Group 0 of passes that draw or read what the sun sees; `uniform` holds its view's [`super::ViewUniform`].
pub(super) fn group(
    gpu: &Gpu,
    layouts: &Layouts,
    scene: &SceneBuffers,
    uniform: &wgpu::Buffer,
) -> wgpu::BindGroup {
    let bound = [
        Binding::Buffer(uniform),
        Binding::Sampler(&layouts.clamped),
        Binding::Sampler(&layouts.nearest),
        Binding::texture(&scene.land.heights),
    ];
    bind(gpu, "view of the sun", &layouts.sun_view, SUN_VIEW.into_iter().zip(bound))
}
