//! What must hold of wedgies, displacements, ranges, payload and mesh, on noise land small enough to check whole.

use std::collections::BTreeMap;

use proptest::prelude::*;

use genescape_schema::scene::{HeightfieldError, bintree};

use super::data::displacements_m;
use super::verify::max_error_m;
use super::*;
use crate::model::{FarGround, Heightfield, Landform, Mesh, TerrainLod};
use crate::noise::fbm2;

fn field(side: u32, spacing_m: f32, seed: u32, relief_m: f32) -> Heightfield {
    let heights_m = (0..side * side)
        .map(|k| {
            let (x, z) = ((k % side) as f32 * spacing_m, (k / side) as f32 * spacing_m);
            relief_m * fbm2(seed, x / 300.0, z / 300.0, 6, 0.5, 0)
        })
        .collect();
    Heightfield { side, spacing_m, heights_m }
}

/// Noise land whose apron (of four times the width) agrees with the field along its border.
fn land(side: u32, seed: u32, relief_m: f32, water_level_m: Option<f32>) -> Landform {
    let field = field(side, 1024.0 / (side - 1) as f32, seed, relief_m);
    let mut apron = self::field(65, 64.0, seed + 1, relief_m);
    for j in 24..=40 {
        for i in 24..=40 {
            apron.heights_m[j * 65 + i] = field.height_m((i as f32 - 32.0) * 64.0, (j as f32 - 32.0) * 64.0);
        }
    }
    Landform { water_level_m, ..Landform::bare(field, apron) }
}

/// Directed edges with how often they occur.
fn edges(mesh: &Mesh) -> BTreeMap<[u32; 2], u32> {
    let mut edges = BTreeMap::new();
    for &[a, b, c] in &mesh.parts[0].triangles {
        for edge in [[a, b], [b, c], [c, a]] {
            *edges.entry(edge).or_insert(0) += 1;
        }
    }
    edges
}

/// Edges without a partner in the other direction.
fn border(mesh: &Mesh) -> Vec<[u32; 2]> {
    let edges = edges(mesh);
    assert!(edges.values().all(|&count| count == 1), "an edge is used twice in one direction");
    edges.keys().filter(|[a, b]| !edges.contains_key(&[*b, *a])).copied().collect()
}

fn assert_faces_up(mesh: &Mesh) {
    for triangle in &mesh.parts[0].triangles {
        let [a, b, c] = triangle.map(|vertex| glam::Vec3::from_array(mesh.positions[vertex as usize]));
        assert!((b - a).cross(c - a).y > 0.0, "{a} {b} {c}");
    }
    assert!(
        mesh.normals.iter().all(|n| n[1] > 0.0 && (glam::Vec3::from_array(*n).length() - 1.0).abs() < 1e-4)
    );
}

/// Lowest and highest point of the samples under a triangle of the bintree, against its own plane.
fn deviation(field: &Heightfield, t: &bintree::Triangle) -> f32 {
    let p = |s: bintree::Sample| glam::Vec3::new(s[0] as f32, field.at(s[0], s[1]), s[1] as f32);
    let (a, b, c) = (p(t.a), p(t.b), p(t.apex));
    let n = (b - a).cross(c - a);
    let mut worst = 0.0_f32;
    for j in 0..field.side {
        for i in 0..field.side {
            let q = p([i, j]);
            let inside =
                |u: glam::Vec3, v: glam::Vec3| (v.z - u.z) * (q.x - u.x) - (v.x - u.x) * (q.z - u.z) >= 0.0;
            if inside(a, b) && inside(b, c) && inside(c, a) {
                worst = worst.max(((q - a).dot(n) / n.y).abs());
            }
        }
    }
    worst
}

/// Checks a triangle and all below it: the wedgie holds all samples, and the children's wedgies lie within it.
fn check_wedgies(field: &Heightfield, wedgies: &[f32], t: bintree::Triangle) -> Option<f32> {
    let m = t.middle()?;
    let own = wedgies[(m[1] * field.side + m[0]) as usize];
    assert!(deviation(field, &t) <= own * (1.0 + 1e-5) + 1e-4);
    let [a, b] = [t.a, t.b].map(|s| field.at(s[0], s[1]));
    let off = (0.5 * (a + b) - field.at(m[0], m[1])).abs();
    for child in t.children(m) {
        let below = check_wedgies(field, wedgies, child).unwrap_or(0.0);
        assert!(own >= below, "monotone");
        assert!(own + 1e-4 >= off + below, "nested");
    }
    Some(own)
}

#[test]
fn wedgies_are_nested_and_hold_the_land() {
    let field = field(33, 2.0, 7, 60.0);
    let wedgies = lod(&field).wedgies_m;
    bintree::Triangle::roots(33).into_iter().for_each(|root| {
        check_wedgies(&field, &wedgies, root);
    });
    assert!(wedgies.iter().all(|&w| w <= wedgies[0]));
}

/// Height at a point of the uniform triangulation of level l with alternating diagonals.
fn uniform_height(field: &Heightfield, level: u32, i: u32, j: u32) -> f32 {
    let s = 1 << level;
    let (bi, bj) = ((i / s).min((field.side - 1) / s - 1), (j / s).min((field.side - 1) / s - 1));
    let (u, v) = ((i - bi * s) as f32 / s as f32, (j - bj * s) as f32 / s as f32);
    let at = |x: u32, z: u32| field.at((bi + x) * s, (bj + z) * s);
    let (nw, ne, sw, se) = (at(0, 0), at(1, 0), at(0, 1), at(1, 1));
    if (bi + bj) % 2 == 0 {
        if u > v { nw + (ne - nw) * u + (se - ne) * v } else { nw + (sw - nw) * v + (se - sw) * u }
    } else if u + v < 1.0 {
        nw + (ne - nw) * u + (sw - nw) * v
    } else {
        se + (sw - se) * (1.0 - u) + (ne - se) * (1.0 - v)
    }
}

#[test]
fn displaced_samples_lie_on_the_next_coarser_triangulation() {
    let field = field(65, 2.0, 3, 60.0);
    let displacements_m = displacements_m(&field);
    for j in 0..65 {
        for i in 0..65 {
            let level = bintree::level([i, j]);
            let target = if level < 6 { uniform_height(&field, level + 1, i, j) } else { field.at(i, j) };
            let displaced = field.at(i, j) + displacements_m[(j * 65 + i) as usize];
            assert!((displaced - target).abs() < 1e-4, "{i} {j}");
        }
    }
}

#[test]
fn block_ranges_hold_samples_and_morphs_at_every_level() {
    let field = field(65, 2.0, 5, 60.0);
    let (lod, displacements_m) = (lod(&field), displacements_m(&field));
    let mut first = 0;
    for level in 0..6 {
        let (across, cells) = (1_u32 << level, 64_u32 >> level);
        for block in 0..across * across {
            let [low, high] = lod.block_ranges_m[(first + block) as usize];
            let (i0, j0) = (block % across * cells, block / across * cells);
            let (mut least, mut greatest) = (f32::MAX, f32::MIN);
            for j in j0..=j0 + cells {
                for i in i0..=i0 + cells {
                    let k = (j * 65 + i) as usize;
                    let moved = field.heights_m[k] + displacements_m[k];
                    least = least.min(field.heights_m[k]).min(moved);
                    greatest = greatest.max(field.heights_m[k]).max(moved);
                }
            }
            assert!(
                low <= least + 1e-4 && high >= greatest - 1e-4,
                "does not hold block {block} of level {level}"
            );
            assert!(
                low >= least - 1e-4 && high <= greatest + 1e-4,
                "not tight at block {block} of level {level}"
            );
        }
        first += across * across;
    }
    assert_eq!(first as usize, lod.block_ranges_m.len());
}

#[test]
fn the_payload_comes_back_exactly_and_damage_is_told() {
    let field = field(33, 1.5, 11, 80.0);
    let lod = lod(&field);
    let bytes = lod.to_bytes();
    assert_eq!(bytes.len() % 4, 0);
    assert_eq!(TerrainLod::from_bytes(&bytes), Ok(lod));
    assert_eq!(TerrainLod::from_bytes(b"RIFF"), Err(HeightfieldError::Magic));
    for length in 0..bytes.len() {
        assert!(TerrainLod::from_bytes(&bytes[..length]).is_err(), "{length} bytes");
    }
    for at in 4..56 {
        for value in [0, 1, 127, 255] {
            let mut damaged = bytes.clone();
            damaged[at] = value;
            let _ = TerrainLod::from_bytes(&damaged);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn the_near_mesh_keeps_its_bound_and_has_no_crack(
        seed in 0_u32..1000, k in 1_u32..7, relief_m in 0.0_f32..400.0, bound_m in 0.0_f32..10.0,
    ) {
        let land = land((1 << k) + 1, seed, relief_m, None);
        let built = mesh(&land, bound_m, f32::MAX, &[]);
        prop_assert!(built.error_m <= bound_m, "{} > {bound_m}", built.error_m);
        prop_assert_eq!(built.error_m, max_error_m(&land.field, &built.near));
        assert_faces_up(&built.near);
        // One border loop along the square, so neither a hole nor a T-junction.
        let open = border(&built.near);
        let next: BTreeMap<u32, u32> = open.iter().map(|&[a, b]| (a, b)).collect();
        prop_assert_eq!(next.len(), open.len());
        let mut at = open[0][0];
        for _ in 0..open.len() {
            let p = built.near.positions[at as usize];
            prop_assert!(p[0].abs() == 512.0 || p[2].abs() == 512.0);
            at = next[&at];
        }
        prop_assert_eq!(at, open[0][0]);
        // The whole square, once.
        let plan: f64 = built.near.parts[0].triangles.iter().map(|t| {
            let [a, b, c] = t.map(|v| glam::Vec3::from_array(built.near.positions[v as usize]));
            f64::from(0.5 * (b - a).cross(c - a).y)
        }).sum();
        prop_assert!((plan - 1024.0 * 1024.0).abs() < 1.0);
    }
}

#[test]
fn the_verifier_sees_what_is_wrong() {
    let land = land(33, 1, 50.0, None);
    let built = mesh(&land, 1.0, f32::MAX, &[]).near;
    let mut lifted = built.clone();
    lifted.positions[7][1] += 20.0;
    assert!(max_error_m(&land.field, &lifted) > 19.0);
    let mut holed = built.clone();
    holed.parts[0].triangles.truncate(built.triangle_count() - 8);
    assert_eq!(max_error_m(&land.field, &holed), f32::INFINITY);
    let mut turned = built;
    turned.parts[0].triangles[3].swap(0, 1);
    assert_eq!(max_error_m(&land.field, &turned), f32::INFINITY);
}

#[test]
fn the_apron_joins_the_near_mesh_edge_by_edge() {
    for (side, bound_m) in [(129, 0.3), (129, 50.0), (5, 0.0)] {
        let land = land(side, 4, 120.0, None);
        let ground = |k: u32| FarGround {
            color: [(k % 65) as u8, (k / 65) as u8, 9, 255],
            weights: [(k / 65) as u8, 0, 190, (k % 65) as u8],
        };
        let all: Vec<FarGround> = (0..65 * 65).map(ground).collect();
        let built = mesh(&land, bound_m, f32::MAX, &all);
        assert_faces_up(&built.apron);
        let place = |mesh: &Mesh, edge: [u32; 2]| edge.map(|v| mesh.positions[v as usize].map(f32::to_bits));
        let mut near: Vec<_> =
            border(&built.near).into_iter().map(|[a, b]| place(&built.near, [b, a])).collect();
        let mut open: Vec<_> =
            border(&built.apron).into_iter().map(|edge| place(&built.apron, edge)).collect();
        let outer =
            |end: [u32; 3]| f32::from_bits(end[0]).abs() == 2048.0 || f32::from_bits(end[2]).abs() == 2048.0;
        open.retain(|edge| !(outer(edge[0]) && outer(edge[1])));
        near.sort_unstable();
        open.sort_unstable();
        assert_eq!(near, open);
        for (position, color) in built.apron.positions.iter().zip(&built.apron.colors) {
            let grid = position[0] / 64.0 + 32.0;
            assert!((f32::from(color[0]) - grid).abs() <= 0.51 && color[2] == 9);
        }
        assert_eq!(built.apron_weights.len(), built.apron.positions.len());
        for (position, weights) in built.apron.positions.iter().zip(&built.apron_weights) {
            let [x, z] = [0, 2].map(|axis: usize| position[axis] / 64.0 + 32.0);
            let [rock, scree, snow, earth] = weights.map(f32::from);
            assert!((0.0..1.01).contains(&(z - rock)) && (0.0..1.01).contains(&(x - earth)), "{weights:?}");
            assert_eq!([scree, snow], [0.0, 190.0]);
        }
        assert!(built.near.colors.is_empty());
    }
}

/// Hills that are twice as wide as the apron's cells, around level land of 1024 m.
fn round_hills(water_level_m: Option<f32>) -> Landform {
    let mut land = land(17, 4, 0.0, water_level_m);
    for j in 0..65 {
        for i in 0..65 {
            let [x, z] = [i, j].map(|line: u32| land.apron.place_m(line));
            let away_m = (x.abs().max(z.abs()) - 512.0).max(0.0);
            land.apron.heights_m[(j * 65 + i) as usize] = hill_m(x, z) * (away_m / 128.0).min(1.0);
        }
    }
    land
}

fn hill_m(x_m: f32, z_m: f32) -> f32 {
    40.0 * libm::sinf(x_m / 61.0) * libm::cosf(z_m / 67.0)
}

#[test]
fn hills_beside_the_field_are_round() {
    let land = round_hills(None);
    let ring = mesh(&land, 1.0, f32::MAX, &[]).apron;
    let (mut worst_m, mut coarse_m, mut counted) = (0.0f32, 0.0f32, 0);
    for [a, b, c] in &ring.parts[0].triangles {
        let [a, b, c] = [a, b, c].map(|&vertex| glam::Vec3::from_array(ring.positions[vertex as usize]));
        let middle = (a + b + c) / 3.0;
        let away_m = middle.x.abs().max(middle.z.abs()) - 512.0;
        if (128.0..400.0).contains(&away_m) {
            let hill_m = hill_m(middle.x, middle.z);
            worst_m = worst_m.max((middle.y - hill_m).abs());
            coarse_m = coarse_m.max((land.apron.height_m(middle.x, middle.z) - hill_m).abs());
            counted += 1;
        }
    }
    assert!(
        counted > 1000 && worst_m < 0.4 * coarse_m,
        "{counted}: {worst_m} m, {coarse_m} m without curves"
    );
}

#[test]
fn level_land_stays_coarse_and_no_curve_dips_below_the_water() {
    let level = mesh(&land(17, 4, 0.0, None), 1.0, f32::MAX, &[]).apron.triangle_count();
    // Two triangles a cell outside the hole of 18 cells a side, and a strip.
    assert!((2 * (64 * 64 - 18 * 18)..7700).contains(&level), "{level}");
    let land = round_hills(Some(4.0));
    let ring = mesh(&land, 1.0, f32::MAX, &[]).apron;
    assert!(ring.triangle_count() > level + 1000);
    let is_dry = |x: f32, z: f32| {
        let around =
            |along: f32| [0, 1].map(|k| ((along + 2048.0) / 64.0) as u32 + k).map(|line| line.min(64));
        around(x).into_iter().all(|i| around(z).into_iter().all(|j| land.apron.at(i, j) > 4.0))
    };
    let dry: Vec<f32> = ring.positions.iter().filter(|p| is_dry(p[0], p[2])).map(|p| p[1]).collect();
    assert!(dry.len() > 1000 && dry.iter().all(|&height_m| height_m > 4.0));
}

#[test]
fn water_lies_at_its_level_or_nowhere() {
    let wet = mesh(&land(17, 4, 120.0, Some(3.5)), 1.0, f32::MAX, &[]).water;
    assert_faces_up(&wet);
    assert!(wet.positions.iter().all(|p| p[1] == 3.5 && p[0].abs() == 2048.0));
    assert_eq!(mesh(&land(17, 4, 120.0, None), 1.0, f32::MAX, &[]).water.triangle_count(), 0);
}

/// Triangles of a mesh by Martini's rule (split where the deviation of the middle, or the greatest below, exceeds
/// `claim_m`), and its true error.
fn martini(field: &Heightfield, claim_m: f32) -> (usize, f32) {
    fn walk(field: &Heightfield, errors: &[f32], claim_m: f32, t: bintree::Triangle) -> (usize, f32) {
        match t.middle() {
            Some(m) if errors[(m[1] * field.side + m[0]) as usize] > claim_m => {
                let [a, b] = t.children(m).map(|child| walk(field, errors, claim_m, child));
                (a.0 + b.0, a.1.max(b.1))
            }
            Some(_) => (1, deviation(field, &t)),
            None => (1, 0.0),
        }
    }
    let errors = data::nested(field.side, &displacements_m(field), f32::max);
    let [a, b] = bintree::Triangle::roots(field.side).map(|root| walk(field, &errors, claim_m, root));
    (a.0 + b.0, a.1.max(b.1))
}

#[test]
fn fewer_triangles_than_martini_at_the_same_verified_bound() {
    let mut land = land(65, 9, 200.0, None);
    land.apron.side = 2;
    land.apron.heights_m.truncate(4);
    let bound_m = 8.0;
    let built = mesh(&land, bound_m, f32::MAX, &[]);
    let claims = (1..=16).rev().map(|part| martini(&land.field, bound_m * part as f32 / 16.0));
    let (martini, _) = claims.into_iter().find(|&(_, error_m)| error_m <= bound_m).unwrap();
    assert!(built.error_m <= bound_m && built.near.triangle_count() * 10 < martini * 9, "{martini}");
}
