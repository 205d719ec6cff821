//! A mesh → what is seen of it from one side, orthographically, by a z-buffer.

use glam::{Vec2, Vec3};

use super::{Frame, SAMPLES, SIDE};
use crate::model::{Impostor, Material, Mesh};

/// Samples a side.
pub(super) const SIZE: usize = SAMPLES * SIDE;

/// A card's colours.
pub(super) struct Card {
    pub width: usize,
    pub height: usize,
    /// Rows from the top; linear, none where the card is cut away.
    pub texels: Vec<Option<Vec3>>,
}

impl Card {
    #[inline]
    fn at(&self, [u, v]: [f32; 2]) -> Option<Vec3> {
        let index = |t: f32, count: usize| ((t * count as f32).max(0.0) as usize).min(count - 1);
        self.texels[index(v, self.height) * self.width + index(u, self.width)]
    }
}

/// What triangles are made of.
#[derive(Clone, Copy)]
pub(super) enum Surface<'a> {
    /// A colour, linear.
    Wood(Vec3),
    Card(&'a Card),
}

/// From where, and how metres become samples.
pub(super) struct Look {
    foot_m: Vec3,
    eye: Vec3,
    right: Vec3,
    samples_per_m: Vec2,
}

impl Look {
    /// For picture `k`.
    pub fn new(frame: &Frame, k: usize) -> Self {
        let [eye, right] = Impostor::eye_and_right(k);
        let samples_per_m = SIZE as f32 / Vec2::from_array(frame.size_m);
        Self { foot_m: frame.foot_m, eye, right, samples_per_m }
    }

    /// Place in samples from the upper left corner, and metres before the axis.
    fn project(&self, position: [f32; 3]) -> Vec3 {
        let p = Vec3::from_array(position) - self.foot_m;
        let x = 0.5 * SIZE as f32 + p.dot(self.right) * self.samples_per_m.x;
        Vec3::new(x, SIZE as f32 - p.y * self.samples_per_m.y, p.dot(self.eye))
    }
}

/// The nearest surface at a sample.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    /// Metres before the axis; −∞ where nothing is.
    pub depth_m: f32,
    /// Albedo, linear.
    pub color: Vec3,
    /// Whether it is leaf or blossom.
    pub leaf: bool,
}

/// Rows of samples from the top.
pub(super) fn draw<'a>(mesh: &Mesh, surface: &dyn Fn(Material) -> Surface<'a>, look: &Look) -> Vec<Sample> {
    let nothing = Sample { depth_m: f32::NEG_INFINITY, color: Vec3::ZERO, leaf: false };
    let mut samples = vec![nothing; SIZE * SIZE];
    let places: Vec<Vec3> = mesh.positions.iter().map(|&p| look.project(p)).collect();
    let color = |i: usize| {
        mesh.colors.get(i).map_or(Vec3::ONE, |&[r, g, b, _]| Vec3::new(r.into(), g.into(), b.into()) / 255.0)
    };
    let uv = |i: usize| mesh.uvs.get(i).copied().unwrap_or_default();
    for part in &mesh.parts {
        let surface = surface(part.material);
        for triangle in &part.triangles {
            let corners = triangle.map(|i| i as usize);
            let Some(shape) = Shape::new(corners.map(|i| places[i])) else { continue };
            let tint = shape.plane(corners.map(color));
            match surface {
                Surface::Wood(wood) => shape.fill(&mut samples, |at| {
                    Some(Sample { depth_m: 0.0, color: wood * tint.at(at), leaf: false })
                }),
                Surface::Card(card) => {
                    let uv = shape.plane(corners.map(|i| Vec3::new(uv(i)[0], uv(i)[1], 0.0)));
                    shape.fill(&mut samples, |at| {
                        let place = uv.at(at);
                        let color = card.at([place.x, place.y])? * tint.at(at);
                        Some(Sample { depth_m: 0.0, color, leaf: true })
                    });
                }
            }
        }
    }
    samples
}

/// What varies linearly over a triangle.
struct Plane {
    origin: Vec3,
    per_x: Vec3,
    per_y: Vec3,
}

impl Plane {
    #[inline]
    fn at(&self, at: Vec2) -> Vec3 {
        self.origin + self.per_x * at.x + self.per_y * at.y
    }
}

/// A triangle on the screen.
struct Shape {
    /// x, y in samples and metres before the axis.
    corners: [Vec3; 3],
    /// Inverse of twice its area with sign.
    over_area: f32,
}

/// Triangles with less than this area in samples are seen from their edge.
const MIN_AREA: f32 = 1e-6;
/// Samples this far outside of an edge are inside of both its triangles, so that rounding leaves no hole between them.
const EDGE: f32 = 1e-3;

impl Shape {
    fn new(corners: [Vec3; 3]) -> Option<Self> {
        let [a, b, c] = corners.map(Vec3::truncate);
        let area = (b - a).perp_dot(c - a);
        (area.abs() > MIN_AREA).then(|| Self { corners, over_area: 1.0 / area })
    }

    fn plane(&self, values: [Vec3; 3]) -> Plane {
        let [a, b, c] = self.corners;
        let (ab, ac) = (b - a, c - a);
        let (db, dc) = (values[1] - values[0], values[2] - values[0]);
        let per_x = (db * ac.y - dc * ab.y) * self.over_area;
        let per_y = (dc * ab.x - db * ac.x) * self.over_area;
        Plane { origin: values[0] - per_x * a.x - per_y * a.y, per_x, per_y }
    }

    /// Puts what `shade` gives where the triangle is the nearest so far.
    #[inline]
    fn fill(&self, samples: &mut [Sample], shade: impl Fn(Vec2) -> Option<Sample>) {
        let [a, b, c] = self.corners;
        let depth = self.plane([a, b, c].map(|corner| Vec3::new(corner.z, 0.0, 0.0)));
        let (top, bottom) = (a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
        for y in first(top)..first(bottom) {
            let line = y as f32 + 0.5;
            let (left, right) = self.span(line);
            let (from, to) = (first(left - EDGE), first(right + EDGE));
            for (x, sample) in samples[y * SIZE..(y + 1) * SIZE].iter_mut().enumerate().take(to).skip(from) {
                let at = Vec2::new(x as f32 + 0.5, line);
                let depth_m = depth.at(at).x;
                if depth_m > sample.depth_m
                    && let Some(seen) = shade(at)
                {
                    *sample = Sample { depth_m, ..seen };
                }
            }
        }
    }

    /// Where a horizontal line enters and leaves the triangle.
    fn span(&self, line: f32) -> (f32, f32) {
        let (mut left, mut right) = (f32::MAX, f32::MIN);
        for k in 0..3 {
            let (a, b) = (self.corners[k], self.corners[(k + 1) % 3]);
            if (a.y <= line) != (b.y <= line) {
                let x = a.x + (b.x - a.x) * ((line - a.y) / (b.y - a.y));
                (left, right) = (left.min(x), right.max(x));
            }
        }
        (left, right)
    }
}

/// The first sample whose middle is not before a place.
fn first(place: f32) -> usize {
    ((place + 0.5).max(0.0) as usize).min(SIZE)
}
