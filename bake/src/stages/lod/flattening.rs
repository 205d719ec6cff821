//! The elements of an aggregate → how their inner vertices go, for all elements alike: a bent card becomes a flat one,
//! whose picture hardly differs, before whole cards go.
//!
//! Half-edge collapses that leave the element's outline in texture space as it is. Their error is how far the place of a
//! removed vertex's texel moves, in metres, on average over the elements.

use glam::{Vec2, Vec3};

use super::state::{PartSpan, State};

/// Elements that errors are averaged over.
const SAMPLES: usize = 64;
/// The outline in texture space may change by this part of its area.
const AREA_TOLERANCE: f32 = 1e-3;

/// One vertex of every element merges into another; ids count from the element's first vertex or triangle.
#[derive(Clone, Debug)]
pub struct Step {
    pub vertex: u32,
    pub into: u32,
    /// How far texels have moved once this and all steps before are done, in metres.
    pub error_m: f64,
    /// Triangles that go.
    pub removed: Vec<u32>,
    /// Corners (3·triangle + 0…2) that get the other vertex.
    pub corners: Vec<u32>,
}

/// The steps that flatten a part's elements, in order.
pub fn plan(state: &State, span: &PartSpan) -> Vec<Step> {
    let Some((elements, vertices, _)) = span.elements().filter(|&(elements, ..)| elements > 0) else {
        return Vec::new();
    };
    let [ids, triangles] = span.element(0);
    let first = ids.start as u32;
    let mut element = Element {
        triangles: state.triangles[triangles].iter().map(|t| Some(t.map(|v| v - first))).collect(),
        uvs: state.vertices[ids].iter().map(|v| Vec2::from_array(v.uv)).collect(),
        samples: (0..elements)
            .step_by((elements as usize / SAMPLES).max(1))
            .map(|e| {
                let vertices = &state.vertices[span.element(e)[0].clone()];
                vertices.iter().map(|v| Vec3::from_array(v.position)).collect()
            })
            .collect(),
        gone: Vec::new(),
    };
    let area = element.area();
    let mut steps: Vec<Step> = Vec::new();
    // The first vertex stays: that it lives says that the element does.
    while let Some(mut step) = (1..vertices).filter_map(|v| element.best_step(v, area)).min_by(by_error) {
        step.error_m = steps.last().map_or(0.0, |last| last.error_m).max(step.error_m);
        element.take(&step);
        steps.push(step);
    }
    steps
}

fn by_error(p: &Step, q: &Step) -> std::cmp::Ordering {
    p.error_m.total_cmp(&q.error_m).then(p.vertex.cmp(&q.vertex))
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
    fn area(&self) -> f32 {
        self.triangles.iter().flatten().map(|t| self.signed_area(t).abs()).sum()
    }

    fn signed_area(&self, t: &[u32; 3]) -> f32 {
        let [a, b, c] = t.map(|v| self.uvs[v as usize]);
        0.5 * (b - a).perp_dot(c - a)
    }

    /// The neighbour that a vertex may best merge into.
    fn best_step(&self, vertex: u32, area: f32) -> Option<Step> {
        let around = self.triangles.iter().flatten().filter(|t| t.contains(&vertex));
        let mut others: Vec<u32> = around.flatten().copied().filter(|&v| v != vertex).collect();
        others.sort_unstable();
        others.dedup();
        others.into_iter().filter_map(|into| self.step(vertex, into, area)).min_by(by_error)
    }

    /// Merging one vertex into another, if no triangle turns over and the outline stays.
    fn step(&self, vertex: u32, into: u32, area: f32) -> Option<Step> {
        let mut step = Step { vertex, into, error_m: 0.0, removed: Vec::new(), corners: Vec::new() };
        let living = (0_u32..).zip(&self.triangles).filter_map(|(t, triangle)| Some((t, (*triangle)?)));
        for (t, triangle) in living {
            let Some(corner) = triangle.iter().position(|&v| v == vertex) else { continue };
            if triangle.contains(&into) {
                step.removed.push(t);
                continue;
            }
            let mut after = triangle;
            after[corner] = into;
            if self.signed_area(&after) * self.signed_area(&triangle) <= 0.0 {
                return None;
            }
            step.corners.push(3 * t + corner as u32);
        }
        let mut after = self.clone();
        after.take(&step);
        let keeps_outline = (after.area() - area).abs() <= AREA_TOLERANCE * area;
        step.error_m = if keeps_outline { after.error_m()? } else { return None };
        Some(step)
    }

    fn take(&mut self, step: &Step) {
        for &t in &step.removed {
            self.triangles[t as usize] = None;
        }
        for &corner in &step.corners {
            if let Some(triangle) = &mut self.triangles[corner as usize / 3] {
                triangle[corner as usize % 3] = step.into;
            }
        }
        self.gone.push(step.vertex);
    }

    /// The mean distance from where removed vertices were to where their texels now are, of the vertex that moved most.
    fn error_m(&self) -> Option<f64> {
        let mut worst = 0.0_f64;
        for &vertex in &self.gone {
            let (corners, weights) = self.texel(self.uvs[vertex as usize])?;
            let moved = |at: &Vec<Vec3>| {
                let now: Vec3 = corners.iter().zip(weights).map(|(&v, weight)| at[v as usize] * weight).sum();
                f64::from(now.distance(at[vertex as usize]))
            };
            worst = worst.max(self.samples.iter().map(moved).sum::<f64>() / self.samples.len() as f64);
        }
        Some(worst)
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
