//! Four landscapes → what a walker needs of them: heights, lakes, trunks, and the area that all of them have.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::Trunks;
use crate::camera::Camera;
use crate::scene::{Asset, Heightfield, Lookouts, Scene, StartView};

/// Height of a walker's eyes above what it stands on.
pub const EYE_HEIGHT_M: f32 = StartView::EYE_HEIGHT_M;
/// No eye comes nearer to the ground, in any mode.
pub const MIN_HEIGHT_M: f32 = 0.5;
/// A walker wades no deeper; where a lake is deeper it swims, its feet this far below the surface.
pub const WADING_DEPTH_M: f32 = 1.2;
/// Radius of a walker's body.
pub const BODY_RADIUS_M: f32 = 0.25;
/// A walker keeps this far from the edge of the land.
pub const EDGE_M: f32 = 1.0;

/// What a walker meets in one landscape.
#[derive(Clone, Debug)]
pub struct Land {
    /// Its heights.
    pub field: Arc<Heightfield>,
    /// Height of its highest point in metres.
    pub top_m: f32,
    /// Surface of its lake in metres, if there is one.
    pub water_level_m: Option<f32>,
    /// Its trees' trunks.
    pub trunks: Trunks,
    /// Where a walk starts, if it is the only landscape.
    pub start: StartView,
    /// How good it looks from elsewhere, if its file says so.
    pub lookouts: Option<Arc<Lookouts>>,
    /// What stands there, if it is anyone's file.
    pub subject: Option<Subject>,
}

/// What stands alone on an even ground: an orbit goes around it, seen from below, too, for no ground hides it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Subject {
    /// Height of its middle, which stands above the origin.
    pub middle_m: f32,
    /// Of a sphere around it.
    pub radius_m: f32,
    /// What a metre of its file is in the viewer's world.
    pub scale: f32,
    /// Whether [`Land::start`] is a camera of its file.
    pub has_camera: bool,
}

impl Land {
    /// That of a scene. Takes milliseconds for 100,000 trees, so it belongs where the scene is read.
    pub fn of(scene: &Scene) -> Self {
        Self {
            field: scene.ground.field.clone(),
            top_m: scene.ground.lod.range_m()[1],
            water_level_m: scene.ground.water_level_m,
            trunks: Trunks::of(&scene.trees.instances),
            start: scene.start,
            lookouts: scene.lookouts.clone(),
            subject: None,
        }
    }

    /// The ground under anyone's file, level and without an end that anyone reaches soon.
    pub fn under(asset: &Asset) -> Self {
        let staging = asset.staging();
        let spacing_m = 2.0 * (10.0 * staging.radius_m + 100.0);
        let to_world = &staging.world_from_file;
        let seen = asset.camera.map(|camera| StartView {
            position_m: to_world.transform_point3(camera.position_m.as_dvec3()).as_vec3(),
            direction: camera.direction,
        });
        let (middle_m, radius_m, scale) = (staging.middle_m, staging.radius_m, staging.scale as f32);
        let subject = Subject { middle_m, radius_m, scale, has_camera: seen.is_some() };
        Self {
            field: Arc::new(Heightfield { side: 2, spacing_m, heights_m: vec![0.0; 4] }),
            top_m: 2.0 * middle_m,
            water_level_m: None,
            trunks: Trunks::default(),
            start: seen.unwrap_or_else(|| subject.view()),
            lookouts: None,
            subject: Some(subject),
        }
    }

    /// The camera that looks on from above, as in the thesis's figures 12 and 13: over the middle, all of the land in
    /// a square picture.
    pub fn overhead(&self, fov_y_rad: f32) -> Camera {
        let half_m = self.subject.map_or(0.5 * self.field.extent_m(), |subject| subject.radius_m);
        let height_m = self.top_m + half_m / libm::tanf(0.5 * fov_y_rad);
        Camera {
            position_m: Vec3::new(0.0, height_m, 0.0),
            yaw_rad: 0.0,
            pitch_rad: -std::f32::consts::FRAC_PI_2,
            fov_y_rad,
        }
    }

    /// Bilinear height of the ground in metres.
    pub fn ground_m(&self, place_m: Vec2) -> f32 {
        if self.field.side < 2 {
            return 0.0;
        }
        self.field.height_m(place_m.x, place_m.y)
    }

    /// Height of what a walker's feet stand on in metres: the ground, or nothing where the lake is too deep.
    pub fn footing_m(&self, place_m: Vec2) -> f32 {
        let ground_m = self.ground_m(place_m);
        self.water_level_m.map_or(ground_m, |water_m| ground_m.max(water_m - WADING_DEPTH_M))
    }

    /// No eye may be lower, in metres: above the ground, and above the lake (from below, a lake is only a lid).
    pub fn floor_m(&self, place_m: Vec2) -> f32 {
        if self.subject.is_some() {
            return f32::NEG_INFINITY;
        }
        let ground_m = self.ground_m(place_m);
        self.water_level_m.map_or(ground_m, |water_m| ground_m.max(water_m)) + MIN_HEIGHT_M
    }
}

impl Subject {
    /// From the front, a little from the right and from above, so that all of it is in the picture.
    fn view(&self) -> StartView {
        let (aside, above) = (0.52, 0.26);
        let ((sin_a, cos_a), (sin_e, cos_e)) = (libm::sincosf(aside), libm::sincosf(above));
        let towards_eye = Vec3::new(sin_a * cos_e, sin_e, cos_a * cos_e);
        let middle_m = Vec3::Y * self.middle_m;
        StartView { position_m: middle_m + towards_eye * (FRAMED * self.radius_m), direction: -towards_eye }
    }
}

/// Radii from its middle from which a subject fills a picture with the usual field of view.
const FRAMED: f32 = 2.0;

/// Half the side in metres of the square around the origin on which all landscapes have land, less [`EDGE_M`].
/// Without a landscape there is no edge.
pub fn reach_m(lands: &[&Land]) -> f32 {
    let half_m = |land: &&Land| match land.field.side {
        0 | 1 => 0.0,
        _ => 0.5 * land.field.extent_m() - EDGE_M,
    };
    lands.iter().map(half_m).fold(1e6, f32::min).max(0.0)
}

/// The nearest place within that square.
pub fn within(lands: &[&Land], place_m: Vec2) -> Vec2 {
    let reach = reach_m(lands);
    place_m.clamp(Vec2::splat(-reach), Vec2::splat(reach))
}
