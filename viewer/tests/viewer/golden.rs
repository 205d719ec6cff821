//! Pictures of a landscape made up of everything that is drawn, compared with pictures that a person has looked at
//! (`golden/*.png`). `cargo xtask bless pictures` writes them anew: look at them before they are kept.
//!
//! The measure is the mean of FLIP (Andersson et al. 2020), 0 for equal pictures. Mesa's software driver gives the same
//! bytes again and again; another moves edges of triangles and filters textures its own way (0.009 to 0.013 on an NVIDIA H200,
//! side by side the same to the eye). What is to be noticed, and is measured here each time:
//! a sun 5° elsewhere (0.013), no grass (0.05), trees that may err three times as much (0.015), levels of the land that
//! begin elsewhere (0.12).

use std::path::PathBuf;
use std::sync::Arc;

use genescape_viewer::camera::Camera;
use genescape_viewer::headless::Headless;
use genescape_viewer::image_file;
use genescape_viewer::lod_mode::{TerrainLodMode, TreeLodMode};
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::scene::{Apron, GroundDetail, Heightfield, Image, Scene, Trees};
use glam::Vec3;
use image::RgbaImage;

use crate::made_up;

/// The greatest mean of FLIP that passes: on the driver whose pictures are kept, and on another.
const THRESHOLD: f32 = 0.004;
const THRESHOLD_ELSEWHERE: f32 = 0.016;
const SIZE_PX: [u32; 2] = [320, 200];

pub fn landscape() -> Scene {
    let field = made_up::field(257, 0.5, 14.0, 0.25);
    let kinds = [[0.02, 0.07, 0.2, 0.7], [0.03, 0.1, 0.35, 0.9]];
    let templates =
        kinds.iter().map(|errors_m| Arc::new(made_up::template(&format!("{errors_m:?}"), errors_m)));
    let tree = |n: u32| {
        let [x, z] = [n, n + 500].map(|n| 120.0 * made_up::hash(n, 3, 4) - 60.0);
        let y = field.field.height_m(x, z);
        (y > -1.0).then(|| made_up::instance(n % 2, [x, y, z], 0.7 + 0.6 * made_up::hash(n, 1, 2), n as f32))
    };
    let instances = (0..140).filter_map(tree).collect();
    let trees = Trees { templates: templates.collect(), instances, ..Trees::default() };
    let mut scene = made_up::scene(field, [0; 4], [0.5, 0.7, 1.0], trees);
    let ground = &mut scene.ground;
    ground.water_level_m = Some(-3.0);
    let steep = |i: u32, j: u32| {
        let at = |i: u32, j: u32| ground.field.at((4 * i).min(256), (4 * j).min(256));
        let rock = ((at(i + 1, j) - at(i, j)).abs() + (at(i, j + 1) - at(i, j)).abs() - 0.9).clamp(0.0, 1.0);
        (rock * 255.0) as u8
    };
    ground.surface.weights = made_up::picture("steep", 64, |i, j| [steep(i, j), 0, 0, 0]);
    ground.surface.color = made_up::picture("green and grey", 64, |i, j| {
        let (rock, tone) = (u16::from(steep(i, j)), (40.0 * made_up::hash(i / 3, j / 3, 9)) as u16);
        [(70 + tone + rock / 5) as u8, (105 + tone + rock / 16) as u8, (45 + tone + rock / 4) as u8, 255]
    });
    ground.surface.details = (0..5).map(tile).collect();
    ground.apron = Arc::new(frame_of_land(&ground.field));
    scene.sky.light.haze_extinction_per_m = 0.002;
    scene
}

/// A tiling texture of soft blots.
fn tile(layer: u32) -> GroundDetail<Image> {
    let blot = move |i: u32, j: u32| {
        0.5 * made_up::hash(i % 16, j % 16, layer) + 0.5 * made_up::hash(i / 2, j / 2, layer)
    };
    GroundDetail {
        name: format!("blots {layer}"),
        detail: made_up::picture(&format!("blots {layer}"), 16, |i, j| [(90.0 + 76.0 * blot(i, j)) as u8; 4]),
        normal: made_up::picture(&format!("bumps {layer}"), 16, |i, j| {
            [(108.0 + 40.0 * blot(i, j)) as u8, (108.0 + 40.0 * blot(j, i)) as u8, 250, 255]
        }),
        tile_m: 3.0,
    }
}

/// Level land from the field's border outwards.
fn frame_of_land(field: &Heightfield) -> Apron {
    let half = 0.5 * field.extent_m();
    let ring = |half: f32, y: f32| [[-half, y, -half], [half, y, -half], [half, y, half], [-half, y, half]];
    Apron {
        positions_m: [ring(half, -4.0), ring(2000.0, -4.0)].concat(),
        normals: vec![[0.0, 1.0, 0.0]; 8],
        colors: vec![[30, 45, 20, 255]; 8],
        weights: vec![[0; 4]; 8],
        triangles: (0..4u32)
            .flat_map(|k| [[k, (k + 1) % 4, 4 + k], [(k + 1) % 4, 4 + (k + 1) % 4, 4 + k]])
            .collect(),
    }
}

/// What is drawn: name, where from (x, z, above the ground, yaw, pitch), options.
fn pictures() -> Vec<(&'static str, [f32; 5], Options)> {
    let trees = Options { tree_lod: TreeLodMode::Quality, tree_error_px: 1.0, ..Options::default() };
    let plain = Options { drift_clouds: false, ..trees };
    vec![
        ("walk", [20.0, 30.0, 1.7, 0.4, -0.1], plain),
        ("above", [0.0, 55.0, 30.0, 0.0, -0.5], Options { grass: false, ..plain }),
        (
            "simple",
            [-20.0, 10.0, 4.0, 2.4, -0.2],
            Options { tree_lod: TreeLodMode::Simple, tree_error_px: 4.0, ..plain },
        ),
        (
            "roam",
            [0.0, 55.0, 30.0, 0.0, -0.5],
            Options { terrain_lod: TerrainLodMode::Roam, grass: false, ..plain },
        ),
        (
            "levels",
            [10.0, 40.0, 12.0, 0.2, -0.3],
            Options { tint_levels: true, terrain_error_px: 4.0, tree_error_px: 6.0, ..plain },
        ),
    ]
}

fn shoot(
    studio: &Headless,
    scene: &Scene,
    [x, z, above, yaw_rad, pitch_rad]: [f32; 5],
    options: Options,
) -> RgbaImage {
    let buffers = made_up::upload(studio, scene);
    let position_m = Vec3::new(x, scene.ground.field.height_m(x, z) + above, z);
    let camera = Camera { position_m, yaw_rad, pitch_rad, fov_y_rad: 1.0 };
    let frame = FrameInput { options, time_s: 3.0, ..FrameInput::default() };
    studio.shoot(&mut studio.view(buffers, SIZE_PX), &frame, &camera, &camera).expect("a picture")
}

fn golden(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name).with_extension("png")
}

fn read(name: &str) -> RgbaImage {
    image::open(golden(name)).expect("a picture; `cargo xtask bless pictures` writes it").into_rgba8()
}

fn difference(a: &RgbaImage, b: &RgbaImage) -> f32 {
    assert_eq!(a.dimensions(), b.dimensions());
    let image = |image: &RgbaImage| {
        let rgb: Vec<u8> = image.pixels().flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        nv_flip::FlipImageRgb8::with_data(image.width(), image.height(), &rgb)
    };
    let map = nv_flip::flip(image(a), image(b), nv_flip::DEFAULT_PIXELS_PER_DEGREE);
    nv_flip::FlipPool::from_image(&map).mean()
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn pictures_are_as_they_were() {
    let studio = made_up::studio();
    let scene = landscape();
    let is_known = studio.gpu.name.starts_with("llvmpipe");
    let threshold = if is_known { THRESHOLD } else { THRESHOLD_ELSEWHERE };
    let mut differing = Vec::new();
    for (name, place, options) in pictures() {
        let drawn = shoot(&studio, &scene, place, options);
        if std::env::var_os("GENESCAPE_BLESS").is_some() {
            image_file::write_png(&golden(name), &drawn).expect("written");
        }
        let difference = difference(&read(name), &drawn);
        genescape_bake::say!("{name}: FLIP {difference}");
        if difference > threshold {
            let path = std::env::temp_dir().join(format!("genescape-golden-{name}.png"));
            image_file::write_png(&path, &drawn).expect("written");
            differing.push(format!("{name}: FLIP {difference}, see {}", path.display()));
        }
    }
    assert!(differing.is_empty(), "{differing:#?}");
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn what_should_be_noticed_is_and_nothing_else() {
    let studio = made_up::studio();
    let scene = landscape();
    let [(_, walk, plain), (_, above, coarse), ..] = &pictures()[..] else { unreachable!("there are five") };
    let before = shoot(&studio, &scene, *walk, *plain);
    assert_eq!(shoot(&studio, &scene, *walk, *plain), before, "run-to-run noise is 0");
    let mut later = scene.clone();
    later.sky.light.sun_direction = turned(scene.sky.light.sun_direction, 5f32.to_radians());
    let from_above = shoot(&studio, &scene, *above, *coarse);
    // Levels of the land hardly show, which is their purpose; in the picture that tints them they do.
    let (_, levels, tinted) = pictures()[4];
    let finer = Options { terrain_error_px: 0.1, ..tinted };
    let by_level = shoot(&studio, &scene, levels, tinted);
    let trees = Options { tree_error_px: 3.0 * coarse.tree_error_px, ..*coarse };
    let no_grass = Options { grass: false, ..*plain };
    let changes = [
        ("sun", difference(&before, &shoot(&studio, &later, *walk, *plain))),
        ("grass", difference(&before, &shoot(&studio, &scene, *walk, no_grass))),
        ("land", difference(&by_level, &shoot(&studio, &scene, levels, finer))),
        ("trees", difference(&from_above, &shoot(&studio, &scene, *above, trees))),
    ];
    genescape_bake::say!("{changes:?}");
    assert!(changes.iter().all(|(_, difference)| *difference > 1.5 * THRESHOLD), "{changes:?}");
}

/// About the vertical.
fn turned(direction: Vec3, by_rad: f32) -> Vec3 {
    let [x, y, z] = direction.to_array();
    let (sin, cos) = libm::sincosf(by_rad);
    Vec3::new(cos * x + sin * z, y, cos * z - sin * x)
}
