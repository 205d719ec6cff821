//! A tree that is far away covers as much as it would if all its leaves were drawn, and is as bright.

use std::sync::Arc;

use genescape_viewer::baker::Event;
use genescape_viewer::camera::Camera;
use genescape_viewer::headless::{Headless, scene_files};
use genescape_viewer::lod_mode::TreeLodMode;
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::passes::Shaders;
use genescape_viewer::scene::{Instance, Scene};
use genescape_world::Source;
use glam::Vec3;

use crate::round::Round;

/// Pixels a side of the pictures in which trees are looked at, and those that a tree's height takes of them.
const SIDE_PX: u32 = 96;
const TREE_PX: f32 = 40.0;
/// Directions from which a tree is looked at.
const DIRECTIONS: u32 = 12;
/// A pixel shows a tree if it differs from the sky by so much in some channel.
const SEEN: u8 = 6;

/// What is seen of a tree from all around.
#[derive(Debug, Default)]
struct Seen {
    pixels: f32,
    /// Sum of all their values.
    light: f32,
}

/// A landscape with a single tree at its middle.
fn alone(scene: &Scene, template: u32) -> Scene {
    let at = scene.ground.field.height_m(0.0, 0.0);
    let world_from_tree = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, at], [0.0, 0.0, 1.0, 0.0]];
    let tree = Instance { world_from_tree, template, trunk_cylinder_m: [0.0, 0.0, 0.1] };
    let mut scene = scene.clone();
    scene.trees.instances = Arc::new([tree]);
    scene
}

fn look(studio: &Headless, scene: &Scene, template: u32, mode: TreeLodMode) -> Seen {
    let alone = alone(scene, template);
    let tree = &scene.trees.templates[template as usize];
    let middle_m = Vec3::from(tree.center_m) + Vec3::Y * scene.ground.field.height_m(0.0, 0.0);
    let mut view = studio.view(studio.upload(&alone).expect("uploaded"), [SIDE_PX; 2]);
    let fov_y_rad = 0.2f32;
    let away_m = 2.0 * tree.radius_m * SIDE_PX as f32 / TREE_PX / fov_y_rad;
    let options = Options { tree_lod: mode, draw_terrain: false, grass: false, ..Options::default() };
    let mut seen = Seen::default();
    for direction in 0..DIRECTIONS {
        let yaw_rad = direction as f32 / DIRECTIONS as f32 * std::f32::consts::TAU;
        let (sin, cos) = libm::sincosf(yaw_rad);
        let position_m = middle_m + away_m * Vec3::new(sin, 0.0, cos);
        let camera = Camera { position_m, yaw_rad, pitch_rad: 0.0, fov_y_rad };
        let mut shoot = |draw_trees: bool| {
            let frame = FrameInput { options: Options { draw_trees, ..options }, ..FrameInput::default() };
            studio.shoot(&mut view, &frame, &camera, &camera).expect("drawn")
        };
        let (with, without) = (shoot(true), shoot(false));
        for (with, without) in with.pixels().zip(without.pixels()) {
            if with.0.iter().zip(without.0).any(|(a, b)| a.abs_diff(b) > SEEN) {
                seen.pixels += 1.0;
                seen.light += with.0[..3].iter().map(|&value| f32::from(value)).sum::<f32>();
            }
        }
    }
    seen
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn pictures_of_trees_cover_as_much_and_are_as_bright_as_trees() {
    let round = Round::new();
    round.until(|event| matches!(event, Event::Done { .. }));
    let studio = Headless::open(&Shaders::builtin(), 1).expect("a device");
    let mut all = Vec::new();
    for path in scene_files(&Source::World(round.files.root().to_owned())).expect("scenes") {
        let scene = studio.read(&path).expect("readable");
        for template in 0..2 {
            assert!(scene.trees.templates[template].impostor.is_some(), "{}", scene.name);
            let [leaves, picture] = [TreeLodMode::Off, TreeLodMode::Simple]
                .map(|mode| look(&studio, &scene, template as u32, mode));
            let brightness = |seen: &Seen| seen.light / seen.pixels;
            let covers = picture.pixels / leaves.pixels;
            let bright = brightness(&picture) / brightness(&leaves);
            let told = format!("{} {template}: covers {covers:.3}, bright {bright:.3}", scene.name);
            // Fronds in pictures cover pixels in part, which count in whole here.
            let most = if scene.name.starts_with("Palms") { 1.15 } else { 1.08 };
            all.push(((0.92..most).contains(&covers) && (0.96..1.04).contains(&bright), told));
        }
    }
    assert!(all.iter().all(|(is_like, _)| *is_like), "{all:#?}");
}
