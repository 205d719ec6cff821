//! What is rough on the ground shows its texture from all sides, and is else as bright as what is plain.

use std::f32::consts::FRAC_PI_4;

use genescape_schema::scene::{GroundPlants, PlantKind, PlantShape};
use genescape_viewer::camera::Camera;
use genescape_viewer::headless::Headless;
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::scene::{Image, Scene, Trees};
use glam::Vec3;

use crate::made_up;

/// A cube of 0.8 m.
fn cube() -> PlantShape {
    let mut shape = PlantShape::default();
    for (axis, side) in [0, 1, 2].into_iter().flat_map(|axis| [(axis, -1.0f32), (axis, 1.0)]) {
        let first = shape.positions_m.len() as u32;
        for [a, b] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0f32]] {
            let (mut position, mut normal) = ([0.0; 3], [0.0; 3]);
            (position[axis], normal[axis]) = (0.4 * side, side);
            (position[(axis + 1) % 3], position[(axis + 2) % 3]) = (0.4 * a, 0.4 * b);
            position[1] += 0.4;
            shape.positions_m.push(position);
            shape.normals.push(normal);
            shape.tints.push(0.5);
        }
        shape.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    shape.coarse = 12;
    shape
}

/// Cubes on black land, with that texture if any.
fn scene(texture: Option<u32>, tile: &Image) -> Scene {
    let land = made_up::land(65, 1.0, |_, _| 0.0);
    let mut scene = made_up::scene(land, [0, 0, 0, 255], [0.0; 3], Trees::default());
    for (layer, detail) in scene.ground.surface.details.iter_mut().enumerate() {
        let normals = |_, _| [128, 128, 255, 255];
        let other = |_, _| [128; 4];
        detail.normal = made_up::picture(&format!("normals {layer}"), 64, normals);
        detail.detail =
            if layer == 1 { tile.clone() } else { made_up::picture(&format!("tile {layer}"), 64, other) };
    }
    let kind = PlantKind {
        name: "cube".into(),
        per_m2: 0.15,
        scale: [1.0; 2],
        reach_m: 40.0,
        colors: vec![[[0.3; 3]; 2]],
        texture,
        shape: cube(),
        ..PlantKind::default()
    };
    let maps = vec![made_up::picture("everywhere", 1, |_, _| [255; 4])];
    scene.ground.surface.plants = GroundPlants { maps, kinds: vec![kind] };
    scene
}

/// The brightness of pixels that show a cube, from one corner of the sky and looking down at them.
fn bright(studio: &Headless, scene: &Scene, yaw_rad: f32) -> Vec<f32> {
    let mut view = studio.view(made_up::upload(studio, scene), [240, 160]);
    let (sin, cos) = libm::sincosf(yaw_rad);
    let camera =
        Camera { position_m: Vec3::new(6.0 * sin, 6.0, 6.0 * cos), yaw_rad, pitch_rad: -0.8, fov_y_rad: 0.7 };
    let frame = FrameInput { options: Options::default(), ..FrameInput::default() };
    let drawn = studio.shoot(&mut view, &frame, &camera, &camera).expect("a picture");
    drawn.pixels().map(|pixel| f32::from(pixel[1])).filter(|&value| value > 8.0).collect()
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn what_is_rough_shows_its_texture_from_all_sides() {
    let studio = made_up::studio();
    let even = made_up::picture("even", 64, |_, _| [128; 4]);
    let spots =
        made_up::picture("spots", 64, |x, y| if (x / 8 + y / 8) % 2 == 0 { [70; 4] } else { [186; 4] });
    for turn in 0..4u8 {
        let of =
            |texture, tile| bright(&studio, &scene(texture, tile), (f32::from(turn) + 0.5) * 2.0 * FRAC_PI_4);
        let [plain, smooth, rough] = [of(None, &even), of(Some(1), &even), of(Some(1), &spots)];
        assert!(
            plain.len() > 2000 && rough.len().abs_diff(plain.len()) < plain.len() / 10,
            "{}",
            plain.len()
        );
        let [plain, smooth, rough] = [plain, smooth, rough].map(|values| made_up::mean_and_spread(&values));
        for (what, seen) in [("smooth", smooth), ("rough", rough)] {
            assert!((seen.0 / plain.0 - 1.0).abs() < 0.15, "{turn}: {what} {seen:?}, plain {plain:?}");
        }
        // What the texture adds to how sides differ.
        let added = rough.1 * rough.1 - smooth.1 * smooth.1;
        assert!(added > 100.0, "{turn}: no texture shows, {rough:?} beside {smooth:?}");
    }
}

/// A slope of 45 degrees of one kind of ground, 150 to 1000 m away.
#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn hillsides_are_rough_from_near_by_and_from_afar() {
    let studio = made_up::studio();
    let no_trees = Trees { templates: Vec::new(), instances: [].into(), ..Trees::default() };
    let land = made_up::land(129, 16.0, |_, j| 12.0 * (64.0 - j as f32).max(0.0));
    let mut scene = made_up::scene(land, [110, 110, 110, 255], [0.4; 3], no_trees);
    for (layer, detail) in scene.ground.surface.details.iter_mut().enumerate() {
        let spots = |x: u32, y: u32| if (x / 8 + y / 8).is_multiple_of(2) { [70; 4] } else { [186; 4] };
        detail.detail = made_up::picture(&format!("spots {layer}"), 64, spots);
        detail.normal = made_up::picture(&format!("even {layer}"), 64, |_, _| [128, 128, 255, 255]);
    }
    for away_m in [30.0, 90.0, 180.0, 350.0] {
        let position_m = Vec3::new(3.0, 150.0, away_m - 190.0);
        let camera = Camera { position_m, yaw_rad: 0.0, pitch_rad: 0.0, fov_y_rad: 0.06 };
        let options = Options { grass: false, ..Options::default() };
        let frame = FrameInput { options, ..FrameInput::default() };
        let mut view = studio.view(made_up::upload(&studio, &scene), [240, 160]);
        let drawn = studio.shoot(&mut view, &frame, &camera, &camera).expect("a picture");
        let values: Vec<f32> = drawn.pixels().map(|pixel| f32::from(pixel[1])).collect();
        let (mean, spread) = made_up::mean_and_spread(&values);
        assert!(spread > 0.05 * mean, "{away_m} m away land is smooth: {spread} around {mean}");
    }
}

/// A cube on bright land under an even sky.
#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn the_ground_is_darker_around_the_foot_of_what_is_rough() {
    let studio = made_up::studio();
    let even = made_up::picture("even", 64, |_, _| [128; 4]);
    let ground = |texture| {
        let mut scene = scene(texture, &even);
        scene.ground.surface.color = made_up::picture("bright", 1, |_, _| [180, 180, 180, 255]);
        // On rock no grass grows.
        scene.ground.surface.weights = made_up::picture("rock", 1, |_, _| [255, 0, 0, 0]);
        scene.sky.light.sun_irradiance_linear = [0.0; 3];
        let mut view = studio.view(made_up::upload(&studio, &scene), [240, 160]);
        let camera =
            Camera { position_m: Vec3::new(0.0, 7.0, 5.0), yaw_rad: 0.0, pitch_rad: -1.0, fov_y_rad: 0.8 };
        let frame = FrameInput { options: Options::default(), ..FrameInput::default() };
        studio.shoot(&mut view, &frame, &camera, &camera).expect("a picture")
    };
    let ([with, without], mut shaded) = ([Some(1), None].map(ground), 0);
    let open = without.pixels().map(|pixel| pixel[1]).max().unwrap_or(0);
    for (with, without) in with.pixels().zip(without.pixels()) {
        // Where no cube is, with or without texture.
        if without[1].abs_diff(open) <= 2 {
            assert!(with[1] <= without[1] + 2, "{with:?} for {without:?}");
            shaded += u32::from(with[1] + 12 < without[1]);
        }
    }
    assert!(shaded > 300, "{shaded} pixels of ground are darker");
}
