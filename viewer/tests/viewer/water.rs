//! A lake mirrors trees and land as they look, hills hide what is behind them in the mirror, too, and its edge is where the
//! land goes under.

use std::sync::Arc;

use genescape_schema::scene::TerrainLod;
use genescape_viewer::camera::Camera;
use genescape_viewer::headless::Headless;
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::scene::{Apron, Scene, Trees};
use glam::Vec3;
use image::RgbaImage;

use crate::made_up;

const SIZE_PX: [u32; 2] = [240, 160];
const GREEN: [u8; 4] = [60, 110, 50, 255];
/// Where the tree stands, north of the lake, and its middle above the surface.
const TREE_M: [f32; 3] = [0.0, 1.0, -45.0];
const MIDDLE_M: f32 = 6.0;

/// A lake from south to north, land a metre above it around; perhaps a tree on its far shore, and a hill before that.
fn lakeside(has_tree: bool, has_hill: bool, color: [u8; 4]) -> Scene {
    let (side, spacing_m) = (257, 0.5);
    let place_m = |line: u32| (line as f32 - 128.0) * spacing_m;
    let height_m = |i: u32, j: u32| {
        let (x, z) = (place_m(i), place_m(j));
        let to_shore = (30.0 - x.abs()).min(32.0 - (z - 0.0).abs());
        let hill = if has_hill && (-42.0..-36.0).contains(&z) { 14.0 } else { 1.0 };
        if to_shore > 0.0 { -3.0 } else { hill }
    };
    let template = genescape_viewer::scene::Template {
        impostor: Some(made_up::impostor("disc", 0.3)),
        ..made_up::template("cones", &[0.02, 0.07])
    };
    let instances = if has_tree { vec![made_up::instance(0, TREE_M, 1.5, 0.0)] } else { Vec::new() };
    let trees =
        Trees { templates: vec![Arc::new(template)], instances: instances.into(), ..Trees::default() };
    let mut scene = made_up::scene(made_up::land(side, spacing_m, height_m), color, [0.5, 0.7, 1.0], trees);
    scene.ground.water_level_m = Some(0.0);
    scene
}

/// Land of that colour without trees, and water at height 0.
fn flooded(bed: TerrainLod, color: [u8; 4]) -> Scene {
    let mut scene = made_up::scene(bed, color, [0.5, 0.7, 1.0], Trees::default());
    scene.ground.water_level_m = Some(0.0);
    scene
}

fn camera() -> Camera {
    Camera { position_m: Vec3::new(0.0, 3.0, 40.0), yaw_rad: 0.0, pitch_rad: 0.0, fov_y_rad: 1.0 }
}

fn shoot(studio: &Headless, scene: &Scene) -> RgbaImage {
    shoot_from(studio, scene, &camera())
}

fn shoot_from(studio: &Headless, scene: &Scene, camera: &Camera) -> RgbaImage {
    let options = Options { grass: false, ..Options::default() };
    let frame = FrameInput { options, ..FrameInput::default() };
    let mut view = studio.view(made_up::upload(studio, scene), SIZE_PX);
    studio.shoot(&mut view, &frame, camera, camera).expect("a picture")
}

/// Where a picture shows a place.
fn pixel_of(camera: &Camera, place_m: Vec3) -> [u32; 2] {
    let [width, height] = SIZE_PX.map(|side| side as f32);
    let clip = camera.clip_from_world(width / height) * place_m.extend(1.0);
    let [x, y] = [0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w];
    [(x * width) as u32, (y * height) as u32]
}

/// Mean colour where an even lake shows the middle of the tree.
fn mirrored(picture: &RgbaImage) -> [f32; 3] {
    let [x, y] = pixel_of(&camera(), Vec3::new(0.0, -MIDDLE_M, TREE_M[2]));
    let pixels = (x - 2..=x + 2).flat_map(|x| (y - 1..=y + 1).map(move |y| picture.get_pixel(x, y)));
    let sum = pixels.fold([0.0; 3], |sum, pixel| [0, 1, 2].map(|n| sum[n] + f32::from(pixel[n])));
    sum.map(|channel| channel / 15.0)
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn a_lake_mirrors_trees_unless_a_hill_hides_them() {
    let studio = made_up::studio();
    let look = |has_tree, has_hill| mirrored(&shoot(&studio, &lakeside(has_tree, has_hill, GREEN)));
    let [bare, tree] = [false, true].map(|has_tree| look(has_tree, false));
    assert!(tree[2] < bare[2] - 25.0, "a tree is less blue than the sky: {tree:?}, {bare:?}");
    assert!(tree[1] > tree[2], "and green: {tree:?}");
    let [bare, tree] = [false, true].map(|has_tree| look(has_tree, true));
    assert_eq!(tree, bare, "behind a hill");
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn a_lake_mirrors_land_in_its_colour() {
    let studio = made_up::studio();
    let look = |color| mirrored(&shoot(&studio, &lakeside(false, true, color)));
    let (red, green) = (look([150, 40, 40, 255]), look(GREEN));
    assert!(red[0] > red[1] + 20.0 && green[1] > green[0] + 10.0, "{red:?}, {green:?}");
}

/// A lake that goes on in the ring around the field, where its far shore rises by 5 mm a metre.
#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn a_far_flat_shore_is_where_the_ring_comes_out_of_the_lake() {
    let bed = made_up::land(129, 1.0, |_, _| -3.0);
    let mut scene = flooded(bed, GREEN);
    let height_m = |z: f32| -0.5 - 0.005 * (z + 64.0);
    let corner = |x: f32, z: f32| [x, height_m(z), z];
    scene.ground.apron = Arc::new(Apron {
        positions_m: [[-800.0, -64.0], [800.0, -64.0], [800.0, -900.0], [-800.0, -900.0]]
            .map(|[x, z]| corner(x, z))
            .to_vec(),
        normals: vec![[0.0, 1.0, 0.0]; 4],
        colors: vec![[200, 20, 20, 255]; 4],
        weights: vec![[0; 4]; 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    });
    let camera =
        Camera { position_m: Vec3::new(0.0, 30.0, 40.0), yaw_rad: 0.0, pitch_rad: -0.1, fov_y_rad: 1.0 };
    let picture = shoot_from(&made_up::studio(), &scene, &camera);
    // Where the land is as high as the lake.
    let [_, shore] = pixel_of(&camera, Vec3::new(0.0, 0.0, -164.0));
    for x in (20..SIZE_PX[0] - 20).step_by(10) {
        let is_red = |y: u32| picture.get_pixel(x, y)[0] > picture.get_pixel(x, y)[2];
        assert!((2..8).all(|above| is_red(shore - above)), "land at {x}, above row {shore}");
        assert!((2..8).all(|below| !is_red(shore + below)), "the lake at {x}, below row {shore}");
    }
}

/// A bar of red land 15 cm under the surface: in the lake behind it its mirror image would stand.
#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn what_is_under_water_is_not_mirrored() {
    let studio = made_up::studio();
    let behind = |bar_m: f32| {
        let height_m = |_: u32, j: u32| if (86..=92).contains(&j) { bar_m } else { -3.0 };
        let bed = made_up::land(257, 0.5, height_m);
        let picture = shoot(&studio, &flooded(bed, [200, 20, 20, 255]));
        let [x, y] = pixel_of(&camera(), Vec3::new(0.0, 0.0, -23.5));
        picture.get_pixel(x, y).0.map(f32::from)
    };
    let [none, sunk] = [-3.0, -0.15].map(behind);
    assert!((0..3).all(|n| (sunk[n] - none[n]).abs() < 6.0), "{sunk:?} behind a bar, {none:?} without it");
}

/// An even sky, of which calm water mirrors nearly all at so low an angle.
#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn a_sea_is_darker_than_the_sky_where_it_ends_and_a_lake_is_not() {
    let studio = made_up::studio();
    // Far behind the eye's back there is land around a lake, and none around a sea.
    let below_horizon = |shore_m: f32| {
        let bed = made_up::land(129, 8.0, |_, _| -30.0);
        let mut scene = flooded(bed, GREEN);
        let corners = [[-4e3, 4e3], [4e3, 4e3], [0.0, 4.1e3]];
        scene.ground.apron = Arc::new(Apron {
            positions_m: corners.map(|[x, z]| [x, shore_m, z]).to_vec(),
            normals: vec![[0.0, 1.0, 0.0]; 3],
            colors: vec![[100; 4]; 3],
            weights: vec![[0; 4]; 3],
            triangles: vec![[0, 1, 2]],
        });
        let eye = Camera { position_m: Vec3::new(0.0, 25.0, 0.0), ..camera() };
        let picture = shoot_from(&studio, &scene, &eye);
        let row = |y: u32| (0..SIZE_PX[0]).map(|x| f32::from(picture.get_pixel(x, y)[2])).sum::<f32>();
        row(SIZE_PX[1] / 2 + 3) / row(SIZE_PX[1] / 2 - 3)
    };
    let [sea, lake] = [-5.0, 5.0].map(below_horizon);
    assert!(sea < 0.93 && lake > sea + 0.04, "the sea {sea} as bright as the sky, a lake {lake}");
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn flooded_ground_mirrors_the_sky() {
    let studio = made_up::studio();
    // On the far shore, red ground; what is under water only shows the blue sky.
    let colour = |dry: u8| {
        let picture = shoot(&studio, &lakeside(false, false, [200, 20, 20, dry]));
        picture.get_pixel(SIZE_PX[0] / 2, SIZE_PX[1] - 8).0.map(f32::from)
    };
    let ([r, _, b, _], [r_flooded, _, b_flooded, _]) = (colour(255), colour(0));
    assert!(r > b + 40.0, "{r} red, {b} blue on dry ground");
    assert!(r_flooded < r - 15.0 && b_flooded > b + 15.0, "{r_flooded} red, {b_flooded} blue under water");
}

/// Single plants are drawn near by only.
#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn rice_hides_the_water_of_far_fields() {
    let studio = made_up::studio();
    let scene = flooded(made_up::land(257, 0.5, |_, _| 1.0), [200, 20, 20, 0]);
    let camera = Camera { position_m: Vec3::new(0.0, 3.0, 60.0), ..camera() };
    let picture = shoot_from(&studio, &scene, &camera);
    let redness = |z_m: f32| {
        let [x, y] = pixel_of(&camera, Vec3::new(0.0, 1.0, z_m));
        let [r, _, b, _] = picture.get_pixel(x, y).0.map(f32::from);
        r / b
    };
    // Of water alone the far field, across which one looks flatter, shows less of the red ground.
    let [near, far] = [50.0, -50.0].map(redness);
    assert!(far > 1.3 * near, "red is {near} of blue near by and {far} far away");
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn a_lake_mirrors_alike_in_pictures_of_all_sizes_and_nothing_from_below() {
    let studio = made_up::studio();
    let scene = made_up::upload(&studio, &lakeside(true, false, GREEN));
    let mut view = studio.view(scene, [31, 17]);
    let shoot = |view: &mut genescape_viewer::view::View, camera: &Camera| {
        let frame =
            FrameInput { options: Options { grass: false, ..Options::default() }, ..FrameInput::default() };
        studio.shoot(view, &frame, camera, camera).expect("a picture")
    };
    shoot(&mut view, &camera());
    view.resize(&studio.passes, SIZE_PX);
    let resized = shoot(&mut view, &camera());
    // Away from the lake, under water, and back: nothing is left over.
    let away = Camera { yaw_rad: std::f32::consts::PI, ..camera() };
    let below = Camera { position_m: Vec3::new(0.0, -1.0, 0.0), pitch_rad: 0.5, ..camera() };
    shoot(&mut view, &away);
    shoot(&mut view, &below);
    assert_eq!(shoot(&mut view, &camera()), resized);
    assert_eq!(self::shoot(&studio, &lakeside(true, false, GREEN)), resized);
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn shade_has_no_edge_on_deep_water() {
    let studio = made_up::studio();
    let mut scene = flooded(made_up::land(257, 0.5, |_, _| -30.0), GREEN);
    // Trees leave all of the sun in the east and none in the west.
    scene.ground.surface.light =
        made_up::picture("shade", 128, |x, _| [255, 255, 255, if x < 64 { 0 } else { 255 }]);
    let camera = Camera {
        position_m: Vec3::new(0.0, 50.0, 0.1),
        yaw_rad: 0.0,
        pitch_rad: 0.01 - std::f32::consts::FRAC_PI_2,
        fov_y_rad: 1.0,
    };
    let picture = shoot_from(&studio, &scene, &camera);
    let column = |x: u32| {
        (60..100)
            .map(|y| picture.get_pixel(x, y).0[..3].iter().map(|&c| f32::from(c)).sum::<f32>())
            .sum::<f32>()
            / 120.0
    };
    let columns: Vec<f32> = (0..SIZE_PX[0]).map(column).collect();
    let rise = columns[SIZE_PX[0] as usize - 1] - columns[0];
    let edge = columns.windows(6).map(|near| near[5] - near[0]).fold(0.0, f32::max);
    assert!(rise > 10.0 && edge < 0.25 * rise, "{edge} of {rise}");
}
