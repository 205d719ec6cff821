//! The elements of an aggregate → how their inner vertices go, for all elements alike: a bent card becomes a flat one,
//! whose picture hardly differs, and that a triangle, before whole cards go.
//!
//! Half-edge collapses that leave the element's outline in texture space as it is. Their error is how far the place of a
//! removed vertex's texel moves, in metres, on average over the elements.

use glam::{Vec2, Vec3};

use super::fitting;
use super::log::Vertex;
use super::repair::repaired;
use super::state::{PartSpan, State};
use crate::model::{AlphaMask, Mesh};

/// Elements that errors are averaged over.
const SAMPLES: usize = 64;
/// The outline in texture space may change by this part of its area.
const AREA_TOLERANCE: f32 = 1e-3;
/// Cards whose vertices lie this far out of a plane on average, in metres, are flat.
const FLAT_M: f64 = 1e-3;

/// What is done to all elements, to each when it is its turn ([`errors_m`]).
#[derive(Clone, Debug)]
pub struct Step {
    /// How far the texels of one vertex have moved once this and all steps before are done, in metres on average over the elements:
    /// of that which moved most.
    error_m: f64,
    pub change: Change,
}

#[derive(Clone, Debug)]
pub enum Change {
    Merge(Merge),
    /// A flat card becomes a triangle with these texture coordinates.
    Fit([Vec2; 3]),
}

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

/// The steps that flatten a part's elements, whose texture leaves so much of them opaque, in order.
pub fn plan(state: &State, span: &PartSpan, mask: &AlphaMask) -> Vec<Step> {
    let Some((elements, vertices, _)) = span.elements().filter(|&(elements, ..)| elements > 0) else {
        return Vec::new();
    };
    let mut element = Element::new(state, span, (elements as usize / SAMPLES).max(1));
    let area = element.area();
    let mut steps: Vec<Step> = Vec::new();
    // The first vertex stays: that it lives says that the element does.
    while let Some((error_m, merge)) = (1..vertices).filter_map(|v| element.best(v, area)).min_by(by_error) {
        element.take(&merge);
        steps.push(Step { error_m, change: Change::Merge(merge) });
    }
    if let Some((error_m, triangle)) = element.fitted(state, span, mask) {
        steps.push(Step { error_m, change: Change::Fit(triangle) });
    }
    steps
}

/// For each element of a part how far its own texels have moved, in metres, once it has taken each of the steps: rows by steps,
/// none less than the one before.
pub fn errors_m(state: &State, span: &PartSpan, steps: &[Step]) -> Vec<Vec<f64>> {
    let Some((elements, ..)) = span.elements().filter(|&(elements, ..)| elements > 0) else {
        return Vec::new();
    };
    let mut element = Element::new(state, span, 1);
    let mut worst_m = vec![0.0_f64; elements as usize];
    let after = |step: &Step| {
        match &step.change {
            Change::Merge(merge) => {
                element.take(merge);
                let moved = element.gone.iter().filter_map(|&vertex| element.moved_m(vertex));
                moved.for_each(|moved| {
                    worst_m.iter_mut().zip(moved).for_each(|(worst, m)| *worst = worst.max(m))
                });
            }
            Change::Fit(_) => {
                let living = element.living();
                for (worst, e) in worst_m.iter_mut().zip(0..) {
                    *worst = worst
                        .max(fitting::error_m(&card(state, span, e, &living)).map_or(f64::MAX, f64::from));
                }
            }
        }
        worst_m.clone()
    };
    steps.iter().map(after).collect()
}

/// Those vertices of an element.
fn card(state: &State, span: &PartSpan, element: u32, living: &[usize]) -> Vec<Vertex> {
    let first = span.element(element)[0].start;
    living.iter().map(|v| state.vertices[first + v]).collect()
}

/// The same mesh with triangles in the place of flat cards: it shows nearly the same, and is drawn in less time.
pub fn fitted(mesh: &Mesh, masks: &[AlphaMask]) -> Mesh {
    let mut state = State::new(&repaired(mesh.clone()));
    for (part, mask) in masks.iter().enumerate().take(state.parts.len()) {
        let span = state.parts[part].clone();
        let [Step { error_m, change: Change::Fit(triangle) }] = plan(&state, &span, mask)[..] else {
            continue;
        };
        if error_m <= FLAT_M {
            let elements = span.elements().map_or(0, |(elements, ..)| elements);
            (0..elements).for_each(|element| fitting::fit(&mut state, &span, element, triangle));
        }
    }
    let unchanged: Vec<f32> =
        state.parts.iter().map(|span| f32::from(u8::from(span.elements().is_some()))).collect();
    state.to_mesh(&unchanged).0
}

fn by_error(p: &(f64, Merge), q: &(f64, Merge)) -> std::cmp::Ordering {
    p.0.total_cmp(&q.0).then(p.1.vertex.cmp(&q.1.vertex))
}

/// What all elements have in common, and where the vertices of some lie.
#[derive(Clone)]
struct Element {
    triangles: Vec<Option<[u32; 3]>>,
    uvs: Vec<Vec2>,
    samples: Vec<Vec<Vec3>>,
    gone: Vec<u32>,
}

impl Element {
    /// Of a part with elements, of which every nth is looked at.
    fn new(state: &State, span: &PartSpan, nth: usize) -> Self {
        let [ids, triangles] = span.element(0);
        let first = ids.start as u32;
        let elements = span.elements().map_or(0, |(elements, ..)| elements);
        let places = |e: u32| {
            let vertices = &state.vertices[span.element(e)[0].clone()];
            vertices.iter().map(|v| Vec3::from_array(v.position)).collect()
        };
        Self {
            triangles: state.triangles[triangles].iter().map(|t| Some(t.map(|v| v - first))).collect(),
            uvs: state.vertices[ids].iter().map(|v| Vec2::from_array(v.uv)).collect(),
            samples: (0..elements).step_by(nth).map(places).collect(),
            gone: Vec::new(),
        }
    }

    fn living(&self) -> Vec<usize> {
        (0..self.uvs.len()).filter(|&v| !self.gone.contains(&(v as u32))).collect()
    }

    fn area(&self) -> f32 {
        self.triangles.iter().flatten().map(|t| self.signed_area(t).abs()).sum()
    }

    fn signed_area(&self, t: &[u32; 3]) -> f32 {
        let [a, b, c] = t.map(|v| self.uvs[v as usize]);
        0.5 * (b - a).perp_dot(c - a)
    }

    /// The neighbour that a vertex may best merge into.
    fn best(&self, vertex: u32, area: f32) -> Option<(f64, Merge)> {
        let around = self.triangles.iter().flatten().filter(|t| t.contains(&vertex));
        let mut others: Vec<u32> = around.flatten().copied().filter(|&v| v != vertex).collect();
        others.sort_unstable();
        others.dedup();
        others.into_iter().filter_map(|into| self.merge(vertex, into, area)).min_by(by_error)
    }

    /// Merging one vertex into another, if no triangle turns over and the outline stays; with its error in metres.
    fn merge(&self, vertex: u32, into: u32, area: f32) -> Option<(f64, Merge)> {
        let mut merge = Merge { vertex, into, removed: Vec::new(), corners: Vec::new() };
        let living = (0_u32..).zip(&self.triangles).filter_map(|(t, triangle)| Some((t, (*triangle)?)));
        for (t, triangle) in living {
            let Some(corner) = triangle.iter().position(|&v| v == vertex) else { continue };
            if triangle.contains(&into) {
                merge.removed.push(t);
                continue;
            }
            let mut after = triangle;
            after[corner] = into;
            if self.signed_area(&after) * self.signed_area(&triangle) <= 0.0 {
                return None;
            }
            merge.corners.push(3 * t + corner as u32);
        }
        let mut after = self.clone();
        after.take(&merge);
        let keeps_outline = (after.area() - area).abs() <= AREA_TOLERANCE * area;
        if !keeps_outline {
            return None;
        }
        Some((after.error_m()?, merge))
    }

    fn take(&mut self, merge: &Merge) {
        for &t in &merge.removed {
            self.triangles[t as usize] = None;
        }
        for &corner in &merge.corners {
            if let Some(triangle) = &mut self.triangles[corner as usize / 3] {
                triangle[corner as usize % 3] = merge.into;
            }
        }
        self.gone.push(merge.vertex);
    }

    /// The triangle for elements that have become flat cards, and how far their vertices lie from it on average, in metres.
    fn fitted(&self, state: &State, span: &PartSpan, mask: &AlphaMask) -> Option<(f64, [Vec2; 3])> {
        let living = self.living();
        if living.len() != 4 || self.triangles.iter().flatten().count() != 2 {
            return None;
        }
        let triangle = fitting::triangle(mask)?;
        let (elements, ..) = span.elements()?;
        let step = (elements as usize / SAMPLES).max(1);
        let mut errors_m = Vec::new();
        for element in (0..elements).step_by(step) {
            errors_m.push(f64::from(fitting::error_m(&card(state, span, element, &living))?));
        }
        Some((errors_m.iter().sum::<f64>() / errors_m.len() as f64, triangle))
    }

    /// The mean distance from where removed vertices were to where their texels now are, of the vertex that moved most.
    fn error_m(&self) -> Option<f64> {
        let mean = |vertex: &u32| Some(self.moved_m(*vertex)?.sum::<f64>() / self.samples.len() as f64);
        self.gone.iter().map(mean).try_fold(0.0_f64, |worst, moved| Some(worst.max(moved?)))
    }

    /// How far a removed vertex's texel is from where the vertex was, in each sample.
    fn moved_m(&self, vertex: u32) -> Option<impl Iterator<Item = f64>> {
        let (corners, weights) = self.texel(self.uvs[vertex as usize])?;
        Some(self.samples.iter().map(move |at| {
            let now: Vec3 = corners.iter().zip(weights).map(|(&v, weight)| at[v as usize] * weight).sum();
            f64::from(now.distance(at[vertex as usize]))
        }))
    }

    /// The triangle with a point of the texture, and the point's barycentric coordinates.
    fn texel(&self, uv: Vec2) -> Option<([u32; 3], [f32; 3])> {
        let inside = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| self.uvs[v as usize]);
            let area = (b - a).perp_dot(c - a);
            let weights = [(b - uv).perp_dot(c - uv), (c - uv).perp_dot(a - uv), (a - uv).perp_dot(b - uv)];
            let weights = weights.map(|weight| weight / area);
            weights.iter().all(|weight| *weight >= -1e-4).then_some((*t, weights))
        };
        self.triangles.iter().flatten().find_map(inside)
    }
}
