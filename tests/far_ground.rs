//! The ground of a forest is as dark beyond the field, where the viewer finds the shadows of trees by itself, as on it, where the
//! bake has found them.

use std::f32::consts::{FRAC_PI_2, TAU};

use genescape_viewer::camera::Camera;
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::scene::{Instance, Scene};
use glam::{Vec2, Vec3};

use crate::backdrop::Backdrops;
use crate::round::starters;

/// Metres of the strips on either side of the field's edge that are compared, and of the gap between them.
const STRIP_M: f32 = 40.0;
const GAP_M: f32 = 6.0;
/// Places along each side of the field.
const PLACES: usize = 12;

/// Places by the edge, and the way out of the field there.
fn places(half_m: f32) -> impl Iterator<Item = (Vec2, Vec2)> {
    (0..4).flat_map(move |side| {
        let out = Vec2::from_angle(side as f32 * 0.25 * TAU).round();
        (0..PLACES).map(move |k| {
            let along_m = (2.0 * (k as f32 + 0.5) / PLACES as f32 - 1.0) * (half_m - STRIP_M);
            (half_m * out + along_m * out.perp(), out)
        })
    })
}

/// What trees leave of the sun on the field's side, by the light map.
fn left_on_field(scene: &Scene) -> f64 {
    let map = &scene.ground.surface.light;
    let half_m = 0.5 * scene.ground.field.extent_m();
    let (mut left, mut all) = (0.0, 0.0);
    for (edge_m, out) in places(half_m) {
        for step in 0..100 {
            let [by, aside] = [step % 10, step / 10].map(|n| (n as f32 + 0.5) / 10.0 * STRIP_M);
            let at_m = edge_m - (GAP_M + by) * out + (aside - 0.5 * STRIP_M) * out.perp();
            let texel = (at_m / (2.0 * half_m) + 0.5) * map.width_px as f32;
            let first = 4 * (texel.y as usize * map.width_px as usize + texel.x as usize);
            let [sun, share] = [1, 3].map(|channel| f64::from(map.levels[0][first + channel]) / 255.0);
            left += sun * share;
            all += sun;
        }
    }
    left / all
}

/// Trees by the edge, on their side of it, by area.
fn density(scene: &Scene, trees: &[Instance]) -> f64 {
    let half_m = 0.5 * scene.ground.field.extent_m();
    let from_edge_m =
        |tree: &Instance| tree.world_from_tree[0][3].abs().max(tree.world_from_tree[2][3].abs()) - half_m;
    let reach_m = 1.5 * STRIP_M;
    let near = trees.iter().map(from_edge_m).filter(|from_edge_m| from_edge_m.abs() < reach_m);
    let (outwards, count) = near.fold((0.0, 0.0), |(sum, count), m| (sum + m.signum(), count + 1.0));
    let side_m = 2.0 * half_m + if outwards > 0.0 { reach_m } else { -reach_m };
    f64::from(count / (4.0 * side_m * reach_m))
}

/// The light that comes from the other side's ground.
fn light_beyond(backdrops: &Backdrops, scene: &Scene) -> f64 {
    const FOV_Y_RAD: f32 = 0.1;
    let mut stage = backdrops.stage(scene, [48; 2]);
    let options = Options { draw_trees: false, grass: false, ..Options::default() };
    let frame = FrameInput { options, ..FrameInput::default() };
    let up_m = STRIP_M / FOV_Y_RAD;
    let half_m = 0.5 * scene.ground.field.extent_m();
    let seen = places(half_m).map(|(edge_m, out)| {
        let at_m = edge_m + (GAP_M + 0.5 * STRIP_M) * out;
        let inner = at_m.clamp(Vec2::splat(-half_m), Vec2::splat(half_m));
        let ground_m = scene.ground.field.height_m(inner.x, inner.y);
        let position_m = Vec3::new(at_m.x, ground_m + up_m, at_m.y);
        let camera = Camera { position_m, yaw_rad: 0.0, pitch_rad: -0.999 * FRAC_PI_2, fov_y_rad: FOV_Y_RAD };
        backdrops.look(&mut stage, &frame, &camera).light.iter().sum::<f64>()
    });
    seen.sum()
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn forests_beyond_the_field_shade_their_ground_as_those_on_it_do() {
    let backdrops = Backdrops::open();
    let mut all = Vec::new();
    for mut scene in starters(backdrops.studio()) {
        scene.sky.light.haze_extinction_per_m = 0.0;
        scene.sky.light.sky_irradiance_linear = [0.0; 3];
        scene.sky.light.sun_irradiance_linear = [2.0; 3];
        // Grass keeps its colour wherever one looks from, water does not.
        scene.ground.water_level_m = None;
        let bare = scene.clone().without_far_trees();
        let left = light_beyond(&backdrops, &scene) / light_beyond(&backdrops, &bare);
        // Where trees are fewer, more of it is left.
        let [far, near] = [&scene.trees.far, &scene.trees.instances].map(|trees| density(&scene, trees));
        let on_field = libm::pow(left_on_field(&scene), far / near);
        let told =
            format!("{}: {left:.3} of the sun is left beyond the field, {on_field:.3} on it", scene.name);
        genescape_bake::say!("{told}");
        all.push(((left - on_field).abs() < 0.08, told));
    }
    assert!(all.iter().all(|(is_like, _)| *is_like), "{all:#?}");
}
