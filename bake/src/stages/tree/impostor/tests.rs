//! What pictures show, of trees and of meshes made by hand.

use glam::Vec3;

use super::{SIDE, impostor};
use crate::math::linear_from_srgb;
use crate::model::{AlphaMask, Impostor, Material, Mesh, Part, PartKind};
use crate::stages::tree::tests::{plain, presets, read};
use crate::stages::tree::{ALPHA_CUTOFF, template, textures};

const BARK: [f32; 3] = [0.5; 3];

/// Adds an upright square about a place that faces along +z or −z.
fn square(mesh: &mut Mesh, middle: Vec3, side_m: f32, material: Material, color: [u8; 3]) {
    let first = mesh.positions.len() as u32;
    for [x, y] in [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5f32]] {
        mesh.positions.push((middle + side_m * Vec3::new(x, y, 0.0)).to_array());
        mesh.uvs.push([0.5; 2]);
        mesh.colors.push([color[0], color[1], color[2], 255]);
    }
    let triangles = vec![[first, first + 1, first + 2], [first, first + 2, first + 3]];
    mesh.parts.push(Part { material, kind: PartKind::Surface, triangles });
}

/// Pixels a side of a picture.
fn side(impostor: &Impostor) -> usize {
    impostor.colors.height as usize
}

/// Pixel (x, y) of picture `k`, if it is kept: linear colour, and relief.
fn pixel(impostor: &Impostor, k: usize, x: usize, y: usize) -> Option<([f32; 3], [f32; 2])> {
    let x = (k * side(impostor) + x) as u32;
    let [color, relief] = [&impostor.colors, &impostor.relief].map(|image| image.pixel(x, y as u32));
    let linear = [0, 1, 2].map(|c| linear_from_srgb(f32::from(color[c]) / 255.0));
    (color[3] >= 128).then(|| (linear, [relief[0], relief[1]].map(|byte| f32::from(byte) / 255.0)))
}

/// Pixel of picture `k` at a place in space.
fn at(impostor: &Impostor, k: usize, place: Vec3) -> Option<([f32; 3], [f32; 2])> {
    let (sin, cos) = libm::sincosf(std::f32::consts::FRAC_PI_4 * k as f32);
    let across = (place.x - impostor.axis_m[0]) * cos - (place.z - impostor.axis_m[1]) * sin;
    let x = (0.5 + across / impostor.size_m[0]) * SIDE as f32;
    let y = (1.0 - (place.y - impostor.low_m) / impostor.size_m[1]) * SIDE as f32;
    pixel(impostor, k, x as usize, y as usize)
}

#[test]
fn things_are_where_one_sees_them_from_each_side() {
    // A red leaf to the right of a blue trunk, a green leaf before it, a square of bark behind.
    let mut mesh = Mesh::default();
    let (red, green) = (Vec3::new(3.0, 4.0, 0.0), Vec3::new(0.0, 2.0, 3.0));
    let (behind, trunk) = (Vec3::new(-1.0, 4.0, -3.0), Vec3::new(-3.0, 1.0, 0.0));
    square(&mut mesh, red, 1.0, Material::Leaf, [255, 0, 0]);
    square(&mut mesh, green, 1.0, Material::Blossom, [0, 255, 0]);
    square(&mut mesh, behind, 1.0, Material::Bark, [255, 255, 255]);
    square(&mut mesh, trunk, 1.0, Material::Bark, [0, 0, 255]);
    // Right behind the green one, so that it never shows from the front.
    square(&mut mesh, green - Vec3::Z * 0.5, 0.9, Material::Bark, [255, 0, 255]);
    let impostor = impostor(&mesh, &plain(BARK));
    assert_eq!((impostor.colors.width, impostor.colors.height), (4 * SIDE as u32, SIDE as u32));
    for k in [0, 1, 3] {
        let (sin, cos) = libm::sincosf(std::f32::consts::FRAC_PI_4 * k as f32);
        let eye = Vec3::new(sin, 0.0, cos);
        let things = [
            (red, [1.0, 0.0, 0.0], 1.0),
            (green, [0.0, 1.0, 0.0], 1.0),
            (behind, [0.5; 3], 0.0),
            (trunk, [0.0, 0.0, 0.5], 0.0),
        ];
        for (place, color, leaf) in things {
            if k == 3 && place == green {
                continue; // seen from behind, where something else is before it
            }
            let (seen, relief) =
                at(&impostor, k, place).unwrap_or_else(|| panic!("{place} is missing from {k}"));
            assert!((0..3).all(|c| (seen[c] - color[c]).abs() < 0.01), "{k}: {place} is {seen:?}");
            let axis = Vec3::new(impostor.axis_m[0], 0.0, impostor.axis_m[1]);
            let before = 0.5 + (place - axis).dot(eye) / impostor.size_m[0];
            assert!((relief[0] - before).abs() < 0.02, "{k}: {place} is at {relief:?}, not {before}");
            assert_eq!(relief[1], leaf, "{k}: {place}");
        }
    }
    let (behind_green, _) = at(&impostor, 3, green - Vec3::Z * 0.5).unwrap();
    assert!(behind_green[0] > 0.45 && behind_green[1] < 0.1, "{behind_green:?}");
    // From the right all squares are seen from their edges.
    assert!((0..SIDE * SIDE).all(|i| pixel(&impostor, 2, i % SIDE, i / SIDE).is_none()));
}

/// The part of picture `k` that D_0 covers, by asking each of 4 × 4 samples a pixel of which triangles it lies in.
fn covered(mesh: &Mesh, masks: &dyn Fn(Material) -> AlphaMask, impostor: &Impostor, k: usize) -> f32 {
    const FINE: usize = 4 * SIDE;
    let [_, right] = Impostor::eye_and_right(k);
    let axis = Vec3::new(impostor.axis_m[0], impostor.low_m, impostor.axis_m[1]);
    let place = |i: u32| {
        let p = Vec3::from_array(mesh.positions[i as usize]) - axis;
        let x = 0.5 + p.dot(right) / impostor.size_m[0];
        [x, 1.0 - p.y / impostor.size_m[1]].map(|t| f64::from(t) * FINE as f64)
    };
    let mut hit = vec![false; FINE * FINE];
    for part in &mesh.parts {
        let mask = masks(part.material);
        for triangle in &part.triangles {
            let p = triangle.map(place);
            let cross = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
                (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            };
            let area = cross(p[0], p[1], p[2]);
            let range = |c: usize| {
                let ends = [p[0][c], p[1][c], p[2][c]];
                let (low, high) = ends.iter().fold((f64::MAX, f64::MIN), |(l, h), &t| (l.min(t), h.max(t)));
                low.max(0.0) as usize..(high.max(0.0) as usize + 1).min(FINE)
            };
            for (x, y) in range(1).flat_map(|y| range(0).map(move |x| (x, y))) {
                let s = [x as f64 + 0.5, y as f64 + 0.5];
                let weights = [cross(p[1], p[2], s), cross(p[2], p[0], s), cross(p[0], p[1], s)];
                let weights = weights.map(|weight| (weight / area) as f32);
                let uv = [0, 1]
                    .map(|c| (0..3).map(|i| weights[i] * mesh.uvs[triangle[i] as usize][c]).sum::<f32>());
                // Bark's texture repeats.
                let shows = part.material == Material::Bark || mask.is_opaque(uv);
                if weights.iter().all(|&w| w >= 0.0) && shows {
                    hit[y * FINE + x] = true;
                }
            }
        }
    }
    hit.iter().filter(|&&hit| hit).count() as f32 / hit.len() as f32
}

#[test]
fn pictures_cover_what_the_tree_covers_and_keep_their_borders() {
    for (name, genome) in presets() {
        let (tree, textures) = (template(&read(&genome), 1), textures(&read(&genome)));
        let impostor = impostor(&tree.mesh, &textures);
        let masks = |material| match material {
            Material::Leaf => AlphaMask::of(&textures.leaf_small, ALPHA_CUTOFF),
            Material::Blossom => AlphaMask::of(&textures.blossom_small, ALPHA_CUTOFF),
            _ => AlphaMask::default(),
        };
        let side = side(&impostor);
        let pixels = || (0..side).flat_map(|y| (0..side).map(move |x| (x, y)));
        for k in 0..4 {
            let kept = pixels().filter(|&(x, y)| pixel(&impostor, k, x, y).is_some()).count();
            let share = |(x, y): (usize, usize)| {
                f32::from(impostor.relief.pixel((k * side + x) as u32, y as u32)[2]) / 255.0
            };
            let (all, target) = ((side * side) as f32, covered(&tree.mesh, &masks, &impostor, k));
            for kept in [kept as f32 / all, pixels().map(share).sum::<f32>() / all] {
                assert!((kept / target - 1.0).abs() < 0.01, "{name}, {k}: {kept} of {target}");
            }
            let border = |t: usize| !(3..side - 3).contains(&t);
            for (x, y) in pixels() {
                let alpha = impostor.colors.pixel((k * side + x) as u32, y as u32)[3];
                assert!(alpha == 0 || !(border(x) || border(y)), "{name}, {k}: alpha {alpha} at {x}, {y}");
            }
        }
    }
}

#[test]
fn transparent_pixels_go_on_in_the_trees_colour() {
    let mut mesh = Mesh::default();
    square(&mut mesh, Vec3::new(0.0, 2.0, 0.0), 1.0, Material::Leaf, [200, 0, 0]);
    square(&mut mesh, Vec3::ZERO, 0.1, Material::Leaf, [200, 0, 0]);
    let impostor = impostor(&mesh, &plain(BARK));
    let colors = (0..SIDE * SIDE).map(|i| impostor.colors.pixel((i % SIDE) as u32, (i / SIDE) as u32));
    assert!(colors.clone().any(|color| color[3] == 0));
    let first = impostor.colors.pixel(64, 64)[..3].to_vec();
    assert!(first[0] > 200 && first[1] == 0);
    assert!(colors.into_iter().all(|color| color[..3] == first));
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let (_, genome) = presets().remove(0);
    let (tree, textures) = (template(&read(&genome), 1), textures(&read(&genome)));
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| impostor(&tree.mesh, &textures))
    };
    assert_eq!(on(1), on(4));
}

#[test]
fn bare_flat_and_empty_meshes_have_pictures() {
    let nothing = impostor(&Mesh::default(), &plain(BARK));
    assert!(nothing.colors.data.chunks_exact(4).all(|pixel| pixel[3] == 0));
    let mut bare = Mesh::default();
    square(&mut bare, Vec3::Y, 1.0, Material::Bark, [255; 3]);
    bare.colors.clear();
    bare.uvs.clear();
    assert!(at(&impostor(&bare, &plain(BARK)), 0, Vec3::Y).is_some());
    // On the ground, seen from its edge.
    let mut flat = bare.clone();
    flat.positions.iter_mut().for_each(|p| *p = [p[0], 0.0, p[1]]);
    // Upright, without any width.
    let mut thin = bare;
    thin.positions.iter_mut().for_each(|p| *p = [0.0, p[1], 0.0]);
    for impostor in [nothing, impostor(&flat, &plain(BARK)), impostor(&thin, &plain(BARK))] {
        assert!(impostor.size_m.iter().all(|&m| m > 0.0) && impostor.error_m > 0.0);
    }
}
