//! Shade of near trees on the ground: as wide as what throws it, from its foot on, wherever one has walked; and far away the
//! light map's.

use std::sync::Arc;

use genescape_viewer::camera::Camera;
use genescape_viewer::headless::Headless;
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::scene::{Range, Scene, Template, TerrainLod, TreeVertex, Trees};
use genescape_viewer::view::View;
use glam::Vec3;

use crate::made_up;

const HEIGHT_M: f32 = 8.0;
const WIDTH_M: f32 = 0.5;

/// A square pole.
fn pole() -> Template {
    let half = 0.5 * WIDTH_M;
    let ring = [[-half, half], [half, half], [half, -half], [-half, -half]];
    let vertex = |[x, z]: [f32; 2], y: f32| TreeVertex {
        position_m: [x, y, z],
        color: [90, 80, 60, 255],
        normal_oct: [0, i16::MAX],
        normal_end_oct: [0, i16::MAX],
        ..TreeVertex::default()
    };
    let mut tree = made_up::template("pole", &[0.01]);
    tree.vertices = [-1.0, HEIGHT_M].into_iter().flat_map(|y| ring.map(|corner| vertex(corner, y))).collect();
    let side = |k: u32| [k, (k + 1) % 4, 4 + k, (k + 1) % 4, 4 + (k + 1) % 4, 4 + k];
    tree.indices = (0..4).flat_map(side).chain([4, 5, 6, 4, 6, 7]).collect();
    tree.levels[0].ranges[0] = Range { first: 0, count: tree.indices.len() as u32 };
    (tree.center_m, tree.radius_m) = ([0.0, 0.5 * HEIGHT_M, 0.0], 0.6 * HEIGHT_M);
    tree
}

/// Such poles on level grey land.
fn scene(places: &[[f32; 2]], let_through: u8) -> Scene {
    on_land(made_up::land(257, 1.0, |_, _| 0.0), places, let_through)
}

/// Such poles at height 0 on grey land, under a sun in the east that stands as high as 8 to 6.
fn on_land(land: TerrainLod, places: &[[f32; 2]], let_through: u8) -> Scene {
    let instances = places.iter().map(|&[x, z]| made_up::instance(0, [x, 0.0, z], 1.0, 0.0)).collect();
    let trees = Trees { templates: vec![Arc::new(pole())], instances, ..Trees::default() };
    let mut scene = made_up::scene(land, [90, 90, 90, 255], [0.2; 3], trees);
    let light = [255, (0.8 * 255.0) as u8, 255, let_through];
    scene.ground.surface.light = made_up::picture(&format!("light {let_through}"), 1, |_, _| light);
    scene.sky.light.sun_direction = Vec3::new(0.6, 0.8, 0.0);
    scene.sky.light.sky_irradiance_linear = [0.3; 3];
    scene
}

/// From 10 m above, north up.
fn above(x: f32, z: f32) -> Camera {
    let position_m = Vec3::new(x, 10.0, z);
    Camera { position_m, yaw_rad: 0.0, pitch_rad: -0.499 * std::f32::consts::PI, fov_y_rad: 1.0 }
}

/// Green of each pixel, by rows.
fn shoot(studio: &Headless, view: &mut View, camera: &Camera, part: f32) -> Vec<Vec<f32>> {
    let options = Options { grass: false, draw_trees: false, ..Options::default() };
    let frame = FrameInput { options, part, ..FrameInput::default() };
    let drawn = studio.shoot(view, &frame, camera, camera).expect("a picture");
    drawn.rows().map(|row| row.map(|pixel| f32::from(pixel[1])).collect()).collect()
}

const SIDE: u32 = 400;
/// Pixels of a metre, seen from `above`.
const METRE_PX: f32 = SIDE as f32 / (2.0 * 0.546_3 * 10.0);

/// Width in metres of what is dark down a column of a picture: where it is half as dark as its darkest.
fn width_m(rows: &[Vec<f32>], column: usize) -> f32 {
    let values: Vec<f32> = rows.iter().map(|row| row[column]).collect();
    let (dark, light) = values.iter().fold((f32::MAX, f32::MIN), |(d, l), &v| (d.min(v), l.max(v)));
    assert!(light > 1.4 * dark, "no shade in column {column}: {dark} to {light}");
    values.iter().filter(|&&value| value < 0.5 * (dark + light)).count() as f32 / METRE_PX
}

/// The pole's shade in a picture whose middle is 2 m west and 1 m south of the pole's foot.
fn assert_is_shade_of_pole(rows: &[Vec<f32>]) {
    let column = |from_foot_m: f32| (0.5 * SIDE as f32 + (2.0 - from_foot_m) * METRE_PX) as usize;
    for from_foot_m in [0.6, 1.5, 3.0, 4.5] {
        let width_m = width_m(rows, column(from_foot_m));
        assert!((width_m - WIDTH_M).abs() < 0.16, "{width_m} m wide, {from_foot_m} m from its foot");
    }
    let middle = &rows[(0.5 * SIDE as f32 - METRE_PX) as usize];
    let (lit, end) = (middle[column(-1.5)], column(6.0 * HEIGHT_M / 8.0 + 0.8));
    assert!(middle[column(-1.5)..].iter().all(|&value| value > lit - 12.0), "shade towards the sun");
    assert!(middle[..end].iter().all(|&value| value > lit - 12.0), "shade beyond the end");
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn a_pole_throws_a_shadow_as_wide_as_itself_from_its_foot_on() {
    let studio = made_up::studio();
    let mut view = studio.view(made_up::upload(&studio, &scene(&[[0.0, 0.0]], 255)), [SIDE; 2]);
    assert_is_shade_of_pole(&shoot(&studio, &mut view, &above(-2.0, 1.0), 1.0));
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn shade_follows_where_one_walks() {
    let studio = made_up::studio();
    let scene = scene(&[[0.0, 0.0], [90.0, 40.0]], 255);
    let mut view = studio.view(made_up::upload(&studio, &scene), [SIDE; 2]);
    for step in 0..=30 {
        let camera = above(-2.0 + 3.0 * step as f32, 1.0 + 40.0 / 30.0 * step as f32);
        shoot(&studio, &mut view, &camera, 1.0);
    }
    assert_is_shade_of_pole(&shoot(&studio, &mut view, &above(88.0, 41.0), 1.0));
    // And back at once.
    assert_is_shade_of_pole(&shoot(&studio, &mut view, &above(-2.0, 1.0), 1.0));
}

/// As seen from the sun's side.
fn brightness_of_pole(studio: &Headless, scene: &Scene, x: f32) -> f32 {
    let mut view = studio.view(made_up::upload(studio, scene), [64; 2]);
    let camera = Camera {
        position_m: Vec3::new(x + 6.0, 4.0, 0.0),
        yaw_rad: std::f32::consts::FRAC_PI_2,
        pitch_rad: 0.0,
        fov_y_rad: 0.1,
    };
    let options = Options { grass: false, ..Options::default() };
    let frame = FrameInput { options, ..FrameInput::default() };
    let drawn = studio.shoot(&mut view, &frame, &camera, &camera).expect("a picture");
    f32::from(drawn.get_pixel(32, 32)[1])
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn land_of_few_samples_does_not_shade_what_stands_in_its_valleys() {
    let studio = made_up::studio();
    // Valleys 64 m apart, 16 m a sample, with slopes that the sun overlooks.
    let valleys = |i: u32, _| [0.0, 10.0, 20.0, 10.0][(i as usize + 2) % 4];
    let x = 32.0;
    let level =
        brightness_of_pole(&studio, &on_land(made_up::land(65, 16.0, |_, _| 0.0), &[[x, 0.0]], 255), x);
    let below = brightness_of_pole(&studio, &on_land(made_up::land(65, 16.0, valleys), &[[x, 0.0]], 255), x);
    assert!((below / level - 1.0).abs() < 0.1, "{below} in a valley, {level} on level land");
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn far_from_the_eye_shade_is_that_of_the_light_map() {
    let studio = made_up::studio();
    // Its light map says that trees let nothing through; none of them is near.
    let mut view = studio.view(made_up::upload(&studio, &scene(&[[100.0, 100.0]], 0)), [64, 400]);
    let camera =
        Camera { position_m: Vec3::new(0.0, 4.0, 0.0), yaw_rad: 0.0, pitch_rad: -0.2, fov_y_rad: 0.8 };
    let middle: Vec<f32> =
        shoot(&studio, &mut view, &camera, 1.0).iter().map(|row| row[32]).skip(120).collect();
    // Rows of 80 m and of 20 m away, and what is between them.
    let row_at = |away_m: f32| (200.0 + (libm::atanf(4.0 / away_m) - 0.2) / 0.8 * 400.0) as usize - 120;
    let (far, near) = (middle[row_at(80.0)], middle[row_at(20.0)]);
    // A card's edges and filters are its own.
    let least = if studio.gpu.software { 60.0 } else { 55.0 };
    assert!(near > far + least, "{far} far away, {near} near");
    let rising = middle[row_at(80.0)..row_at(20.0)].windows(2).all(|rows| rows[1] >= rows[0] - 3.0);
    assert!(rising, "{middle:?}");
    // A picture of part of full resolution, while one walks, does not wait for it.
    if studio.gpu.software {
        let away = Camera { position_m: Vec3::new(0.0, 4.0, 110.0), ..camera };
        let row = row_at(20.0) + 120;
        let moving = shoot(&studio, &mut view, &away, 0.5)[row][32];
        let at_rest = shoot(&studio, &mut view, &away, 1.0)[row][32];
        assert!((moving - far).abs() < 20.0 && (at_rest - near).abs() < 8.0, "{moving}, then {at_rest}");
    }
}
