//! Four landscapes → what a walker needs of them: heights, lakes, trunks, and the area that all of them have.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::Trunks;
use crate::camera::Camera;
use crate::scene::{Heightfield, Lookouts, Scene, StartView};

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
        }
    }

    /// The camera that looks on from above, as in the thesis's figures 12 and 13: over the middle, all of the land in
    /// a square picture.
    pub fn overhead(&self, fov_y_rad: f32) -> Camera {
        let height_m = self.top_m + 0.5 * self.field.extent_m() / libm::tanf(0.5 * fov_y_rad);
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
        let ground_m = self.ground_m(place_m);
        self.water_level_m.map_or(ground_m, |water_m| ground_m.max(water_m)) + MIN_HEIGHT_M
    }
}

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
