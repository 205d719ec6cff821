//! A tree that is far away covers as much and is as bright as in a picture so large that each leaf has its pixels: whether its
//! own pictures are drawn or all its leaves. And its leaves differ in light.

use std::sync::Arc;

use genescape_viewer::camera::Camera;
use genescape_viewer::lod_mode::TreeLodMode;
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::scene::{Instance, Scene};
use glam::Vec3;

use crate::backdrop::{Backdrops, Matte};
use crate::round::starters;

/// Pixels a side of the pictures in which trees are looked at, and those that the larger of a tree's height and width takes of them.
const SIDE_PX: u32 = 96;
const TREE_PX: f32 = 40.0;
/// Pictures of full trees have so many times as many pixels a side.
const FINER: u32 = 8;
/// Directions from which a tree is looked at: of small pictures, in which much is chance, so many times as many.
const DIRECTIONS: u32 = 12;
const SMALL: u32 = 4;

/// A landscape with a single tree in clear air.
fn alone(scene: &Scene, template: u32, [x, y, z]: [f32; 3]) -> Scene {
    let world_from_tree = [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]];
    let tree = Arc::new([Instance { world_from_tree, template, trunk_cylinder_m: [x, z, 0.1] }]);
    let mut scene = scene.clone().without_far_trees();
    scene.sky.light.haze_extinction_per_m = 0.0;
    if x.abs().max(z.abs()) > 0.5 * scene.ground.field.extent_m() {
        (scene.trees.instances, scene.trees.far) = (Arc::default(), tree);
    } else {
        scene.trees.instances = tree;
    }
    scene
}

/// At the landscape's middle.
fn look(backdrops: &Backdrops, scene: &Scene, template: u32, mode: TreeLodMode, finer: u32) -> Matte {
    let foot_m = [0.0, scene.ground.field.height_m(0.0, 0.0), 0.0];
    look_at(backdrops, scene, template, foot_m, mode, finer)
}

fn look_at(
    backdrops: &Backdrops,
    scene: &Scene,
    template: u32,
    foot_m: [f32; 3],
    mode: TreeLodMode,
    finer: u32,
) -> Matte {
    let alone = alone(scene, template, foot_m);
    let tree = &scene.trees.templates[template as usize];
    let middle_m = Vec3::from(tree.center_m) + Vec3::from(foot_m);
    let mut stage = backdrops.stage(&alone, [SIDE_PX * finer; 2]);
    let fov_y_rad = 0.2f32;
    let [width_m, height_m] = tree.impostor.as_ref().expect("pictures of a tree").size_m;
    let away_m = width_m.max(height_m) * SIDE_PX as f32 / TREE_PX / fov_y_rad;
    let options = Options { tree_lod: mode, draw_terrain: false, grass: false, ..Options::default() };
    let frame = FrameInput { options, ..FrameInput::default() };
    let mut seen = Matte::default();
    let directions = if finer == 1 { SMALL * DIRECTIONS } else { DIRECTIONS };
    for direction in 0..directions {
        let yaw_rad = direction as f32 / directions as f32 * std::f32::consts::TAU;
        let (sin, cos) = libm::sincosf(yaw_rad);
        let position_m = middle_m + away_m * Vec3::new(sin, 0.0, cos);
        let camera = Camera { position_m, yaw_rad, pitch_rad: 0.0, fov_y_rad };
        seen += backdrops.look(&mut stage, &frame, &camera);
    }
    seen
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn far_trees_cover_as_much_and_are_as_bright_as_near_ones() {
    let backdrops = Backdrops::open();
    let mut all = Vec::new();
    for scene in starters(backdrops.studio()) {
        for template in 0..2 {
            assert!(scene.trees.templates[template].impostor.is_some(), "{}", scene.name);
            let of = |mode, finer| look(&backdrops, &scene, template as u32, mode, finer);
            let truth = of(TreeLodMode::Off, FINER);
            let [leaves, picture] = [of(TreeLodMode::Off, 1), of(TreeLodMode::Simple, 1)];
            // How much of a palm's leaves single samples find is the driver's matter.
            let most = if backdrops.studio().gpu.software { 0.07 } else { 0.12 };
            for (what, seen, most) in [("leaves", &leaves, most), ("picture", &picture, 0.05)] {
                let covers = seen.pixels / truth.pixels * f64::from(FINER * FINER) / f64::from(SMALL);
                let bright = seen.brightness() / truth.brightness();
                let told =
                    format!("{} {template}, {what}: covers {covers:.3}, bright {bright:.3}", scene.name);
                genescape_bake::say!("{told}");
                all.push(((covers - 1.0).abs() < most && (bright - 1.0).abs() < 0.08, told));
            }
            // A leaf in the sun beside one in the shade; twigs cover few pixels whole.
            if !scene.name.starts_with("Bare") {
                let varies = picture.contrast() / leaves.contrast();
                let told = format!("{} {template}, picture: {varies:.2} of the contrast", scene.name);
                genescape_bake::say!("{told}");
                all.push((varies > 0.65, told));
            }
        }
    }
    assert!(all.iter().all(|(is_like, _)| *is_like), "{all:#?}");
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn trees_beyond_the_field_are_there_and_as_bright_as_on_it() {
    let backdrops = Backdrops::open();
    let mut all = Vec::new();
    for scene in starters(backdrops.studio()) {
        let half_m = 0.5 * scene.ground.field.extent_m();
        let away_m = |tree: &Instance| tree.world_from_tree[0][3].abs().max(tree.world_from_tree[2][3].abs());
        assert!(scene.trees.instances.iter().all(|tree| away_m(tree) < half_m), "{}", scene.name);
        assert!(scene.trees.far.len() > 1000, "{}: {} far trees", scene.name, scene.trees.far.len());
        assert!(scene.trees.far.iter().all(|tree| away_m(tree) > half_m), "{}", scene.name);
        // So high that no hill is before the sun.
        let y = scene.ground.field.range_m()[1] + 300.0;
        for mode in [TreeLodMode::Quality, TreeLodMode::Simple] {
            let of = |x: f32| look_at(&backdrops, &scene, 0, [x, y, 0.0], mode, 1);
            let [on_field, beyond] = [of(0.0), of(half_m + 3000.0)];
            let bright = beyond.brightness() / on_field.brightness();
            let covers = beyond.pixels / on_field.pixels;
            let told =
                format!("{} beyond the field, {mode:?}: covers {covers:.3}, bright {bright:.3}", scene.name);
            genescape_bake::say!("{told}");
            all.push(((covers - 1.0).abs() < 0.06 && (bright - 1.0).abs() < 0.12, told));
        }
    }
    assert!(all.iter().all(|(is_like, _)| *is_like), "{all:#?}");
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn light_ground_lights_trees_from_below() {
    let backdrops = Backdrops::open();
    for scene in starters(backdrops.studio()) {
        let on = |byte: u8, mode| {
            let mut scene = scene.clone();
            let color = &mut scene.ground.surface.color;
            color.name = format!("ground of {byte}");
            color.levels = vec![vec![byte; 4 * (color.width_px * color.height_px) as usize].into()];
            look(&backdrops, &scene, 0, mode, 1).brightness()
        };
        for mode in [TreeLodMode::Off, TreeLodMode::Simple] {
            let lighter = on(200, mode) / on(60, mode);
            genescape_bake::say!("{}, {mode:?}: {lighter:.3} times as bright on light ground", scene.name);
            assert!((1.03..1.6).contains(&lighter), "{}, {mode:?}: {lighter}", scene.name);
        }
    }
}
