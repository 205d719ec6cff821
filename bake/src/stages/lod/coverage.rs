//! How many pixels a mesh covers when seen from the sides: rows of bits, filled triangle by triangle; elements of
//! aggregates are cut out by their texture's alpha.
//!
//! Orthographic views of square pixels; a pixel counts when its centre is inside a triangle and opaque there.

use std::cell::LazyCell;
use std::f32::consts::FRAC_1_SQRT_2;

use glam::{Vec2, Vec3};

use super::state::{PartSpan, State};
use crate::model::AlphaMask;

/// Unit vectors to the right in each view, all round, and how far each looks from below or above: the tangent of its
/// elevation.
const VIEWS: [(Vec3, f32); 4] = [
    (Vec3::new(1.0, 0.0, 0.0), 0.2),
    (Vec3::new(FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2), 0.0),
    (Vec3::new(0.0, 0.0, 1.0), -0.2),
    (Vec3::new(-FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2), 0.0),
];

/// Where a mesh lies in the views.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    middle: Vec3,
    pixels_per_m: f32,
    /// Pixels a side, a multiple of 64.
    side: usize,
}

impl Camera {
    /// Shows the box from `low` to `high`, with room for elements to grow beyond it.
    pub fn of([low, high]: [Vec3; 2], side: usize) -> Self {
        let extent_m = (high - low).length().max(f32::MIN_POSITIVE) * 1.1;
        Self { middle: (low + high) * 0.5, pixels_per_m: side as f32 / extent_m, side }
    }

    /// A distance in pixels from the left and from the bottom.
    fn offset(&self, (right, tilt): (Vec3, f32), by: Vec3) -> Vec2 {
        let forward = right.cross(Vec3::Y);
        Vec2::new(by.dot(right), by.y + by.dot(forward) * tilt) * self.pixels_per_m
    }

    fn place(&self, view: (Vec3, f32), at: Vec3) -> Vec2 {
        self.offset(view, at - self.middle) + 0.5 * self.side as f32
    }
}

/// Which pixels are covered in each view.
#[derive(Clone)]
pub struct Canvas {
    camera: Camera,
    /// Rows of 64 pixels a word, from the bottom.
    views: [Vec<u64>; VIEWS.len()],
}

impl Canvas {
    pub fn empty(camera: &Camera) -> Self {
        Self { camera: *camera, views: VIEWS.map(|_| vec![0; camera.side * camera.side / 64]) }
    }

    pub fn covered(&self) -> u32 {
        self.views.iter().flatten().map(|word| word.count_ones()).sum()
    }

    /// Draws what lives of the surface parts, grown by `offset_m` along its normals.
    pub fn draw_surfaces(&mut self, state: &State, offset_m: f32) {
        let grown = |v: u32| Vec3::from_array(state.grown(v as usize, offset_m));
        let surfaces = state.parts.iter().filter(|span| span.elements().is_none());
        let living = surfaces.flat_map(PartSpan::range).filter(|&t| state.triangle_lives[t]);
        let triangles: Vec<[Vec3; 3]> = living.map(|t| state.triangles[t].map(grown)).collect();
        let camera = self.camera;
        for (pixels, view) in self.views.iter_mut().zip(VIEWS) {
            let flat = |corner: Vec3| camera.place(view, corner);
            triangles.iter().for_each(|corners| fill(pixels, camera.side, corners.map(flat), |_, _| true));
        }
    }
}

/// The living elements of an aggregate as seen from the sides.
pub struct Elements {
    mask: AlphaMask,
    triangles: Vec<Triangle>,
}

/// A triangle of an element in each view, in pixels.
struct Triangle {
    uvs: [Vec2; 3],
    /// Where the element's centre is.
    centres: [Vec2; VIEWS.len()],
    /// Where the corners are from there.
    corners: [[Vec2; 3]; VIEWS.len()],
}

impl Elements {
    /// Projects what lives of a part.
    pub fn new(state: &State, span: &PartSpan, camera: &Camera, mask: AlphaMask) -> Self {
        let mut triangles = Vec::new();
        for element in state.living_elements(span) {
            let [ids, range] = span.element(element);
            let centre = state.centre(ids);
            let centres = VIEWS.map(|view| camera.place(view, centre));
            for t in range.filter(|&t| state.triangle_lives[t]) {
                let vertices = state.triangles[t].map(|v| state.vertices[v as usize]);
                let offsets = vertices.map(|v| Vec3::from_array(v.position) - centre);
                let corners = VIEWS.map(|view| offsets.map(|by| camera.offset(view, by)));
                triangles.push(Triangle { uvs: vertices.map(|v| Vec2::from_array(v.uv)), centres, corners });
            }
        }
        Self { mask, triangles }
    }

    /// Draws the elements, each scaled about its centre.
    pub fn draw(&self, scale: f32, canvas: &mut Canvas) {
        for (view, pixels) in canvas.views.iter_mut().enumerate() {
            for triangle in &self.triangles {
                let corners = triangle.corners[view].map(|by| triangle.centres[view] + by * scale);
                // Most small triangles show nothing that is not covered yet, so their texture is placed only when it counts.
                let texture = LazyCell::new(|| Affine::through(corners, triangle.uvs));
                fill(pixels, canvas.camera.side, corners, |x, y| {
                    texture.as_ref().is_some_and(|texture| self.mask.is_opaque(texture.at(x, y).into()))
                });
            }
        }
    }

    /// Pixels that the elements alone cover.
    pub fn covered(&self, camera: &Camera, scale: f32) -> u32 {
        let mut canvas = Canvas::empty(camera);
        self.draw(scale, &mut canvas);
        canvas.covered()
    }
}

/// Texture coordinates as a function of the place in a picture.
struct Affine {
    origin: Vec2,
    along_x: Vec2,
    along_y: Vec2,
}

impl Affine {
    fn through([a, b, c]: [Vec2; 3], [at_a, at_b, at_c]: [Vec2; 3]) -> Option<Self> {
        let (p, q) = (b - a, c - a);
        let area = p.perp_dot(q);
        let (u, v) = (at_b - at_a, at_c - at_a);
        let along_x = (u * q.y - v * p.y) / area;
        let along_y = (v * p.x - u * q.x) / area;
        let origin = at_a - along_x * a.x - along_y * a.y;
        origin.is_finite().then_some(Self { origin, along_x, along_y })
    }

    fn at(&self, x: f32, y: f32) -> Vec2 {
        self.origin + self.along_x * x + self.along_y * y
    }
}

/// Sets the bits of pixels whose centres lie in a triangle and are opaque.
fn fill(pixels: &mut [u64], side: usize, [a, b, c]: [Vec2; 3], opaque: impl Fn(f32, f32) -> bool) {
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let first = (low.y - 0.5).max(-1.0).ceil() as i32;
    let last = (high.y - 0.5).min(side as f32).floor() as i32;
    if first > last || whole(low.x) == whole(high.x) {
        return;
    }
    let slopes = [(a, b), (b, c), (c, a)].map(|(p, q)| (q.x - p.x) / (q.y - p.y));
    for row in first.max(0)..=last.min(side as i32 - 1) {
        let y = row as f32 + 0.5;
        let (mut left, mut right) = (f32::MAX, f32::MIN);
        for ((p, q), slope) in [(a, b), (b, c), (c, a)].into_iter().zip(slopes) {
            if (p.y <= y) != (q.y <= y) {
                let x = p.x + (y - p.y) * slope;
                left = left.min(x);
                right = right.max(x);
            }
        }
        let (start, end) = (whole(left), whole(right).min(side));
        let line = &mut pixels[row as usize * side / 64..][..side / 64];
        for (word, covered) in line.iter_mut().enumerate().take(end.div_ceil(64)).skip(start / 64) {
            let (from, to) = (start.max(64 * word) % 64, end.min(64 * word + 64) - 64 * word);
            let mut bare = !*covered & u64::MAX << from & u64::MAX >> (64 - to);
            while bare != 0 {
                let bit = bare & bare.wrapping_neg();
                bare ^= bit;
                if opaque((64 * word) as f32 + bit.trailing_zeros() as f32 + 0.5, y) {
                    *covered |= bit;
                }
            }
        }
    }
}

/// The first pixel whose centre is not left of a place: without a call, since this is the bake's innermost loop but one.
fn whole(place: f32) -> usize {
    (place + 0.5).max(0.0) as usize
}
