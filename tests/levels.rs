//! Each of four landscapes in one window looks as it does without levels of detail, from where it is first seen.

use genescape_viewer::headless::Headless;
use genescape_viewer::lod_mode::{TerrainLodMode, TreeLodMode};
use genescape_viewer::measure::flip;
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::passes::Shaders;
use genescape_viewer::walk::{Land, Rig, start_pose};

use crate::round::starters;

/// A quarter of a window that is not large: the fewer pixels, the coarser are trees whose levels follow the error in pixels alone.
const SIZE_PX: [u32; 2] = [640, 400];

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn one_of_four_views_looks_as_it_does_without_levels() {
    let studio = Headless::open(&Shaders::default(), 4).expect("a device");
    let mut all = Vec::new();
    for scene in starters(&studio) {
        let land = Land::of(&scene).from_its_start();
        let fov_y_rad = Options::default().fov_y_deg.to_radians();
        let camera = Rig::new(start_pose(&[&land]), &[&land]).camera(&land, fov_y_rad);
        let mut view = studio.view(studio.upload(&scene).expect("uploaded"), SIZE_PX);
        let mut look = |options: Options| {
            let frame = FrameInput { options, ..FrameInput::default() };
            studio.shoot_still(&mut view, &frame, [&camera, &camera]).expect("a picture").into_raw()
        };
        let usual = look(Options::default());
        let (tree_lod, terrain_lod) = (TreeLodMode::Off, TerrainLodMode::Off);
        let full = look(Options { tree_lod, terrain_lod, ..Options::default() });
        let off = flip(&full, &usual, SIZE_PX[0]);
        genescape_bake::say!("{}: FLIP {off:.4} from what it is without levels", scene.name);
        all.push(off);
    }
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    assert!(mean < 0.026, "{all:?}");
}
