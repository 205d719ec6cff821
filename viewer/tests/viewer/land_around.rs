//! Where the field ends the land goes on as it was: as bright, and of the same kinds of ground.

use std::sync::Arc;

use genescape_viewer::camera::Camera;
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::scene::{Apron, Trees};
use glam::Vec3;

use crate::made_up::{self, mean_and_spread};

const SIDE: u32 = 129;
const SIZE_PX: [u32; 2] = [320, 320];
/// sRGB of the field, and nearly the same as linear light.
const ROCK: [u8; 4] = [128, 128, 128, 255];
const ROCK_LINEAR: [u8; 4] = [55, 55, 55, 255];

/// Mean and spread of level land, rock all over, on both sides of the field's northern border: around it and within, as seen from
/// above.
fn both_sides(grain: u8) -> [(f32, f32); 2] {
    let mut scene = made_up::scene(made_up::land(SIDE, 1.0, |_, _| 0.0), ROCK, [0.6; 3], Trees::default());
    let surface = &mut scene.ground.surface;
    surface.weights = made_up::picture("all rock", 1, |_, _| [255, 0, 0, 0]);
    let tone = |i, j| 128 - grain + (2.0 * f32::from(grain) * made_up::hash(i, j, 3)) as u8;
    surface.details[1].detail = made_up::picture("rough rock", 64, |i, j| [tone(i, j); 4]);
    for (layer, detail) in surface.details.iter_mut().enumerate() {
        if layer != 1 {
            detail.detail = made_up::picture(&format!("smooth {layer}"), 64, |_, _| [128; 4]);
        }
        detail.normal = made_up::picture(&format!("level {layer}"), 64, |_, _| [128, 128, 255, 255]);
    }
    // The light map holds n·l, which level land around has from its normals.
    let up = scene.sky.light.sun_direction.normalize().y;
    surface.light = made_up::picture("level light", 1, |_, _| [255, (255.0 * up) as u8, 255, 255]);
    let (half, far) = (0.5 * (SIDE - 1) as f32, 1000.0);
    let square = |half: f32| [[-half, 0.0, -half], [half, 0.0, -half], [half, 0.0, half], [-half, 0.0, half]];
    scene.ground.apron = Arc::new(Apron {
        positions_m: [square(half), square(far)].concat(),
        normals: vec![[0.0, 1.0, 0.0]; 8],
        colors: vec![ROCK_LINEAR; 8],
        weights: vec![[255, 0, 0, 0]; 8],
        triangles: (0..4u32)
            .flat_map(|k| [[k, (k + 1) % 4, 4 + k], [(k + 1) % 4, 4 + (k + 1) % 4, 4 + k]])
            .collect(),
    });
    let studio = made_up::studio();
    let camera = Camera {
        position_m: Vec3::new(0.0, 20.0, -half),
        yaw_rad: 0.0,
        pitch_rad: -std::f32::consts::FRAC_PI_2,
        fov_y_rad: 0.8,
    };
    let frame =
        FrameInput { options: Options { grass: false, ..Options::default() }, ..FrameInput::default() };
    let mut view = studio.view(made_up::upload(&studio, &scene), SIZE_PX);
    let picture = studio.shoot(&mut view, &frame, &camera, &camera).expect("a picture");
    [0..SIZE_PX[1] / 2 - 4, SIZE_PX[1] / 2 + 4..SIZE_PX[1]].map(|rows| {
        let pixels = rows.flat_map(|y| (0..SIZE_PX[0]).map(move |x| (x, y)));
        mean_and_spread(&pixels.map(|(x, y)| f32::from(picture.get_pixel(x, y)[1])).collect::<Vec<f32>>())
    })
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn the_field_ends_without_a_line() {
    for grain in [10, 60] {
        let [around, within] = both_sides(grain);
        assert!((around.0 / within.0 - 1.0).abs() < 0.04, "bright: {around:?} around, {within:?} within");
        assert!((0.8..1.25).contains(&(around.1 / within.1)), "rough: {around:?} around, {within:?} within");
    }
}
