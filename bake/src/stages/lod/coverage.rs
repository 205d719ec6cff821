//! How many pixels a mesh covers when seen from the sides, orthographically; elements of aggregates are cut out by their
//! texture's alpha.

use std::f32::consts::FRAC_1_SQRT_2;

use glam::{Vec2, Vec3};

use super::state::{PartSpan, State};
use crate::model::AlphaMask;
use crate::silhouette::Silhouette;

/// Unit vectors to the right in each view, one across the other, and how far each looks from below or above: the tangent of its
/// elevation.
const VIEWS: [(Vec3, f32); 2] = [
    (Vec3::new(FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2), 0.2),
    (Vec3::new(-FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2), -0.2),
];

/// Where a mesh lies in the views.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    middle: Vec3,
    pixels_per_m: f32,
    /// Pixels a side.
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
    /// Rows from the bottom.
    views: [Silhouette; VIEWS.len()],
}

impl Canvas {
    pub fn empty(camera: &Camera) -> Self {
        Self { views: VIEWS.map(|_| Silhouette::empty(camera.side)) }
    }

    pub fn covered(&self) -> u32 {
        self.views.iter().map(Silhouette::covered).sum()
    }

    /// Covers what another canvas of the same camera covers.
    pub fn add(&mut self, other: &Self) {
        self.views.iter_mut().zip(&other.views).for_each(|(view, other)| view.add(other));
    }
}

/// What lives of the surface parts as seen from the sides.
pub struct Surfaces {
    /// Of each triangle in each view, where its corners are, in pixels, and how they move for each metre by which the
    /// surface grows.
    triangles: Vec<[[Growing; 3]; VIEWS.len()]>,
}

#[derive(Clone, Copy)]
struct Growing {
    at: Vec2,
    per_m: Vec2,
}

impl Surfaces {
    /// Projects all of them.
    pub fn new(state: &State, camera: &Camera) -> Self {
        let surfaces = state.parts.iter().filter(|span| span.elements().is_none());
        let living = surfaces.flat_map(PartSpan::range).filter(|&t| state.triangle_lives[t]);
        let project = |t: usize| {
            let corners = state.triangles[t].map(|v| {
                let vertex = &state.vertices[v as usize];
                (Vec3::from_array(vertex.position), vertex.outward())
            });
            VIEWS.map(|view| {
                corners.map(|(position, out)| Growing {
                    at: camera.place(view, position),
                    per_m: camera.offset(view, out),
                })
            })
        };
        Self { triangles: living.map(project).collect() }
    }

    /// Draws them, grown by `offset_m` along their normals.
    pub fn draw(&self, offset_m: f32, canvas: &mut Canvas) {
        for (view, pixels) in canvas.views.iter_mut().enumerate() {
            for triangle in &self.triangles {
                pixels.fill(triangle[view].map(|corner| corner.at + corner.per_m * offset_m));
            }
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
                pixels.fill_cut_out(corners, triangle.uvs, |uv| self.mask.opaque(uv));
            }
        }
    }

    /// What the elements alone cover.
    pub fn canvas(&self, camera: &Camera, scale: f32) -> Canvas {
        let mut canvas = Canvas::empty(camera);
        self.draw(scale, &mut canvas);
        canvas
    }
}
