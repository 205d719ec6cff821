//! The shape of a bush or of a young tree → the same with smaller leaves, for eyes that are close to it. A file has leaves as large as
//! what is seen from some metres needs, and each is a triangle; these are oval and folded.

use std::collections::HashMap;

use glam::Vec3;

use super::PlantVertex;

/// In the place of one leaf, each so large beside it: all together they cover as much.
const LEAVES: [Leaf; 3] = [
    Leaf { at: [0.0, 0.0], tilt: 0.5, tint: 0.72 },
    Leaf { at: [0.5, 0.05], tilt: -0.45, tint: 1.1 },
    Leaf { at: [0.08, 0.42], tilt: 0.35, tint: 0.92 },
];
const SIZE: f32 = 0.6;
/// Factor on the tint at the root of each, which lies in the shade of others.
const ROOT: f32 = 0.7;
/// Shapes with fewer large leaves are left as they are.
const MIN_LEAVES: usize = 48;
/// Metres from the root of a large leaf to its tip, at least: those of dwarf shrubs are small enough.
const MIN_LARGE_M: f32 = 0.11;

/// A smaller leaf.
struct Leaf {
    /// Where its root is, as parts of the ways from the large one's root to its other corners.
    at: [f32; 2],
    /// Tangent of the angle by which it is turned around its midrib, off the large one's plane.
    tilt: f32,
    /// Factor on the tints.
    tint: f32,
}

/// All corners, three to a triangle; none where there are hardly any leaves. `coarse`: the triangles that are enough from afar, `fine`:
/// the others.
pub(super) fn several_for_each(
    coarse: &[[PlantVertex; 3]],
    fine: &[[PlantVertex; 3]],
) -> Option<Vec<PlantVertex>> {
    // What bounds two triangles bounds no leaf.
    let mut edges = HashMap::<_, u32>::new();
    for triangle in coarse.iter().chain(fine) {
        sides(triangle).for_each(|side| *edges.entry(side).or_default() += 1);
    }
    let is_leaf = |triangle: &[PlantVertex; 3]| sides(triangle).all(|side| edges[&side] == 1);
    let long_m = |[root, _, tip]: &[PlantVertex; 3]| Vec3::from(root.position).distance(tip.position.into());
    if fine.iter().filter(|leaf| is_leaf(leaf) && long_m(leaf) > MIN_LARGE_M).count() < MIN_LEAVES {
        return None;
    }
    let mut smaller = Vec::new();
    // What stands for all leaves of a twig is two halves, each a large leaf as well.
    let mut rest = coarse;
    while let [one, others @ ..] = rest {
        match others.first().and_then(|other| halves(one, other)) {
            Some(halves) => {
                smaller.extend(halves.iter().flat_map(|half| LEAVES.iter().flat_map(|leaf| leaf.of(half))));
                rest = &others[1..];
            }
            None => {
                smaller.extend(one);
                rest = others;
            }
        }
    }
    for triangle in fine {
        match is_leaf(triangle) {
            true => smaller.extend(LEAVES.iter().flat_map(|leaf| leaf.of(triangle))),
            false => smaller.extend(triangle),
        }
    }
    Some(smaller)
}

/// Two triangles that begin at the root and share the line from there to the tip, as halves, if they do: root, side and tip.
fn halves(one: &[PlantVertex; 3], other: &[PlantVertex; 3]) -> Option<[[PlantVertex; 3]; 2]> {
    let is_same = |a: &PlantVertex, b: &PlantVertex| place_mm(a) == place_mm(b);
    let ([root, a, b], [other_root, c, d]) = (*one, *other);
    match is_same(&root, &other_root) {
        true if is_same(&b, &c) => Some([[root, a, b], [root, d, c]]),
        true if is_same(&a, &d) => Some([[root, b, a], [root, c, d]]),
        _ => None,
    }
}

fn place_mm(corner: &PlantVertex) -> [i64; 3] {
    corner.position.map(|along| (1000.0 * along).round() as i64)
}

/// Between which places its sides are, in millimetres.
fn sides(triangle: &[PlantVertex; 3]) -> impl Iterator<Item = [[i64; 3]; 2]> {
    let places = triangle.map(|corner| place_mm(&corner));
    [[0, 1], [1, 2], [2, 0]]
        .into_iter()
        .map(move |[a, b]| [places[a].min(places[b]), places[a].max(places[b])])
}

/// Half of a leaf: places along its midrib, as parts of its length, and beside it, as parts of its half width; from the root to the tip.
const HALF: [[f32; 2]; 4] = [[0.0, 0.0], [0.3, 1.0], [0.65, 0.8], [1.0, 0.0]];
/// Half of a leaf's width over the height of a triangle as long that covers as much.
const HALF_WIDTH: f32 = 0.383;
/// How far the halves are folded up, as a part of their width.
const FOLD: f32 = 0.4;
/// Triangles of a leaf.
const TRIANGLES: usize = 4;

impl Leaf {
    fn of(&self, triangle: &[PlantVertex; 3]) -> [PlantVertex; 3 * TRIANGLES] {
        let [root, side, tip] = triangle.map(|corner| Vec3::from(corner.position));
        let (to_side, to_tip) = (side - root, tip - root);
        let lit = Vec3::from(triangle[0].normal);
        let across = to_side.cross(to_tip).normalize_or_zero();
        let front = if across.dot(lit) < 0.0 { -across } else { across };
        let from = root + self.at[0] * to_tip + self.at[1] * to_side;
        let along = SIZE * to_tip;
        let aside = to_side.reject_from(to_tip.normalize_or_zero());
        let tilted = (aside + self.tilt * aside.length() * front).normalize_or_zero();
        let wide = SIZE * HALF_WIDTH * aside.length() * tilted;
        let fold = FOLD * wide.length() * front;
        let half = |way: f32| {
            let place = |[t, out]: [f32; 2]| from + t * along + out * (way * wide + fold);
            let places = HALF.map(place);
            let face = (places[1] - from).cross(along).normalize_or_zero();
            // Its front stays on the side that it is lit from.
            let (is_front, face) = if face.dot(front) < 0.0 { (false, -face) } else { (true, face) };
            let normal = (lit + 0.6 * (face - front)).normalize_or(lit);
            let corner = |k: usize| PlantVertex {
                position: places[k].to_array(),
                normal: normal.to_array(),
                tint: (triangle[k.min(2)].tint * self.tint * if k == 0 { ROOT } else { 1.0 }).min(1.0),
            };
            if is_front { [0, 1, 2, 0, 2, 3].map(corner) } else { [0, 2, 1, 0, 3, 2].map(corner) }
        };
        let [one, other] = [half(1.0), half(-1.0)];
        std::array::from_fn(|k| if k < one.len() { one[k] } else { other[k - one.len()] })
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
        // A twig of two triangles and two halves of a large leaf, which are enough from afar, a blade of two, and sixty leaves.
        let mut places = vec![[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.1, 1.0, 0.0], [0.0, 1.0, 0.0]];
        places.extend([[2.0, 0.0, 0.0], [2.1, 0.1, 0.0], [2.0, 0.2, 0.0], [1.9, 0.1, 0.0]]);
        places.extend([[1.0, 0.0, 0.0], [1.1, 0.0, 0.0], [1.1, 1.0, 0.0], [1.0, 1.0, 0.0]]);
        let mut triangles = vec![[0, 1, 2], [3, 0, 2], [4, 5, 6], [4, 6, 7], [8, 9, 10], [11, 8, 10]];
        for k in 0..60u8 {
            let (first, at) = (places.len() as u32, 0.3 * f32::from(k));
            places.extend([[at, 2.0, 0.0], [at + 0.05, 2.05, 0.01], [at, 2.12, 0.03]]);
            triangles.push([first, first + 1, first + 2]);
        }
        let corner = |position| PlantVertex { position, normal: [0.0, 0.0, 1.0], tint: 0.9 };
        let corners: Vec<PlantVertex> = places.iter().copied().map(corner).collect();
        let triangles: Vec<[PlantVertex; 3]> =
            triangles.iter().map(|triangle| triangle.map(|number: u32| corners[number as usize])).collect();
        let leafy = several_for_each(&triangles[..4], &triangles[4..]).expect("it has leaves");
        assert_eq!(leafy.len(), 3 * (4 + 62 * LEAVES.len() * TRIANGLES));
        let plain = triangles.as_flattened();
        let halves = 2 * 3 * LEAVES.len() * TRIANGLES;
        let (large, small) = (&leafy[6..6 + halves], &leafy[12 + halves..]);
        assert_eq!(leafy[..6], plain[..6], "the twig");
        assert_eq!(leafy[6 + halves..12 + halves], plain[12..18], "the blade");
        for (leaves, of) in [(large, &plain[6..12]), (small, &plain[18..])] {
            let part = area(leaves) / area(of);
            assert!((part - 1.1).abs() < 0.1, "{part}");
            for (corner, triangle) in leaves.iter().zip(leaves.chunks_exact(3).flat_map(|t| [t; 3])) {
                let [a, b, c] = [0, 1, 2].map(|k| Vec3::from(triangle[k].position));
                assert!((b - a).cross(c - a).dot(Vec3::from(corner.normal)) > 0.0, "lit from its front");
                assert!((Vec3::from(corner.normal).length() - 1.0).abs() < 1e-3 && corner.tint <= 1.0);
            }
        }
        assert!(several_for_each(&triangles[..4], &triangles[4..6]).is_none());
    }
}
