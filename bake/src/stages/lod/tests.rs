//! What must hold for levels of detail, whatever the method.

use std::collections::BTreeMap;

use glam::Vec3;

use super::progressive::reader;
use super::shapes::{plane, sphere, torus, tree};
use super::{LodOptions, Placement, levels, strip};
use crate::model::{AlphaMask, Image8, Level, LevelledMesh, Material, Mesh, Morph, Part, PartKind};

fn shapes() -> Vec<(&'static str, Mesh)> {
    vec![
        ("plane", plane(24)),
        ("torus", torus(48, 24)),
        ("sphere", sphere(32, 30)),
        ("tree", tree(14, 6, 700)),
    ]
}

fn made(mesh: &Mesh) -> LevelledMesh {
    levels(mesh, &LodOptions::default())
}

type Key = [[i64; 3]; 3];

/// Triangles as positions on a grid of 10 µm, each from its least corner on; those without area left out.
fn coarse_triangles(mesh: &Mesh, positions: &[[f32; 3]]) -> BTreeMap<Key, usize> {
    let mut found = BTreeMap::new();
    for triangle in mesh.parts.iter().flat_map(|part| &part.triangles) {
        let corners = triangle.map(|v| positions[v as usize]);
        let [p, q, r] = corners.map(Vec3::from_array);
        let longest = (q - p).length().max((r - p).length()).max((r - q).length());
        if (q - p).cross(r - p).length() <= 2e-5 * longest.max(1e-3) {
            continue;
        }
        let key = corners.map(|c| c.map(|x| (f64::from(x) * 1e4).round() as i64));
        let least = (0..3).min_by_key(|&k| key[k]).unwrap();
        *found.entry([key[least], key[(least + 1) % 3], key[(least + 2) % 3]]).or_default() += 1;
    }
    found
}

/// Edges (pairs of positions) that don't have two triangles.
fn open_edges(mesh: &Mesh, part: usize) -> usize {
    let mut edges: BTreeMap<[[u32; 3]; 2], usize> = BTreeMap::new();
    for t in &mesh.parts[part].triangles {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            let [p, q] = [a, b].map(|v| mesh.positions[v as usize].map(f32::to_bits));
            *edges.entry(if p < q { [p, q] } else { [q, p] }).or_default() += 1;
        }
    }
    edges.values().filter(|&&uses| uses != 2).count()
}

#[test]
fn the_original_is_the_first_level_and_comes_back_bit_for_bit() {
    for (name, mesh) in shapes() {
        let made = made(&mesh);
        assert_eq!(made.levels[0].mesh, mesh, "{name}");
        let read = reader::decode(&made.progressive).unwrap();
        assert_eq!(read.rebuild(usize::MAX), mesh, "{name}");
        assert_eq!(read.vertex_range().1, mesh.positions.len());
    }
}

#[test]
fn each_level_is_rebuilt_from_its_number_of_vertices() {
    for (name, mesh) in shapes() {
        let made = made(&mesh);
        let read = reader::decode(&made.progressive).unwrap();
        assert_eq!(read.marks().len(), made.levels.len());
        for (level, mark) in made.levels.iter().zip(read.marks()) {
            assert_eq!(mark.vertices as usize, level.mesh.positions.len());
            assert_eq!(mark.error_m, level.error_m);
            assert!(read.rebuild(mark.vertices as usize) == level.mesh, "{name} at {}", mark.vertices);
        }
    }
}

#[test]
fn any_number_of_vertices_gives_a_sound_mesh() {
    let mesh = tree(14, 6, 700);
    let read = reader::decode(&made(&mesh).progressive).unwrap();
    let (least, most) = read.vertex_range();
    for wanted in (least..most).step_by(97) {
        let rebuilt = read.rebuild(wanted);
        let count = rebuilt.positions.len();
        assert!(count <= wanted && wanted - count < 40, "{count} of {wanted}");
        assert!(rebuilt.parts.iter().flat_map(|p| &p.triangles).flatten().all(|&v| (v as usize) < count));
        assert!(rebuilt.positions.iter().flatten().all(|x| x.is_finite()));
    }
}

#[test]
fn levels_halve_and_errors_grow() {
    for (name, mesh) in shapes() {
        let made = made(&mesh);
        assert!(made.levels.len() >= 3, "{name} has {} levels", made.levels.len());
        for pair in made.levels.windows(2) {
            let (before, after) = (pair[0].mesh.positions.len(), pair[1].mesh.positions.len());
            assert!(after <= before / 2 && after + 8 >= before / 2, "{name}: {before} to {after}");
            assert!(pair[0].error_m > 0.0 && pair[1].error_m > pair[0].error_m, "{name}");
        }
        assert!(made.levels.last().unwrap().morph.is_none());
    }
}

#[test]
fn a_whole_morph_is_the_next_level() {
    for (name, mesh) in shapes() {
        for pair in made(&mesh).levels.windows(2) {
            let Level { mesh: from, morph, .. } = &pair[0];
            let morph = morph.as_ref().unwrap();
            let to = &pair[1].mesh;
            let moved: Vec<[f32; 3]> = (0..from.positions.len())
                .map(|v| std::array::from_fn(|k| from.positions[v][k] + morph.positions[v][k]))
                .collect();
            let (got, wanted) = (coarse_triangles(from, &moved), coarse_triangles(to, &to.positions));
            let count = |of: &BTreeMap<Key, usize>| of.values().sum::<usize>();
            // Rounding to the grid may part a few twins.
            let missing = wanted.iter().filter(|(key, n)| got.get(*key) != Some(n)).count();
            assert!(missing * 100 <= wanted.len(), "{name}: {missing} of {}", wanted.len());
            assert!(count(&got).abs_diff(count(&wanted)) <= 2, "{name}: {} {}", count(&got), count(&wanted));
            assert_eq!(morph.normals.len(), from.normals.len());
            assert_eq!(morph.uvs.len(), from.uvs.len());
        }
    }
}

#[test]
fn what_is_closed_stays_closed() {
    for (name, mesh) in [("torus", torus(48, 24)), ("sphere", sphere(32, 30)), ("tree", tree(14, 6, 700))] {
        for level in made(&mesh).levels {
            assert_eq!(open_edges(&level.mesh, 0), 0, "{name}");
        }
    }
}

fn volume(mesh: &Mesh) -> f32 {
    let at = |v: u32| Vec3::from_array(mesh.positions[v as usize]);
    let of = |t: &[u32; 3]| at(t[0]).dot(at(t[1]).cross(at(t[2])));
    mesh.parts[0].triangles.iter().map(of).sum::<f32>() / 6.0
}

#[test]
fn a_sphere_keeps_its_radius_and_its_volume() {
    let mesh = sphere(48, 46);
    for level in &made(&mesh).levels {
        assert!((volume(&level.mesh) / volume(&mesh) - 1.0).abs() < 0.02, "{}", volume(&level.mesh));
        let worst = level.mesh.positions.iter().map(|&p| (Vec3::from_array(p).length() - 1.0).abs());
        let worst = worst.fold(0.0, f32::max);
        assert!(worst < 0.12 && worst <= 4.0 * level.error_m + 1e-3, "{worst} at {}", level.error_m);
    }
}

#[test]
fn vertices_placed_on_edges_stay_inside_the_sphere_which_shrinks() {
    let mesh = sphere(48, 46);
    let on_edges = levels(&mesh, &LodOptions { placement: Placement::Edge, ..LodOptions::default() });
    for level in &on_edges.levels[1..] {
        let lengths = level.mesh.positions.iter().map(|&p| Vec3::from_array(p).length());
        let farthest = lengths.fold(0.0, f32::max);
        assert!(farthest <= 1.0 + 1e-5, "{farthest}");
        let share = volume(&level.mesh) / volume(&mesh);
        assert!((0.5..0.999).contains(&share), "{share}");
    }
}

#[test]
fn a_plane_stays_flat_and_whole() {
    for level in made(&plane(24)).levels {
        let at = |v: u32| Vec3::from_array(level.mesh.positions[v as usize]);
        let area = |t: &[u32; 3]| (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).y / 2.0;
        let whole: f32 = level.mesh.parts[0].triangles.iter().map(area).sum();
        assert!((whole - 1.0).abs() < 1e-3, "{whole}");
        // A flat sheet's texture coordinates follow from its positions.
        for (p, uv) in level.mesh.positions.iter().zip(&level.mesh.uvs) {
            assert!((p[0] - uv[0]).abs() < 1e-3 && (1.0 - p[2] - uv[1]).abs() < 1e-3, "{p:?} {uv:?}");
        }
    }
}

/// A texture that is opaque in its left half.
fn half_opaque() -> AlphaMask {
    let mut image = Image8::new(32, 32, 4);
    for (i, pixel) in image.data.chunks_exact_mut(4).enumerate() {
        pixel[3] = if i % 32 < 16 { 255 } else { 0 };
    }
    AlphaMask::of(&image, 0.5)
}

/// Pixels that some parts cover from a direction, 384 px a side, cut out by one texture.
fn covered(mesh: &Mesh, parts: &[usize], azimuth: f32, mask: &AlphaMask, weight: Option<&Morph>) -> usize {
    let bounds = Vec3::new(4.5, 9.0, 4.5);
    let (right, n) = (Vec3::new(libm::cosf(azimuth), 0.0, libm::sinf(azimuth)), 384_usize);
    let mut pixels = vec![false; n * n];
    let at = |v: u32| {
        let half = weight.map_or(Vec3::ZERO, |morph| 0.5 * Vec3::from_array(morph.positions[v as usize]));
        Vec3::from_array(mesh.positions[v as usize]) + half
    };
    for t in parts.iter().flat_map(|&part| &mesh.parts[part].triangles) {
        let flat = |v: u32| {
            let p = at(v);
            ((p.dot(right) / bounds.x * 0.5 + 0.5) * n as f32, p.y / bounds.y * n as f32)
        };
        let [a, b, c] = t.map(flat);
        let side =
            |p: (f32, f32), q: (f32, f32), x: f32, y: f32| (q.0 - p.0) * (y - p.1) - (q.1 - p.1) * (x - p.0);
        let whole = side(a, b, c.0, c.1);
        let low =
            |k: fn(&(f32, f32)) -> f32| [a, b, c].iter().map(k).fold(f32::MAX, f32::min).max(0.0) as usize;
        let high =
            |k: fn(&(f32, f32)) -> f32| (([a, b, c].iter().map(k).fold(0.0, f32::max) + 1.0) as usize).min(n);
        for y in low(|p| p.1)..high(|p| p.1) {
            for x in low(|p| p.0)..high(|p| p.0) {
                let (px, py) = (x as f32 + 0.5, y as f32 + 0.5);
                let weights = [side(b, c, px, py), side(c, a, px, py), side(a, b, px, py)].map(|s| s / whole);
                let uv = [0, 1].map(|k| (0..3).map(|i| weights[i] * mesh.uvs[t[i] as usize][k]).sum());
                if weights.iter().all(|&w| w >= 0.0) && mask.is_opaque(uv) {
                    pixels[y * n + x] = true;
                }
            }
        }
    }
    pixels.iter().filter(|&&p| p).count()
}

const AZIMUTHS: [f32; 4] = [0.2, 1.1, 2.0, 2.9];

#[test]
fn leaves_keep_covering_the_sky() {
    let mesh = tree(30, 10, 3000);
    for mask in [AlphaMask::default(), half_opaque()] {
        let options = LodOptions { masks: vec![AlphaMask::default(), mask], ..LodOptions::default() };
        let levels = levels(&mesh, &options).levels;
        let sum = |mesh: &Mesh, morph: Option<&Morph>| {
            AZIMUTHS.iter().map(|&azimuth| covered(mesh, &[1], azimuth, &mask, morph)).sum::<usize>() as f32
        };
        let full = sum(&mesh, None);
        for level in &levels[1..=4] {
            let count = level.mesh.positions.len();
            let ratio = sum(&level.mesh, None) / full;
            assert!((0.97..1.03).contains(&ratio), "{ratio} at {count} vertices");
            let half_way = sum(&level.mesh, level.morph.as_ref()) / full;
            assert!((0.95..1.05).contains(&half_way), "{half_way} half-way from {count} vertices");
        }
    }
}

#[test]
fn leaves_that_are_not_counted_go_on_growing() {
    let mesh = tree(30, 10, 2800);
    let made = |counted_levels| levels(&mesh, &LodOptions { counted_levels, ..LodOptions::default() }).levels;
    let (all, two) = (made(u32::MAX), made(2));
    assert!(all[..=2].iter().zip(&two).all(|(a, b)| a.mesh == b.mesh), "the same where they are counted");
    let opaque = AlphaMask::default();
    let sum = |level: &Level| -> usize {
        AZIMUTHS.iter().map(|&azimuth| covered(&level.mesh, &[1], azimuth, &opaque, None)).sum()
    };
    for (counted, guessed) in all.iter().zip(&two).skip(3) {
        let ratio = sum(guessed) as f32 / sum(counted) as f32;
        assert!(
            ratio != 1.0 && (0.85..1.15).contains(&ratio),
            "{ratio}: near to what would be counted, but a guess"
        );
    }
}

#[test]
fn trees_of_few_leaves_keep_covering_the_sky() {
    let mesh = tree(30, 10, 300);
    let levels = levels(&mesh, &LodOptions { thickens: true, ..LodOptions::default() }).levels;
    let opaque = AlphaMask::default();
    let sum = |mesh: &Mesh| {
        AZIMUTHS.iter().map(|&azimuth| covered(mesh, &[0, 1], azimuth, &opaque, None)).sum::<usize>() as f32
    };
    for level in &levels[1..=4] {
        let (ratio, count) = (sum(&level.mesh) / sum(&mesh), level.mesh.positions.len());
        assert!((0.97..1.03).contains(&ratio), "{ratio} at {count} vertices");
    }
}

#[test]
fn bare_branches_keep_covering_the_sky() {
    let mut mesh = tree(30, 10, 0);
    mesh.parts.truncate(1);
    let made = levels(&mesh, &LodOptions { thickens: true, ..LodOptions::default() });
    let opaque = AlphaMask::default();
    let sum = |mesh: &Mesh| {
        AZIMUTHS.iter().map(|&azimuth| covered(mesh, &[0], azimuth, &opaque, None)).sum::<usize>() as f32
    };
    for level in &made.levels[1..=4] {
        let (ratio, count) = (sum(&level.mesh) / sum(&mesh), level.mesh.positions.len());
        // Twigs may not grow as much as this would take: a few fat arms look worse than a little more sky.
        assert!((0.9..1.05).contains(&ratio), "{ratio} at {count} vertices");
    }
    let read = reader::decode(&made.progressive).unwrap();
    assert!(read.marks().last().unwrap().sizes()[0] > 0.0);
}

/// Cards of three rows, of which the middle one is so far out of the plane.
fn bent_cards(count: u32, bend: impl Fn(u32) -> f32) -> Mesh {
    let mut mesh = Mesh::default();
    for k in 0..count {
        let root = Vec3::new((k % 8) as f32, (k / 64) as f32, (k / 8 % 8) as f32);
        for (row, bend) in [(0.0, 0.0), (1.0, bend(k)), (2.0, 0.0)] {
            for column in [0.0, 1.0] {
                mesh.positions.push((root + Vec3::new(0.2 * column, 0.3 * row, bend)).to_array());
                mesh.normals.push([0.0, 0.0, 1.0]);
                mesh.uvs.push([column, 1.0 - 0.5 * row]);
            }
        }
    }
    let card = |k: u32| {
        let cells = [0, 2].map(|row| 6 * k + row);
        cells.into_iter().flat_map(|a| [[a, a + 1, a + 3], [a, a + 3, a + 2]])
    };
    let kind = PartKind::Aggregate { vertices: 6, triangles: 4 };
    mesh.parts.push(Part { material: Material::Leaf, kind, triangles: (0..count).flat_map(card).collect() });
    mesh
}

#[test]
fn bent_cards_are_flattened_before_any_goes() {
    let mesh = bent_cards(300, |_| 0.05);
    let made = made(&mesh);
    let read = reader::decode(&made.progressive).unwrap();
    // Two of each card's six vertices, and not yet a card.
    let flat = read.rebuild(4 * 300);
    assert_eq!(flat.parts[0].kind, PartKind::Aggregate { vertices: 4, triangles: 2 });
    assert_eq!(flat.parts[0].triangles.len(), 2 * 300);
    let corners = |mesh: &Mesh, per_card: usize| -> Vec<_> {
        let ends = mesh.positions.chunks(per_card).flat_map(|card| [card[0], card[1], card[per_card - 1]]);
        ends.map(|p| p.map(|x| (x * 1e3).round() as i32)).collect()
    };
    assert_eq!(corners(&flat, 4), corners(&mesh, 6), "cards moved");
    // Their texture is where it was.
    for (p, uv) in flat.positions.iter().zip(&flat.uvs) {
        assert!((p[1] % 1.0 - 0.6 * (1.0 - uv[1])).abs() < 1e-3 || uv[1] == 0.0, "{p:?} {uv:?}");
    }
}

#[test]
fn cards_are_flattened_in_the_order_of_their_own_bends() {
    let bend = |k: u32| 0.0002 * (k * 7 % 300) as f32;
    let made = made(&bent_cards(300, bend));
    let read = reader::decode(&made.progressive).unwrap();
    for gone in [100, 300, 500] {
        let left = read.rebuild(6 * 300 - gone);
        let still_bent: Vec<u32> = (0..300)
            .filter(|&k| {
                let root = [k % 8, k / 64, k / 8 % 8].map(|place| place as f32);
                let is_bent = |p: &[f32; 3]| {
                    let [x, y, z] = [0, 1, 2].map(|axis| p[axis] - root[axis]);
                    (0.0..0.25).contains(&x) && (y - 0.3).abs() < 1e-3 && (z - bend(k)).abs() < 1e-4
                };
                left.positions.iter().filter(|&p| is_bent(p)).count() == 2
            })
            .collect();
        let straightest = still_bent.iter().map(|&k| bend(k)).fold(f32::MAX, f32::min);
        let flattened = (0..300).filter(|k| !still_bent.contains(k)).map(bend).fold(0.0, f32::max);
        // One may be half-way.
        assert!(flattened <= straightest + 0.0005, "{gone} gone: {flattened} and {straightest}");
        assert!(still_bent.len().abs_diff(300 - gone / 2) <= 2, "{gone} gone: {}", still_bent.len());
    }
}

/// A closed strip of valence 3 at every tip: a pyramid on each triangle of a sphere.
#[test]
fn tips_of_three_triangles_can_go() {
    let mut mesh = sphere(24, 22);
    let faces = std::mem::take(&mut mesh.parts[0].triangles);
    for [a, b, c] in faces {
        let corners = [a, b, c].map(|v| Vec3::from_array(mesh.positions[v as usize]));
        let tip = corners.iter().sum::<Vec3>() / 3.0 * 1.001;
        let at = mesh.positions.len() as u32;
        mesh.positions.push(tip.to_array());
        mesh.normals.push(tip.normalize().to_array());
        mesh.uvs.push([0.5, 0.5]);
        mesh.parts[0].triangles.extend([[a, b, at], [b, c, at], [c, a, at]]);
    }
    mesh.normals.clear();
    mesh.uvs.clear();
    let levels = made(&mesh).levels;
    let last = levels.last().unwrap();
    assert!(last.mesh.positions.len() <= 200, "{} vertices are left", last.mesh.positions.len());
    assert!(levels.iter().all(|level| open_edges(&level.mesh, 0) == 0));
}

#[test]
fn strips_hold_the_same_triangles() {
    let first = |t: [u32; 3]| (0..3).map(|k| [t[k], t[(k + 1) % 3], t[(k + 2) % 3]]).min().unwrap();
    for (name, mesh) in shapes() {
        let mut indices = 0;
        for level in made(&mesh).levels {
            for (part, strip) in level.mesh.parts.iter().zip(&level.strips) {
                let sorted = |triangles: &[[u32; 3]]| {
                    let mut all: Vec<_> = triangles.iter().map(|&t| first(t)).collect();
                    all.sort_unstable();
                    all
                };
                assert_eq!(sorted(&strip::triangles(strip)), sorted(&part.triangles), "{name}");
                indices += strip.len();
            }
        }
        let triangles: usize = made(&mesh).levels.iter().map(|l| l.mesh.triangle_count()).sum();
        let most = if name == "tree" { 3.2 } else { 1.8 };
        assert!(indices as f32 / (triangles as f32) < most, "{name}: {}", indices as f32 / triangles as f32);
    }
}

#[test]
fn a_damaged_payload_is_an_error_and_never_a_panic() {
    let bytes = made(&tree(3, 2, 40)).progressive;
    for length in (0..bytes.len()).step_by(13) {
        assert!(reader::decode(&bytes[..length]).is_err());
    }
    for at in 0..bytes.len().min(6000) {
        let mut broken = bytes.clone();
        broken[at] ^= 1 << (at % 8);
        if let Ok(read) = reader::decode(&broken) {
            let _ = read.rebuild(read.vertex_range().0 + 100);
        }
    }
}

#[test]
fn odd_meshes_do_no_harm() {
    let mut mesh = tree(3, 2, 40);
    mesh.parts[0].triangles.push([0, 1, u32::MAX]);
    mesh.parts[0].triangles.push([5, 5, 6]);
    mesh.positions[9] = [f32::NAN; 3];
    mesh.positions.push([1.0; 3]);
    assert!(!made(&mesh).levels.is_empty());
    assert_eq!(made(&Mesh::default()).levels.len(), 1);
    assert_eq!(reader::decode(&made(&Mesh::default()).progressive).unwrap().rebuild(9), Mesh::default());
    // Three sheets on one edge, and every triangle twice.
    let mut fan = plane(24);
    let doubled: Vec<_> = fan.parts[0].triangles.iter().map(|t| [t[0], t[2], t[1]]).collect();
    fan.parts[0].triangles.extend(doubled);
    let made = made(&fan);
    assert_eq!(reader::decode(&made.progressive).unwrap().rebuild(usize::MAX), fan);
}
