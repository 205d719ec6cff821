//! What the elements of an aggregate have in common: their triangles in texture space, and which of these a merge of two vertices
//! leaves, with what it cuts off of the picture and how far it moves the rest.

use std::collections::BTreeSet;

use glam::{Vec2, Vec3};

use super::state::{PartSpan, State};
use crate::model::AlphaMask;

/// A merge leaves the outline in texture space as it is if it changes the area by no more than this part.
const AREA_TOLERANCE: f32 = 1e-3;
/// Merges may cut off the corners of a picture, where hardly anything is, until this part of what it shows is gone.
const MAX_LOST: f64 = 0.25;
/// How far outside of a triangle a point may lie and belong to it, in barycentric coordinates.
const ROUNDING: f32 = 1e-4;
/// Points in a word.
const WORD: usize = u64::BITS as usize;

/// One vertex of an element merges into another; ids count from the element's first vertex or triangle.
#[derive(Clone, Debug)]
pub struct Merge {
    pub vertex: u32,
    pub into: u32,
    /// Triangles that go.
    pub removed: Vec<u32>,
    /// Corners (3·triangle + 0…2) that get the other vertex.
    pub corners: Vec<u32>,
}

/// Elements as they are at first.
pub struct Pattern {
    triangles: Vec<[u32; 3]>,
    uvs: Vec<Vec2>,
    /// Where the vertices lie, in metres, of each element that is looked at.
    places: Vec<Vec<Vec3>>,
    /// Mean root mean square distance of an element's vertices from its centre, in metres.
    radius_m: f64,
    /// Points of the picture that show something; none if all do.
    shown: Vec<Vec2>,
    /// For each vertex, the point nearest to it that shows something.
    watched: Vec<Point>,
}

/// A point of the picture: between which vertices it is, and how much of each counts.
#[derive(Clone, Copy, Debug)]
struct Point {
    uv: Vec2,
    corners: [u32; 3],
    weights: [f32; 3],
}

impl Point {
    /// Where it is in an element with vertices at these places.
    fn place(&self, places: &[Vec3]) -> Vec3 {
        self.corners.iter().zip(self.weights).map(|(&v, weight)| places[v as usize] * weight).sum()
    }

    fn is_inside(&self) -> bool {
        are_inside(&self.weights)
    }
}

fn are_inside(weights: &[f32; 3]) -> bool {
    weights.iter().all(|&weight| weight >= -ROUNDING)
}

impl Pattern {
    /// Of a part with elements, of which every nth is looked at; `mask` is their picture's.
    pub fn new(state: &State, span: &PartSpan, nth: usize, mask: &AlphaMask) -> Self {
        let [ids, triangles] = span.element(0);
        let first = ids.start as u32;
        let count = span.elements().map_or(0, |(elements, ..)| elements);
        let places = |e: u32| -> Vec<Vec3> {
            let vertices = &state.vertices[span.element(e)[0].clone()];
            vertices.iter().map(|v| Vec3::from_array(v.position)).collect()
        };
        let looked_at = || (0..count).step_by(nth);
        let radii_m = looked_at().map(|e| f64::from(state.radius_m(span.element(e)[0].clone())));
        let mut pattern = Self {
            triangles: state.triangles[triangles].iter().map(|t| t.map(|v| v - first)).collect(),
            uvs: state.vertices[ids].iter().map(|v| Vec2::from_array(v.uv)).collect(),
            places: looked_at().map(places).collect(),
            radius_m: radii_m.sum::<f64>() / looked_at().count().max(1) as f64,
            shown: if mask.is_full() { Vec::new() } else { mask.shown().map(Vec2::from_array).collect() },
            watched: Vec::new(),
        };
        let nearest = |&uv: &Vec2| {
            let away = |p: &&Vec2| p.distance_squared(uv);
            pattern.shown.iter().min_by(|p, q| away(p).total_cmp(&away(q))).copied().unwrap_or(uv)
        };
        let points = pattern.uvs.iter().map(nearest);
        pattern.watched = points.filter_map(|uv| pattern.point(pattern.triangles.iter(), uv)).collect();
        pattern
    }

    /// All of their vertices and triangles.
    pub fn whole(&self) -> Element<'_> {
        Element {
            of: self,
            triangles: self.triangles.iter().map(|&corners| Some(self.triangle(corners))).collect(),
            living: (0..self.uvs.len() as u32).collect(),
            lost: 0.0,
        }
    }

    fn signed_area(&self, t: &[u32; 3]) -> f32 {
        let [a, b, c] = t.map(|v| self.uvs[v as usize]);
        0.5 * (b - a).perp_dot(c - a)
    }

    fn triangle(&self, corners: [u32; 3]) -> Triangle {
        let weights = self.weights(corners);
        let word = |points: &[Vec2]| {
            let bits = points.iter().enumerate().map(|(bit, &uv)| u64::from(are_inside(&weights(uv))) << bit);
            bits.fold(0, |word, bit| word | bit)
        };
        Triangle { corners, shown: self.shown.chunks(WORD).map(word).collect() }
    }

    /// Barycentric coordinates in a triangle; not finite where it has no area.
    fn weights(&self, corners: [u32; 3]) -> impl Fn(Vec2) -> [f32; 3] + use<> {
        let [a, b, c] = corners.map(|v| self.uvs[v as usize]);
        let area = (b - a).perp_dot(c - a);
        move |uv| {
            let weights = [(b - uv).perp_dot(c - uv), (c - uv).perp_dot(a - uv), (a - uv).perp_dot(b - uv)];
            weights.map(|weight| weight / area)
        }
    }

    /// A point of the picture in that of some triangles in which it is or else nearest to which it is.
    fn point<'a>(&self, triangles: impl Iterator<Item = &'a [u32; 3]>, uv: Vec2) -> Option<Point> {
        let in_triangle = |&corners: &[u32; 3]| Point { uv, corners, weights: self.weights(corners)(uv) };
        let least = |point: &Point| point.weights.into_iter().fold(f32::MAX, f32::min);
        let points = triangles.map(in_triangle).filter(|point| point.weights.iter().all(|w| w.is_finite()));
        points.max_by(|p, q| least(p).total_cmp(&least(q)))
    }
}

/// A triangle of an element.
#[derive(Clone)]
struct Triangle {
    corners: [u32; 3],
    /// Which of the points that the picture shows are in it, a bit each.
    shown: Vec<u64>,
}

/// What is left of them after some merges.
#[derive(Clone)]
pub struct Element<'a> {
    of: &'a Pattern,
    triangles: Vec<Option<Triangle>>,
    living: BTreeSet<u32>,
    /// The part of what the picture shows that is cut off.
    lost: f64,
}

impl Element<'_> {
    /// Whether it is a card of four vertices and two triangles.
    pub fn is_card(&self) -> bool {
        self.living.len() == 4 && self.triangles.iter().flatten().count() == 2
    }

    /// The neighbour that a vertex may best merge into, with the error in metres.
    pub fn best(&self, vertex: u32) -> Option<(f64, Merge)> {
        let around = self.corners().filter(|t| t.contains(&vertex));
        let others: BTreeSet<u32> = around.flatten().copied().filter(|&v| v != vertex).collect();
        others.into_iter().filter_map(|into| self.merge(vertex, into)).min_by(by_error)
    }

    /// Merging one vertex into another, if no triangle turns over and hardly anything that shows is cut off; with its error in
    /// metres.
    fn merge(&self, vertex: u32, into: u32) -> Option<(f64, Merge)> {
        let mut merge = Merge { vertex, into, removed: Vec::new(), corners: Vec::new() };
        let living = (0_u32..).zip(&self.triangles);
        for (t, triangle) in living.filter_map(|(t, triangle)| Some((t, triangle.as_ref()?.corners))) {
            let Some(corner) = triangle.iter().position(|&v| v == vertex) else { continue };
            if triangle.contains(&into) {
                merge.removed.push(t);
                continue;
            }
            let mut after = triangle;
            after[corner] = into;
            if self.of.signed_area(&after) * self.of.signed_area(&triangle) <= 0.0 {
                return None;
            }
            merge.corners.push(3 * t + corner as u32);
        }
        let mut after = self.clone();
        after.take(&merge);
        let (area, before) = (after.area(), self.area());
        let is_allowed = area <= before * (1.0 + AREA_TOLERANCE) && after.lost <= MAX_LOST;
        is_allowed.then(|| (after.error_m(), merge))
    }

    /// Does that.
    pub fn take(&mut self, merge: &Merge) {
        let before = self.area();
        for &t in &merge.removed {
            self.triangles[t as usize] = None;
        }
        for &corner in &merge.corners {
            if let Some(triangle) = &mut self.triangles[corner as usize / 3] {
                triangle.corners[corner as usize % 3] = merge.into;
                *triangle = self.of.triangle(triangle.corners);
            }
        }
        self.living.remove(&merge.vertex);
        if (self.area() - before).abs() > AREA_TOLERANCE * before {
            self.lost = self.lost_now();
        }
    }

    fn corners(&self) -> impl Iterator<Item = &[u32; 3]> {
        self.triangles.iter().flatten().map(|triangle| &triangle.corners)
    }

    fn area(&self) -> f32 {
        self.corners().map(|t| self.of.signed_area(t).abs()).sum()
    }

    fn lost_now(&self) -> f64 {
        let all = self.of.shown.len();
        if all == 0 {
            // All of it shows, and nothing may be cut off.
            return 1.0;
        }
        let in_word = |word: usize| {
            self.triangles.iter().flatten().fold(0, |left, triangle| left | triangle.shown[word])
        };
        let left: u32 = (0..all.div_ceil(WORD)).map(|word| in_word(word).count_ones()).sum();
        (all - left as usize) as f64 / all as f64
    }

    fn point(&self, uv: Vec2) -> Option<Point> {
        self.of.point(self.corners(), uv)
    }

    /// By how much it differs from the whole, in metres: how far what is seen of the picture has moved at most, on average over the
    /// elements, and what is cut off, as if all of it were an element's radius away.
    fn error_m(&self) -> f64 {
        let mean = |moved: Vec<f64>| moved.iter().sum::<f64>() / moved.len().max(1) as f64;
        self.moved_m().map(mean).fold(0.0, f64::max) + self.lost * self.of.radius_m
    }

    /// For each of the points that are watched and not cut off, how far it has moved in each element, in metres.
    pub fn moved_m(&self) -> impl Iterator<Item = Vec<f64>> {
        self.of.watched.iter().filter_map(|was| {
            let now = self.point(was.uv).filter(Point::is_inside)?;
            let moved = |places: &Vec<Vec3>| f64::from(now.place(places).distance(was.place(places)));
            Some(self.of.places.iter().map(moved).collect())
        })
    }
}

/// The least error first, then the first vertex.
pub fn by_error(p: &(f64, Merge), q: &(f64, Merge)) -> std::cmp::Ordering {
    p.0.total_cmp(&q.0).then(p.1.vertex.cmp(&q.1.vertex))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Image8, Material, Mesh, Part, PartKind};

    /// Two arching strips of three columns and six rows.
    fn fronds() -> State {
        let mut mesh = Mesh::default();
        let mut triangles = Vec::new();
        for element in 0..2_u32 {
            for i in 0..18_u32 {
                let [u, v] = [(i % 3) as f32 / 2.0, (i / 3) as f32 / 5.0];
                mesh.positions.push([u - 0.5 + 3.0 * element as f32, 3.0 * v, -2.0 * v * v]);
                mesh.uvs.push([u, v]);
            }
            for [row, column] in (0..10).map(|i| [i / 2, i % 2]) {
                let a = 18 * element + 3 * row + column;
                triangles.extend([[a, a + 1, a + 4], [a, a + 4, a + 3]]);
            }
        }
        let kind = PartKind::Aggregate { vertices: 18, triangles: 20 };
        mesh.parts.push(Part { material: Material::Leaf, kind, triangles });
        State::new(&mesh)
    }

    /// What is opaque within a rhomb with its corners in the middles of a picture's sides.
    fn rhomb() -> AlphaMask {
        let mut image = Image8::new(64, 64, 4);
        for (i, pixel) in image.data.chunks_exact_mut(4).enumerate() {
            let [x, y] = [i % 64, i / 64].map(|t| (t as f32 - 31.5).abs());
            pixel[3] = if x + y < 32.0 { 255 } else { 0 };
        }
        AlphaMask::of(&image, 0.5)
    }

    /// The vertices that are left when nothing more can go but the first, and the part of the picture that is lost.
    fn merged(mask: &AlphaMask) -> (BTreeSet<u32>, f64) {
        let state = fronds();
        let pattern = Pattern::new(&state, &state.parts[0], 1, mask);
        let mut element = pattern.whole();
        let mut last = 0.0;
        while let Some((error_m, merge)) = (1..18).filter_map(|v| element.best(v)).min_by(by_error) {
            element.take(&merge);
            assert!(error_m >= 0.0 && element.lost >= last, "what is gone does not come back");
            last = element.lost;
        }
        (element.living, element.lost)
    }

    #[test]
    fn corners_go_where_the_picture_shows_nothing() {
        let (living, lost) = merged(&rhomb());
        assert!(lost <= MAX_LOST, "{lost}");
        assert!([2, 15, 17].iter().all(|corner| !living.contains(corner)), "{living:?}");
        assert!(living.len() <= 6, "{living:?}");
    }

    #[test]
    fn corners_stay_where_the_picture_shows_something() {
        let (living, lost) = merged(&AlphaMask::default());
        assert_eq!((living, lost), (BTreeSet::from([0, 2, 15, 17]), 0.0));
    }

    #[test]
    fn a_picture_moves_as_far_as_it_is_said_to() {
        let state = fronds();
        let pattern = Pattern::new(&state, &state.parts[0], 1, &AlphaMask::default());
        let mut element = pattern.whole();
        // All of the left column but its ends: the arch becomes a chord, from which a parabola is a quarter of its height away,
        // and the places along it which are as far up.
        for [vertex, into] in [[3, 0], [6, 0], [9, 0], [12, 0]] {
            let (_, merge) = element.merge(vertex, into).expect("it lies on the outline");
            element.take(&merge);
        }
        let moved: Vec<f64> = element.moved_m().map(|moved| moved[0]).collect();
        let off = |v: f64| 2.0 * (v - v * v);
        for (vertex, v) in [(3, 0.2), (6, 0.4), (9, 0.6), (12, 0.8)] {
            assert!((moved[vertex] - off(v)).abs() < 1e-5, "{vertex}: {} m", moved[vertex]);
        }
        assert!((element.error_m() - off(0.4)).abs() < 1e-5, "{}", element.error_m());
    }
}
