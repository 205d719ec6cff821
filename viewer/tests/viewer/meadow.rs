//! Blades of grass are seen before the turf that they stand on, and leave a meadow as bright as it is without them.

use std::ops::Range;

use genescape_viewer::camera::Camera;
use genescape_viewer::headless::Headless;
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::scene::Trees;
use glam::Vec3;
use image::RgbaImage;

use crate::made_up;

/// A green meadow, seen from eye level.
fn meadow(studio: &Headless, grass: bool) -> RgbaImage {
    let land = made_up::land(65, 1.0, |_, _| 0.0);
    let mut scene = made_up::scene(land, [110, 140, 80, 255], [0.6; 3], Trees::default());
    scene.ground.surface.weights = made_up::picture("turf", 1, |_, _| [0; 4]);
    for (layer, detail) in scene.ground.surface.details.iter_mut().enumerate() {
        detail.detail = made_up::picture(&format!("tile {layer}"), 64, |_, _| [128; 4]);
        detail.normal = made_up::picture(&format!("normals {layer}"), 64, |_, _| [128, 128, 255, 255]);
    }
    let camera =
        Camera { position_m: Vec3::new(0.0, 1.7, 0.0), yaw_rad: 0.0, pitch_rad: -0.45, fov_y_rad: 0.9 };
    let frame = FrameInput { options: Options { grass, ..Options::default() }, ..FrameInput::default() };
    let mut view = studio.view(made_up::upload(studio, &scene), [480, 320]);
    studio.shoot(&mut view, &frame, &camera, &camera).expect("a picture")
}

/// Mean and standard deviation of its brightness in some eighths of the picture from its top.
fn brightness(picture: &RgbaImage, rows: Range<u32>) -> (f32, f32) {
    let seen = picture.enumerate_pixels().filter(|(_, y, _)| rows.contains(&(y * 8 / picture.height())));
    let values: Vec<f32> = seen.map(|(_, _, pixel)| f32::from(pixel[1])).collect();
    made_up::mean_and_spread(&values)
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn blades_are_seen_and_a_meadow_is_as_bright_as_without_them() {
    let studio = made_up::studio();
    let pictures = [false, true].map(|grass| meadow(&studio, grass));
    // 1.7 to 2.8, 2.8 to 5 and 5 to 17 m away.
    for rows in [6..8, 4..6, 2..4] {
        let [(bare, _), (mean, spread)] = pictures.each_ref().map(|one| brightness(one, rows.clone()));
        assert!((0.85..1.1).contains(&(mean / bare)), "{rows:?}: {mean} with blades, {bare} without");
        // .07 to .08 where turf is as bright as blades.
        assert!(spread > 0.09 * mean, "{rows:?}: blades are hardly seen, {spread} around {mean}");
    }
}
