//! The device chooses trees and levels as a reference in Rust does: the same trees, each once, at the same λ. What holds for
//! the reference, for any distance and errors, then holds for the device.

use genescape_viewer::camera::{Camera, Frustum};
use genescape_viewer::gpu::Gpu;
use genescape_viewer::headless::Headless;
use genescape_viewer::image_file;
use genescape_viewer::lod::tree::{
    Control, MAX_LEVELS, SEEN_PX, allowance, distance_m, lod_number, pictured, simple_error_m,
};
use genescape_viewer::lod_mode::TreeLodMode;
use genescape_viewer::options::Options;
use genescape_viewer::passes::{BoundTrees, CullUniform};
use genescape_viewer::scene::{Image, Material, Template, Trees};
use genescape_viewer::upload::{DrawCommand, SceneBuffers};
use glam::Vec3;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use std::sync::Arc;
use strum::VariantArray;

use crate::made_up;

/// Differences of λ that rounding explains.
const ROUNDING: f32 = 2e-3;

/// A random forest, and what the reference needs of it.
struct Forest {
    trees: Trees,
    errors_m: Vec<Vec<f32>>,
    scales: Vec<f32>,
    /// Of the pictures, the same for all; `None` where there are none.
    picture_error_m: Option<f32>,
}

/// How the device draws a tree.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shown {
    /// By its mesh or by its picture.
    lambda: f32,
    /// Shares of its pixels that show its mesh, clusters of the next level, and its picture.
    mesh: f32,
    next: f32,
    picture: f32,
    /// The share of the bark that is drawn.
    bark: f32,
}

fn forest(rng: &mut Pcg32) -> Forest {
    let errors_m: Vec<Vec<f32>> = (0..rng.random_range(1..4))
        .map(|_| {
            let mut error_m = rng.random_range(0.002..0.05f32);
            let levels = rng.random_range(1..8);
            (0..levels)
                .map(|_| {
                    error_m *= rng.random_range(1.1..4.0f32);
                    error_m
                })
                .collect()
        })
        .collect();
    let picture_error_m = rng.random_bool(0.7).then(|| rng.random_range(0.02..0.4f32));
    let template = |(kind, errors_m): (usize, &Vec<f32>)| {
        let name = format!("kind {kind}");
        let impostor = picture_error_m.map(|error_m| made_up::impostor(&name, error_m));
        let mut template = Template { impostor, ..made_up::template(&name, errors_m) };
        // Every other kind has clusters from its second level on.
        if kind % 2 == 0 && errors_m.len() > 1 {
            let color = Some(Image::of_one_pixel([255; 4]));
            template.materials.push(Material {
                color,
                alpha_cutoff: Some(0.5),
                clusters: true,
                ..template.materials[0].clone()
            });
            template.clusters = Some(1);
        }
        Arc::new(template)
    };
    let templates = errors_m.iter().enumerate().map(template).collect();
    let (mut instances, mut scales) = (Vec::new(), Vec::new());
    for _ in 0..rng.random_range(1..300) {
        let mut place = |m: f32| rng.random_range(-m..m);
        let at = [place(200.0), place(20.0), place(200.0)];
        let (kind, scale) = (rng.random_range(0..errors_m.len()) as u32, rng.random_range(0.3..3.0f32));
        instances.push(made_up::instance(kind, at, scale, rng.random_range(0.0..6.0f32)));
        scales.push(scale);
    }
    let far = instances.split_off(rng.random_range(0..=instances.len()));
    Forest {
        trees: Trees { templates, instances: instances.into(), far: far.into() },
        errors_m,
        scales,
        picture_error_m,
    }
}

/// Anywhere, or inside a crown.
fn eye(rng: &mut Pcg32, trees: &Trees) -> Camera {
    let all: Vec<_> = trees.all().collect();
    let crown = all[rng.random_range(0..all.len())].world_from_tree;
    let inside = rng.random_range(0..4) == 0;
    let mut place = |m: f32| rng.random_range(-m..m);
    let near = Vec3::new(place(0.5), place(0.5) + 3.0, place(0.5)) + Vec3::from(crown.map(|row| row[3]));
    let far = Vec3::new(place(250.0), place(40.0), place(250.0));
    Camera {
        position_m: if inside { near } else { far },
        yaw_rad: place(3.1),
        pitch_rad: place(1.2),
        fov_y_rad: 0.9 + place(0.4),
    }
}

fn fetch(gpu: &Gpu, from: &wgpu::Buffer) -> Vec<u8> {
    image_file::read_buffer(gpu, from).expect("readable")
}

/// How the device draws each tree, `None` where it is not seen. Checks lists, counts and commands on the way.
fn chosen(
    studio: &Headless,
    buffers: &SceneBuffers,
    uniform: &CullUniform,
    forest: &Forest,
) -> Vec<Option<Shown>> {
    let gpu = &studio.gpu;
    let set = buffers.trees.as_ref().expect("trees");
    let lists = BoundTrees::new(gpu, &studio.passes.layouts, set);
    lists.set(&gpu.queue, uniform);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    studio.passes.cull.dispatch(&mut encoder.begin_compute_pass(&Default::default()), &lists);
    gpu.queue.submit([encoder.finish()]);
    let counts: Vec<u32> = bytemuck::pod_collect_to_vec(&fetch(gpu, &lists.counts));
    let visible: Vec<[u32; 3]> = bytemuck::pod_collect_to_vec(&fetch(gpu, &lists.visible));
    let commands: Vec<DrawCommand> = bytemuck::pod_collect_to_vec(&fetch(gpu, &lists.commands));
    let (buckets, kinds) = (lists.buckets as usize, set.template_count as usize);
    let meshes = buckets * set.mesh_draws as usize;
    let all: Vec<_> = forest.trees.all().collect();
    let mut shown: Vec<Option<Shown>> = vec![None; forest.scales.len()];
    for (index, (command, before)) in commands.iter().zip(&set.commands).enumerate() {
        if index < meshes {
            assert_eq!(*command, DrawCommand { instances: counts[index % buckets], ..*before });
        } else {
            assert_eq!(*command, DrawCommand { indices: 6 * counts[buckets + index - meshes], ..*before });
        }
    }
    for list in 0..buckets + 2 {
        let is_picture = list >= buckets;
        let (level, kind) = (list / kinds, list % kinds);
        let field = set.field_count as usize;
        let first = match list.checked_sub(buckets) {
            Some(lists) => lists * field,
            None => commands[list].first_instance as usize,
        };
        for &[tree, lambda, part] in &visible[first..first + counts[list] as usize] {
            let lambda = f32::from_bits(lambda);
            let [from, to, picture] = [0, 10, 20].map(|bit| (part >> bit & 1023) as f32 / 1023.0);
            assert!(is_picture || lambda as usize == level, "a tree is listed at its level");
            let is_kind = all[tree as usize].template as usize == kind;
            assert!(is_picture || is_kind, "and under its kind");
            let is_beyond = tree as usize >= field;
            assert!(
                !is_picture || is_beyond == (list > buckets),
                "pictures beyond the field are drawn apart"
            );
            let one = shown[tree as usize].get_or_insert(Shown {
                lambda,
                mesh: 0.0,
                next: 0.0,
                picture: 0.0,
                bark: 0.0,
            });
            let part = match (is_picture, to < 1.0) {
                (true, _) => &mut one.picture,
                (false, true) => &mut one.next,
                (false, false) => &mut one.mesh,
            };
            if !is_picture && to == 1.0 {
                one.bark = 1.0 - picture;
            }
            assert!(std::mem::replace(part, to - from) == 0.0 && to > from, "tree {tree} is drawn twice");
            if !is_picture && to < 1.0 {
                let clusters = forest.trees.templates[kind].clusters.expect("only clusters dissolve");
                assert!(
                    clusters as usize <= level && one.lambda as usize + 1 == level,
                    "into the next level"
                );
            }
        }
    }
    shown
}

/// The distance from the nearest plane at which a sphere would just be out of sight.
fn margin_m(frustum: &Frustum, center_m: Vec3, radius_m: f32) -> f32 {
    frustum
        .planes
        .iter()
        .map(|plane| (plane.dot(center_m.extend(1.0)) + radius_m).abs())
        .fold(f32::MAX, f32::min)
}

/// How many trees are out of sight, seen as meshes alone, as both, as pictures alone.
fn compare(studio: &Headless, seed: u64) -> [usize; 4] {
    let mut rng = Pcg32::seed_from_u64(seed);
    let forest = forest(&mut rng);
    let scene = made_up::scene(made_up::field(17, 2.0, 1.0, 0.1), [90; 4], [1.0; 3], forest.trees.clone());
    let buffers = genescape_viewer::upload::Uploader::new(&studio.gpu).upload(&scene).expect("uploaded");
    let set = buffers.trees.as_ref().expect("trees");
    // What throws a shadow is never a picture, which has no depth, however far away it stands.
    let shadow = CullUniform::for_shadow(set, 0.1, 0..set.count).coarser_from(Vec3::ZERO, 1.0);
    for (tree, shown) in chosen(studio, &buffers, &shadow, &forest).into_iter().enumerate() {
        let is_mesh = shown.is_some_and(|one| one.mesh == 1.0 && one.lambda.fract() == 0.0);
        assert!(is_mesh, "seed {seed}, tree {tree}");
    }
    let mut seen = [0; 4];
    for &mode in TreeLodMode::VARIANTS {
        let camera = eye(&mut rng, &forest.trees);
        let frustum = camera.frustum(1.6);
        let control = Control {
            mode,
            focal_px: rng.random_range(100.0..900.0f32),
            error_px: rng.random_range(0.3..8.0f32),
        };
        let options = Options { tree_lod: mode, tree_error_px: control.error_px, ..Options::default() };
        let uniform = CullUniform::for_view(set, &frustum, camera.position_m, control.focal_px, &options);
        let device = chosen(studio, &buffers, &uniform, &forest);
        let all: Vec<_> = forest.trees.all().collect();
        for (tree, shown) in device.into_iter().enumerate() {
            let (instance, scale) = (all[tree], forest.scales[tree]);
            let template = &forest.trees.templates[instance.template as usize];
            let middle = Vec3::from(template.center_m).extend(1.0);
            let center = Vec3::from(instance.world_from_tree.map(|row| glam::Vec4::from(row).dot(middle)));
            let radius_m = template.radius_m * scale;
            if margin_m(&frustum, center, radius_m) > 1e-2 {
                assert_eq!(
                    shown.is_some(),
                    frustum.sees_sphere(center, radius_m),
                    "seed {seed}, tree {tree}"
                );
            }
            let Some(Shown { lambda, mesh, next, picture, bark }) = shown else {
                seen[0] += 1;
                continue;
            };
            seen[if picture == 0.0 { 1 } else { 2 + usize::from(mesh == 0.0) }] += 1;
            let all = mesh + next + picture;
            assert!((all - 1.0).abs() < 5e-5, "seed {seed}, tree {tree}: {mesh}, {next} and {picture}");
            assert!(
                mesh == 0.0 || (bark + picture - 1.0).abs() < 2e-3,
                "tree {tree}: bark {bark}, {picture}"
            );
            // Beyond the field, trees have levels in any mode.
            let is_far = tree >= forest.trees.instances.len();
            let mode = if is_far && mode == TreeLodMode::Off { TreeLodMode::Quality } else { mode };
            let distance_to_center_m = center.distance(camera.position_m);
            let allowance = allowance(control.focal_px, distance_to_center_m, radius_m);
            let control = Control { mode, error_px: control.error_px * allowance, ..control };
            let errors_m = &forest.errors_m[instance.template as usize];
            let away_m = distance_m(distance_to_center_m, radius_m);
            let number = |control: &Control, away_m: f32| {
                lod_number(control, errors_m, simple_error_m(errors_m), away_m, scale)
            };
            let expected = number(&control, away_m);
            // Rounding may tip a tree over the edge of a level.
            let [lower, upper] = [0.999, 1.001].map(|factor| number(&control, factor * away_m));
            let close = (lambda - expected).abs() < ROUNDING || lambda == lower || lambda == upper;
            assert!(close, "seed {seed}, {mode:?}, tree {tree}: λ {lambda} instead of {expected}");
            let steepness = (camera.position_m - center).normalize_or_zero().y.abs();
            let share = |away_m: f32| {
                let error_m = forest.picture_error_m.unwrap_or(f32::MAX);
                pictured(&control, error_m, away_m, scale, steepness)
            };
            let close = [0.999, 1.0, 1.001].map(|factor| (picture - share(factor * away_m)).abs() < 5e-3);
            assert!(
                close.contains(&true),
                "seed {seed}, {mode:?}, tree {tree}: {picture}, not {}",
                share(away_m)
            );
        }
    }
    seen
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn the_device_chooses_as_the_reference_does() {
    let studio = made_up::studio();
    let mut seen = [0; 4];
    for seed in 0..60 {
        let more = compare(&studio, seed);
        seen = std::array::from_fn(|k| seen[k] + more[k]);
    }
    assert!(seen.iter().all(|&count| count > 150), "all of it happens: {seen:?}");
}

prop_compose! {
    fn errors()(first in 1e-4f32..0.1, ratios in prop::collection::vec(1.05f32..8.0, 0..MAX_LEVELS)) -> Vec<f32> {
        let mut errors = vec![first];
        for ratio in ratios {
            errors.push(errors[errors.len() - 1] * ratio);
        }
        errors
    }
}

fn control(mode: TreeLodMode, error_px: f32) -> Control {
    Control { mode, focal_px: 800.0, error_px }
}

fn mode() -> impl Strategy<Value = TreeLodMode> {
    prop::sample::select(vec![
        TreeLodMode::Quality,
        TreeLodMode::Simple,
        TreeLodMode::Discrete,
        TreeLodMode::Off,
    ])
}

proptest! {
    #[test]
    fn number_is_bounded_and_grows_with_distance(
        errors in errors(), mode in mode(), near in 0.0f32..2000., more in 0.0f32..500., scale in 0.2f32..4.
    ) {
        let control = control(mode, 1.0);
        let q = simple_error_m(&errors);
        let at = |distance| lod_number(&control, &errors, q, distance, scale);
        let k = errors.len() as f32 - 1.0;
        prop_assert!((0.0..=k).contains(&at(near)));
        prop_assert!(at(near + more) >= at(near) - 1e-4);
    }

    #[test]
    fn number_is_continuous_unless_discrete(
        errors in errors(), simple in any::<bool>(), distance in 0.1f32..2000., scale in 0.2f32..4.
    ) {
        let mode = if simple { TreeLodMode::Simple } else { TreeLodMode::Quality };
        let control = control(mode, 1.0);
        let q = simple_error_m(&errors);
        let at = |distance| lod_number(&control, &errors, q, distance, scale);
        // Steepest where neighbours differ least: log₂(1.0001) / log₂ 1.05.
        prop_assert!((at(distance * 1.0001) - at(distance)).abs() < 3e-3);
    }

    #[test]
    fn error_on_the_screen_is_kept_wherever_detail_is_left_out(
        errors in errors(), discrete in any::<bool>(), distance in 0.1f32..2000., scale in 0.2f32..4.,
        error_px in 0.1f32..8.
    ) {
        let mode = if discrete { TreeLodMode::Discrete } else { TreeLodMode::Quality };
        let control = control(mode, error_px);
        let lambda = lod_number(&control, &errors, 0.1, distance, scale);
        let (i, alpha) = (lambda as usize, lambda.fract());
        let next = errors.get(i + 1).copied().unwrap_or(1.0);
        let fine = errors[i];
        let shown = fine * libm::powf(next / fine, alpha) * scale * control.focal_px / distance;
        prop_assert!(lambda == 0.0 || shown <= error_px * 1.001, "{lambda}: {shown} px");
    }

    #[test]
    fn of_a_tree_that_is_larger_in_the_picture_no_more_error_is_allowed(
        focal_px in 100f32..2000., distance in 0f32..2000., more in 0f32..500., radius in 0.1f32..60.
    ) {
        let allowed = |distance: f32, radius| allowance(focal_px, distance, radius);
        let here = allowed(distance, radius);
        prop_assert!((SEEN_PX[0] / SEEN_PX[1]..=1.0).contains(&here));
        prop_assert!(allowed(distance + more, radius) >= here && allowed(distance, 1.1 * radius) <= here);
        // Nor may the farther one have less in metres, or its level would be finer.
        prop_assert!(allowed(distance + more, radius) * (distance + more) >= here * distance);
        prop_assert_eq!(allowed(1e6, radius), 1.0);
    }

    #[test]
    fn no_number_is_poison(
        errors in errors(), mode in mode(), pick in 0usize..6, other in 0usize..6, third in 0usize..6
    ) {
        let odd = [f32::NAN, f32::INFINITY, 0.0, -1.0, f32::NEG_INFINITY, 1.0];
        let control = Control { mode, focal_px: odd[third], error_px: 1.0 };
        let lambda = lod_number(&control, &errors, simple_error_m(&errors), odd[pick], odd[other]);
        prop_assert!(lambda >= 0.0 && lambda <= errors.len() as f32 - 1.0, "{lambda}");
    }
}

#[test]
fn inside_the_crown_every_leaf_is_drawn() {
    for mode in [TreeLodMode::Quality, TreeLodMode::Simple, TreeLodMode::Discrete] {
        let distance = distance_m(3.0, 5.0);
        assert_eq!(lod_number(&control(mode, 1.0), &[0.001, 0.01, 0.1], 0.005, distance, 1.0), 0.0);
    }
}

#[test]
fn simple_mode_asks_as_much_as_quality_if_errors_follow_counts() {
    let errors: Vec<f32> = (0..8).map(|i| 0.01 * libm::exp2f(0.5 * i as f32)).collect();
    let q = simple_error_m(&errors);
    for distance in [5.0, 20.0, 37.0, 60.0, 300.0] {
        let [a, b] = [TreeLodMode::Simple, TreeLodMode::Quality]
            .map(|mode| lod_number(&control(mode, 1.0), &errors, q, distance, 1.3));
        assert!((a - b).abs() < 1e-3, "{a} {b}");
    }
}

#[test]
fn a_tree_without_levels_is_drawn_as_it_is() {
    assert_eq!(lod_number(&control(TreeLodMode::Simple, 1.0), &[], simple_error_m(&[]), 1e9, 1.0), 0.0);
    assert_eq!(lod_number(&control(TreeLodMode::Quality, 1.0), &[0.1], 0.1, 1e9, 1.0), 0.0);
}
