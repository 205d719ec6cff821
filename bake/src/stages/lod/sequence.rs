//! The order of simplification: edge collapses, removal of whole pieces (twigs) and of elements of aggregates, by one
//! cost in metres, until a mesh has few enough vertices.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;

use glam::{DVec3, Vec3};

use super::LodOptions;
use super::aggregate::{Aggregate, Loss};
use super::calibration::Calibration;
use super::collapse::Surface;
use super::fitting;
use super::flattening::Change;
use super::state::{NONE, State};

/// No step may cost more than this part of the mesh's diagonal.
const MAX_COST: f64 = 0.06;
/// Refused collapses are tried again whenever costs have grown by this factor.
const RETRY_GROWTH: f64 = 1.4;
/// Of a point with more corners than this only the edges are queued that the collapse gave to it; the others keep the
/// place that they had. Else a hub of n triangles would cost n² entries, and its collapses n³ steps in all.
const MAX_REQUEUED: usize = 1024;
/// A piece may take a level this far below its target.
const OVERSHOOT: usize = 4;

/// A mesh on its way down.
pub struct Sequence {
    pub state: State,
    aggregates: Vec<Aggregate>,
    calibration: Calibration,
    /// Greatest error so far, in metres.
    pub error_m: f64,
    surface: Surface,
    queue: BinaryHeap<Reverse<Entry>>,
    versions: Vec<u32>,
    /// Collapses that were refused and may be possible later.
    refused: Vec<(u32, u32, u32)>,
    retry_above_m: f64,
    max_cost_m: f64,
    surface_weight: f64,
    /// Pieces by falling cost, and those put off because they are too large for the level.
    pieces: Vec<(f64, u32)>,
    put_off: Vec<(f64, u32)>,
    unused: Vec<u32>,
}

enum Next {
    Edge,
    Piece,
    Loss(usize),
}

impl Sequence {
    /// The whole mesh.
    pub fn new(state: State, options: &LodOptions) -> Self {
        let surface = Surface::new(&state, options.placement);
        let bounds = bounds(&state);
        let aggregate = |part: usize| {
            let mask = options.masks.get(part).copied().unwrap_or_default();
            Aggregate::new(&state, part, options.aggregate_weight, &mask)
        };
        let aggregates: Vec<_> = (0..state.parts.len()).filter_map(aggregate).collect();
        let diagonal_m = (bounds[1] - bounds[0]).max(Vec3::ZERO).length();
        let calibration = Calibration::new(&state, &aggregates, bounds, options);
        let mut used = vec![false; state.vertices.len()];
        state.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
        for span in &state.parts {
            let (elements, each, _) = span.elements().unwrap_or_default();
            used[span.first_vertex as usize..][..(elements * each) as usize].fill(true);
        }
        let mut sequence = Self {
            versions: vec![0; surface.topology.positions.len()],
            unused: (0..used.len() as u32).filter(|&v| !used[v as usize]).collect(),
            pieces: pieces_by_cost(&surface, f64::from(options.piece_weight)),
            put_off: Vec::new(),
            queue: BinaryHeap::new(),
            refused: Vec::new(),
            retry_above_m: 0.0,
            surface_weight: f64::from(options.surface_weight),
            max_cost_m: MAX_COST * f64::from(diagonal_m),
            error_m: 0.0,
            aggregates,
            calibration,
            surface,
            state,
        };
        sequence.queue_all();
        sequence
    }

    /// For each part of the mesh, the living elements and their scale or, for surfaces, 0 and how far they grow, in
    /// metres, so that the mesh covers as much as it did.
    pub fn sizes(&mut self) -> Vec<(u32, f32)> {
        let sizes = self.calibration.sizes(&self.state, &self.aggregates);
        let mut parts = vec![(0, sizes.offset_m); self.state.parts.len()];
        for (aggregate, scale) in self.aggregates.iter().zip(sizes.scales) {
            parts[aggregate.part] = (aggregate.living() as u32, scale);
        }
        parts
    }

    /// Simplifies until at most `target` vertices live or nothing more can be removed. `watch` sees the number of
    /// vertices and the error after every step.
    pub fn reduce_to(&mut self, target: usize, mut watch: impl FnMut(usize, f64)) {
        self.pieces.append(&mut self.put_off);
        self.pieces.sort_by(|p, q| q.0.total_cmp(&p.0).then(q.1.cmp(&p.1)));
        self.retry();
        self.drop_unused(target);
        while self.state.vertex_count > target {
            let Some((next, cost_m)) = self.next().filter(|&(_, cost_m)| cost_m <= self.max_cost_m) else {
                break;
            };
            if cost_m > self.retry_above_m && !self.refused.is_empty() {
                self.retry_above_m = RETRY_GROWTH * cost_m;
                self.retry();
                continue;
            }
            match next {
                Next::Edge => self.collapse_next(),
                Next::Piece => self.drop_piece(target),
                Next::Loss(index) => self.lose(index, cost_m),
            }
            watch(self.state.vertex_count, self.error_m);
        }
    }

    /// Queues refused collapses again: what made them impossible may have been removed.
    fn retry(&mut self) {
        for (a, b, version) in std::mem::take(&mut self.refused) {
            if current_version(&self.versions, a, b) == version {
                self.queue_edge(a, b);
            }
        }
    }

    fn next(&self) -> Option<(Next, f64)> {
        let weighed = |bits| self.surface_weight * f64::from(f32::from_bits(bits));
        let edge = self.queue.peek().map(|&Reverse(entry)| (Next::Edge, weighed(unpacked(entry).0)));
        let piece = self.pieces.last().map(|&(cost, _)| (Next::Piece, cost));
        let elements = self.aggregates.iter().enumerate();
        let elements = elements.filter_map(|(index, part)| Some((Next::Loss(index), part.next_cost_m()?)));
        edge.into_iter().chain(piece).chain(elements).min_by(|p, q| p.1.total_cmp(&q.1))
    }

    fn queue_all(&mut self) {
        let mut entries = Vec::with_capacity(4 * self.versions.len());
        for a in 0..self.versions.len() as u32 {
            let forward = self.surface.candidates(&self.state, a).filter(|&(_, b)| a < b);
            entries.extend(forward.map(|(cost, b)| entry(&self.versions, cost, a, b)));
        }
        self.queue = BinaryHeap::from(entries);
    }

    fn queue_edge(&mut self, a: u32, b: u32) {
        if let Some(candidate) = self.surface.candidate(&self.state, a, b) {
            self.queue.push(entry(&self.versions, candidate.cost, a, b));
        }
    }

    fn collapse_next(&mut self) {
        let Some(Reverse(next)) = self.queue.pop() else { return };
        let (_, a, b, version) = unpacked(next);
        if current_version(&self.versions, a, b) != version {
            return;
        }
        let Some(candidate) = self.surface.candidate(&self.state, a, b) else { return };
        let Some(done) = self.surface.collapse(&mut self.state, [a, b], candidate.freedom) else {
            self.refused.push((a, b, version));
            return;
        };
        self.error_m = self.error_m.max(done.error_m);
        let removed = if done.point == a { b } else { a };
        self.versions[removed as usize] = self.versions[removed as usize].wrapping_add(1);
        if done.corners > MAX_REQUEUED {
            for other in self.surface.new_neighbours(&self.state, done.point) {
                self.queue_edge(done.point, other);
            }
            return;
        }
        let kept = &mut self.versions[done.point as usize];
        *kept = kept.wrapping_add(1);
        let found = self.surface.candidates(&self.state, done.point);
        self.queue.extend(found.map(|(cost, other)| entry(&self.versions, cost, done.point, other)));
    }

    fn drop_piece(&mut self, target: usize) {
        let Some((cost, index)) = self.pieces.pop() else { return };
        let piece = &self.surface.topology.pieces[index as usize];
        if piece.living_vertices > self.state.vertex_count - target + OVERSHOOT {
            self.put_off.push((cost, index));
            return;
        }
        let triangles = piece.triangles.clone();
        let shrunk = self.shrinking_piece(triangles.clone());
        for k in triangles {
            let t = self.surface.topology.piece_triangles[k];
            if !self.state.triangle_lives[t as usize] {
                continue;
            }
            self.state.remove_triangle(t);
            for v in self.state.triangles[t as usize] {
                let point = self.surface.topology.point_of[v as usize] as usize;
                self.versions[point] = self.versions[point].wrapping_add(1);
                if self.state.vertex_lives[v as usize] {
                    self.state.remove_vertex(v, NONE);
                    self.state.collapsed_to[v as usize] = shrunk(self.surface.topology.positions[point]);
                }
            }
        }
        self.state.log.finish_record();
        // Nothing hides a twig of a bare tree: it is missed for its length as well.
        let seen = if self.aggregates.is_empty() { cost.max(self.piece_size_m(index)) } else { cost };
        self.error_m = self.error_m.max(seen);
    }

    /// The side of a square as large as a piece looks from the side.
    fn piece_size_m(&self, index: u32) -> f64 {
        let piece = &self.surface.topology.pieces[index as usize];
        (piece.thickness_m * piece.extent_m).sqrt()
    }

    /// Where a point of a removed piece goes: to the nearest place of the line through the piece's middle along its
    /// longest extent.
    fn shrinking_piece(&self, triangles: Range<usize>) -> impl Fn(DVec3) -> [f32; 3] + use<> {
        let topology = &self.surface.topology;
        let living = triangles.map(|k| topology.piece_triangles[k] as usize);
        let corners = living.filter(|&t| self.state.triangle_lives[t]).flat_map(|t| self.state.triangles[t]);
        let points: Vec<DVec3> =
            corners.map(|v| topology.positions[topology.point_of[v as usize] as usize]).collect();
        let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
        let farthest = |from: DVec3| {
            let squared = |p: DVec3| p.distance_squared(from);
            points.iter().fold(from, |best, &p| if squared(p) > squared(best) { p } else { best })
        };
        let one_end = farthest(middle);
        let along = (farthest(one_end) - one_end).try_normalize().unwrap_or(DVec3::Y);
        let origin = topology.origin;
        move |point| (middle + along * (point - middle).dot(along) + origin).as_vec3().to_array()
    }

    /// Takes a vertex of an element of an aggregate, or an element.
    fn lose(&mut self, index: usize, cost_m: f64) {
        let aggregate = &mut self.aggregates[index];
        let Some(loss) = aggregate.take_next() else { return };
        let span = &self.state.parts[aggregate.part];
        match loss {
            Loss::Vertex { element, change: Change::Fit(triangle) } => {
                let span = span.clone();
                fitting::fit(&mut self.state, &span, element, triangle);
            }
            Loss::Vertex { element, change: Change::Merge(step) } => {
                let [ids, triangles] = span.element(element);
                let (vertex, triangle) = (ids.start as u32, triangles.start as u32);
                step.removed.iter().for_each(|t| self.state.remove_triangle(triangle + t));
                for corner in step.corners {
                    self.state.change_corner(3 * triangle + corner, vertex + step.into);
                }
                self.state.remove_vertex(vertex + step.vertex, vertex + step.into);
            }
            Loss::Element(element) => {
                let [vertices, triangles] = span.element(element);
                for t in triangles.filter(|&t| self.state.triangle_lives[t]).collect::<Vec<_>>() {
                    self.state.remove_triangle(t as u32);
                }
                for v in vertices.filter(|&v| self.state.vertex_lives[v]).collect::<Vec<_>>() {
                    self.state.remove_vertex(v as u32, NONE);
                }
            }
        }
        self.state.log.finish_record();
        self.error_m = self.error_m.max(cost_m);
    }

    /// Removes vertices that no triangle uses, one by one, before anything else.
    fn drop_unused(&mut self, target: usize) {
        while self.state.vertex_count > target {
            let Some(vertex) = self.unused.pop() else { break };
            self.state.remove_vertex(vertex, NONE);
            self.state.log.finish_record();
        }
    }
}

/// The version of an edge, which changes when the edge does: those of points only grow, so the sum stays the same only
/// if both do.
fn current_version(versions: &[u32], a: u32, b: u32) -> u32 {
    versions[a as usize].wrapping_add(versions[b as usize])
}

/// Cost, ends and version of an edge, the cost first: one number, for that is compared sooner than four.
type Entry = u128;

/// An entry of the queue.
fn entry(versions: &[u32], cost: f64, a: u32, b: u32) -> Reverse<Entry> {
    let parts = [(cost as f32).to_bits(), a, b, current_version(versions, a, b)];
    Reverse(parts.into_iter().fold(0, |entry, part| entry << 32 | Entry::from(part)))
}

fn unpacked(entry: Entry) -> (u32, u32, u32, u32) {
    ((entry >> 96) as u32, (entry >> 64) as u32, (entry >> 32) as u32, entry as u32)
}

fn bounds(state: &State) -> [Vec3; 2] {
    let points = state.vertices.iter().map(|vertex| Vec3::from_array(vertex.position));
    points.fold([Vec3::MAX, Vec3::MIN], |[low, high], p| [low.min(p), high.max(p)])
}

/// Pieces and the error in metres of their removal, the cheapest last. The largest piece stays.
fn pieces_by_cost(surface: &Surface, weight: f64) -> Vec<(f64, u32)> {
    let pieces = &surface.topology.pieces;
    let largest = (0..pieces.len()).max_by(|&p, &q| pieces[p].extent_m.total_cmp(&pieces[q].extent_m));
    let all = pieces.iter().enumerate().filter(|&(index, _)| Some(index) != largest);
    all.map(|(index, piece)| (weight * piece.thickness_m, index as u32)).collect()
}
