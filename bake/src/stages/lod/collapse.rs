//! One edge of a surface: what its collapse costs, whether it may collapse, and the collapse itself.
//!
//! Hoppe, "Progressive meshes" (1996), for vertices that share a position but not their attributes ("wedges"):
//! both sides of a texture seam or crease merge in one collapse, each with its own attributes interpolated along the
//! edge. A wedge that the edge doesn't touch keeps its attributes, and so its point keeps its place. The link
//! condition (Dey et al. 1999) keeps the topology, a fold-over check the orientation. Metres.

use glam::DVec3;

use super::Placement;
use super::quadric::{Freedom, Metric};
use super::state::{Log, NONE, State, Vertex};
use super::topology::{BOUNDARY, LOCKED, Topology, surface_triangles};

/// Error per metre of edge that orders collapses which cost nothing: short edges first.
const LENGTH_WEIGHT: f64 = 1e-3;
/// Factor on the cost of a collapse that can't respect a seam.
const SEAM_PENALTY: f64 = 3.0;
/// Weights of the planes that hold boundaries and seams in place, relative to the surface's own.
const BOUNDARY_WEIGHT: f64 = 2.0;
const SEAM_WEIGHT: f64 = 0.25;
/// Keeping the volume may make the error so much larger.
const VOLUME_SLACK: f64 = 1.2;
/// A triangle may not turn further than this: cosine.
const LEAST_COSINE: f64 = 0.15;

/// A possible collapse of the edge between two points.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// What orders collapses: the error in metres, and a little for length and for seams.
    pub cost: f64,
    freedom: Freedom,
}

/// How far a collapse moved the surface, in metres.
pub struct Collapsed {
    pub error_m: f64,
    /// The point that stands for both.
    pub point: u32,
}

/// Surface parts with what it takes to collapse their edges.
pub struct Surface<M> {
    pub topology: Topology,
    metric: M,
    placement: Placement,
    stamps: Vec<u32>,
    stamp: u32,
    star_a: Vec<u32>,
    star_b: Vec<u32>,
    wedges: Vec<u32>,
}

/// What the triangles at an edge say about it.
#[derive(Clone, Copy, Default)]
struct EdgeView {
    triangles: usize,
    /// Vertices at its two ends, a pair for each triangle, and the corners opposite.
    pairs: [(u32, u32); 2],
    opposite: [u32; 2],
}

impl EdgeView {
    fn touched(&self, end: impl Fn((u32, u32)) -> u32) -> u32 {
        match self.triangles {
            1 => 1,
            _ => 1 + u32::from(end(self.pairs[0]) != end(self.pairs[1])),
        }
    }
}

impl<M: Metric> Surface<M> {
    /// Prepares all surface parts of a whole mesh.
    pub fn new(state: &State, metric: M, placement: Placement) -> Self {
        let topology = Topology::new(state);
        let points = topology.positions.len();
        let mut surface = Self {
            topology,
            metric,
            placement,
            stamps: vec![0; points],
            stamp: 0,
            star_a: Vec::new(),
            star_b: Vec::new(),
            wedges: Vec::new(),
        };
        surface.metric.reset(points);
        for t in surface_triangles(state) {
            let points = surface.topology.points_from(state, 3 * t as u32).map(|p| p as usize);
            surface.metric.add_triangle(points, points.map(|p| surface.topology.positions[p]));
        }
        surface.find_creases(state);
        surface
    }

    /// The collapse of edge (a, b), if there can be one.
    pub fn candidate(&mut self, state: &State, a: u32, b: u32) -> Option<Candidate> {
        let mut star = std::mem::take(&mut self.star_a);
        self.topology.star(state, a, &mut star);
        let candidate = self.judge(state, a, b, &star);
        self.star_a = star;
        candidate
    }

    /// All collapses of a point's edges: what each costs, and the point at the edge's other end.
    pub fn candidates(&mut self, state: &State, point: u32, found: &mut Vec<(f64, u32)>) {
        let (mut star, mut ring) = (std::mem::take(&mut self.star_a), std::mem::take(&mut self.wedges));
        self.topology.star(state, point, &mut star);
        self.ring(state, point, &star, &mut ring);
        found.clear();
        for &other in &ring {
            if let Some(candidate) = self.judge(state, point, other, &star) {
                found.push((candidate.cost, other));
            }
        }
        (self.star_a, self.wedges) = (star, ring);
    }

    fn judge(&self, state: &State, a: u32, b: u32, star_a: &[u32]) -> Option<Candidate> {
        let view = self.view(state, b, star_a);
        let (freedom, penalty) = self.freedom(a, b, &view)?;
        let ends = [self.topology.positions[a as usize], self.topology.positions[b as usize]];
        let placed = self.metric.place(a as usize, b as usize, ends, freedom);
        let length = (ends[1] - ends[0]).length() * LENGTH_WEIGHT;
        let cost = (placed.error_m * placed.error_m + length * length).sqrt() * penalty;
        cost.is_finite().then_some(Candidate { cost, freedom })
    }

    /// Collapses edge (a, b) and writes down how to undo it; `None` if that would tear or fold the surface.
    pub fn collapse(
        &mut self,
        state: &mut State,
        log: &mut Log,
        dead: &mut Dead<'_>,
        [a, b]: [u32; 2],
        candidate: Candidate,
    ) -> Option<Collapsed> {
        // What stays in place is kept; so `a` does unless the new vertex lies at `b`.
        let (a, b, freedom) = match candidate.freedom {
            Freedom::End => (b, a, Freedom::Start),
            other => (a, b, other),
        };
        let (mut star_a, mut star_b) = (std::mem::take(&mut self.star_a), std::mem::take(&mut self.star_b));
        self.topology.star(state, a, &mut star_a);
        self.topology.star(state, b, &mut star_b);
        let view = self.view(state, b, &star_a);
        let mut done = None;
        if self.link_holds(state, a, b, &star_a, &star_b, &view)
            && let Some((along, at)) = self.place(state, a, b, freedom, &star_a, &star_b)
        {
            let error_m = self.metric.error_m(a as usize, b as usize, at);
            let step = Step { a, b, along: along as f32, at, view };
            self.apply(state, log, dead, &step, &star_a, &star_b);
            self.metric.merge(a as usize, b as usize);
            done = Some(Collapsed { error_m, point: a });
        }
        (self.star_a, self.star_b) = (star_a, star_b);
        done
    }

    fn find_creases(&mut self, state: &State) {
        let (mut star, mut ring) = (Vec::new(), Vec::new());
        for a in 0..self.topology.positions.len() as u32 {
            self.topology.star(state, a, &mut star);
            self.ring(state, a, &star, &mut ring);
            let mut boundaries = 0;
            for &b in &ring {
                let view = self.view(state, b, &star);
                boundaries += usize::from(view.triangles == 1);
                self.flag_edge(a, b, &view);
                if a < b {
                    self.constrain(state, a, b, &view);
                }
            }
            // One fan has none or two boundary edges and visits each neighbour once.
            let one_fan = star.len() + usize::from(boundaries > 0) == ring.len();
            if boundaries > 2 || !one_fan || !self.is_one_fan(state, a, &star) {
                self.topology.flags[a as usize] |= LOCKED;
            }
        }
    }

    /// Whether the triangles around a point hang together by edges; stars of over 64 triangles count as torn.
    fn is_one_fan(&self, state: &State, point: u32, star: &[u32]) -> bool {
        if star.len() > 64 {
            return false;
        }
        let (all, mut reached) = (u64::MAX >> (64 - star.len().max(1)), 1_u64);
        let mut front = reached;
        while front != 0 {
            let index = front.trailing_zeros() as usize;
            front &= front - 1;
            let [_, p, q] = self.topology.points_from(state, star[index]);
            for (other, &corner) in star.iter().enumerate() {
                let seen = reached >> other & 1 == 1;
                let [_, r, s] = self.topology.points_from(state, corner);
                if !seen && [p, q].iter().any(|&end| end != point && (end == r || end == s)) {
                    reached |= 1 << other;
                    front |= 1 << other;
                }
            }
        }
        reached == all
    }

    fn flag_edge(&mut self, a: u32, b: u32, view: &EdgeView) {
        let flag = match view.triangles {
            1 => BOUNDARY,
            2 => 0,
            _ => LOCKED,
        };
        for point in [a, b] {
            self.topology.flags[point as usize] |= flag;
        }
    }

    fn constrain(&mut self, state: &State, a: u32, b: u32, view: &EdgeView) {
        let seam = view.triangles == 2 && view.pairs[0] != view.pairs[1];
        if view.triangles != 1 && !seam {
            return;
        }
        let weight = if seam { SEAM_WEIGHT } else { BOUNDARY_WEIGHT };
        let positions = &self.topology.positions;
        let ends = [positions[a as usize], positions[b as usize]];
        for &corner in &view.opposite[..view.triangles] {
            let apex = positions[self.topology.point_at(state, corner) as usize];
            let edge = ends[1] - ends[0];
            let across = edge.cross(apex - ends[0]).cross(edge);
            if let Some(across) = across.try_normalize() {
                self.metric.add_crease([a as usize, b as usize], ends, across, weight);
            }
        }
    }

    fn next_stamp(&mut self) -> u32 {
        self.stamp += 1;
        self.stamp
    }

    fn ring(&mut self, state: &State, point: u32, star: &[u32], found: &mut Vec<u32>) {
        let stamp = self.next_stamp();
        self.stamps[point as usize] = stamp;
        found.clear();
        for &corner in star {
            for other in self.topology.points_from(state, corner) {
                if self.stamps[other as usize] != stamp {
                    self.stamps[other as usize] = stamp;
                    found.push(other);
                }
            }
        }
    }

    fn view(&self, state: &State, b: u32, star_a: &[u32]) -> EdgeView {
        let mut view = EdgeView::default();
        for &corner in star_a {
            let (t, k) = (corner as usize / 3, corner as usize % 3);
            let triangle = state.triangles[t];
            for (other, opposite) in [((k + 1) % 3, (k + 2) % 3), ((k + 2) % 3, (k + 1) % 3)] {
                if self.topology.point_of[triangle[other] as usize] != b {
                    continue;
                }
                if view.triangles < 2 {
                    view.pairs[view.triangles] = (triangle[k], triangle[other]);
                    view.opposite[view.triangles] = (3 * t + opposite) as u32;
                }
                view.triangles += 1;
            }
        }
        view
    }

    /// Which ends may move, and the factor on the cost; `None` if the edge may not collapse at all.
    fn freedom(&self, a: u32, b: u32, view: &EdgeView) -> Option<(Freedom, f64)> {
        if !(1..=2).contains(&view.triangles) {
            return None;
        }
        let flags = |p: u32| self.topology.flags[p as usize];
        let moves = |p: u32| flags(p) & LOCKED == 0 && (flags(p) & BOUNDARY == 0 || view.triangles == 1);
        let whole_a = view.touched(|pair| pair.0) == self.topology.wedges[a as usize];
        let whole_b = view.touched(|pair| pair.1) == self.topology.wedges[b as usize];
        let choose = |a_moves: bool, b_moves: bool| match (a_moves, b_moves) {
            (true, true) => Some(Freedom::Edge),
            (true, false) => Some(Freedom::End),
            (false, true) => Some(Freedom::Start),
            (false, false) => None,
        };
        let within_seams = choose(moves(a) && whole_a, moves(b) && whole_b);
        let across_seams = || match choose(moves(a), moves(b)) {
            Some(Freedom::Edge) => Some(Freedom::Start),
            other => other,
        };
        within_seams.map(|freedom| (freedom, 1.0)).or_else(|| Some((across_seams()?, SEAM_PENALTY)))
    }

    /// The two ends share no neighbours but those opposite the edge, and something is left of the surface.
    fn link_holds(
        &mut self,
        state: &State,
        a: u32,
        b: u32,
        star_a: &[u32],
        star_b: &[u32],
        view: &EdgeView,
    ) -> bool {
        let stamp = self.next_stamp();
        for &corner in star_a {
            for point in self.topology.points_from(state, corner) {
                self.stamps[point as usize] = stamp;
            }
        }
        let opposite = &view.opposite[..view.triangles.min(2)];
        let apex = |p: u32| opposite.iter().any(|&corner| self.topology.point_at(state, corner) == p);
        let mut remains = star_a.len() > view.triangles;
        for &corner in star_b {
            let [_, p, q] = self.topology.points_from(state, corner);
            if p == a || q == a {
                continue;
            }
            remains = true;
            let shared = [p, q].map(|point| self.stamps[point as usize] == stamp);
            if (shared[0] && !apex(p)) || (shared[1] && !apex(q)) || (shared[0] && shared[1]) {
                return false;
            }
        }
        // On a closed piece no triangle may join `a` to both opposite points either: the last tetrahedron.
        remains
            && !star_a.iter().any(|&corner| {
                let [_, p, q] = self.topology.points_from(state, corner);
                p != b && q != b && view.triangles == 2 && apex(p) && apex(q)
            })
    }

    /// Where the new vertex goes: with the volume kept if that folds nothing, else on the edge, else nowhere.
    fn place(
        &self,
        state: &State,
        a: u32,
        b: u32,
        freedom: Freedom,
        star_a: &[u32],
        star_b: &[u32],
    ) -> Option<(f64, DVec3)> {
        let ends = [a, b].map(|p| self.topology.positions[p as usize]);
        let along = self.metric.place(a as usize, b as usize, ends, freedom).along;
        let on_edge = if along == 0.0 { ends[0] } else { ends[0] + (ends[1] - ends[0]) * along };
        let open = (self.topology.flags[a as usize] | self.topology.flags[b as usize]) & BOUNDARY != 0;
        if self.placement == Placement::Volume && freedom == Freedom::Edge && !open {
            let at = self.keep_volume(state, on_edge, ends, a, star_a, star_b);
            let [moved, still] = [at, on_edge].map(|x| self.metric.error_m(a as usize, b as usize, x));
            let near = moved <= VOLUME_SLACK * still + LENGTH_WEIGHT * (ends[1] - ends[0]).length();
            if at != on_edge && near && self.keeps_facing(state, [a, b], at, star_a, star_b) {
                return Some((along, at));
            }
        }
        self.keeps_facing(state, [a, b], on_edge, star_a, star_b).then_some((along, on_edge))
    }

    /// Moves a point along the mean normal of both stars until their volume is as before, but not far.
    fn keep_volume(
        &self,
        state: &State,
        on_edge: DVec3,
        ends: [DVec3; 2],
        a: u32,
        star_a: &[u32],
        star_b: &[u32],
    ) -> DVec3 {
        let (mut normal, mut volume) = (DVec3::ZERO, 0.0);
        let of_b = star_b.iter().filter(|&&corner| {
            let [_, p, q] = self.topology.points_from(state, corner);
            p != a && q != a
        });
        for &corner in star_a.iter().chain(of_b) {
            let points = self.topology.points_from(state, corner);
            // Relative to the edge, for the sake of precision.
            let [p, q, r] = points.map(|p| self.topology.positions[p as usize] - on_edge);
            normal += (q - p).cross(r - p);
            volume += p.dot(q.cross(r));
        }
        let steep = normal.length_squared();
        if steep == 0.0 {
            return on_edge;
        }
        let offset = normal * (volume / steep);
        let most = 0.5 * (ends[1] - ends[0]).length();
        let at = on_edge + offset * (most / offset.length().max(most).max(f64::MIN_POSITIVE));
        if at.is_finite() { at } else { on_edge }
    }

    fn keeps_facing(
        &self,
        state: &State,
        [a, b]: [u32; 2],
        at: DVec3,
        star_a: &[u32],
        star_b: &[u32],
    ) -> bool {
        let keeps = |&corner: &u32, partner: u32| {
            let points = self.topology.points_from(state, corner);
            if points[1] == partner || points[2] == partner {
                return true;
            }
            let [p, q, r] = points.map(|p| self.topology.positions[p as usize]);
            let (before, after) = ((q - p).cross(r - p), (q - at).cross(r - at));
            before.dot(after) >= LEAST_COSINE * (before.length_squared() * after.length_squared()).sqrt()
        };
        star_a.iter().all(|corner| keeps(corner, b)) && star_b.iter().all(|corner| keeps(corner, a))
    }

    /// Changes the mesh.
    fn apply(
        &mut self,
        state: &mut State,
        log: &mut Log,
        dead: &mut Dead<'_>,
        step: &Step,
        star_a: &[u32],
        star_b: &[u32],
    ) {
        let before = log.born.len();
        let mut merges = [(NONE, NONE); 2];
        merges[0] = step.view.pairs[0];
        if step.view.triangles == 2 {
            let (wa, wb) = step.view.pairs[1];
            if wb != merges[0].1 && wa != merges[0].0 {
                merges[1] = (wa, wb);
            }
        }
        let into =
            |wb: u32| merges.iter().find(|pair| pair.1 == wb && wb != NONE).map_or(NONE, |pair| pair.0);

        let mut wedges = std::mem::take(&mut self.wedges);
        wedges.clear();
        let note = |wedges: &mut Vec<u32>, vertex: u32| {
            if !wedges.contains(&vertex) {
                wedges.push(vertex);
            }
        };
        let vertex_at =
            |state: &State, corner: u32| state.triangles[corner as usize / 3][corner as usize % 3];
        star_a.iter().chain(star_b).for_each(|&corner| note(&mut wedges, vertex_at(state, corner)));

        let piece = self.topology.piece_of[step.a as usize] as usize;
        let mut apexes = [NONE; 2];
        for (apex, &corner) in apexes.iter_mut().zip(&step.view.opposite).take(step.view.triangles) {
            *apex = vertex_at(state, corner);
            let t = corner / 3;
            log.triangles.push((t, state.triangles[t as usize]));
            state.triangle_lives[t as usize] = false;
            for vertex in state.triangles[t as usize] {
                self.topology.uses[vertex as usize] -= 1;
            }
        }
        self.topology.pieces[piece].living_triangles -= step.view.triangles;
        for &corner in star_b.iter().filter(|&&c| state.triangle_lives[c as usize / 3]) {
            let wb = vertex_at(state, corner);
            let wa = into(wb);
            if wa != NONE {
                log.corners.push((corner, wb));
                state.triangles[corner as usize / 3][corner as usize % 3] = wa;
                self.topology.uses[wb as usize] -= 1;
                self.topology.uses[wa as usize] += 1;
            }
        }
        self.settle_wedges(state, log, dead, step, &wedges, &merges);
        for apex in apexes.into_iter().filter(|&apex| apex != NONE) {
            if self.topology.uses[apex as usize] == 0 && state.vertex_lives[apex as usize] {
                let point = self.topology.point_of[apex as usize];
                self.topology.wedges[point as usize] -= 1;
                dead.lay(state, log, apex, NONE);
            }
        }
        self.wedges = wedges;
        self.topology.join(step.a, step.b);
        self.topology.flags[step.a as usize] |= self.topology.flags[step.b as usize];
        let gone = log.born.len() - before;
        self.topology.pieces[piece].living_vertices -= gone;
        log.finish_record();
    }

    fn settle_wedges(
        &mut self,
        state: &mut State,
        log: &mut Log,
        dead: &mut Dead<'_>,
        step: &Step,
        wedges: &[u32],
        merges: &[(u32, u32); 2],
    ) {
        let exact = step.at + self.topology.origin;
        let kept_place = step.at == self.topology.positions[step.a as usize];
        let keeper = wedges.iter().copied().find(|&w| self.topology.uses[w as usize] > 0).unwrap_or(NONE);
        let position = match kept_place {
            true => state.vertices[step.view.pairs[0].0 as usize].position,
            false => exact.to_array().map(|x| x as f32),
        };
        let originals = [0, 1].map(|k| {
            let (wa, wb) = step.view.pairs[k.min(step.view.triangles - 1)];
            [wa, wb].map(|w| (w, state.vertices[w as usize]))
        });
        let mut living = 0;
        for &wedge in wedges {
            let merged = merges.iter().find(|pair| pair.1 == wedge).map(|pair| pair.0);
            if let Some(wa) = merged {
                let heir = if self.topology.uses[wa as usize] > 0 { wa } else { keeper };
                dead.lay(state, log, wedge, heir);
                continue;
            }
            if self.topology.uses[wedge as usize] == 0 {
                dead.lay(state, log, wedge, keeper);
                continue;
            }
            living += 1;
            self.topology.point_of[wedge as usize] = step.a;
            let touched = originals.iter().find(|ends| ends[0].0 == wedge || ends[1].0 == wedge);
            let before = state.vertices[wedge as usize];
            let mut after = match touched {
                Some([(_, va), (_, vb)]) => between(va, vb, step.along),
                None => before,
            };
            after.position = position;
            if !after.same_bits(&before) {
                log.restored.push((wedge, before));
                state.vertices[wedge as usize] = after;
            }
        }
        self.topology.wedges[step.a as usize] = living;
        if !kept_place {
            let rounded = DVec3::from_array(position.map(f64::from));
            self.topology.positions[step.a as usize] = rounded - self.topology.origin;
        }
    }
}

/// One collapse, decided.
struct Step {
    a: u32,
    b: u32,
    along: f32,
    at: DVec3,
    view: EdgeView,
}

/// Where vertices go that are gone: into another vertex, or to a place.
pub struct Dead<'a> {
    /// Vertex that each merged into; `NONE` while it lives or if it went with its piece.
    pub heirs: &'a mut [u32],
    /// Place that each shrank to if it has no heir.
    pub graves: &'a mut [[f32; 3]],
}

impl Dead<'_> {
    /// Takes a vertex away.
    pub fn lay(&mut self, state: &mut State, log: &mut Log, vertex: u32, heir: u32) {
        let was = state.vertices[vertex as usize];
        log.born.push((vertex, heir, was));
        state.vertex_lives[vertex as usize] = false;
        state.vertex_count -= 1;
        self.heirs[vertex as usize] = heir;
        self.graves[vertex as usize] = was.position;
    }
}

/// Attributes part of the way along an edge; normals of unit length.
fn between(a: &Vertex, b: &Vertex, along: f32) -> Vertex {
    if along == 0.0 {
        return *a;
    }
    if along == 1.0 {
        return *b;
    }
    let mix = |a: f32, b: f32| a + (b - a) * along;
    let normal: [f32; 3] = std::array::from_fn(|k| mix(a.normal[k], b.normal[k]));
    let length = (normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]).sqrt();
    Vertex {
        position: a.position,
        normal: if length > 1e-6 { normal.map(|n| n / length) } else { a.normal },
        uv: std::array::from_fn(|k| mix(a.uv[k], b.uv[k])),
        color: std::array::from_fn(|k| (mix(a.color[k].into(), b.color[k].into()) + 0.5) as u8),
    }
}
