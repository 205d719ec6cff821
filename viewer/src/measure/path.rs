//! Where measurements are made: forests of any number of trees, and the camera's path across a land.

use glam::{Vec2, Vec3};

use crate::camera::Camera;
use crate::options::Options;
use crate::scene::{Instance, Scene};
use crate::walk::{EYE_HEIGHT_M, Land, nearest_free};

/// The camera's path: straight across the middle of the land, a quarter of its extent to each side, at a walker's height
/// and clear of trunks, with the sun behind and to the side (thesis section 7).
pub fn camera_path(scene: &Scene, steps: u32) -> Vec<Camera> {
    let land = Land::of(scene);
    let [x, _, z] = scene.sky.light.sun_direction.to_array();
    let away = Vec2::new(-x, -z).normalize_or(Vec2::NEG_Y);
    let ahead = Vec2::from_angle(0.6).rotate(away);
    let half_m = 0.25 * scene.ground.field.extent_m();
    let at = |step: u32| {
        let wished_m = ahead * half_m * (2.0 * step as f32 / (steps - 1).max(1) as f32 - 1.0);
        let place_m = nearest_free(&[&land], wished_m).unwrap_or(wished_m);
        let position_m = Vec3::new(place_m.x, land.footing_m(place_m) + EYE_HEIGHT_M, place_m.y);
        Camera {
            position_m,
            yaw_rad: libm::atan2f(-ahead.x, -ahead.y),
            pitch_rad: 0.0,
            fov_y_rad: Options::default().fov_y_deg.to_radians(),
        }
    };
    (0..steps).map(at).collect()
}

/// A flight out of the middle of the land, backwards and upwards: trees go from near by to the size of a picture.
pub fn fly_out_path(scene: &Scene, steps: u32) -> Vec<Camera> {
    let [low, high] = [0.02, 0.24].map(|part| part * scene.ground.field.extent_m());
    let mut start = camera_path(scene, 3)[1];
    start.pitch_rad = -0.12;
    let back = Vec3::new(libm::sinf(start.yaw_rad), 0.0, libm::cosf(start.yaw_rad));
    let at = |step: u32| {
        let way = step as f32 / (steps - 1).max(1) as f32;
        let position_m = start.position_m + way * (high * back + low * Vec3::Y);
        Camera { position_m, ..start }
    };
    (0..steps).map(at).collect()
}

/// The same landscape with `count` trees: of more than are wanted an even choice; else copies stand between them,
/// spread evenly over the dry land (the additive recurrence of Roberts 2018).
pub fn forest(scene: &Scene, count: usize) -> Scene {
    let known = &scene.trees.instances;
    let mut scene_with = scene.clone().without_far_trees();
    if known.is_empty() || count <= known.len() {
        let stride = |i: usize| known[i * known.len() / count];
        scene_with.trees.instances = (0..count.min(known.len())).map(stride).collect();
        return scene_with;
    }
    let field = &scene.ground.field;
    let dry_m = scene.ground.water_level_m.unwrap_or(f32::MIN);
    let place = |i: u32| {
        // Exact in f64 for any number of trees; the constants are 1/g and 1/g² of the plastic number g.
        let part = |step: f64| ((0.5 + f64::from(i) * step).fract() as f32 - 0.5) * field.extent_m() * 0.98;
        Vec2::new(part(0.754_877_666_246_692_7), part(0.569_840_290_998_053_3))
    };
    let dry = |place_m: &Vec2| field.height_m(place_m.x, place_m.y) > dry_m;
    // A land that is all lake gets its trees in the lake.
    let any = (0..1000).map(place).any(|place_m| dry(&place_m));
    let places = (0..).map(place).filter(|place_m| !any || dry(place_m));
    let copies = known.iter().cycle().zip(places).map(|(tree, place_m)| moved(tree, place_m, field));
    scene_with.trees.instances = known.iter().copied().chain(copies).take(count).collect();
    scene_with
}

/// A tree at another place, as high above the land as before.
fn moved(tree: &Instance, place_m: Vec2, field: &crate::scene::Heightfield) -> Instance {
    let mut copy = *tree;
    let [x, y, z] = tree.world_from_tree.map(|row| row[3]);
    let above_m = y - field.height_m(x, z);
    copy.world_from_tree[0][3] = place_m.x;
    copy.world_from_tree[1][3] = field.height_m(place_m.x, place_m.y) + above_m;
    copy.world_from_tree[2][3] = place_m.y;
    copy.trunk_cylinder_m[0] += place_m.x - x;
    copy.trunk_cylinder_m[1] += place_m.y - z;
    copy
}
