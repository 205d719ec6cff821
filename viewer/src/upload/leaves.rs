//! The shape of a bush or of a young tree → the same with smaller leaves, for eyes that are close to it. A file has leaves as large as
//! what is seen from some metres needs, and each is a triangle.

use std::collections::HashMap;

use genescape_schema::scene::PlantShape;
use glam::Vec3;

use super::PlantVertex;

/// In the place of one leaf, each so large beside it: all together they cover as much.
const LEAVES: [Leaf; 3] = [
    Leaf { at: [0.0, 0.0], tilt: 0.5, tint: 0.72 },
    Leaf { at: [0.5, 0.05], tilt: -0.45, tint: 1.1 },
    Leaf { at: [0.08, 0.42], tilt: 0.35, tint: 0.92 },
];
const SIZE: f32 = 0.58;
/// Factor on the tint at the root of each, which lies in the shade of others.
const ROOT: f32 = 0.7;
/// Shapes with fewer leaves are left as they are.
const MIN_LEAVES: usize = 48;

/// A smaller leaf.
struct Leaf {
    /// Where its root is, as parts of the ways from the large one's root to its other corners.
    at: [f32; 2],
    /// By how much the second corner is lifted off the large one's plane, as a part of its way from the root.
    tilt: f32,
    /// Factor on the tints.
    tint: f32,
}

/// All corners, three to a triangle; none where there are hardly any leaves. `corners`: those of the shape.
pub(super) fn several_for_each(corners: &[PlantVertex], shape: &PlantShape) -> Option<Vec<PlantVertex>> {
    let corner = |number: u32| corners.get(number as usize).copied();
    let triangles: Vec<[PlantVertex; 3]> =
        shape.triangles.iter().filter_map(|&[a, b, c]| Some([corner(a)?, corner(b)?, corner(c)?])).collect();
    // What bounds two triangles bounds no leaf.
    let mut edges = HashMap::<_, u32>::new();
    for triangle in &triangles {
        sides(triangle).for_each(|side| *edges.entry(side).or_default() += 1);
    }
    let is_leaf = |triangle: &[PlantVertex; 3]| sides(triangle).all(|side| edges[&side] == 1);
    let fine = triangles.get(shape.coarse as usize..).unwrap_or_default();
    if fine.iter().filter(|triangle| is_leaf(triangle)).count() < MIN_LEAVES {
        return None;
    }
    let (coarse, _) = triangles.split_at(triangles.len() - fine.len());
    let smaller = fine.iter().flat_map(|triangle| match is_leaf(triangle) {
        true => LEAVES.iter().flat_map(|leaf| leaf.of(triangle)).collect(),
        false => triangle.to_vec(),
    });
    Some(coarse.as_flattened().iter().copied().chain(smaller).collect())
}

/// Between which places its sides are, in millimetres.
fn sides(triangle: &[PlantVertex; 3]) -> impl Iterator<Item = [[i64; 3]; 2]> {
    let places = triangle.map(|corner| corner.position.map(|along| (1000.0 * along).round() as i64));
    [[0, 1], [1, 2], [2, 0]]
        .into_iter()
        .map(move |[a, b]| [places[a].min(places[b]), places[a].max(places[b])])
}

impl Leaf {
    fn of(&self, triangle: &[PlantVertex; 3]) -> [PlantVertex; 3] {
        let [root, side, tip] = triangle.map(|corner| Vec3::from(corner.position));
        let (to_side, to_tip) = (side - root, tip - root);
        let front = to_side.cross(to_tip).normalize_or_zero();
        let lift = front * (self.tilt * to_side.length());
        let from = root + self.at[0] * to_tip + self.at[1] * to_side;
        let places = [from, from + SIZE * (to_side + lift), from + SIZE * to_tip];
        // Its front stays on the side that it is lit from.
        let across = (places[1] - from).cross(places[2] - from).normalize_or_zero();
        let lit = Vec3::from(triangle[0].normal);
        let normal = (lit + 0.6 * (across - front)).normalize_or(lit);
        std::array::from_fn(|k| PlantVertex {
            position: places[k].to_array(),
            normal: normal.to_array(),
            tint: (triangle[k].tint * self.tint * if k == 0 { ROOT } else { 1.0 }).min(1.0),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[PlantVertex]) -> f32 {
        let place = |corner: &PlantVertex| Vec3::from(corner.position);
        let of = |t: &[PlantVertex]| {
            0.5 * (place(&t[1]) - place(&t[0])).cross(place(&t[2]) - place(&t[0])).length()
        };
        corners.chunks_exact(3).map(of).sum()
    }

    #[test]
    fn smaller_leaves_cover_as_much_and_what_is_no_leaf_stays() {
        // A twig of two triangles, which is enough from afar, a blade of two, and sixty leaves.
        let mut places = vec![[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.1, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let quad = |first: u32| [[first, first + 1, first + 2], [first, first + 2, first + 3]];
        places.extend([[1.0, 0.0, 0.0], [1.1, 0.0, 0.0], [1.1, 1.0, 0.0], [1.0, 1.0, 0.0]]);
        let mut triangles = [quad(0), quad(4)].concat();
        for k in 0..60u8 {
            let (first, at) = (places.len() as u32, 0.3 * f32::from(k));
            places.extend([[at, 2.0, 0.0], [at + 0.05, 2.05, 0.01], [at, 2.12, 0.03]]);
            triangles.push([first, first + 1, first + 2]);
        }
        let corner = |position| PlantVertex { position, normal: [0.0, 0.0, 1.0], tint: 0.9 };
        let corners: Vec<PlantVertex> = places.iter().copied().map(corner).collect();
        let shape = PlantShape { positions_m: places, triangles, coarse: 2, ..PlantShape::default() };
        let leafy = several_for_each(&corners, &shape).expect("it has leaves");
        assert_eq!(leafy.len(), 3 * (4 + 60 * LEAVES.len()));
        let plain: Vec<PlantVertex> =
            shape.triangles.as_flattened().iter().map(|number| corners[*number as usize]).collect();
        assert_eq!(leafy[..12], plain[..12], "the twig and the blade");
        let part = area(&leafy[12..]) / area(&plain[12..]);
        assert!((part - 1.1).abs() < 0.1, "{part}");
        for (corner, triangle) in leafy[12..].iter().zip(leafy[12..].chunks_exact(3).flat_map(|t| [t; 3])) {
            let [a, b, c] = [0, 1, 2].map(|k| Vec3::from(triangle[k].position));
            assert!((b - a).cross(c - a).dot(Vec3::from(corner.normal)) > 0.0, "lit from its front");
            assert!((Vec3::from(corner.normal).length() - 1.0).abs() < 1e-3 && corner.tint <= 1.0);
        }
        let bare = PlantShape { triangles: shape.triangles[..4].to_vec(), ..shape };
        assert!(several_for_each(&corners, &bare).is_none());
    }
}
