//! Camera, landscape and the person's wishes → the numbers that all shaders read (`View` in `common.wgsl`).

use glam::{Mat4, Vec3};

use super::drift::Drift;
use super::grass::SHADED_TURF_M;
use super::{Shift, SunView};
use crate::camera::Camera;
use crate::lod::morph::Detail;
use crate::options::FrameInput;
use crate::upload::{KINDS, SceneBuffers};

/// `View` of `common.wgsl`, which says what each field is; a test compares the two.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct ViewUniform {
    pub clip_from_world: [[f32; 4]; 4],
    pub ray_from_clip: [[f32; 4]; 4],
    pub shadow_from_world: [[f32; 4]; 4],
    pub eye: [f32; 3],
    pub time_s: f32,
    pub sun_direction: [f32; 3],
    pub sun_angular_radius: f32,
    pub sun_irradiance: [f32; 3],
    pub exposure: f32,
    pub sky_irradiance: [f32; 3],
    pub haze_extinction: f32,
    pub water_level: f32,
    pub sea: f32,
    pub focal_px: f32,
    pub tint_levels: u32,
    pub other_clouds: f32,
    pub lod_pixels: f32,
    pub noise: f32,
    pub mip_bias: f32,
    pub clouds: [f32; 4],
    pub drift: [f32; 4],
    pub lod_eye: [f32; 3],
    pub lod_above: f32,
    pub field: [f32; 4],
    pub shade: [f32; 4],
    pub ground_kinds: [[f32; 4]; KINDS],
    pub ground_albedo: [f32; 3],
    pub turf_m: f32,
    pub lod_top: f32,
    pub part: f32,
    pub lod_unit: f32,
    pub unused: f32,
}

/// What stands for "no lake".
const NO_WATER_M: f32 = -1.0e6;

impl ViewUniform {
    /// What all views have: `camera` draws, `exposure` is the landscape's own.
    pub fn of_camera(camera: &Camera, size_px: [u32; 2], frame: &FrameInput, exposure: f32) -> Self {
        let [width, height] = size_px.map(|side| side.max(1) as f32);
        // Directions don't depend on where the eye is.
        let at_origin = Camera { position_m: Vec3::ZERO, ..*camera };
        let options = &frame.options;
        let Shift { middle_px: [x_px, y_px], noise, mip_bias } =
            Shift::of(frame.accumulated, options.samples);
        // What is at a pixel's moved middle is drawn in its middle.
        let moved = Mat4::from_translation(Vec3::new(-2.0 * x_px / width, -2.0 * y_px / height, 0.0));
        let clip_from = |camera: &Camera| moved * camera.clip_from_world(width / height);
        Self {
            clip_from_world: clip_from(camera).to_cols_array_2d(),
            ray_from_clip: clip_from(&at_origin).inverse().to_cols_array_2d(),
            eye: camera.position_m.into(),
            time_s: frame.time_s,
            exposure: exposure * options.exposure,
            focal_px: camera.focal_px(height),
            tint_levels: options.tint_levels.into(),
            part: frame.part,
            noise,
            mip_bias,
            ..Default::default()
        }
    }

    /// The numbers of one view of a landscape: `camera` draws, `lod_eye` is the camera for which levels of detail are
    /// chosen, `detail` says how detailed the land is where, and `shade` where that of near trees is known.
    pub fn new(
        scene: &SceneBuffers,
        camera: &Camera,
        lod_camera: &Camera,
        size_px: [u32; 2],
        frame: &FrameInput,
        detail: &Detail,
        shade: [f32; 4],
    ) -> Self {
        let (options, sky) = (&frame.options, &scene.sky);
        let drift = if options.drift_clouds { Drift::after(frame.time_s) } else { Drift::default() };
        let ([x, z], [other_x, other_z]) = (drift.main_m.to_array(), drift.other_m.to_array());
        Self {
            sun_direction: sky.sun_direction.to_array(),
            sun_angular_radius: sky.sun_angular_radius_rad,
            sun_irradiance: sky.sun_irradiance_linear,
            sky_irradiance: sky.sky_irradiance_linear,
            haze_extinction: sky.haze_extinction_per_m,
            water_level: scene.ground.water_level_m.unwrap_or(NO_WATER_M),
            sea: scene.land.lake.as_ref().map_or(0.0, |lake| lake.sea),
            other_clouds: drift.other_share,
            lod_pixels: detail.pixels,
            clouds: scene.sky_textures.sheets_m,
            drift: [x, z, other_x, other_z],
            lod_eye: lod_camera.position_m.into(),
            lod_above: detail.above_m,
            ground_kinds: scene.land.kinds,
            lod_top: detail.top,
            lod_unit: detail.unit_m,
            ground_albedo: scene.land.albedo_linear.to_array(),
            turf_m: if options.draws_grass() { SHADED_TURF_M * frame.part } else { 0.0 },
            shadow_from_world: SunView::of_field(scene).clip_from_world().to_cols_array_2d(),
            shade,
            field: Self::field(scene),
            ..Self::of_camera(camera, size_px, frame, sky.exposure)
        }
    }

    /// What is read of it while a shadow map is drawn.
    pub fn for_sun(scene: &SceneBuffers, sun_view: &SunView) -> Self {
        Self {
            shadow_from_world: sun_view.clip_from_world().to_cols_array_2d(),
            sun_angular_radius: scene.sky.sun_angular_radius_rad,
            field: Self::field(scene),
            ..Default::default()
        }
    }

    fn field(scene: &SceneBuffers) -> [f32; 4] {
        let (field, [_, top_m]) = (&scene.ground.field, scene.ground.lod.range_m());
        [field.side as f32, field.spacing_m, 0.5 * field.extent_m(), top_m]
    }
}
