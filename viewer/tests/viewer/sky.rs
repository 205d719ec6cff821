//! Clouds that are painted with few texels get edges finer than these, and are neither more nor fewer for it.

use std::f32::consts::FRAC_PI_3;

use genescape_viewer::camera::Camera;
use genescape_viewer::headless::Headless;
use genescape_viewer::options::FrameInput;
use genescape_viewer::scene::{HdrImage, Scene};
use glam::Vec3;
use image::RgbaImage;

use crate::golden::landscape;
use crate::made_up;

/// Texels a side of a face, and of a cloud.
const FACE: u32 = 64;
const CLOUD: u32 = 8;

/// A clear sky, and one with square clouds.
fn cloudy() -> Scene {
    let mut scene = landscape();
    let face = |name: String, cloud: f32| {
        let texel = |n: u32| {
            let is_cloud = (n % FACE / CLOUD + n / FACE / CLOUD).is_multiple_of(2);
            [if is_cloud { cloud } else { 0.05 }, 0.05, 0.05, 1.0].map(half::f16::from_f32)
        };
        let pixels: Vec<_> = (0..FACE * FACE).flat_map(texel).collect();
        HdrImage { name, width_px: FACE, height_px: FACE, pixels: bytemuck::cast_slice(&pixels).into() }
    };
    let images = &mut scene.sky.images;
    images.faces = (0..6).map(|n| face(format!("cloudy {n}"), 0.4)).collect();
    images.clear_faces = (0..6).map(|n| face(format!("clear {n}"), 0.05)).collect();
    scene
}

/// Which pixels of a picture of the sky show a cloud.
fn clouds(studio: &Headless, side_px: u32, pitch_rad: f32, fov_y_rad: f32) -> Vec<Vec<bool>> {
    let camera = Camera { position_m: Vec3::new(0.0, 50.0, 0.0), yaw_rad: 2.5, pitch_rad, fov_y_rad };
    let mut view = studio.view(made_up::upload(studio, &cloudy()), [side_px; 2]);
    let picture: RgbaImage =
        studio.shoot(&mut view, &FrameInput::default(), &camera, &camera).expect("a picture");
    let [least, most] = picture.pixels().fold([255, 0], |[least, most], p| [least.min(p[0]), most.max(p[0])]);
    let is_cloud = |pixel: &image::Rgba<u8>| pixel[0] > least + (most - least) / 2;
    picture.rows().map(|row| row.map(is_cloud).collect()).collect()
}

/// The part that is cloud, and how many edges a row has.
fn measure(clouds: &[Vec<bool>]) -> [f32; 2] {
    let pixels = (clouds.len() * clouds.len()) as f32;
    let covered = clouds.iter().flatten().filter(|is_cloud| **is_cloud).count() as f32;
    [covered / pixels, edges(clouds)]
}

/// How many edges a row has.
fn edges(clouds: &[Vec<bool>]) -> f32 {
    let edges = |row: &Vec<bool>| row.windows(2).filter(|pair| pair[0] != pair[1]).count();
    clouds.iter().map(edges).sum::<usize>() as f32 / clouds.len() as f32
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn magnified_clouds_are_frayed_and_cover_as_much() {
    let studio = made_up::studio();
    // A texel of the sky is two thirds of a pixel, and then ten.
    let [small, large] = [24, 384].map(|side_px| measure(&clouds(&studio, side_px, 1.2, FRAC_PI_3)));
    assert!((small[0] - large[0]).abs() < 0.03, "{} and {} are covered", small[0], large[0]);
    assert!(large[1] > 1.1 * small[1] && large[1] < 4.0 * small[1], "{} and {} edges", small[1], large[1]);
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn clouds_at_the_horizon_are_not_torn_into_streaks() {
    let low = clouds(&made_up::studio(), 384, 0.2, 0.3);
    let turned: Vec<Vec<bool>> = (0..384).map(|i| low.iter().map(|row| row[i]).collect()).collect();
    let [across, up] = [edges(&low), edges(&turned)];
    assert!(up < 1.3 * across, "{across} edges a row and {up} a column");
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn clouds_fade_into_their_other_copy_without_a_leap() {
    let studio = made_up::studio();
    let camera =
        Camera { position_m: Vec3::new(0.0, 50.0, 0.0), yaw_rad: 2.5, pitch_rad: 0.9, fov_y_rad: FRAC_PI_3 };
    let mut view = studio.view(made_up::upload(&studio, &cloudy()), [96; 2]);
    let mut after = |time_s: f32| {
        let frame = FrameInput { time_s, ..FrameInput::default() };
        studio.shoot(&mut view, &frame, &camera, &camera).expect("a picture")
    };
    let mut differ = |from_s: f32, to_s: f32| {
        let (a, b): (RgbaImage, RgbaImage) = (after(from_s), after(to_s));
        let pairs = a.pixels().zip(b.pixels());
        pairs.map(|(a, b)| f32::from(a[0].abs_diff(b[0]))).sum::<f32>() / (96.0 * 96.0)
    };
    // Another shader draws the sky from the 40th second on, and up to the 60th; in the middle the copies change places.
    for leap_s in [40.0, 50.0, 60.0] {
        let step = differ(leap_s - 0.01, leap_s + 0.01);
        assert!(step < 0.5, "{step} at {leap_s} s");
    }
    let fading = differ(44.0, 56.0);
    assert!(fading > 5.0, "{fading} while they fade");
}
