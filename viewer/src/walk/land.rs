//! Four landscapes → what a walker needs of them: heights, lakes, trunks, and where they end. Places and heights are the
//! walk's ([`Anchor`]) unless something else is said.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::{Anchor, Trunk, Trunks};
use crate::camera::Camera;
use crate::scene::{Asset, Heightfield, Scene, Staging, StartView};

/// Height of a walker's eyes above what it stands on.
pub const EYE_HEIGHT_M: f32 = StartView::EYE_HEIGHT_M;
/// No eye comes nearer to the ground, in any mode.
pub const MIN_HEIGHT_M: f32 = 0.5;
/// A walker wades no deeper; where a lake is deeper it swims, its feet this far below the surface.
pub const WADING_DEPTH_M: f32 = 1.2;
/// Radius of a walker's body.
pub const BODY_RADIUS_M: f32 = 0.25;
/// So much of the way from the middle to the edge may be walked: of 1,024 m, up to 41 m before the edge, beyond which no grass grows.
pub const WALKABLE: f32 = 0.92;

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
    /// From where it looks best.
    pub start: StartView,
    /// Where the walk lies in it.
    pub anchor: Anchor,
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
            anchor: Anchor::default(),
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
            start: seen.unwrap_or_else(|| front_view(asset, &staging)),
            anchor: Anchor::default(),
            subject: Some(subject),
        }
    }

    /// The same, with the walk's middle where it looks best.
    pub fn from_its_start(self) -> Self {
        let anchor = self.start_anchor();
        Self { anchor, ..self }
    }

    /// Where a walk that begins here lies. Anyone's file stays where it is.
    pub fn start_anchor(&self) -> Anchor {
        if self.subject.is_some() { Anchor::default() } else { Anchor::at(&self.start) }
    }

    /// Whether the ground is the same, whatever stands on it.
    pub fn is_same_ground(&self, other: &Self) -> bool {
        self.subject == other.subject && self.field == other.field
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

    /// Where in the landscape, in its own metres, somebody is who walked there: at its edge if it ends before.
    pub fn standing_m(&self, place_m: Vec2) -> Vec2 {
        let reach = Vec2::splat(self.reach_m());
        self.anchor.in_land(place_m).clamp(-reach, reach)
    }

    /// Bilinear height of the ground in metres.
    pub fn ground_m(&self, place_m: Vec2) -> f32 {
        if self.field.side < 2 {
            return 0.0;
        }
        let Vec2 { x, y: z } = self.standing_m(place_m);
        self.field.height_m(x, z) - self.anchor.level_m()
    }

    /// Height of what a walker's feet stand on in metres: the ground, or nothing where the lake is too deep.
    pub fn footing_m(&self, place_m: Vec2) -> f32 {
        let ground_m = self.ground_m(place_m);
        self.water_m().map_or(ground_m, |water_m| ground_m.max(water_m - WADING_DEPTH_M))
    }

    /// No eye may be lower, in metres: above the ground, and above the lake (from below, a lake is only a lid).
    pub fn floor_m(&self, place_m: Vec2) -> f32 {
        if self.subject.is_some() {
            return f32::NEG_INFINITY;
        }
        let ground_m = self.ground_m(place_m);
        self.water_m().map_or(ground_m, |water_m| ground_m.max(water_m)) + MIN_HEIGHT_M
    }

    /// Whether a walker's body has room there.
    pub fn is_clear(&self, place_m: Vec2) -> bool {
        self.trunks.clear(self.anchor.in_land(place_m), BODY_RADIUS_M)
    }

    /// The trunks that a walker's body would touch there.
    pub fn touched(&self, place_m: Vec2) -> impl Iterator<Item = Trunk> {
        let here_m = self.anchor.in_land(place_m);
        let touched = self.trunks.near(here_m, BODY_RADIUS_M);
        let touched = touched.filter(move |trunk| !trunk.clears(here_m, BODY_RADIUS_M));
        touched.map(|trunk| Trunk { center_m: self.anchor.in_walk(trunk.center_m), ..*trunk })
    }

    fn water_m(&self) -> Option<f32> {
        Some(self.water_level_m? - self.anchor.level_m())
    }

    /// Half the side in metres of the square around the landscape's middle on which one can walk.
    fn reach_m(&self) -> f32 {
        if self.field.side < 2 { 0.0 } else { WALKABLE * 0.5 * self.field.extent_m() }
    }

    fn has(&self, place_m: Vec2) -> bool {
        self.anchor.in_land(place_m).abs().max_element() <= self.reach_m()
    }

    /// The nearest place that it has, by so little inside that it has what rounding makes of it.
    fn nearest(&self, place_m: Vec2) -> Vec2 {
        let reach = Vec2::splat((self.reach_m() - 1e-3).max(0.0));
        self.anchor.in_walk(self.anchor.in_land(place_m).clamp(-reach, reach))
    }
}

/// From the front, a little from the right and from above, so near that what stands there fills a square picture and all of it
/// is in it.
fn front_view(asset: &Asset, staging: &Staging) -> StartView {
    let (aside, above) = (0.52, 0.26);
    let ((sin_a, cos_a), (sin_e, cos_e)) = (libm::sincosf(aside), libm::sincosf(above));
    let towards_eye = Vec3::new(sin_a * cos_e, sin_e, cos_a * cos_e);
    let right = Vec3::new(cos_a, 0.0, -sin_a);
    let middle_m = Vec3::Y * staging.middle_m;
    // A point is in the picture from so far away as it is before the middle, and as it is off the axis over `HALF_PICTURE`.
    let off_axis = [right, -right, towards_eye.cross(right), right.cross(towards_eye)];
    let needed_m = off_axis.map(|off| {
        let direction = towards_eye + off / HALF_PICTURE;
        (asset.reach_m(direction, &staging.world_from_file) - f64::from(middle_m.dot(direction))) as f32
    });
    let away_m = needed_m.into_iter().fold(MIN_RADII * staging.radius_m, f32::max);
    StartView { position_m: middle_m + towards_eye * away_m, direction: -towards_eye }
}

/// Half of a square picture at a distance of 1 with the usual field of view, 60°, less a margin.
const HALF_PICTURE: f32 = 0.55;
/// Nobody first looks at a thing from nearer than this, in its radii.
const MIN_RADII: f32 = 1.25;

/// The nearest place to walk to that any of these landscapes has: the others' walkers wait at their edges. Without a
/// landscape there is no edge.
pub fn within(lands: &[&Land], place_m: Vec2) -> Vec2 {
    if lands.iter().any(|land| land.has(place_m)) {
        return place_m;
    }
    let nearest = lands.iter().map(|land| land.nearest(place_m));
    let nearest = nearest.min_by(|a, b| a.distance(place_m).total_cmp(&b.distance(place_m)));
    nearest.unwrap_or_else(|| place_m.clamp(Vec2::splat(-1e6), Vec2::splat(1e6)))
}

/// The longest way across one of them, in metres.
pub fn across_m(lands: &[&Land]) -> f32 {
    lands.iter().map(|land| 2.0 * 1.5 * land.reach_m()).fold(0.0, f32::max).min(1e4)
}
