//! A mesh without normals → the same mesh with smooth normals and sharp creases, angles in radians.
//!
//! The rule is that of section 4.1 of Merry's thesis: the normal of a face's corner averages the normals of those
//! faces around the vertex that differ from the face's own by less than a threshold. Faces count by the angle of
//! their corner there (Thürmer & Wüthrich 1998), so that the triangulation of a flat side does not show.

use std::collections::BTreeMap;

use glam::Vec3;

use crate::model::{Mesh, Part};

/// Faces around a vertex beyond which it pays to look whether one in the same plane came before.
const MANY_FACES: usize = 64;

/// The mesh with unit normals, vertices split where normals differ.
///
/// Vertices at bit-identical positions in the same part count as one place, so texture seams stay smooth. Faces
/// without area take the average of all others around. Any normals that the mesh had are replaced. Triangles keep
/// their number and order; every part's vertices become its own.
pub fn crease_normals(mesh: &Mesh, threshold_rad: f32) -> Mesh {
    let cos_threshold = libm::cosf(threshold_rad.clamp(0.0, std::f32::consts::PI));
    let mut out = Mesh::default();
    for part in &mesh.parts {
        let corners = corners(mesh, part, cos_threshold);
        append(mesh, part, &corners, &mut out);
    }
    out
}

fn position(mesh: &Mesh, vertex: u32) -> Vec3 {
    Vec3::from_array(mesh.positions[vertex as usize])
}

/// Unit normal of a triangle; zero if it has no area.
fn face_normal(mesh: &Mesh, [a, b, c]: [u32; 3]) -> Vec3 {
    let (a, b, c) = (position(mesh, a), position(mesh, b), position(mesh, c));
    (b - a).cross(c - a).normalize_or_zero()
}

/// Angle in radians at corner `k` of a triangle.
fn corner_angle(mesh: &Mesh, triangle: [u32; 3], k: usize) -> f32 {
    let at = |i: usize| position(mesh, triangle[i % 3]);
    let (a, b) = ((at(k + 1) - at(k)).normalize_or_zero(), (at(k + 2) - at(k)).normalize_or_zero());
    libm::acosf(a.dot(b).clamp(-1.0, 1.0))
}

/// Bits that are the same for the same place (−0 is 0).
fn place(p: [f32; 3]) -> [u32; 3] {
    p.map(|v| (v + 0.0).to_bits())
}

/// The normal of each corner of each triangle of a part.
fn corners(mesh: &Mesh, part: &Part, cos_threshold: f32) -> Vec<Vec3> {
    let faces: Vec<Vec3> = part.triangles.iter().map(|&t| face_normal(mesh, t)).collect();
    // All corners, sorted by place: each run is a vertex with the faces around it.
    let vertices = part.triangles.as_flattened();
    let at = |(corner, &vertex): (usize, &u32)| (place(mesh.positions[vertex as usize]), corner);
    let mut incident: Vec<([u32; 3], usize)> = vertices.iter().enumerate().map(at).collect();
    incident.sort_unstable();
    let mut normals = vec![Vec3::ZERO; vertices.len()];
    for around in incident.chunk_by(|a, b| a.0 == b.0) {
        let weight = |&(_, corner): &_| corner_angle(mesh, part.triangles[corner / 3], corner % 3);
        let weights: Vec<f32> = around.iter().map(weight).collect();
        // Of very many faces around a vertex most lie in few planes: those of one plane have one normal.
        let mut known: BTreeMap<[u32; 3], Vec3> = BTreeMap::new();
        for &(_, corner) in around {
            let own = faces[corner / 3];
            let plane = own.to_array().map(f32::to_bits);
            let joins_itself = own.length_squared() > cos_threshold;
            if let Some(&same) = known.get(&plane) {
                normals[corner] = same;
                continue;
            }
            let joins = |other: usize| {
                own == Vec3::ZERO || other == corner / 3 || own.dot(faces[other]) > cos_threshold
            };
            let joined = around.iter().zip(&weights).filter(|((_, other), _)| joins(other / 3));
            let sum: Vec3 = joined.map(|((_, other), &weight)| faces[other / 3] * weight).sum();
            normals[corner] = sum.try_normalize().unwrap_or(own).try_normalize().unwrap_or(Vec3::Y);
            if around.len() > MANY_FACES && joins_itself {
                known.insert(plane, normals[corner]);
            }
        }
    }
    normals
}

/// Appends a part to `out`: one vertex for each different pair of old vertex and normal.
fn append(mesh: &Mesh, part: &Part, normals: &[Vec3], out: &mut Mesh) {
    let mut triangles = part.triangles.clone();
    let corners = triangles.as_flattened_mut();
    let bits = |normal: &Vec3| normal.to_array().map(f32::to_bits);
    let uses = corners.iter().zip(normals).enumerate();
    let mut uses: Vec<(u32, [u32; 3], usize)> =
        uses.map(|(corner, (&vertex, normal))| (vertex, bits(normal), corner)).collect();
    uses.sort_unstable();
    for same in uses.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let old = same[0].0 as usize;
        let new = out.positions.len() as u32;
        out.positions.push(mesh.positions[old]);
        out.normals.push(same[0].1.map(f32::from_bits));
        out.uvs.push(mesh.uvs.get(old).copied().unwrap_or_default());
        if let Some(&color) = mesh.colors.get(old) {
            out.colors.push(color);
        }
        for &(_, _, corner) in same {
            corners[corner] = new;
        }
    }
    out.parts.push(Part { material: part.material, kind: part.kind, triangles });
}

#[cfg(test)]
mod tests {
    use std::f32::consts::{FRAC_PI_4, TAU};

    use super::*;
    use crate::model::{Material, PartKind};

    fn mesh(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Mesh {
        let part = Part { material: Material::Foreign(0), kind: PartKind::Surface, triangles };
        Mesh { positions, parts: vec![part], ..Mesh::default() }
    }

    /// Corners of all triangles: position and normal.
    fn corner_list(mesh: &Mesh) -> Vec<(Vec3, Vec3)> {
        let vertices = mesh.parts.iter().flat_map(|part| part.triangles.iter().flatten());
        vertices.map(|&v| (position(mesh, v), Vec3::from_array(mesh.normals[v as usize]))).collect()
    }

    fn cylinder(sides: u32) -> Mesh {
        let mut positions = vec![[0.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let mut triangles = Vec::new();
        for k in 0..sides {
            let (sin, cos) = libm::sincosf(TAU * k as f32 / sides as f32);
            positions.push([cos, 0.0, sin]);
            positions.push([cos, 2.0, sin]);
            let (a, b) = (2 + 2 * k, 2 + 2 * ((k + 1) % sides));
            triangles.extend([[a, a + 1, b + 1], [a, b + 1, b], [0, a, b], [1, b + 1, a + 1]]);
        }
        mesh(positions, triangles)
    }

    #[test]
    fn a_cube_has_three_normals_at_every_corner() {
        let positions = (0..8).map(|i| [(i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32]).collect();
        let quads: [[u32; 4]; 6] =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let cube = crease_normals(&mesh(positions, triangles), FRAC_PI_4);
        assert_eq!(cube.positions.len(), 24);
        for normal in &cube.normals {
            let n = Vec3::from_array(*normal).abs();
            assert!((n.max_element() - 1.0).abs() < 1e-6 && (n.element_sum() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_cylinder_is_smooth_around_and_crisp_at_its_caps() {
        for (p, n) in corner_list(&crease_normals(&cylinder(24), 0.6)) {
            let radial = Vec3::new(p.x, 0.0, p.z);
            assert!(n.y.abs() > 0.999 || (n.y.abs() < 1e-5 && n.dot(radial) > 0.999), "{p} {n}");
        }
    }

    #[test]
    fn the_normals_of_a_sphere_are_radial_and_none_is_split() {
        let (rings, sides) = (12, 16);
        let mut positions = vec![[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]];
        let mut triangles = Vec::new();
        for i in 1..rings {
            let (sin, cos) = libm::sincosf(std::f32::consts::PI * i as f32 / rings as f32);
            for k in 0..sides {
                let (s, c) = libm::sincosf(TAU * k as f32 / sides as f32);
                positions.push([sin * c, cos, sin * s]);
            }
        }
        let at = |i: u32, k: u32| 2 + (i - 1) * sides + k % sides;
        for k in 0..sides {
            triangles.push([0, at(1, k + 1), at(1, k)]);
            triangles.push([1, at(rings - 1, k), at(rings - 1, k + 1)]);
            for i in 1..rings - 1 {
                triangles.push([at(i, k), at(i, k + 1), at(i + 1, k + 1)]);
                triangles.push([at(i, k), at(i + 1, k + 1), at(i + 1, k)]);
            }
        }
        let count = positions.len();
        let sphere = crease_normals(&mesh(positions, triangles), 1.0);
        assert_eq!(sphere.positions.len(), count);
        for (p, n) in corner_list(&sphere) {
            assert!(n.dot(p) > 0.995, "{p} {n}");
        }
    }

    #[test]
    fn a_texture_seam_stays_smooth_and_flat_faces_do_no_harm() {
        let mut seamed = cylinder(8);
        seamed.uvs = vec![[0.0, 0.0]; seamed.positions.len()];
        let copy = seamed.positions.len() as u32;
        seamed.positions.extend([seamed.positions[2], seamed.positions[3]]);
        seamed.uvs.extend([[1.0, 0.0], [1.0, 1.0]]);
        for triangle in seamed.parts[0].triangles.iter_mut().skip(28) {
            *triangle = triangle.map(|v| if v == 2 || v == 3 { v - 2 + copy } else { v });
        }
        seamed.parts[0].triangles.push([4, 4, 5]);
        let out = crease_normals(&seamed, 1.0);
        assert_eq!(out.uvs.len(), out.positions.len());
        // The last triangle has no area and so no side of its own.
        for (p, n) in corner_list(&out).into_iter().take(3 * 32) {
            assert!((n.length() - 1.0).abs() < 1e-5);
            let radial = Vec3::new(p.x, 0.0, p.z);
            assert!(n.y.abs() > 0.9 || n.dot(radial) > 0.99, "{p} {n}");
        }
    }
}
