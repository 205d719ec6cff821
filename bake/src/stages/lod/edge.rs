//! One edge of a surface: the triangles around it, whether it may collapse, and where its new vertex keeps the volume.
//!
//! The link condition (Dey et al. 1999) keeps the topology, a fold-over check the orientation. Metres.

use glam::DVec3;

use super::state::State;
use super::topology::{PointMap, PointSet, Topology};

/// Cosine of the greatest angle that a collapse may turn a triangle by.
const MIN_COSINE: f64 = 0.15;

/// The triangles that have an edge.
#[derive(Clone, Copy, Default)]
pub struct EdgeTriangles {
    pub count: usize,
    /// Vertices at the edge's two ends in the first two triangles.
    pub vertices: [(u32, u32); 2],
    /// Corners opposite the edge in the first two triangles.
    pub opposite: [u32; 2],
}

impl EdgeTriangles {
    /// Those of the edge from a point with the corners `star` to point `b`.
    pub fn new(topology: &Topology, state: &State, b: u32, star: &[u32]) -> Self {
        let mut found = Self::default();
        for &corner in star {
            let (t, k) = (corner as usize / 3, corner as usize % 3);
            let triangle = state.triangles[t];
            for (other, opposite) in [((k + 1) % 3, (k + 2) % 3), ((k + 2) % 3, (k + 1) % 3)] {
                if topology.point_of[triangle[other] as usize] != b {
                    continue;
                }
                found.add((triangle[k], triangle[other]), (3 * t + opposite) as u32);
            }
        }
        found
    }

    /// Those of all edges from a point with the corners `star`, each with the point at its other end, in the order in
    /// which the star names these: what [`EdgeTriangles::new`] finds, in one pass.
    pub fn all(
        topology: &Topology,
        state: &State,
        star: &[u32],
        slots: &mut PointMap,
        found: &mut Vec<(u32, Self)>,
    ) {
        slots.clear();
        found.clear();
        for &corner in star {
            let (t, k) = (corner as usize / 3, corner as usize % 3);
            let triangle = state.triangles[t];
            let point = topology.point_of[triangle[k] as usize];
            for (other, opposite) in [((k + 1) % 3, (k + 2) % 3), ((k + 2) % 3, (k + 1) % 3)] {
                let end = topology.point_of[triangle[other] as usize];
                if end == point {
                    continue;
                }
                let slot = slots.get_or_insert(end, found.len() as u32) as usize;
                if slot == found.len() {
                    found.push((end, Self::default()));
                }
                found[slot].1.add((triangle[k], triangle[other]), (3 * t + opposite) as u32);
            }
        }
    }

    fn add(&mut self, ends: (u32, u32), opposite: u32) {
        if self.count < 2 {
            self.vertices[self.count] = ends;
            self.opposite[self.count] = opposite;
        }
        self.count += 1;
    }

    /// Whether attributes are discontinuous across the edge.
    pub fn is_seam(&self) -> bool {
        self.count == 2 && self.vertices[0] != self.vertices[1]
    }

    /// How many vertices the triangles have at one end.
    pub fn vertices_at(&self, end: impl Fn((u32, u32)) -> u32) -> u32 {
        1 + u32::from(self.count != 1 && end(self.vertices[0]) != end(self.vertices[1]))
    }
}

/// An edge about to collapse.
pub struct Edge {
    pub points: [u32; 2],
    /// Where these lie, relative to [`Topology::origin`].
    pub ends: [DVec3; 2],
    /// The corners at each point.
    pub stars: [Vec<u32>; 2],
    pub triangles: EdgeTriangles,
}

impl Edge {
    pub fn length(&self) -> f64 {
        (self.ends[1] - self.ends[0]).length()
    }

    /// Corners at the second point of triangles that survive the collapse.
    fn surviving<'a>(&'a self, topology: &'a Topology, state: &'a State) -> impl Iterator<Item = u32> + 'a {
        self.stars[1].iter().copied().filter(|&corner| {
            let [_, p, q] = topology.points_from(state, corner);
            p != self.points[0] && q != self.points[0]
        })
    }

    /// Whether the two ends share no neighbours but those opposite the edge, and something is left of the surface.
    ///
    /// On a closed piece both opposite points may form a triangle with one end, which then has three triangles, but not
    /// with both ends: that is the last tetrahedron, and its two other triangles would become one twice over.
    pub fn link_holds(&self, topology: &Topology, state: &State, neighbours: &mut PointSet) -> bool {
        neighbours.clear();
        for &corner in &self.stars[0] {
            for point in topology.points_from(state, corner) {
                neighbours.insert(point);
            }
        }
        let opposite = &self.triangles.opposite[..self.triangles.count.min(2)];
        let is_opposite = |p: u32| opposite.iter().any(|&corner| topology.point_at(state, corner) == p);
        let mut remains = self.stars[0].len() > self.triangles.count;
        let mut joins_both_at_end = false;
        for corner in self.surviving(topology, state) {
            remains = true;
            let [_, p, q] = topology.points_from(state, corner);
            if [p, q].into_iter().any(|point| neighbours.contains(point) && !is_opposite(point)) {
                return false;
            }
            joins_both_at_end |= is_opposite(p) && is_opposite(q);
        }
        let joins_both_at_start = || {
            let b = self.points[1];
            self.stars[0].iter().any(|&corner| {
                let [_, p, q] = topology.points_from(state, corner);
                p != b && q != b && is_opposite(p) && is_opposite(q)
            })
        };
        remains && !(joins_both_at_end && joins_both_at_start())
    }

    /// A point moved along the mean normal of both stars until their volume is as before, but not far.
    pub fn keep_volume(&self, topology: &Topology, state: &State, on_edge: DVec3) -> DVec3 {
        let (mut normal, mut volume) = (DVec3::ZERO, 0.0);
        for corner in self.stars[0].iter().copied().chain(self.surviving(topology, state)) {
            let points = topology.points_from(state, corner);
            // Relative to the edge, for precision.
            let [p, q, r] = points.map(|p| topology.positions[p as usize] - on_edge);
            normal += (q - p).cross(r - p);
            volume += p.dot(q.cross(r));
        }
        let steep = normal.length_squared();
        if steep == 0.0 {
            return on_edge;
        }
        let offset = normal * (volume / steep);
        let max = 0.5 * self.length();
        let at = on_edge + offset * (max / offset.length().max(max).max(f64::MIN_POSITIVE));
        if at.is_finite() { at } else { on_edge }
    }

    /// Whether no triangle folds over when both ends move to `at`.
    pub fn keeps_facing(&self, topology: &Topology, state: &State, at: DVec3) -> bool {
        let keeps = |corner: u32, partner: u32| {
            let points = topology.points_from(state, corner);
            if points[1] == partner || points[2] == partner {
                return true;
            }
            let [p, q, r] = points.map(|p| topology.positions[p as usize]);
            let (before, after) = ((q - p).cross(r - p), (q - at).cross(r - at));
            before.dot(after) >= MIN_COSINE * (before.length_squared() * after.length_squared()).sqrt()
        };
        let [a, b] = self.points;
        self.stars[0].iter().all(|&corner| keeps(corner, b))
            && self.stars[1].iter().all(|&corner| keeps(corner, a))
    }
}
