//! Camera, landscape and the person's wishes → the numbers that all shaders read (`View` in `common.wgsl`).

use glam::{Mat4, Vec3, Vec4};

use crate::camera::Camera;
use crate::frame::FrameInput;
use crate::lod::morph::Detail;
use crate::lod_mode::TerrainLodMode;
use crate::upload::SceneBuffers;

/// `View` of `common.wgsl`, field by field; a test compares the two.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[expect(missing_docs, reason = "common.wgsl says what each field is")]
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
    pub haze: [f32; 3],
    pub water_level: f32,
    pub viewport_px: [f32; 2],
    pub focal_px: f32,
    pub flags: u32,
    pub clouds: [f32; 4],
    pub lod_eye: [f32; 3],
    pub unused: f32,
    pub field: [f32; 4],
    pub terrain_lod: [f32; 4],
    pub tiles: [f32; 4],
    pub last_tile: [f32; 4],
}

/// Bits of `ViewUniform::flags`, as in `common.wgsl`.
const TINT: u32 = 1;
const DRIFT: u32 = 2;
const MORPH: u32 = 4;

/// What stands for "no lake".
const NO_WATER_M: f32 = -1.0e6;

impl ViewUniform {
    /// The numbers of one view: `camera` draws, `lod_eye` is the camera for which levels of detail are chosen, and
    /// `detail` says how detailed the land is where.
    pub fn new(
        scene: &SceneBuffers,
        camera: &Camera,
        lod_camera: &Camera,
        size_px: [u32; 2],
        frame: &FrameInput,
        detail: &Detail,
    ) -> Self {
        let [width, height] = size_px.map(|side| side.max(1) as f32);
        let clip_from_world = camera.clip_from_world(width / height);
        // Directions don't depend on where the eye is.
        let at_origin = Camera { position_m: Vec3::ZERO, ..*camera };
        let options = &frame.options;
        let flag = |on: bool, bit: u32| if on { bit } else { 0 };
        let (field, sky) = (&scene.ground.field, &scene.sky);
        let tiles = scene.land.tiles_m;
        Self {
            clip_from_world: clip_from_world.to_cols_array_2d(),
            ray_from_clip: at_origin.clip_from_world(width / height).inverse().to_cols_array_2d(),
            shadow_from_world: shadow_from_world(scene).to_cols_array_2d(),
            eye: camera.position_m.into(),
            time_s: frame.time_s,
            sun_direction: sky.sun_direction,
            sun_angular_radius: sky.sun_angular_radius_rad,
            sun_irradiance: sky.sun_irradiance_linear,
            exposure: sky.exposure * options.exposure,
            sky_irradiance: sky.sky_irradiance_linear,
            haze_extinction: sky.haze_extinction_per_m,
            haze: sky.haze_linear,
            water_level: scene.ground.water_level_m.unwrap_or(NO_WATER_M),
            viewport_px: [width, height],
            focal_px: focal_px(camera, height),
            flags: flag(options.tint_levels, TINT)
                | flag(options.drift_clouds, DRIFT)
                | flag(options.terrain_lod == TerrainLodMode::Morph, MORPH),
            clouds: scene.heaven.sheets_m,
            lod_eye: lod_camera.position_m.into(),
            unused: 0.0,
            field: [field.side as f32, field.spacing_m, 0.5 * field.extent_m(), field.range_m()[1]],
            terrain_lod: [detail.unit_m, detail.top, detail.above_m, 0.0],
            tiles: [tiles[0], tiles[1], tiles[2], tiles[3]],
            last_tile: [tiles[4], 0.0, 0.0, 0.0],
        }
    }
}

impl ViewUniform {
    /// What the shadow pass reads of it.
    pub fn for_sun(scene: &SceneBuffers) -> Self {
        let field = &scene.ground.field;
        Self {
            shadow_from_world: shadow_from_world(scene).to_cols_array_2d(),
            field: [field.side as f32, field.spacing_m, 0.5 * field.extent_m(), field.range_m()[1]],
            ..Default::default()
        }
    }
}

/// Pixels that one radian covers in the middle of a picture `height_px` high.
pub fn focal_px(camera: &Camera, height_px: f32) -> f32 {
    0.5 * height_px / libm::tanf(0.5 * camera.fov_y_rad)
}

/// How high trees may reach above the land: what throws shadows lies below.
const TALLEST_M: f32 = 60.0;

/// The sun's view of the whole field, trees included: x and y in [−1, 1], depth in [0, 1] away from the sun.
pub fn shadow_from_world(scene: &SceneBuffers) -> Mat4 {
    let field = &scene.ground.field;
    let to_sun = Vec3::from(scene.sky.sun_direction).normalize_or(Vec3::Y);
    // Any direction that is never parallel to the sun's.
    let aside = if to_sun.y.abs() < 0.9 { Vec3::Y } else { Vec3::X };
    let right = aside.cross(to_sun).normalize();
    let up = to_sun.cross(right);
    let half = 0.5 * field.extent_m();
    let [low, high] = field.range_m();
    let (mut least, mut most) = (Vec3::MAX, Vec3::MIN);
    for corner in 0..8 {
        let pick = |bit: u32, a: f32, b: f32| if corner >> bit & 1 == 0 { a } else { b };
        let place =
            Vec3::new(pick(0, -half, half), pick(1, low - 5.0, high + TALLEST_M), pick(2, -half, half));
        let seen = Vec3::new(right.dot(place), up.dot(place), -to_sun.dot(place));
        (least, most) = (least.min(seen), most.max(seen));
    }
    let size = most - least;
    let scale = Vec3::new(2.0 / size.x, 2.0 / size.y, 1.0 / size.z);
    let offset = Vec3::new(-1.0, -1.0, 0.0) - least * scale;
    let rows = [
        (right * scale.x).extend(offset.x),
        (up * scale.y).extend(offset.y),
        (-to_sun * scale.z).extend(offset.z),
        Vec4::W,
    ];
    Mat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose()
}
