//! The edges of a surface → what each one's collapse costs, and the collapse itself.
//!
//! Hoppe, "Progressive meshes" (1996), for vertices that share a position but not their attributes ("wedges"). Metres.

use glam::DVec3;

use super::Placement;
use super::edge::{Edge, EdgeTriangles};
use super::merge::merge;
use super::quadric::{Freedom, Quadrics};
use super::state::State;
use super::topology::{BOUNDARY, LOCKED, PointMap, PointSet, Topology, surface_triangles};

/// Error per metre of edge that orders collapses which cost nothing: short edges first.
const LENGTH_WEIGHT: f64 = 1e-3;
/// Factor on the cost of a collapse that can't respect a seam.
const SEAM_PENALTY: f64 = 3.0;
/// Weights of the planes that hold boundaries and seams in place, relative to the surface's own.
const BOUNDARY_WEIGHT: f64 = 2.0;
const SEAM_WEIGHT: f64 = 0.25;
/// Keeping the volume may make the error larger by this factor.
const VOLUME_SLACK: f64 = 1.2;

/// A possible collapse of the edge between two points.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// What orders collapses: the error in metres, and a little for length and for seams.
    pub cost: f64,
    /// Where the new vertex may lie.
    pub freedom: Freedom,
}

/// How far a collapse moved the surface, in metres.
pub struct Collapsed {
    pub error_m: f64,
    /// The point that stands for both.
    pub point: u32,
    /// How many corners it has, or a few less.
    pub corners: usize,
}

/// Surface parts with what it takes to collapse their edges.
pub struct Surface {
    pub topology: Topology,
    placement: Placement,
    quadrics: Quadrics,
    /// Scratch memory.
    seen: PointSet,
    slots: PointMap,
    stars: [Vec<u32>; 2],
    edges: Vec<(u32, EdgeTriangles)>,
}

impl Surface {
    /// Prepares all surface parts of a whole mesh.
    pub fn new(state: &State, placement: Placement) -> Self {
        let topology = Topology::new(state);
        let points = topology.positions.len();
        let mut surface = Self {
            topology,
            placement,
            quadrics: Quadrics::new(points),
            seen: PointSet::new(points),
            slots: PointMap::new(points),
            stars: Default::default(),
            edges: Vec::new(),
        };
        for t in surface_triangles(state) {
            let points = surface.topology.points_from(state, 3 * t as u32).map(|p| p as usize);
            surface.quadrics.add_triangle(points, points.map(|p| surface.topology.positions[p]));
        }
        surface.find_creases(state);
        surface
    }

    /// The collapse of edge (a, b), if there can be one.
    pub fn candidate(&mut self, state: &State, a: u32, b: u32) -> Option<Candidate> {
        self.topology.star(state, a, &mut self.stars[0]);
        self.judge(a, b, &EdgeTriangles::new(&self.topology, state, b, &self.stars[0]))
    }

    /// All collapses of a point's edges: what each costs, and the point at the edge's other end.
    pub fn candidates(&mut self, state: &State, point: u32) -> impl Iterator<Item = (f64, u32)> {
        self.topology.star(state, point, &mut self.stars[0]);
        EdgeTriangles::all(&self.topology, state, &self.stars[0], &mut self.slots, &mut self.edges);
        let surface: &Self = self;
        let judged = move |(b, triangles): &(u32, _)| Some((surface.judge(point, *b, triangles)?.cost, *b));
        surface.edges.iter().filter_map(judged)
    }

    /// The points at the other ends of the edges that the last collapse gave to `point`.
    pub fn new_neighbours(&mut self, state: &State, point: u32) -> Vec<u32> {
        self.seen.clear();
        self.seen.insert(point);
        let living = self.stars[1].iter().filter(|&&corner| state.triangle_lives[corner as usize / 3]);
        let points = living.flat_map(|&corner| self.topology.points_from(state, corner));
        points.filter(|&other| self.seen.insert(other)).collect()
    }

    /// The collapse of edge (a, b), which has these triangles.
    fn judge(&self, a: u32, b: u32, triangles: &EdgeTriangles) -> Option<Candidate> {
        let (freedom, penalty) = self.freedom(a, b, triangles)?;
        let ends = self.ends(a, b);
        let placed = self.quadrics.place(a as usize, b as usize, ends, freedom);
        let length = (ends[1] - ends[0]).length() * LENGTH_WEIGHT;
        let cost = (placed.error_m * placed.error_m + length * length).sqrt() * penalty;
        cost.is_finite().then_some(Candidate { cost, freedom })
    }

    /// Collapses edge (a, b) and logs how to undo it; `None` if that would tear or fold the surface.
    pub fn collapse(&mut self, state: &mut State, [a, b]: [u32; 2], freedom: Freedom) -> Option<Collapsed> {
        // The first point is kept: `a`, unless the new vertex lies at `b`.
        let (a, b, freedom) = if freedom == Freedom::End { (b, a, Freedom::Start) } else { (a, b, freedom) };
        let mut stars = std::mem::take(&mut self.stars);
        self.topology.star(state, a, &mut stars[0]);
        self.topology.star(state, b, &mut stars[1]);
        let triangles = EdgeTriangles::new(&self.topology, state, b, &stars[0]);
        let edge = Edge { points: [a, b], ends: self.ends(a, b), stars, triangles };
        let mut done = None;
        if edge.link_holds(&self.topology, state, &mut self.seen)
            && let Some((along, at)) = self.place(state, &edge, freedom)
        {
            let error_m = self.quadrics.error_m(a as usize, b as usize, at);
            merge(&mut self.topology, state, &edge, along as f32, at);
            self.quadrics.merge(a as usize, b as usize);
            let corners = edge.stars[0].len() + edge.stars[1].len();
            done = Some(Collapsed { error_m, point: a, corners });
        }
        self.stars = edge.stars;
        done
    }

    fn ends(&self, a: u32, b: u32) -> [DVec3; 2] {
        [a, b].map(|point| self.topology.positions[point as usize])
    }

    /// Flags boundaries and what is no surface, and holds boundaries and seams in place.
    fn find_creases(&mut self, state: &State) {
        let (mut star, mut edges) = (Vec::new(), Vec::new());
        for a in 0..self.topology.positions.len() as u32 {
            self.topology.star(state, a, &mut star);
            EdgeTriangles::all(&self.topology, state, &star, &mut self.slots, &mut edges);
            let mut boundaries = 0;
            for (b, triangles) in &edges {
                let b = *b;
                boundaries += usize::from(triangles.count == 1);
                let flag = [LOCKED, BOUNDARY, 0, LOCKED][triangles.count.min(3)];
                self.topology.flags[a as usize] |= flag;
                self.topology.flags[b as usize] |= flag;
                if a < b {
                    self.constrain(state, a, b, triangles);
                }
            }
            // One fan has none or two boundary edges and visits each neighbour once.
            let one_fan = star.len() + usize::from(boundaries > 0) == edges.len();
            if boundaries > 2 || !one_fan || !self.topology.is_one_fan(state, a, &star) {
                self.topology.flags[a as usize] |= LOCKED;
            }
        }
    }

    fn constrain(&mut self, state: &State, a: u32, b: u32, triangles: &EdgeTriangles) {
        if triangles.count != 1 && !triangles.is_seam() {
            return;
        }
        let weight = if triangles.is_seam() { SEAM_WEIGHT } else { BOUNDARY_WEIGHT };
        let ends = self.ends(a, b);
        for &corner in &triangles.opposite[..triangles.count] {
            let apex = self.topology.positions[self.topology.point_at(state, corner) as usize];
            let edge = ends[1] - ends[0];
            if let Some(across) = edge.cross(apex - ends[0]).cross(edge).try_normalize() {
                self.quadrics.add_crease([a as usize, b as usize], ends, across, weight);
            }
        }
    }

    /// Which ends may move, and the factor on the cost; `None` if the edge may not collapse at all.
    fn freedom(&self, a: u32, b: u32, triangles: &EdgeTriangles) -> Option<(Freedom, f64)> {
        if !(1..=2).contains(&triangles.count) {
            return None;
        }
        let topology = &self.topology;
        let flags = |p: u32| topology.flags[p as usize];
        let moves = |p: u32| flags(p) & LOCKED == 0 && (flags(p) & BOUNDARY == 0 || triangles.count == 1);
        let whole_a = triangles.vertices_at(|pair| pair.0) == topology.wedges[a as usize];
        let whole_b = triangles.vertices_at(|pair| pair.1) == topology.wedges[b as usize];
        let choose = |a_moves: bool, b_moves: bool| match (a_moves, b_moves) {
            (true, true) => Some(Freedom::Edge),
            (true, false) => Some(Freedom::End),
            (false, true) => Some(Freedom::Start),
            (false, false) => None,
        };
        if let Some(within_seams) = choose(moves(a) && whole_a, moves(b) && whole_b) {
            return Some((within_seams, 1.0));
        }
        let across_seams = choose(moves(a), moves(b))?;
        Some((if across_seams == Freedom::Edge { Freedom::Start } else { across_seams }, SEAM_PENALTY))
    }

    /// Where the new vertex goes: with the volume kept if that is wanted and folds nothing (Lindstrom and Turk 1998), else
    /// on the edge, else nowhere.
    fn place(&self, state: &State, edge: &Edge, freedom: Freedom) -> Option<(f64, DVec3)> {
        let topology = &self.topology;
        let ([a, b], ends) = (edge.points.map(|p| p as usize), edge.ends);
        let along = self.quadrics.place(a, b, ends, freedom).along;
        let on_edge = if along == 0.0 { ends[0] } else { ends[0] + (ends[1] - ends[0]) * along };
        let open = (topology.flags[a] | topology.flags[b]) & BOUNDARY != 0;
        if self.placement == Placement::Volume && freedom == Freedom::Edge && !open {
            let at = edge.keep_volume(topology, state, on_edge);
            let [moved, still] = [at, on_edge].map(|x| self.quadrics.error_m(a, b, x));
            let near = moved <= VOLUME_SLACK * still + LENGTH_WEIGHT * edge.length();
            if at != on_edge && near && edge.keeps_facing(topology, state, at) {
                return Some((along, at));
            }
        }
        edge.keeps_facing(topology, state, on_edge).then_some((along, on_edge))
    }
}
