//! A still picture becomes finer: the mean of several, with their pixels' middles a little beside.

use genescape_viewer::camera::Camera;
use genescape_viewer::headless::Headless;
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::passes::{Shaders, pictures};
use genescape_viewer::scene::{Scene, Trees};
use glam::Vec3;
use image::RgbaImage;

use crate::golden;
use crate::made_up;

/// Sides of a picture, and of one with many more pixels, of which the first is the mean of squares.
const SIZE_PX: [u32; 2] = [120, 80];
const FINER: u32 = 8;

fn camera(ground_m: f32) -> Camera {
    Camera { position_m: Vec3::new(0.0, ground_m + 1.7, 40.0), yaw_rad: 0.3, pitch_rad: 0.05, fov_y_rad: 1.0 }
}

/// What a picture of many more pixels shows in squares of them, in linear light as far as bytes tell.
fn averaged(picture: &RgbaImage) -> Vec<[f32; 3]> {
    let linear = |byte: u8| libm::powf(f32::from(byte) / 255.0, 2.2);
    let [width, height] = SIZE_PX;
    let square = |i: u32| {
        let [x, y] = [i % width * FINER, i / width * FINER];
        let pixels = (0..FINER * FINER).map(|k| picture.get_pixel(x + k % FINER, y + k / FINER).0);
        let sum = pixels.fold([0.0; 3], |sum, p| std::array::from_fn(|c| sum[c] + linear(p[c])));
        sum.map(|sum| 255.0 * libm::powf(sum / (FINER * FINER) as f32, 1.0 / 2.2))
    };
    (0..width * height).map(square).collect()
}

fn error(picture: &RgbaImage, truth: &[[f32; 3]]) -> f64 {
    let of = |(pixel, truth): (&image::Rgba<u8>, &[f32; 3])| {
        let off = |c: usize| f64::from(f32::from(pixel.0[c]) - truth[c]);
        (0..3).map(|c| off(c) * off(c)).sum::<f64>()
    };
    let sum: f64 = picture.pixels().zip(truth).map(of).sum();
    (sum / (3 * truth.len()) as f64).sqrt()
}

/// A plain whose ground varies from texel to texel.
fn grained() -> Scene {
    let no_trees = Trees { templates: Vec::new(), instances: [].into(), ..Trees::default() };
    let mut scene = made_up::scene(made_up::field(65, 2.0, 0.0, 0.0), [128; 4], [0.5, 0.7, 1.0], no_trees);
    for detail in &mut scene.ground.surface.details {
        let grain = |i: u32, j: u32| [(40.0 + 170.0 * made_up::hash(i, j, 5)) as u8; 4];
        detail.detail = made_up::picture("grain", 256, grain);
        detail.normal = made_up::picture("level", 256, |_, _| [128, 128, 255, 255]);
    }
    scene
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn textures_are_sharper_in_a_still_picture() {
    let studio = Headless::open(&Shaders::builtin(), 1).expect("a Vulkan driver");
    let buffers = made_up::upload(&studio, &grained());
    let options = Options { grass: false, samples: 1, ..Options::default() };
    let frame = FrameInput { options, ..FrameInput::default() };
    let camera =
        Camera { position_m: Vec3::new(0.0, 3.0, 0.0), yaw_rad: 0.0, pitch_rad: -0.5, fov_y_rad: 0.6 };
    let many = studio
        .shoot(&mut studio.view(buffers.clone(), SIZE_PX.map(|side| side * FINER)), &frame, &camera, &camera)
        .expect("a picture");
    let truth = averaged(&many);
    let mut view = studio.view(buffers, SIZE_PX);
    let first = error(&studio.shoot(&mut view, &frame, &camera, &camera).expect("a picture"), &truth);
    let still = error(&studio.shoot_still(&mut view, &frame, [&camera; 2]).expect("a picture"), &truth);
    genescape_bake::say!("{first:.2} {still:.2}");
    assert!(still < 0.7 * first, "{first} and {still}");
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn a_still_picture_comes_nearer_to_one_of_many_more_pixels_with_each_that_is_added() {
    let scene = golden::landscape();
    let camera = camera(scene.ground.field.height_m(0.0, 40.0));
    // Levels of detail and blades depend on pixels.
    let options = Options { grass: false, tree_error_px: 0.0, terrain_error_px: 0.0, ..Options::default() };
    // The truth has finer mip levels, so that there always is some error.
    for (samples, left) in [(1, 0.5), (4, 0.85)] {
        let studio = Headless::open(&Shaders::builtin(), samples).expect("a Vulkan driver");
        let buffers = made_up::upload(&studio, &scene);
        let frame = FrameInput { options: Options { samples, ..options }, ..FrameInput::default() };
        let many = studio.shoot(
            &mut studio.view(buffers.clone(), SIZE_PX.map(|side| side * FINER)),
            &frame,
            &camera,
            &camera,
        );
        let truth = averaged(&many.expect("a picture"));
        let mut view = studio.view(buffers.clone(), SIZE_PX);
        let errors: Vec<f64> = (0..pictures(samples))
            .map(|accumulated| {
                let frame = FrameInput { accumulated, ..frame };
                error(&studio.shoot(&mut view, &frame, &camera, &camera).expect("a picture"), &truth)
            })
            .collect();
        genescape_bake::say!("{samples} samples: {errors:.2?}");
        let (first, last) = (errors[0], errors[errors.len() - 1]);
        assert!(last < left * first, "{samples} samples: {errors:?}");
        assert!(errors[1] < first, "the second: {errors:?}");

        let still = studio.shoot_still(&mut studio.view(buffers.clone(), SIZE_PX), &frame, [&camera; 2]);
        let still = still.expect("a picture");
        assert_eq!(error(&still, &truth), last, "what a screenshot is");
        let unrefined = FrameInput { options: Options { refine: false, ..frame.options }, ..frame };
        let single = studio.shoot_still(&mut studio.view(buffers, SIZE_PX), &unrefined, [&camera; 2]);
        assert_eq!(error(&single.expect("a picture"), &truth), first, "one picture, if that is wanted");
    }
}
