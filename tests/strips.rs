//! Bark is the same whether it is drawn as lists of triangles or as strips (thesis section 4.4.1).

use std::sync::Arc;

use genescape_viewer::camera::Camera;
use genescape_viewer::headless::Headless;
use genescape_viewer::lod_mode::TreeLodMode;
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::passes::Shaders;
use genescape_viewer::scene::Instance;
use glam::Vec3;

use crate::round::starters;

/// Trees of each landscape, in a row.
const TREES: u32 = 4;
/// Steps of 255 by which a value of a pixel may differ: triangles begin at other corners.
const TOLERANCE: u8 = 2;

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn bark_in_strips_is_bark_in_lists() {
    let studio = Headless::open(&Shaders::builtin(), 1).expect("a device");
    for scene in starters(&studio) {
        let mut scene = scene.without_far_trees();
        let ground_m = scene.ground.field.height_m(0.0, 0.0);
        let kinds = scene.trees.templates.len() as u32;
        let height_m = 2.0 * scene.trees.templates.iter().map(|tree| tree.radius_m).fold(0.0, f32::max);
        // Each farther away than the one before: coarser levels are seen as well.
        let tree = |n: u32| Instance {
            world_from_tree: [
                [1.0, 0.0, 0.0, height_m * (n as f32 - 1.0)],
                [0.0, 1.0, 0.0, ground_m],
                [0.0, 0.0, 1.0, -3.0 * height_m * n as f32],
            ],
            template: n % kinds,
            trunk_cylinder_m: [0.0, 0.0, 0.1],
        };
        scene.trees.instances = (0..TREES).map(tree).collect::<Arc<_>>();
        let buffers = studio.upload(&scene).expect("uploaded");
        let trees = buffers.trees.as_ref().expect("trees");
        assert!(trees.mesh_draws as usize > trees.materials.len(), "{} has strips", scene.name);
        let position_m = Vec3::new(0.0, ground_m + 0.4 * height_m, height_m);
        let camera = Camera { position_m, yaw_rad: 0.0, pitch_rad: 0.0, fov_y_rad: 1.0 };
        let mut view = studio.view(buffers, [320, 240]);
        for tree_lod in [TreeLodMode::Off, TreeLodMode::Quality] {
            let mut shoot = |bark_strips: bool, draw_trees: bool| {
                let usual = Options { tree_lod, draw_terrain: false, grass: false, ..Options::default() };
                let frame = FrameInput {
                    options: Options { bark_strips, draw_trees, ..usual },
                    ..FrameInput::default()
                };
                studio.shoot(&mut view, &frame, &camera, &camera).expect("drawn").into_raw()
            };
            let (lists, strips, none) = (shoot(false, true), shoot(true, true), shoot(false, false));
            let differ = |a: &[u8], b: &[u8]| {
                a.chunks(4)
                    .zip(b.chunks(4))
                    .filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > TOLERANCE))
                    .count()
            };
            let (shown, wrong) = (differ(&lists, &none), differ(&lists, &strips));
            assert!(shown > 200 && 1000 * wrong <= shown, "{}: {wrong} of {shown} pixels", scene.name);
        }
    }
}
