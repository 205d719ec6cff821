//! The meshes that both algorithms draw, taken apart: closed, unfolded, near the land, and calm.

use std::collections::HashMap;

use genescape_bake::model;
use genescape_bake::stages::terrain_lod;
use glam::{Mat4, Vec2, Vec3};
use proptest::prelude::*;

use super::bintree::Sample;
use super::morph::{Detail, LEAST_UNIT_CELLS, sample_m};
use super::quadtree::{self, Block, Errors, block_cells, block_indices};
use super::roam::Roam;
use crate::camera::Camera;
use crate::scene::Heightfield;

/// Rough land of a given side: waves and noise from a seed, `relief_m` high.
fn land(side: u32, spacing_m: f32, relief_m: f32, seed: u32) -> Heightfield {
    let noise = |i: u32, j: u32| {
        let mixed = (i.wrapping_mul(0x9e37_79b9) ^ j.wrapping_mul(0x85eb_ca6b) ^ seed).wrapping_mul(0xc2b2_ae35);
        ((mixed ^ mixed >> 15).wrapping_mul(0x27d4_eb2f) >> 8) as f32 / (1 << 24) as f32
    };
    let height = |i: u32, j: u32| {
        let (x, z, turn) = (i as f32 / side as f32, j as f32 / side as f32, seed as f32);
        let waves = libm::sinf(7.0 * x + turn) * libm::cosf(5.0 * z - turn) + 0.4 * libm::sinf(23.0 * (x + z));
        relief_m * (0.5 * waves + 0.05 * noise(i, j))
    };
    let heights_m = (0..side * side).map(|n| height(n % side, n / side)).collect();
    let field = model::Heightfield { side, spacing_m, heights_m };
    let lod = terrain_lod::lod(&field);
    Heightfield {
        side,
        spacing_m,
        heights_m: field.heights_m,
        wedgies_m: lod.wedgies_m,
        displacements_m: lod.displacements_m,
        levels: lod.levels,
        block_ranges_m: lod.block_ranges_m,
    }
}

type Triangle = [Vec3; 3];

/// What the GPU draws of some blocks.
fn drawn(field: &Heightfield, detail: &Detail, blocks: &[Block]) -> Vec<Triangle> {
    let cells = block_cells(field);
    let indices = block_indices(cells);
    let mut triangles = Vec::new();
    for block in blocks {
        let vertex = |number: u32| {
            let step = 1 << block.level;
            let (column, row) = (number % (cells + 1), number / (cells + 1));
            detail.place_m(field, [block.i + column * step, block.j + row * step])
        };
        let vertices: Vec<Vec3> = (0..(cells + 1) * (cells + 1)).map(vertex).collect();
        let corners = indices.chunks_exact(3).map(|t| [0, 1, 2].map(|c| vertices[t[c] as usize]));
        triangles.extend(corners.filter(|[a, b, c]| a != b && b != c && c != a));
    }
    triangles
}

/// Twice the area seen from above; negative if clockwise.
fn doubled_area_m2([a, b, c]: &Triangle) -> f64 {
    let (u, v) = ((*b - *a).as_dvec3(), (*c - *a).as_dvec3());
    u.z * v.x - u.x * v.z
}

/// No hole, no T-junction, no fold; the square is covered exactly.
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
            let count = edges.entry((bits(triangle[a]), bits(triangle[b]))).or_default();
            *count += 1;
            prop_assert_eq!(*count, 1, "an edge is used twice in one direction");
        }
    }
    let border = 0.5 * field.extent_m();
    for (a, b) in edges.keys() {
        if !edges.contains_key(&(*b, *a)) {
            let [a, b] = [a, b].map(|v| v.map(f32::from_bits));
            let on_border = [0, 2].iter().any(|&axis| a[axis].abs() == border && a[axis] == b[axis]);
            prop_assert!(on_border, "an open edge from {a:?} to {b:?}");
        }
    }
    let whole = f64::from(field.extent_m()) * f64::from(field.extent_m());
    prop_assert!((area / whole - 1.0).abs() < 1e-5, "{area} of {whole}");
    Ok(())
}

/// λ with the least d₀ that is allowed, times `unit`.
fn detail_at(field: &Heightfield, eye_m: Vec3, unit: f32) -> Detail {
    let mut detail = quadtree::detail(field, &Errors::default(), eye_m, 500.0, 1.0, f32::MAX);
    detail.unit_m *= unit;
    detail
}

prop_compose! {
    /// An eye over or beside a field of extent 1, near or far.
    fn eye()(x in -1.5f32..1.5, y in -0.1f32..0.5, z in -1.5f32..1.5, far in 1f32..4.) -> Vec3 {
        Vec3::new(x, y, z) * far
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn morphed_blocks_close_without_folds(
        depth in 2u32..9, eye in eye(), unit in 1f32..1.5, relief in 0f32..30., seed in 0u32..99
    ) {
        let field = land((1 << depth) + 1, 0.5, relief, seed);
        let detail = detail_at(&field, eye * field.extent_m(), unit);
        let mut blocks = Vec::new();
        quadtree::select(&field, &detail, None, &mut blocks);
        check_closed(&field, &drawn(&field, &detail, &blocks))?;
    }

    #[test]
    fn level_of_detail_spans_two_levels_in_a_block(eye in eye(), unit in 1f32..3., x in 0u32..=16, z in 0u32..=16) {
        let field = Heightfield { side: 1025, spacing_m: 1.0, ..Heightfield::default() };
        let detail = detail_at(&field, eye * field.extent_m(), unit);
        let mut blocks = Vec::new();
        quadtree::select(&field, &detail, None, &mut blocks);
        let cells: u64 = blocks.iter().map(|block| (16u64 << block.level) * (16u64 << block.level)).sum();
        prop_assert_eq!(cells, 1024 * 1024);
        for block in blocks {
            let place = Vec2::new(
                field.place_m(block.i + (x << block.level)),
                field.place_m(block.j + (z << block.level)),
            );
            let lambda = detail.lambda(place);
            let level = block.level as f32;
            prop_assert!(lambda >= level - 1e-4 && lambda <= level + 2.0 + 1e-4, "{lambda} in {block:?}");
        }
    }
}
