//! Camera, landscape and the person's wishes → the numbers that all shaders read (`View` in `common.wgsl`).

use glam::{BVec3, Mat4, Vec3, Vec4};

use crate::camera::Camera;
use crate::lod::morph::Detail;
use crate::options::FrameInput;
use crate::upload::SceneBuffers;

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
    pub haze: [f32; 3],
    pub water_level: f32,
    pub focal_px: f32,
    pub tint_levels: u32,
    pub drift_clouds: u32,
    pub morph_terrain: u32,
    pub clouds: [f32; 4],
    pub lod_eye: [f32; 3],
    pub lod_above: f32,
    pub field: [f32; 4],
    pub tiles: [f32; 4],
    pub last_tile: f32,
    pub lod_top: f32,
    pub part: f32,
    pub lod_morph: f32,
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
        Self {
            clip_from_world: camera.clip_from_world(width / height).to_cols_array_2d(),
            ray_from_clip: at_origin.clip_from_world(width / height).inverse().to_cols_array_2d(),
            eye: camera.position_m.into(),
            time_s: frame.time_s,
            exposure: exposure * options.exposure,
            focal_px: camera.focal_px(height),
            tint_levels: options.tint_levels.into(),
            part: frame.part,
            ..Default::default()
        }
    }

    /// The numbers of one view of a landscape: `camera` draws, `lod_eye` is the camera for which levels of detail are
    /// chosen, and `detail` says how detailed the land is where.
    pub fn new(
        scene: &SceneBuffers,
        camera: &Camera,
        lod_camera: &Camera,
        size_px: [u32; 2],
        frame: &FrameInput,
        detail: &Detail,
    ) -> Self {
        let (options, sky) = (&frame.options, &scene.sky);
        let [tiles @ .., last_tile] = scene.land.tiles_m;
        Self {
            sun_direction: sky.sun_direction.to_array(),
            sun_angular_radius: sky.sun_angular_radius_rad,
            sun_irradiance: sky.sun_irradiance_linear,
            sky_irradiance: sky.sky_irradiance_linear,
            haze_extinction: sky.haze_extinction_per_m,
            haze: sky.haze_linear,
            water_level: scene.ground.water_level_m.unwrap_or(NO_WATER_M),
            drift_clouds: options.drift_clouds.into(),
            morph_terrain: options.terrain_lod.morphs().into(),
            clouds: scene.sky_textures.sheets_m,
            lod_eye: lod_camera.position_m.into(),
            lod_above: detail.above_m,
            tiles,
            last_tile,
            lod_top: detail.top,
            lod_morph: detail.morph_m,
            shadow_from_world: shadow_from_world(scene).to_cols_array_2d(),
            field: Self::field(scene),
            ..Self::of_camera(camera, size_px, frame, sky.exposure)
        }
    }

    /// What the shadow pass reads of it.
    pub fn for_sun(scene: &SceneBuffers) -> Self {
        let shadow_from_world = shadow_from_world(scene).to_cols_array_2d();
        Self { shadow_from_world, field: Self::field(scene), ..Default::default() }
    }

    fn field(scene: &SceneBuffers) -> [f32; 4] {
        let (field, [_, top_m]) = (&scene.ground.field, scene.ground.lod.range_m());
        [field.side as f32, field.spacing_m, 0.5 * field.extent_m(), top_m]
    }
}

/// Trees reach no higher above the land: what throws shadows lies below.
const MAX_TREE_HEIGHT_M: f32 = 60.0;

/// The sun's view of the whole field, trees included: x and y in [−1, 1], depth in [0, 1] away from the sun.
pub fn shadow_from_world(scene: &SceneBuffers) -> Mat4 {
    let field = &scene.ground.field;
    let to_sun = scene.sky.sun_direction.normalize_or(Vec3::Y);
    // Any direction that is never parallel to the sun's.
    let aside = if to_sun.y.abs() < 0.9 { Vec3::Y } else { Vec3::X };
    let right = aside.cross(to_sun).normalize();
    let up = to_sun.cross(right);
    let half = 0.5 * field.extent_m();
    let [low, high] = scene.ground.lod.range_m();
    let (low, high) = (Vec3::new(-half, low - 5.0, -half), Vec3::new(half, high + MAX_TREE_HEIGHT_M, half));
    let (mut min, mut max) = (Vec3::MAX, Vec3::MIN);
    for corner in 0..8u32 {
        let place = Vec3::select(BVec3::from_array([0, 1, 2].map(|bit| corner >> bit & 1 == 1)), high, low);
        let seen = Vec3::new(right.dot(place), up.dot(place), -to_sun.dot(place));
        (min, max) = (min.min(seen), max.max(seen));
    }
    let size = max - min;
    let scale = Vec3::new(2.0 / size.x, 2.0 / size.y, 1.0 / size.z);
    let offset = Vec3::new(-1.0, -1.0, 0.0) - min * scale;
    let rows = [
        (right * scale.x).extend(offset.x),
        (up * scale.y).extend(offset.y),
        (-to_sun * scale.z).extend(offset.z),
        Vec4::W,
    ];
    Mat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose()
}
