//! Which points, edges and pieces the surface parts of a mesh have: vertices with bit-identical positions in one
//! part are one point, and a point's triangles are a chain of corners that two points can join in constant time.

use std::collections::HashMap;
use std::mem::replace;
use std::ops::Range;

use glam::{DVec3, Vec3};

use super::state::{NONE, PartSpan, State};

/// The surface ends here.
pub const BOUNDARY: u8 = 1;
/// The surface is not a surface here (an edge of three triangles, two fans that touch): never moves.
pub const LOCKED: u8 = 2;

/// A connected piece of surface.
#[derive(Clone, Debug, Default)]
pub struct Piece {
    /// Its triangles at full detail, a range of `Topology::piece_triangles`.
    pub triangles: Range<usize>,
    /// Its living vertices.
    pub living_vertices: usize,
    /// Mean width across its longest extent, in metres: a twig's diameter.
    pub thickness_m: f64,
    /// Diagonal of the box around it in metres.
    pub extent_m: f64,
}

/// Points, corners and pieces; updated by `merge`.
pub struct Topology {
    /// Taken from all positions, so that double precision is used near zero.
    pub origin: DVec3,
    /// Point of each vertex; `NONE` for vertices of aggregates and for unused ones.
    pub point_of: Vec<u32>,
    /// Where each point lies, relative to the origin.
    pub positions: Vec<DVec3>,
    /// `BOUNDARY` and `LOCKED`.
    pub flags: Vec<u8>,
    /// Living vertices at each point.
    pub wedges: Vec<u32>,
    /// Living corners of each vertex.
    pub uses: Vec<u32>,
    /// Piece of each point.
    pub piece_of: Vec<u32>,
    pub pieces: Vec<Piece>,
    pub piece_triangles: Vec<u32>,
    /// Scratch memory: a set of vertices.
    pub seen: PointSet,
    /// What follows each corner in its point's chain; after all corners, what each point's chain starts with.
    next: Vec<u32>,
    /// The last link of each point's chain: a corner or, if there is none, the chain's start.
    tail: Vec<u32>,
}

impl Topology {
    /// Finds everything about the surface parts of a whole mesh.
    pub fn new(state: &State) -> Self {
        let (point_of, positions, origin) = number_points(state);
        let (points, corners) = (positions.len(), 3 * state.triangles.len());
        let mut topology = Self {
            origin,
            flags: vec![0; points],
            wedges: vec![0; points],
            uses: vec![0; state.vertices.len()],
            piece_of: vec![NONE; points],
            pieces: Vec::new(),
            piece_triangles: Vec::new(),
            seen: PointSet::new(state.vertices.len()),
            next: vec![NONE; corners + points],
            tail: (corners..corners + points).map(|start| start as u32).collect(),
            point_of,
            positions,
        };
        topology.chain_corners(state);
        topology.find_pieces(state);
        topology
    }

    /// The point at a corner.
    #[inline]
    pub fn point_at(&self, state: &State, corner: u32) -> u32 {
        self.point_of[state.triangles[corner as usize / 3][corner as usize % 3] as usize]
    }

    /// Points of a triangle, from the given corner on.
    #[inline]
    pub fn points_from(&self, state: &State, corner: u32) -> [u32; 3] {
        let [a, b, c] = state.triangles[corner as usize / 3];
        let [p, q, r] = match corner % 3 {
            0 => [a, b, c],
            1 => [b, c, a],
            _ => [c, a, b],
        };
        [self.point_of[p as usize], self.point_of[q as usize], self.point_of[r as usize]]
    }

    /// The living corners at a point; forgets removed ones.
    pub fn star(&mut self, state: &State, point: u32, corners: &mut Vec<u32>) {
        corners.clear();
        let mut last = self.chain_start(point);
        let mut corner = self.next[last];
        while corner != NONE {
            if state.triangle_lives[corner as usize / 3] {
                corners.push(corner);
                self.next[last] = corner;
                last = corner as usize;
            }
            corner = self.next[corner as usize];
        }
        self.next[last] = NONE;
        self.tail[point as usize] = last as u32;
    }

    /// Gives all corners of `removed` to `kept`.
    pub fn join(&mut self, kept: u32, removed: u32) {
        let start = self.chain_start(removed);
        if self.next[start] != NONE {
            let last = replace(&mut self.tail[removed as usize], start as u32);
            let before = replace(&mut self.tail[kept as usize], last);
            self.next[before as usize] = replace(&mut self.next[start], NONE);
        }
    }

    #[inline]
    fn chain_start(&self, point: u32) -> usize {
        self.next.len() - self.tail.len() + point as usize
    }

    /// Whether the triangles around a point hang together by edges; stars of over 64 triangles count as torn.
    pub fn is_one_fan(&self, state: &State, point: u32, star: &[u32]) -> bool {
        if star.len() > 64 {
            return false;
        }
        let (all, mut reached) = (u64::MAX >> (64 - star.len().max(1)), 1_u64);
        let mut front = reached;
        while front != 0 {
            let index = front.trailing_zeros() as usize;
            front &= front - 1;
            let [_, p, q] = self.points_from(state, star[index]);
            for (other, &corner) in star.iter().enumerate() {
                let seen = reached >> other & 1 == 1;
                let [_, r, s] = self.points_from(state, corner);
                if !seen && [p, q].iter().any(|&end| end != point && (end == r || end == s)) {
                    reached |= 1 << other;
                    front |= 1 << other;
                }
            }
        }
        reached == all
    }

    fn chain_corners(&mut self, state: &State) {
        for t in surface_triangles(state) {
            for k in 0..3 {
                let (vertex, corner) = (state.triangles[t][k] as usize, (3 * t + k) as u32);
                let point = self.point_of[vertex] as usize;
                self.wedges[point] += u32::from(self.uses[vertex] == 0);
                self.uses[vertex] += 1;
                let before = replace(&mut self.tail[point], corner);
                self.next[before as usize] = corner;
            }
        }
    }

    fn find_pieces(&mut self, state: &State) {
        let mut union: Vec<u32> = (0..self.positions.len() as u32).collect();
        for t in surface_triangles(state) {
            let [a, b, c] = state.triangles[t].map(|v| find(&mut union, self.point_of[v as usize]));
            let least = a.min(b).min(c);
            for root in [a, b, c] {
                union[root as usize] = least;
            }
        }
        for point in 0..union.len() {
            let root = find(&mut union, point as u32) as usize;
            if root == point {
                self.piece_of[point] = self.pieces.len() as u32;
                self.pieces.push(Piece::default());
            }
            self.piece_of[point] = self.piece_of[root];
            self.pieces[self.piece_of[point] as usize].living_vertices += self.wedges[point] as usize;
        }
        self.collect_piece_triangles(state);
        self.measure_pieces(state);
    }

    fn collect_piece_triangles(&mut self, state: &State) {
        let piece = |&t: &u32| self.piece_of[self.point_of[state.triangles[t as usize][0] as usize] as usize];
        let mut triangles: Vec<u32> = surface_triangles(state).map(|t| t as u32).collect();
        triangles.sort_by_key(piece);
        let mut start = 0;
        for run in triangles.chunk_by(|s, t| piece(s) == piece(t)) {
            self.pieces[piece(&run[0]) as usize].triangles = start..start + run.len();
            start += run.len();
        }
        self.piece_triangles = triangles;
    }

    fn measure_pieces(&mut self, state: &State) {
        for piece in &mut self.pieces {
            let (mut area, mut low, mut high) = (0.0, DVec3::MAX, DVec3::MIN);
            for &t in &self.piece_triangles[piece.triangles.clone()] {
                let at = |v: u32| self.positions[self.point_of[v as usize] as usize];
                let [p, q, r] = state.triangles[t as usize].map(at);
                area += 0.5 * (q - p).cross(r - p).length();
                low = low.min(p).min(q).min(r);
                high = high.max(p).max(q).max(r);
            }
            piece.extent_m = if low.x <= high.x { (high - low).length() } else { 0.0 };
            // A tube of diameter d and length l has the area πdl.
            let thickness_m = area / (std::f64::consts::PI * piece.extent_m.max(f64::MIN_POSITIVE));
            piece.thickness_m = thickness_m.min(piece.extent_m);
        }
    }
}

/// A set of points, or of vertices, that is emptied in constant time.
pub struct PointSet {
    stamps: Vec<u32>,
    now: u32,
}

impl PointSet {
    pub fn new(points: usize) -> Self {
        Self { stamps: vec![0; points], now: 0 }
    }

    pub fn clear(&mut self) {
        self.now += 1;
    }

    /// Whether the point is new.
    #[inline]
    pub fn insert(&mut self, point: u32) -> bool {
        replace(&mut self.stamps[point as usize], self.now) != self.now
    }

    #[inline]
    pub fn contains(&self, point: u32) -> bool {
        self.stamps[point as usize] == self.now
    }
}

/// A number for each point of some, emptied in constant time.
pub struct PointMap {
    /// When it was set, and what to.
    entries: Vec<(u32, u32)>,
    now: u32,
}

impl PointMap {
    pub fn new(points: usize) -> Self {
        Self { entries: vec![(0, 0); points], now: 0 }
    }

    pub fn clear(&mut self) {
        self.now += 1;
    }

    /// The point's number: `number`, if it had none.
    #[inline]
    pub fn get_or_insert(&mut self, point: u32, number: u32) -> u32 {
        let entry = &mut self.entries[point as usize];
        if entry.0 != self.now {
            *entry = (self.now, number);
        }
        entry.1
    }
}

/// Triangles of surface parts, by number.
pub fn surface_triangles(state: &State) -> impl Iterator<Item = usize> {
    state.parts.iter().filter(|span| span.elements().is_none()).flat_map(PartSpan::range)
}

fn find(union: &mut [u32], mut point: u32) -> u32 {
    while union[point as usize] != point {
        union[point as usize] = union[union[point as usize] as usize];
        point = union[point as usize];
    }
    point
}

/// Numbers the points in the order in which triangles use them: the point of each vertex, where points lie, and the
/// origin from which that is measured.
fn number_points(state: &State) -> (Vec<u32>, Vec<DVec3>, DVec3) {
    let mut point_of = vec![NONE; state.vertices.len()];
    let mut known: HashMap<(usize, [u32; 3]), u32> = HashMap::with_capacity(state.vertices.len());
    let mut places = Vec::new();
    for (part, span) in state.parts.iter().enumerate().filter(|(_, span)| span.elements().is_none()) {
        for &vertex in state.triangles[span.range()].iter().flatten() {
            if point_of[vertex as usize] != NONE {
                continue;
            }
            let position = state.vertices[vertex as usize].position;
            point_of[vertex as usize] =
                *known.entry((part, position.map(f32::to_bits))).or_insert_with(|| {
                    places.push(Vec3::from_array(position).as_dvec3());
                    places.len() as u32 - 1
                });
        }
    }
    let origin = places.first().copied().unwrap_or(DVec3::ZERO);
    (point_of, places.into_iter().map(|place| place - origin).collect(), origin)
}
