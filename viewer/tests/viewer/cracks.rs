//! Nothing shines through the land, whatever triangles it is drawn with: green land before a magenta sky, seen from above
//! so that all there can be is land.

use genescape_viewer::camera::Camera;
use genescape_viewer::lod_mode::TerrainLodMode;
use genescape_viewer::options::FrameInput;
use genescape_viewer::scene::Trees;
use glam::Vec3;
use image::RgbaImage;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

use crate::made_up;

const SIZE_PX: [u32; 2] = [120, 75];
const CAMERAS: u64 = 200;

/// Pixels that are rather magenta than green.
fn sky_pixels(pixels: &RgbaImage) -> usize {
    pixels.pixels().filter(|pixel| pixel[0] >= pixel[1]).count()
}

/// Looks down so steeply that even the picture's corners show land, from at most 14 m above it.
fn camera(seed: u64, height_m: impl Fn(f32, f32) -> f32) -> (Camera, f32) {
    let mut rng = Pcg32::seed_from_u64(seed);
    let (x, z) = (rng.random_range(-16.0..16.0f32), rng.random_range(-16.0..16.0f32));
    let above_m = rng.random_range(1.0..14.0f32);
    let camera = Camera {
        position_m: Vec3::new(x, height_m(x, z) + above_m, z),
        yaw_rad: rng.random_range(-3.1..3.1f32),
        pitch_rad: rng.random_range(-1.5..-1.05f32),
        fov_y_rad: 0.87,
    };
    (camera, libm::exp2f(rng.random_range(-1.0..5.0f32)))
}

fn no_sky_shines_through(mode: TerrainLodMode) {
    let studio = made_up::studio();
    let field = made_up::field(257, 0.5, 9.0, 0.7);
    let scene = made_up::scene(field, [30, 200, 30, 255], [2.0, 0.0, 2.0], Trees::default());
    let buffers = made_up::upload(&studio, &scene);
    let mut view = studio.view(buffers, SIZE_PX);
    let mut frame = FrameInput::default();
    frame.options.terrain_lod = mode;
    frame.options.grass = false;
    let up = Camera { position_m: Vec3::Y * 60.0, yaw_rad: 0.0, pitch_rad: 1.2, fov_y_rad: 0.87 };
    let sky = studio.shoot(&mut view, &frame, &up, &up).expect("a picture");
    assert_eq!(sky_pixels(&sky), sky.pixels().len(), "sky is told from land");
    for seed in 0..CAMERAS {
        let (camera, error_px) = camera(seed, |x, z| scene.ground.field.height_m(x, z));
        frame.options.terrain_error_px = error_px;
        let pixels = studio.shoot(&mut view, &frame, &camera, &camera).expect("a picture");
        assert_eq!(sky_pixels(&pixels), 0, "{mode:?}, error of {error_px} px, camera {seed}: {camera:?}");
    }
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn triangles_that_rise_have_no_cracks() {
    no_sky_shines_through(TerrainLodMode::Morph);
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn blocks_that_morph_by_distance_alone_have_no_cracks() {
    no_sky_shines_through(TerrainLodMode::Distance);
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn the_strip_of_triangles_has_no_cracks() {
    no_sky_shines_through(TerrainLodMode::Roam);
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn the_whole_grid_has_no_cracks() {
    no_sky_shines_through(TerrainLodMode::Off);
}
