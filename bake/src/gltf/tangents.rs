//! Texture coordinates → the tangent frames that normal maps need (Lengyel, "Foundations of Game Engine
//! Development" 2, 7.5): glTF viewers may make their own, but not all make the same.

use glam::Vec3;

/// Tangents (x, y, z, handedness) of the vertices `first .. first + count` from the triangles that use them.
///
/// The bitangent is `cross(normal, tangent) · w` and points up in the picture, against +v.
pub fn tangents(
    positions: &[[f32; 3]],
    normals: &[[f32; 3]],
    uvs: &[[f32; 2]],
    triangles: &[[u32; 3]],
    (first, count): (usize, usize),
) -> Vec<[f32; 4]> {
    let mut sums = vec![(Vec3::ZERO, Vec3::ZERO); count];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| i as usize);
        let point = |i: usize| Vec3::from_array(positions[i]);
        let (e1, e2) = (point(b) - point(a), point(c) - point(a));
        let (du1, dv1) = (uvs[b][0] - uvs[a][0], uvs[b][1] - uvs[a][1]);
        let (du2, dv2) = (uvs[c][0] - uvs[a][0], uvs[c][1] - uvs[a][1]);
        let det = du1 * dv2 - du2 * dv1;
        if det == 0.0 {
            continue;
        }
        // Weighted by the triangle's area: its edges are not normalised.
        let sign = det.signum();
        let along_u = (e1 * dv2 - e2 * dv1) * sign;
        let along_v = (e2 * du1 - e1 * du2) * sign;
        for i in [a, b, c] {
            sums[i - first].0 += along_u;
            sums[i - first].1 += along_v;
        }
    }
    let frame = |(i, (along_u, along_v)): (usize, &(Vec3, Vec3))| {
        let normal = Vec3::from_array(normals[first + i]);
        let flat = *along_u - normal * normal.dot(*along_u);
        let tangent =
            flat.try_normalize().unwrap_or_else(|| normal.any_orthogonal_vector().normalize_or(Vec3::X));
        let w = if normal.cross(tangent).dot(*along_v) > 0.0 { -1.0 } else { 1.0 };
        [tangent.x, tangent.y, tangent.z, w]
    };
    sums.iter().enumerate().map(frame).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0]];
    const UP: [[f32; 3]; 3] = [[0.0, 1.0, 0.0]; 3];

    #[test]
    fn level_ground_has_its_tangent_east_and_its_bitangent_north() {
        let uvs = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]];
        let all = tangents(&CORNERS, &UP, &uvs, &[[0, 1, 2]], (0, 3));
        assert_eq!(all, [[1.0, 0.0, 0.0, 1.0]; 3]);
    }

    #[test]
    fn a_mirrored_picture_has_the_other_hand() {
        let uvs = [[1.0, 0.0], [1.0, 1.0], [0.0, 0.0]];
        let all = tangents(&CORNERS, &UP, &uvs, &[[0, 1, 2]], (0, 3));
        assert_eq!(all, [[-1.0, 0.0, 0.0, -1.0]; 3]);
    }

    #[test]
    fn a_picture_without_extent_still_gives_unit_tangents() {
        for [x, y, z, w] in tangents(&CORNERS, &UP, &[[0.5, 0.5]; 3], &[[0, 1, 2]], (0, 3)) {
            assert!((x * x + y * y + z * z - 1.0).abs() < 1e-6 && y.abs() < 1e-6 && w.abs() == 1.0);
        }
    }
}
