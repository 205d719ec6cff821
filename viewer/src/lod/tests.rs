//! The meshes that all algorithms draw, taken apart: closed, unfolded, near the land, and calm.

use std::collections::HashMap;

use genescape_bake::stages::terrain_lod;
use genescape_schema::scene::bintree::{parents, requires};
use glam::{Vec2, Vec3};
use proptest::prelude::*;

use super::block::{BLOCK_BITS, Block};
use super::morph::{Detail, sample_m};
use super::nested::{self, Nested};
use super::quadtree;
use super::roam::triangulate;
use crate::camera::{Camera, Frustum};
use crate::scene::{Heightfield, TerrainLod};

/// Rough land of a given side: waves and noise from a seed, `relief_m` high.
fn land(side: u32, spacing_m: f32, relief_m: f32, seed: u32) -> TerrainLod {
    let height = |i: u32, j: u32| {
        let (x, z, turn) = (i as f32 / side as f32, j as f32 / side as f32, seed as f32);
        let waves =
            libm::sinf(7.0 * x + turn) * libm::cosf(5.0 * z - turn) + 0.4 * libm::sinf(23.0 * (x + z));
        relief_m * (0.5 * waves + 0.05 * hash(i, j, seed))
    };
    let heights_m = (0..side * side).map(|n| height(n % side, n / side)).collect();
    terrain_lod::lod(&Heightfield { side, spacing_m, heights_m })
}

/// In [0, 1), of two coordinates and a seed.
fn hash(i: u32, j: u32, seed: u32) -> f32 {
    let mixed = i.wrapping_mul(0x9e37_79b9) ^ j.wrapping_mul(0x85eb_ca6b) ^ seed.wrapping_mul(0x27d4_eb2f);
    let mixed = (mixed ^ mixed >> 15).wrapping_mul(0xc2b2_ae35);
    ((mixed ^ mixed >> 13).wrapping_mul(0x27d4_eb2f) >> 8) as f32 / (1 << 24) as f32
}

type Triangle = [Vec3; 3];

/// Twice the area seen from above; negative if clockwise.
fn doubled_area_m2([a, b, c]: &Triangle) -> f64 {
    let (u, v) = ((*b - *a).as_dvec3(), (*c - *a).as_dvec3());
    u.z * v.x - u.x * v.z
}

/// No hole, no T-junction, no fold; the square is covered exactly: no triangle is turned over, each edge is passed as often one
/// way as the other, and the areas add up. (More than once where triangles without area lie on it, whose third vertex is still
/// on its way along the edge.)
fn check_closed(field: &Heightfield, triangles: &[Triangle]) -> Result<(), TestCaseError> {
    let bits = |v: Vec3| v.to_array().map(|x| (x + 0.0).to_bits());
    let mut edges: HashMap<_, i32> = HashMap::new();
    let mut area = 0.0;
    let cell = f64::from(field.spacing_m * field.spacing_m);
    for triangle in triangles {
        let doubled = doubled_area_m2(triangle);
        prop_assert!(doubled > -1e-6 * cell, "folded by {doubled}: {triangle:?}");
        area += 0.5 * doubled;
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            *edges.entry((bits(triangle[a]), bits(triangle[b]))).or_default() += 1;
        }
    }
    let border = 0.5 * field.extent_m();
    for ((a, b), count) in &edges {
        if edges.get(&(*b, *a)) != Some(count) {
            let [a, b] = [a, b].map(|v| v.map(f32::from_bits));
            let on_border = [0, 2].iter().any(|&axis| a[axis].abs() == border && a[axis] == b[axis]);
            prop_assert!(on_border, "an open edge from {a:?} to {b:?}");
        }
    }
    let whole = f64::from(field.extent_m()) * f64::from(field.extent_m());
    prop_assert!((area / whole - 1.0).abs() < 1e-5, "{area} of {whole}");
    Ok(())
}

/// Cells a side of a block.
const CELLS: u32 = 1 << BLOCK_BITS;

/// What an eye is shown of a land by distance alone, for pictures of so many pixels a radian: the more, the farther fine levels
/// reach.
struct Sight {
    detail: Detail,
    blocks: Vec<Block>,
}

impl Sight {
    fn of(lod: &TerrainLod, eye_m: Vec3, pixels: f32) -> Self {
        let levels_m = Nested::of(&lod.field).levels_m;
        let detail = quadtree::detail(lod, &levels_m, pixels, eye_m, false, f32::MAX);
        let mut blocks = Vec::new();
        quadtree::select(lod, &detail, None, &mut blocks);
        Self { detail, blocks }
    }

    fn drawn(&self, field: &Heightfield) -> Vec<Triangle> {
        let mut triangles = quadtree::drawn(field, &self.detail, &self.blocks);
        triangles.retain(|[a, b, c]| a != b && b != c && c != a);
        triangles
    }
}

/// What an eye is shown by distance and roughness.
fn risen(
    field: &Heightfield,
    nested: &Nested,
    sight: &nested::Sight,
    frustum: Option<&Frustum>,
) -> Vec<Triangle> {
    let mut triangles = Vec::new();
    nested.select(field, sight, frustum, &mut triangles);
    nested.drawn(field, sight, &triangles)
}

prop_compose! {
    /// An eye over or beside a field of extent 1, as often as not on the ground.
    fn eye()(x in -0.8f32..0.8, y in -0.3f32..0.3, z in -0.8f32..0.8) -> Vec3 {
        Vec3::new(x, y, z)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn morphed_blocks_close_without_folds(
        depth in 2u32..9, eye in eye(), pixels in 1f32..400., relief in 0f32..30., seed in 0u32..99
    ) {
        let lod = land((1 << depth) + 1, 0.5, relief, seed);
        let field = &*lod.field;
        let sight = Sight::of(&lod, eye * field.extent_m(), pixels);
        check_closed(field, &sight.drawn(field))?;
    }

    #[test]
    fn level_of_detail_spans_two_levels_in_a_block(
        eye in eye(), pixels in 1f32..400., seed in 0u32..99, x in 0..=CELLS, z in 0..=CELLS
    ) {
        let lod = land(257, 1.0, 10.0, seed);
        let field = &*lod.field;
        let sight = Sight::of(&lod, eye * field.extent_m(), pixels);
        let cells: u64 = sight.blocks.iter().map(|block| u64::from(CELLS << block.level).pow(2)).sum();
        prop_assert_eq!(cells, 256 * 256);
        for (&[x, z], block) in [[0, 0], [CELLS, 0], [0, CELLS], [CELLS, CELLS], [x, z]].iter().flat_map(|v| sight.blocks.iter().map(move |b| (v, b))) {
            let place = |from: u32, by: u32| field.place_m(from + (by << block.level));
            let lambda = sight.detail.lambda(Vec2::new(place(block.i, x), place(block.j, z)));
            let level = block.level as f32;
            prop_assert!(lambda >= level - 1e-4 && lambda <= level + 2.0 + 1e-4, "{lambda} in {block:?}");
        }
    }

    /// What is drawn of a land that is seen whole, closed wherever corners are on their way.
    #[test]
    fn triangles_that_rise_close_without_folds(
        depth in 1u32..9, eye in eye(), pixels in 1f32..4000., relief in 0f32..30., seed in 0u32..99
    ) {
        let lod = land((1 << depth) + 1, 0.5, relief, seed);
        let field = &*lod.field;
        let sight = nested::Sight { eye_m: eye * field.extent_m(), pixels };
        check_closed(field, &risen(field, &Nested::of(field), &sight, None))?;
    }

    /// What is in sight is drawn as if all were.
    #[test]
    fn what_is_left_out_is_out_of_sight(mut camera in camera(), pixels in 1f32..4000., seed in 0u32..99) {
        let lod = land(65, 1.0, 12.0, seed);
        let (field, nested) = (&*lod.field, Nested::of(&lod.field));
        camera.position_m *= field.extent_m();
        let (sight, frustum) = (nested::Sight { eye_m: camera.position_m, pixels }, camera.frustum(1.5));
        let bits = |triangle: &Triangle| triangle.map(|p| p.to_array().map(f32::to_bits));
        let seen: HashMap<_, ()> =
            risen(field, &nested, &sight, Some(&frustum)).iter().map(|t| (bits(t), ())).collect();
        for triangle in risen(field, &nested, &sight, None) {
            let middle_m = triangle.iter().sum::<Vec3>() / 3.0;
            let is_seen = triangle.iter().chain([&middle_m]).any(|p| frustum.sees_sphere(*p, 0.0));
            prop_assert!(!is_seen || seen.contains_key(&bits(&triangle)), "{triangle:?} is missing");
        }
    }

    /// What a sample requires has risen before it begins.
    #[test]
    fn errors_and_radii_are_nested(depth in 2u32..8, relief in 0f32..30., seed in 0u32..99) {
        let lod = land((1 << depth) + 1, 0.7, relief, seed);
        let (field, nested) = (&*lod.field, Nested::of(&lod.field));
        let (side, last) = (field.side, field.side - 1);
        for sample in (0..side * side).map(|n| [n % side, n / side]).filter(|at| at.map(|line| line % last) != [0, 0]) {
            let bounds = |[i, j]: [u32; 2]| nested.bounds[(j * side + i) as usize];
            let (own, at_m) = (bounds(sample), sample_m(field, sample));
            for needed in requires(sample, last).into_iter().flatten().filter(|at| at.map(|line| line % last) != [0, 0]) {
                let apart_m = sample_m(field, needed).distance(at_m);
                prop_assert!(bounds(needed).error_m >= nested::RATIO * own.error_m, "{needed:?} of {sample:?}");
                prop_assert!(bounds(needed).radius_m >= own.radius_m + apart_m, "{needed:?} of {sample:?}");
            }
            let [a, b] = parents(sample).map(|end| sample_m(field, end));
            prop_assert!(own.error_m >= (at_m.y - 0.5 * (a.y + b.y)).abs() * 0.9999 - 1e-5, "{sample:?}");
        }
    }

    /// What keeps triangles from folding, and cracks from opening.
    #[test]
    fn samples_between_vertices_change_by_one_in_eleven_cells_at_most(
        eye in eye(), pixels in 1f32..400., relief in 0f32..30., seed in 0u32..99,
        x in -0.5f32..0.5, z in -0.5f32..0.5, turn in -4f32..4., cells in 0.5f32..60.
    ) {
        let lod = land(257, 1.0, relief, seed);
        let field = &*lod.field;
        let sight = Sight::of(&lod, eye * field.extent_m(), pixels);
        let here = Vec2::new(x, z) * field.extent_m();
        let limit = Vec2::splat(0.5 * field.extent_m());
        let there = (here + Vec2::from_angle(turn) * cells * field.spacing_m).clamp(-limit, limit);
        let [before, after] = [here, there].map(|at| libm::exp2f(sight.detail.lambda(at)));
        let allowed = here.distance(there) / (8.0 * std::f32::consts::SQRT_2 * field.spacing_m);
        prop_assert!((after - before).abs() <= allowed + 1e-3, "{before} to {after} from {here} to {there}");
    }

    #[test]
    fn a_look_along_the_land_meets_blocks_in_their_order(eye in eye(), pixels in 1f32..400., yaw in -4f32..4.) {
        let lod = land(257, 1.0, 10.0, 7);
        let field = &*lod.field;
        let sight = Sight::of(&lod, eye * field.extent_m(), pixels);
        let holds = |block: &Block, place_m: Vec2| {
            let side = CELLS << block.level;
            let [low, high] = [0, side].map(|by| Vec2::new(field.place_m(block.i + by), field.place_m(block.j + by)));
            place_m.cmpgt(low).all() && place_m.cmplt(high).all()
        };
        let places_m = (1..1500u32).map(|step| sight.detail.eye_m + Vec2::from_angle(yaw) * (step as f32 * 0.25));
        let met: Vec<usize> = places_m.filter_map(|at| sight.blocks.iter().position(|block| holds(block, at))).collect();
        prop_assert!(met.is_sorted(), "{met:?}");
    }
}

/// Height of a mesh at (x, z), by the triangle that holds it.
fn height_in(triangles: &[Triangle], at: Vec2) -> Option<f32> {
    triangles.iter().find_map(|t| {
        let [a, b, c] = t.map(|v| Vec2::new(v.x, v.z));
        let whole = (b - a).perp_dot(c - a);
        let weights = [(b - at).perp_dot(c - at), (c - at).perp_dot(a - at), (a - at).perp_dot(b - at)];
        let inside = whole != 0.0 && weights.iter().all(|w| w / whole >= -1e-5);
        inside.then(|| (weights[0] * t[0].y + weights[1] * t[1].y + weights[2] * t[2].y) / whole)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Over the walk vertices arrive and blocks change their levels; a pop would be as high as a displacement, metres here.
    #[test]
    fn land_moves_little_when_the_eye_does(eye in eye(), pixels in 1f32..20., seed in 0u32..99) {
        let lod = land(65, 1.0, 30.0, seed);
        let (field, nested) = (&*lod.field, Nested::of(&lod.field));
        let steps = (0..64u32).flat_map(|j| (0..64).map(move |i| [i, j]));
        let steepest = steps.fold(0f32, |most, [i, j]| {
            let here = field.at(i, j);
            most.max((field.at(i + 1, j) - here).abs()).max((field.at(i, j + 1) - here).abs())
        });
        let (start, step_m) = (eye * field.extent_m(), 0.05);
        let places: Vec<Vec2> = (0..20).map(|n| Vec2::new((n * 7 % 20) as f32, n as f32) * 3.1 - 30.0).collect();
        let heights = |mesh: &[Triangle]| -> Vec<f32> {
            places.iter().map(|&at| height_in(mesh, at).expect("the mesh covers the square")).collect()
        };
        // A sample rises by its own height over P·E·(1 − 1/k) metres at the least, E being no less.
        let fastest = 1.0 / (pixels * (1.0 - 1.0 / nested::RATIO));
        let mut before: Option<(Vec<Vec3>, Vec<f32>, Vec<f32>)> = None;
        for step in 0..12 {
            let eye_m = start + Vec3::new(0.6, 0.0, 0.8) * (step_m * step as f32);
            let sight = Sight::of(&lod, eye_m, pixels);
            let vertices: Vec<Vec3> =
                (0..65 * 65).map(|n| sight.detail.drawn_m(field, [n % 65, n / 65])).collect();
            let slid = heights(&sight.drawn(field));
            let rising = heights(&risen(field, &nested, &nested::Sight { eye_m, pixels }, None));
            if let Some((vertices_before, slid_before, rising_before)) = &before {
                for (now, then) in vertices.iter().zip(vertices_before) {
                    prop_assert!(now.distance(*then) < 0.5 * (1.0 + steepest) * step_m, "{then} to {now}");
                }
                for (now, then) in slid.iter().zip(slid_before) {
                    prop_assert!((now - then).abs() < steepest * step_m, "{then} to {now}, slope {steepest}");
                }
                for (now, then) in rising.iter().zip(rising_before) {
                    prop_assert!((now - then).abs() <= 1.01 * fastest * step_m + 1e-4, "{then} to {now}, {pixels}");
                }
            }
            before = Some((vertices, slid, rising));
        }
    }

    #[test]
    fn blocks_look_as_near_to_the_land_as_asked(
        eye in eye(), relief in 1f32..20., error_px in 0.5f32..8., seed in 0u32..99
    ) {
        let lod = land(129, 1.0, relief, seed);
        let field = &*lod.field;
        let eye_m = eye * field.extent_m();
        let sight = Sight::of(&lod, eye_m, 300.0 / error_px);
        let mesh = sight.drawn(field);
        for n in 0..1000u32 {
            let land_m = sample_m(field, [n * 37 % 129, n * 53 % 128]);
            let at = Vec2::new(land_m.x, land_m.z);
            let height = height_in(&mesh, at).expect("the mesh covers the square");
            let seen_px = (height - land_m.y).abs() * 300.0 / sight.detail.distance_squared_m2(at).sqrt();
            prop_assert!(seen_px <= error_px, "{seen_px} of {error_px} px at {land_m}");
        }
    }

    /// All samples, while corners are on their way as well.
    #[test]
    fn triangles_that_rise_look_as_near_to_the_land_as_asked(
        eye in eye(), relief in 1f32..20., error_px in 0.2f32..8., seed in 0u32..99
    ) {
        let lod = land(65, 1.0, relief, seed);
        let field = &*lod.field;
        let sight = nested::Sight { eye_m: eye * field.extent_m(), pixels: 300.0 / error_px };
        let mesh = risen(field, &Nested::of(field), &sight, None);
        for n in 0..65 * 65 {
            let land_m = sample_m(field, [n % 65, n / 65]);
            let height = height_in(&mesh, Vec2::new(land_m.x, land_m.z)).expect("the mesh covers the square");
            let seen_px = (height - land_m.y).abs() * 300.0 / land_m.distance(sight.eye_m);
            prop_assert!(seen_px <= 1.001 * error_px + 1e-3, "{seen_px} of {error_px} px at {land_m}");
        }
    }
}

/// Triangles of a strip without the degenerate ones, the odd ones turned.
fn strip_triangles(field: &Heightfield, strip: &[u32]) -> Vec<Triangle> {
    let place = |entry: u32| sample_m(field, [entry % field.side, entry / field.side]);
    let corners = strip.windows(3).enumerate();
    let turned = corners.map(|(n, t)| if n % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] });
    turned.filter(|[a, b, c]| a != b && b != c && c != a).map(|t| t.map(place)).collect()
}

prop_compose! {
    /// A camera on or above a field of extent 1.
    fn camera()(x in -0.6f32..0.6, y in -0.02f32..0.3, z in -0.6f32..0.6, yaw in -4f32..4., pitch in -1.5f32..0.7)
        -> Camera {
        Camera { position_m: Vec3::new(x, y, z), yaw_rad: yaw, pitch_rad: pitch, fov_y_rad: 1.0 }
    }
}

const PICTURE: (f32, f32) = (1.5, 400.0);

/// Pixels of a point, from the middle of the picture; `None` behind the near plane.
fn project_px(camera: &Camera, point_m: Vec3) -> Option<Vec2> {
    let clip = camera.clip_from_world(PICTURE.0) * point_m.extend(1.0);
    (clip.w > 0.1).then(|| Vec2::new(clip.x / clip.w * PICTURE.0, clip.y / clip.w) * (0.5 * PICTURE.1))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn strip_is_a_closed_mesh_near_the_land(
        depth in 1u32..7, mut camera in camera(), relief in 0f32..20., error_px in 0.3f32..20., seed in 0u32..99
    ) {
        let lod = land((1 << depth) + 1, 1.0, relief, seed);
        let field = &*lod.field;
        camera.position_m *= field.extent_m();
        let mut strip = Vec::new();
        let triangles = triangulate(&lod, &camera, PICTURE, error_px, true, None, &mut strip);
        let mesh = strip_triangles(field, &strip);
        check_closed(field, &mesh)?;
        prop_assert_eq!(triangles as usize, mesh.len());

        let frustum = camera.frustum(PICTURE.0);
        for entry in 0..field.side * field.side {
            let land_m = sample_m(field, [entry % field.side, entry / field.side]);
            let height = height_in(&mesh, Vec2::new(land_m.x, land_m.z)).expect("the mesh covers the square");
            let drawn_m = Vec3::new(land_m.x, height, land_m.z);
            if frustum.sees_sphere(land_m, 0.0) && let Some(seen) = project_px(&camera, land_m) {
                let off = project_px(&camera, drawn_m).map_or(f32::MAX, |drawn| drawn.distance(seen));
                prop_assert!(off <= error_px * 1.01 + 1e-2, "{off} of {error_px} px at {land_m}");
            }
        }
    }

    /// As many as are allowed, or a few less; and closed.
    #[test]
    fn a_budget_is_kept_and_used(
        depth in 1u32..7, mut camera in camera(), relief in 0f32..20., budget in 2u32..4000, seed in 0u32..99
    ) {
        let lod = land((1 << depth) + 1, 1.0, relief, seed);
        let field = &*lod.field;
        camera.position_m *= field.extent_m();
        let (mut strip, mut all) = (Vec::new(), Vec::new());
        let triangles = triangulate(&lod, &camera, PICTURE, 0.5, true, Some(budget), &mut strip);
        let unbounded = triangulate(&lod, &camera, PICTURE, 0.5, true, None, &mut all);
        check_closed(field, &strip_triangles(field, &strip))?;
        prop_assert!(triangles <= budget, "{triangles} of {budget}");
        match unbounded <= budget {
            // What is split in another order is split all the same.
            true => prop_assert_eq!(strip, all),
            // A split may ask for two on each level.
            false => prop_assert!(triangles + 8 * depth > budget, "{triangles} of {budget}"),
        }
    }

    /// The more triangles, the less the greatest error.
    #[test]
    fn a_budget_goes_to_the_worst_places(mut camera in camera(), seed in 0u32..99) {
        let lod = land(65, 1.0, 12.0, seed);
        let field = &*lod.field;
        camera.position_m *= field.extent_m();
        let mut strip = Vec::new();
        let mut greatest_px = |budget: u32| {
            triangulate(&lod, &camera, PICTURE, 0.1, true, Some(budget), &mut strip);
            let mesh = strip_triangles(field, &strip);
            let frustum = camera.frustum(PICTURE.0);
            let seen = (0..65 * 65).map(|n| sample_m(field, [n % 65, n / 65]));
            let off = seen.filter(|land_m| frustum.sees_sphere(*land_m, 0.0)).filter_map(|land_m| {
                let height = height_in(&mesh, Vec2::new(land_m.x, land_m.z))?;
                let [seen, drawn] = [land_m, land_m.with_y(height)].map(|p| project_px(&camera, p));
                Some(seen?.distance(drawn?))
            });
            off.fold(0.0f32, f32::max)
        };
        let [few, many] = [40, 4000].map(&mut greatest_px);
        prop_assert!(many <= few + 1e-3, "{few} px, then {many} px");
    }

    #[test]
    fn without_an_allowed_error_all_that_is_seen_is_drawn(mut camera in camera(), seed in 0u32..99) {
        let lod = land(33, 1.0, 20.0, seed);
        let field = &*lod.field;
        camera.position_m *= field.extent_m();
        let mut strip = Vec::new();
        triangulate(&lod, &camera, PICTURE, 0.0, true, None, &mut strip);
        let frustum = camera.frustum(PICTURE.0);
        for entry in 0..field.side * field.side {
            let sample = [entry % field.side, entry / field.side];
            let corner = sample.map(|line| line % (field.side - 1)) == [0, 0];
            let height_m = |[i, j]: [u32; 2]| field.at(i, j);
            let middle_m = || parents(sample).map(height_m).iter().sum::<f32>() / 2.0;
            let flat = corner || middle_m() == height_m(sample);
            let seen = frustum.sees_sphere(sample_m(field, sample), 0.0);
            prop_assert!(flat || !seen || strip.contains(&entry), "sample {entry}");
        }
    }
}

#[test]
fn more_error_and_less_sight_mean_fewer_triangles() {
    let lod = land(129, 2.0, 40.0, 3);
    let field = &*lod.field;
    let camera =
        Camera { position_m: Vec3::new(0.0, 30.0, 100.0), yaw_rad: 0.0, pitch_rad: -0.2, fov_y_rad: 1.0 };
    let (mut strip, mut blocks) = (Vec::new(), Vec::new());
    let counts: Vec<u32> = [0.0, 1.0, 4.0, 64.0, 1e9]
        .map(|error_px| triangulate(&lod, &camera, PICTURE, error_px, true, None, &mut strip))
        .to_vec();
    assert!(counts.is_sorted_by(|a, b| a > b), "{counts:?}");
    let levels_m = Nested::of(field).levels_m;
    let detail = |exact| quadtree::detail(&lod, &levels_m, 100.0, camera.position_m, exact, f32::MAX);
    let mut count = |frustum: Option<&Frustum>| {
        quadtree::select(&lod, &detail(false), frustum, &mut blocks);
        blocks.len()
    };
    let (all, seen) = (count(None), count(Some(&camera.frustum(1.5))));
    assert!(seen < all && seen > 0, "{seen} of {all}");
    quadtree::select(&lod, &detail(true), None, &mut blocks);
    assert_eq!(quadtree::triangles(field, &blocks), 128 * 128 * 2);
}

#[test]
fn rising_triangles_keep_to_a_budget() {
    let lod = land(129, 2.0, 40.0, 3);
    let (field, nested) = (&*lod.field, Nested::of(&lod.field));
    let sight = nested::Sight { eye_m: Vec3::new(0.0, 30.0, 100.0), pixels: 1000.0 };
    let mut triangles = Vec::new();
    nested.select(field, &sight, None, &mut triangles);
    let all = triangles.len() as u32;
    for budget in [all, all / 3, 1000] {
        let within = nested.select_within(field, sight, None, budget, &mut triangles);
        let (found, mut anew) = (triangles.len() as u32, Vec::new());
        nested.select(field, &within, None, &mut anew);
        assert_eq!(triangles, anew, "what is drawn is what the sight asks for");
        assert!(found <= budget && found > budget * 9 / 10, "{found} of {budget}");
        assert_eq!(within.pixels == sight.pixels, budget == all);
    }
}

/// What nobody should notice costs little: fewer triangles where land is flat, and than all of ROAM's for the same bound.
#[test]
fn rough_places_get_the_triangles() {
    let flat = terrain_lod::lod(&Heightfield { side: 129, spacing_m: 1.0, heights_m: vec![3.0; 129 * 129] });
    let rough = land(129, 2.0, 40.0, 3);
    let camera =
        Camera { position_m: Vec3::new(0.0, 30.0, 100.0), yaw_rad: 0.0, pitch_rad: -0.2, fov_y_rad: 1.0 };
    let count = |lod: &TerrainLod, error_px: f32| {
        let sight = nested::Sight { eye_m: camera.position_m, pixels: camera.focal_px(PICTURE.1) / error_px };
        risen(&lod.field, &Nested::of(&lod.field), &sight, Some(&camera.frustum(PICTURE.0))).len()
    };
    assert_eq!(count(&flat, 0.1), 2);
    let mut strip = Vec::new();
    for error_px in [0.5, 2.0, 8.0] {
        let roam = triangulate(&rough, &camera, PICTURE, error_px, true, None, &mut strip) as usize;
        let ours = count(&rough, error_px);
        assert!(ours < roam, "{ours} and {roam} at {error_px} px");
    }
}
