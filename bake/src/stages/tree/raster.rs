//! A mesh → what is seen of it from one side, orthographically, by a z-buffer.

use std::cell::LazyCell;

use glam::{Vec2, Vec3, Vec4};

use super::surfaces::{Surface, Surfaces};
use crate::model::{Impostor, Mesh};

/// Samples a side of a tile.
const TILE: usize = 8;
/// Samples that are compared at once, beginning at any of a row.
const LANES: usize = 4;
/// Fewer triangles are drawn in the order of the mesh.
const MANY: usize = 256;
/// How often it is noted in which tiles nothing more can show, and after how many triangles at the earliest.
const ROUNDS: usize = 24;
const MIN_ROUND: usize = 1024;

/// Towards the sun in whose light levels are compared, a unit vector.
pub(super) const SUN: Vec3 = Vec3::new(0.5, 0.75, 0.433);

/// From where, and how metres become samples.
pub(super) struct Look {
    /// In the middle of the lower edge.
    foot_m: Vec3,
    /// Unit vectors: towards the eye, to the right and up.
    eye: Vec3,
    right: Vec3,
    up: Vec3,
    samples_per_m: Vec2,
    /// Samples a side.
    size: usize,
}

impl Look {
    /// From side `k` of an impostor, of what lies above and beside `foot_m` in a picture of that width and height with
    /// `size` samples a side.
    pub fn new(k: usize, foot_m: Vec3, size_m: [f32; 2], size: usize) -> Self {
        let [eye, right] = Impostor::eye_and_right(k);
        let samples_per_m = size as f32 / Vec2::from_array(size_m);
        Self { foot_m, eye, right, up: Vec3::Y, samples_per_m, size }
    }

    /// From above, or from below where it is negative, by that tangent of the elevation; heights stay what they are.
    pub fn tilted(self, tangent: f32) -> Self {
        Self { up: self.up - tangent * self.eye, eye: self.eye + tangent * self.up, ..self }
    }

    /// Straight before a rectangle with that middle, those directions to the right and up, and half of that width and
    /// height.
    pub fn before(middle_m: Vec3, [right, up]: [Vec3; 2], half_m: Vec2, size: usize) -> Self {
        let samples_per_m = 0.5 * size as f32 / half_m;
        Self { foot_m: middle_m - half_m.y * up, eye: right.cross(up), right, up, samples_per_m, size }
    }

    /// Place in samples from the upper left corner, and metres before the axis.
    pub fn project(&self, position: [f32; 3]) -> Vec3 {
        let p = Vec3::from_array(position) - self.foot_m;
        let x = 0.5 * self.size as f32 + p.dot(self.right) * self.samples_per_m.x;
        Vec3::new(x, self.size as f32 - p.dot(self.up) * self.samples_per_m.y, p.dot(self.eye))
    }
}

/// The nearest surface at a sample.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    /// Metres before the axis.
    pub depth_m: f32,
    /// Albedo, linear.
    pub color: Vec3,
    /// Whether it is leaf or blossom.
    pub leaf: bool,
    /// Mean normal of the triangle's corners, a unit vector; zero of a mesh without normals.
    pub normal: Vec3,
    /// Cosine of the angle between normal and [`SUN`], 0 on the far side; of a cluster the mean of its leaves.
    pub sunlit: f32,
}

/// What is nearest at each sample, rows from the top.
pub(super) struct Drawing<'a> {
    /// Those that were seen when it was their turn.
    triangles: Vec<Triangle<'a>>,
    /// Metres before the axis; −∞ where nothing is. Some more follow the last row, for the lanes that reach beyond it.
    depths_m: Vec<f32>,
    /// Index into `triangles`.
    nearest: Vec<u32>,
    /// Samples a side.
    size: usize,
}

impl<'a> Drawing<'a> {
    pub fn new(mesh: &Mesh, surfaces: &'a Surfaces, look: &Look) -> Self {
        let size = look.size;
        let samples = size * size + LANES - 1;
        let (depths_m, nearest) = (vec![f32::NEG_INFINITY; samples], vec![0; samples]);
        let mut drawing = Self { triangles: Vec::new(), depths_m, nearest, size };
        drawing.draw(mesh, surfaces, look);
        drawing
    }

    /// Draws the nearest triangles first, where they are many, since most of what comes later is then hidden. Where two are
    /// equally near, the one that comes first in the mesh is drawn.
    fn draw(&mut self, mesh: &Mesh, surfaces: &'a Surfaces, look: &Look) {
        let places: Vec<Vec3> = mesh.positions.iter().map(|&p| look.project(p)).collect();
        let corners = |triangle: [u32; 3]| triangle.map(|i| places[i as usize]);
        let parts = mesh.parts.iter().map(|part| (surfaces.of_part(part.material), &part.triangles));
        let all: Vec<_> = parts.flat_map(|(surface, part)| part.iter().map(move |&t| (surface, t))).collect();
        if all.len() < MANY {
            for (surface, vertices) in all {
                if let Some(outline) = Outline::new(corners(vertices)) {
                    self.add(mesh, vertices, &outline, surface);
                }
            }
            return;
        }
        let nearest_m = |t: [u32; 3]| corners(t).iter().map(|c| c.z).fold(f32::MIN, f32::max);
        let shown = (0..).zip(&all).filter(|(_, (_, t))| self.holds_a_sample(corners(*t)));
        let mut order: Vec<u64> =
            shown.map(|(index, (_, t))| farther_later(nearest_m(*t)) << 32 | index).collect();
        order.sort_unstable();
        for some in order.chunks((order.len() / ROUNDS).max(MIN_ROUND)) {
            let farthest_m = self.tiles();
            for &key in some {
                let (surface, vertices) = all[key as u32 as usize];
                let nearest_m = nearest_m(vertices);
                let corners = corners(vertices);
                if self.tiles_around(corners).all(|tile| farthest_m[tile] >= nearest_m) {
                    continue;
                }
                if let Some(outline) = Outline::new(corners) {
                    self.add(mesh, vertices, &outline, surface);
                }
            }
        }
    }

    /// Samples a side.
    pub fn size(&self) -> usize {
        self.size
    }

    fn add(&mut self, mesh: &Mesh, vertices: [u32; 3], outline: &Outline, surface: Surface<'a>) {
        // Most triangles show nothing in the end, so their texture is placed only when it counts.
        let uv = LazyCell::new(|| outline.uv(mesh, vertices));
        let at = |x: Vec4, y: f32| [0, 1].map(|axis: usize| uv[axis].at_four(x, y));
        let shows = match surface {
            Surface::Wood(_) => self.fill(outline, |_, _| u64::MAX),
            Surface::Card(card) => self.fill(outline, |x, y| card.mask.opaque(at(x, y))),
            Surface::Atlas(atlas) => self.fill(outline, |x, y| atlas.opaque(at(x, y))),
        };
        if shows {
            self.triangles.push(Triangle::new(mesh, vertices, outline, surface));
        }
    }

    /// Whether there is any sample in the rectangle around a triangle: in that of a small one, often none is.
    fn holds_a_sample(&self, [a, b, c]: [Vec3; 3]) -> bool {
        let (low, high) = (a.min(b).min(c) - EDGE, a.max(b).max(c) + EDGE);
        [0, 1].iter().all(|&axis| first(low[axis], self.size) < first(high[axis], self.size))
    }

    /// The tiles that a triangle may reach into.
    fn tiles_around(&self, corners: [Vec3; 3]) -> impl Iterator<Item = usize> + use<> {
        let size = self.size;
        let (low, high) =
            (corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2]));
        let tile = |place: f32| first(place, size).min(size - 1) / TILE;
        let [columns, rows] = [0, 1].map(|axis| tile(low[axis] - EDGE)..tile(high[axis] + EDGE) + 1);
        rows.flat_map(move |row| columns.clone().map(move |column| row * (size / TILE) + column))
    }

    /// The farthest depth in each tile: what lies behind it is hidden.
    fn tiles(&self) -> Vec<f32> {
        let across = self.size / TILE;
        let mut tiles = vec![f32::INFINITY; across * across];
        for (row, depths_m) in self.depths_m.chunks_exact(self.size).enumerate() {
            let tiles = &mut tiles[row / TILE * across..][..across];
            for (tile, depths_m) in tiles.iter_mut().zip(depths_m.chunks_exact(TILE)) {
                *tile = depths_m.iter().fold(*tile, |farthest, &m| if m < farthest { m } else { farthest });
            }
        }
        tiles
    }

    /// Puts the next triangle where it is the nearest so far and there, for which it asks about four samples at once; whether
    /// it is anywhere.
    #[inline]
    fn fill(&mut self, outline: &Outline, is_there: impl Fn(Vec4, f32) -> u64) -> bool {
        let index = self.triangles.len() as u32;
        let [a, b, c] = outline.corners.map(|corner| corner.y);
        let size = self.size;
        let mut shows = false;
        let rows = first(a.min(b).min(c), size)..first(a.max(b).max(c), size);
        for four in rows.clone().step_by(LANES) {
            let [left, right] = outline.spans(four).map(|ends| ends.to_array());
            for row in four..(four + LANES).min(rows.end) {
                let y = row as i32 as f32 + 0.5;
                let columns = first(left[row - four] - EDGE, size)..first(right[row - four] + EDGE, size);
                let row_m = outline.depth_m.origin + outline.depth_m.per_y * y;
                for column in columns.clone().step_by(LANES) {
                    let x = column as i32 as f32 + Vec4::new(0.5, 1.5, 2.5, 3.5);
                    let here_m = row_m + outline.depth_m.per_x * x;
                    let at = row * size + column;
                    let in_row = (1 << (columns.end - column).min(LANES)) - 1;
                    let mut nearer = here_m.cmpgt(Vec4::from_slice(&self.depths_m[at..])).bitmask() & in_row;
                    if nearer != 0 {
                        nearer &= is_there(x, y) as u32;
                        shows |= nearer != 0;
                    }
                    while nearer != 0 {
                        let lane = nearer.trailing_zeros() as usize;
                        (self.depths_m[at + lane], self.nearest[at + lane]) = (here_m[lane], index);
                        nearer &= nearer - 1;
                    }
                }
            }
        }
        shows
    }

    /// What is seen at a sample, if anything is.
    pub fn sample(&self, column: usize, row: usize) -> Option<Sample> {
        let depth_m = self.depths_m[row * self.size + column];
        if depth_m == f32::NEG_INFINITY {
            return None;
        }
        let triangle = &self.triangles[self.nearest[row * self.size + column] as usize];
        let (x, y) = (column as f32 + 0.5, row as f32 + 0.5);
        let [u, v] = [0, 1].map(|axis: usize| triangle.uv[axis].at(x, y));
        let normal = triangle.normal;
        let sunlit = normal.dot(SUN).max(0.0);
        let (color, sunlit, leaf) = match triangle.surface {
            Surface::Wood(color) => (color, sunlit, false),
            Surface::Card(card) => (card.at(u, v), sunlit, !card.is_wood),
            Surface::Atlas(atlas) => {
                let (color, sunlit) = atlas.at(u, v);
                (color, sunlit, true)
            }
        };
        Some(Sample { depth_m, color: color * triangle.tint, leaf, normal, sunlit })
    }
}

/// What varies linearly over a triangle.
struct Plane {
    origin: f32,
    per_x: f32,
    per_y: f32,
}

impl Plane {
    #[inline]
    fn at(&self, x: f32, y: f32) -> f32 {
        self.origin + self.per_y * y + self.per_x * x
    }

    #[inline]
    fn at_four(&self, x: Vec4, y: f32) -> Vec4 {
        self.origin + self.per_y * y + self.per_x * x
    }
}

/// Triangles with less than this area in samples are seen from their edge.
const MIN_AREA: f32 = 1e-6;
/// Samples this far outside of an edge are inside of both its triangles, so that rounding leaves no hole between them.
const EDGE: f32 = 1e-3;

/// Where a triangle is on the screen.
struct Outline {
    /// x, y in samples and metres before the axis.
    corners: [Vec3; 3],
    /// Samples to the right a row, along the edge from each corner to the next.
    slopes: [f32; 3],
    /// From the first corner to the two others, over twice the area.
    edges: [Vec2; 2],
    depth_m: Plane,
}

impl Outline {
    /// `None` of what is seen from its edge.
    #[inline]
    fn new(corners: [Vec3; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let [ab, ac] = [b - a, c - a].map(Vec3::truncate);
        let area = ab.perp_dot(ac);
        if area.abs() < MIN_AREA {
            return None;
        }
        let slope = |(p, q): (Vec3, Vec3)| (q.x - p.x) / (q.y - p.y);
        let slopes = [(a, b), (b, c), (c, a)].map(slope);
        let edges = [ab / area, ac / area];
        Some(Self { corners, slopes, edges, depth_m: plane(a, edges, corners.map(|corner| corner.z)) })
    }

    /// Texture coordinates.
    fn uv(&self, mesh: &Mesh, vertices: [u32; 3]) -> [Plane; 2] {
        let uvs = vertices.map(|i| mesh.uvs.get(i as usize).copied().unwrap_or_default());
        [0, 1].map(|axis| plane(self.corners[0], self.edges, uvs.map(|uv| uv[axis])))
    }

    /// Where the middles of four rows enter and leave it: from right to left where they do not.
    #[inline]
    fn spans(&self, first_row: usize) -> [Vec4; 2] {
        let y = first_row as i32 as f32 + Vec4::new(0.5, 1.5, 2.5, 3.5);
        (0..3).fold([Vec4::MAX, Vec4::MIN], |[left, right], k| {
            let (a, b) = (self.corners[k], self.corners[(k + 1) % 3]);
            let crosses = Vec4::splat(a.y).cmple(y) ^ Vec4::splat(b.y).cmple(y);
            let x = a.x + (y - a.y) * self.slopes[k];
            let at = |nowhere: Vec4| Vec4::select(crosses, x, nowhere);
            [left.min(at(Vec4::MAX)), right.max(at(Vec4::MIN))]
        })
    }
}

/// Through these values at the corners of a triangle that has its first corner there.
#[inline]
fn plane(first: Vec3, [ab, ac]: [Vec2; 2], values: [f32; 3]) -> Plane {
    let (db, dc) = (values[1] - values[0], values[2] - values[0]);
    let (per_x, per_y) = (db * ac.y - dc * ab.y, dc * ab.x - db * ac.x);
    Plane { origin: values[0] - per_x * first.x - per_y * first.y, per_x, per_y }
}

/// What a triangle looks like.
struct Triangle<'a> {
    surface: Surface<'a>,
    uv: [Plane; 2],
    /// Linear factor on the surface's colour, the mean of the corners'.
    tint: Vec3,
    normal: Vec3,
}

impl<'a> Triangle<'a> {
    fn new(mesh: &Mesh, vertices: [u32; 3], outline: &Outline, surface: Surface<'a>) -> Self {
        let tint = |i: u32| {
            let color = mesh.colors.get(i as usize);
            color.map_or(Vec3::ONE, |&[r, g, b, _]| Vec3::from_array([r, g, b].map(f32::from)) / 255.0)
        };
        let normals = vertices.iter().filter_map(|&i| mesh.normals.get(i as usize));
        Self {
            surface,
            uv: outline.uv(mesh, vertices),
            tint: vertices.map(tint).iter().sum::<Vec3>() / 3.0,
            normal: normals.map(|&normal| Vec3::from_array(normal)).sum::<Vec3>().normalize_or_zero(),
        }
    }
}

/// The first of `size` samples whose middle is not before a place.
#[inline]
fn first(place: f32, size: usize) -> usize {
    ((place + 0.5).max(0.0) as i32 as usize).min(size)
}

/// A key by which the farther of two depths comes later: equal for equal ones.
#[inline]
fn farther_later(depth_m: f32) -> u64 {
    // The bits of a positive number grow with it, those of a negative one fall.
    let bits = (depth_m + 0.0).to_bits();
    u64::from(if bits >> 31 == 0 { !bits & 0x7FFF_FFFF } else { bits })
}
