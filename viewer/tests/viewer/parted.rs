//! Who walks under branches parts them: leaves before the very eye are not drawn.

use genescape_viewer::camera::Camera;
use genescape_viewer::headless::Headless;
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::scene::Trees;
use glam::Vec3;
use image::RgbaImage;

use crate::made_up::{self, differing};

/// Part of a picture that a tree of one leaf, or of one board, changes, seen from so far.
fn seen(studio: &Headless, is_leaf: bool, away_m: f32) -> f64 {
    let draw = |trees: Trees| -> RgbaImage {
        let scene = made_up::scene(made_up::field(65, 2.0, 0.0, 0.0), [128; 4], [0.5, 0.7, 1.0], trees);
        let camera = Camera {
            position_m: Vec3::new(0.0, 3.0, away_m),
            yaw_rad: 0.0,
            // At the sky, for its shadow is to be seen on the ground.
            pitch_rad: 0.5,
            fov_y_rad: 0.6,
        };
        let options = Options { grass: false, ..Options::default() };
        let frame = FrameInput { options, ..FrameInput::default() };
        let mut view = studio.view(made_up::upload(studio, &scene), [96, 64]);
        studio.shoot(&mut view, &frame, &camera, &camera).expect("a picture")
    };
    let instances = [made_up::instance(0, [0.0, 3.0, 0.0], 1.0, 0.0)].into();
    let mut tree = made_up::one_leaf("a leaf", [200, 60, 60, 255]);
    if !is_leaf {
        tree.name = "a board".into();
        tree.materials[0].alpha_cutoff = None;
    }
    let with = draw(Trees { templates: vec![tree.into()], instances, ..Trees::default() });
    let without = draw(Trees { templates: Vec::new(), instances: [].into(), ..Trees::default() });
    differing(&with, &without) as f64 / f64::from(96 * 64)
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn a_leaf_before_the_very_eye_is_not_drawn() {
    let studio = made_up::studio();
    let seen = |is_leaf, away_m| seen(&studio, is_leaf, away_m);
    assert_eq!(seen(true, 0.3), 0.0);
    let (some, most) = (seen(true, 0.75), seen(true, 1.0));
    assert!(0.05 < some && some < most, "{some} {most}");
    assert!(seen(true, 1.5) > 0.99);
    assert!(seen(false, 0.3) > 0.99, "wood is");
}
