//! A wood is as bright, has the same colour and hides as much of the sky at every distance.

use std::sync::Arc;

use genescape_viewer::camera::Camera;
use genescape_viewer::lod::tree::allowance;
use genescape_viewer::lod_mode::TreeLodMode;
use genescape_viewer::options::{FrameInput, Options};
use genescape_viewer::scene::{Instance, Scene, Template};
use glam::{Vec2, Vec3};

use crate::backdrop::{Backdrops, Matte, Stage};
use crate::round::starters;

/// Pixels a radian: those of a window 720 pixels high.
const FOCAL_PX: f32 = 623.0;
/// The most pixels a side; of a larger wood its middle is seen.
const MAX_PX: u32 = 160;
/// Pictures of full trees have so many times as many pixels a side.
const FINER: u32 = 4;
/// Trees of a wood, and directions from which it is seen: with the sun behind the eye, and before it.
const TREES: u32 = 24;
const DIRECTIONS_RAD: [f32; 2] = [0.5, 2.5];
/// By how much cover and light may differ from those of full trees.
const MORE: f64 = 0.04;
const BRIGHTER: f64 = 0.085;

/// How much of the sky one hides, as a multiple of what another hides that has `FINER` times as many pixels a side, and by how much
/// each channel differs as a part of the brightest one.
fn beside(one: &Matte, other: &Matte) -> (f64, [f64; 3]) {
    let (light, whole) = (one.radiance(), other.radiance());
    let brightest = whole.into_iter().fold(0.0, f64::max);
    let cover = one.pixels / other.pixels * f64::from(FINER * FINER);
    (cover, [0, 1, 2].map(|c| (light[c] - whole[c]) / brightest))
}

/// A wood in the middle of a landscape, of trees so close that their crowns meet, in clear air; and how far it reaches.
fn wood(scene: &Scene) -> (Scene, f32) {
    let templates = &scene.trees.templates;
    let wide_m = mean(templates, |tree| tree.impostor.as_ref().expect("pictures").size_m[0]);
    let spread_m = 0.62 * wide_m;
    let tree = |n: u32| {
        // A sunflower's seeds.
        let (sin, cos) = libm::sincosf(n as f32 * 2.399_963);
        let place_m = Vec2::new(cos, sin) * spread_m * (n as f32 + 0.5).sqrt();
        let y = scene.ground.field.height_m(place_m.x, place_m.y);
        let scale = 0.85 + 0.03 * (n * 7 % 11) as f32;
        let (sin, cos) = libm::sincosf(1.7 * n as f32);
        Instance {
            world_from_tree: [
                [scale * cos, 0.0, scale * sin, place_m.x],
                [0.0, scale, 0.0, y],
                [-scale * sin, 0.0, scale * cos, place_m.y],
            ],
            template: n % templates.len() as u32,
            trunk_cylinder_m: [place_m.x, place_m.y, 0.2],
        }
    };
    let mut wood = scene.clone().without_far_trees();
    wood.trees.instances = (0..TREES).map(tree).collect();
    wood.sky.light.haze_extinction_per_m = 0.0;
    (wood, spread_m * (TREES as f32).sqrt() + wide_m)
}

fn mean(templates: &[Arc<Template>], of: impl Fn(&Template) -> f32) -> f32 {
    templates.iter().map(|tree| of(tree)).sum::<f32>() / templates.len() as f32
}

struct Look<'a> {
    backdrops: &'a Backdrops,
    stage: Stage,
    middle_m: Vec3,
    reach_m: f32,
    to_sun: Vec3,
}

impl Look<'_> {
    fn see(&mut self, away_m: f32, mode: TreeLodMode, finer: u32) -> Matte {
        let side_px = ((2.0 * self.reach_m / away_m * FOCAL_PX) as u32).clamp(16, MAX_PX);
        let fov_y_rad = 2.0 * libm::atanf(side_px as f32 / 2.0 / FOCAL_PX);
        self.backdrops.resize(&mut self.stage, [side_px * finer; 2]);
        let options = Options { tree_lod: mode, draw_terrain: false, grass: false, ..Options::default() };
        let frame = FrameInput { options, ..FrameInput::default() };
        let mut seen = Matte::default();
        for direction_rad in DIRECTIONS_RAD {
            let yaw_rad = libm::atan2f(self.to_sun.x, self.to_sun.z) + direction_rad;
            let pitch_rad = -0.08;
            let look = Camera { position_m: Vec3::ZERO, yaw_rad, pitch_rad, fov_y_rad };
            let camera = Camera { position_m: self.middle_m - away_m * look.forward(), ..look };
            seen += self.backdrops.look(&mut self.stage, &frame, &camera);
        }
        seen
    }
}

/// From where most trees are shown by a middle level, by clusters where there are some, and by pictures.
fn distances_m(templates: &[Arc<Template>]) -> Vec<(String, f32)> {
    let radius_m = mean(templates, |tree| tree.radius_m);
    // The first distance, to a hundredth, at which so much error is allowed.
    let allows = |error_m: f32| {
        let wanted_m = error_m * FOCAL_PX / Options::default().tree_error_px;
        std::iter::successors(Some(wanted_m), |away_m| Some(1.01 * away_m))
            .find(|&away_m| away_m * allowance(FOCAL_PX, away_m + radius_m, radius_m) >= wanted_m)
            .expect("they grow without end")
    };
    let least = templates.iter().map(|tree| tree.levels.len()).min().unwrap_or(1);
    let clusters = templates.iter().filter_map(|tree| tree.clusters).max().map(|first| first as usize + 1);
    let levels = [Some(2), clusters].into_iter().flatten().filter(|level| *level < least);
    let of_level = |level: usize| {
        (format!("D{level}"), 1.05 * allows(mean(templates, |tree| tree.levels[level].error_m)))
    };
    let picture_m = mean(templates, |tree| tree.impostor.as_ref().expect("pictures").error_m);
    levels.map(of_level).chain([("pictures".to_owned(), 2.3 * allows(picture_m))]).collect()
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn a_wood_is_the_same_at_every_distance() {
    let backdrops = Backdrops::open();
    let mut all = Vec::new();
    for scene in starters(backdrops.studio()) {
        let templates = &scene.trees.templates;
        let (wood, reach_m) = wood(&scene);
        let mut look = Look {
            backdrops: &backdrops,
            stage: backdrops.stage(&wood, [MAX_PX; 2]),
            middle_m: Vec3::Y
                * (scene.ground.field.height_m(0.0, 0.0) + mean(templates, |tree| tree.center_m[1])),
            reach_m,
            to_sun: scene.sky.light.sun_direction,
        };
        for (stage, away_m) in distances_m(templates) {
            let full = look.see(away_m, TreeLodMode::Off, FINER);
            let (cover, light) = beside(&look.see(away_m, TreeLodMode::default(), 1), &full);
            let told =
                format!("{}, {stage}, {away_m:.0} m: covers {cover:.3}, light {light:+.3?}", scene.name);
            genescape_bake::say!("{told}");
            let is_like = (cover - 1.0).abs() < MORE && light.iter().all(|channel| channel.abs() < BRIGHTER);
            all.push((is_like, told));
        }
    }
    assert!(all.iter().all(|(is_like, _)| *is_like), "{all:#?}");
}
