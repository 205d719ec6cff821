//! How many pixels a mesh covers when seen from the sides, orthographically; elements of aggregates are cut out by their
//! texture's alpha.

use std::f32::consts::FRAC_1_SQRT_2;

use glam::{Vec2, Vec3};

use super::state::{PartSpan, State};
use crate::model::AlphaMask;
use crate::silhouette::Silhouette;

/// Unit vectors to the right in each view, the first two across each other, and how far each looks from below or above: the tangent
/// of its elevation.
const VIEWS: [View; 8] = [
    (Vec3::new(FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2), 0.2),
    (Vec3::new(-FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2), -0.2),
    (Vec3::X, 0.2),
    (Vec3::Z, -0.2),
    (Vec3::new(FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2), -0.2),
    (Vec3::new(-FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2), 0.2),
    (Vec3::X, -0.2),
    (Vec3::Z, 0.2),
];

type View = (Vec3, f32);

/// How finely is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// Of many elements, for which two views will do.
    Many,
    /// Of thin ones.
    Thin,
    /// Of few, which hide each other from one side and not from another, from above and not from below.
    Few,
}

impl Detail {
    /// Views, and pixels along each of their sides.
    fn views(self) -> (&'static [View], usize) {
        match self {
            Self::Many => (&VIEWS[..2], 128),
            Self::Thin => (&VIEWS[..4], 320),
            Self::Few => (&VIEWS, 320),
        }
    }
}

/// Where a mesh lies in the views.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    middle: Vec3,
    pixels_per_m: f32,
    views: &'static [View],
    /// Pixels a side.
    side: usize,
}

impl Camera {
    /// Shows the box from `low` to `high`, with room for elements to grow beyond it.
    pub fn of([low, high]: [Vec3; 2], detail: Detail) -> Self {
        let (views, side) = detail.views();
        let extent_m = (high - low).length().max(f32::MIN_POSITIVE) * 1.1;
        Self { middle: (low + high) * 0.5, pixels_per_m: side as f32 / extent_m, views, side }
    }

    /// A distance in pixels from the left and from the bottom.
    fn offset(&self, (right, tilt): View, by: Vec3) -> Vec2 {
        let forward = right.cross(Vec3::Y);
        Vec2::new(by.dot(right), by.y + by.dot(forward) * tilt) * self.pixels_per_m
    }

    fn place(&self, view: View, at: Vec3) -> Vec2 {
        self.offset(view, at - self.middle) + 0.5 * self.side as f32
    }
}

/// Which pixels are covered in each view.
#[derive(Clone)]
pub struct Canvas {
    /// Rows from the bottom.
    views: Vec<Silhouette>,
}

impl Canvas {
    pub fn empty(camera: &Camera) -> Self {
        Self { views: vec![Silhouette::empty(camera.side); camera.views.len()] }
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
    /// In each view of each triangle, where its corners are, in pixels, and how they move for each metre by which the surface
    /// grows.
    views: Vec<Vec<[Growing; 3]>>,
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
        let living: Vec<usize> =
            surfaces.flat_map(PartSpan::range).filter(|&t| state.triangle_lives[t]).collect();
        let project = |view: View, t: usize| {
            state.triangles[t].map(|v| {
                let vertex = &state.vertices[v as usize];
                Growing {
                    at: camera.place(view, Vec3::from_array(vertex.position)),
                    per_m: camera.offset(view, vertex.outward()),
                }
            })
        };
        let in_view = |&view: &View| living.iter().map(|&t| project(view, t)).collect();
        Self { views: camera.views.iter().map(in_view).collect() }
    }

    /// Draws them, grown by `offset_m` along their normals.
    pub fn draw(&self, offset_m: f32, canvas: &mut Canvas) {
        for (triangles, pixels) in self.views.iter().zip(&mut canvas.views) {
            for triangle in triangles {
                pixels.fill(triangle.map(|corner| corner.at + corner.per_m * offset_m));
            }
        }
    }
}

/// The living elements of an aggregate as seen from the sides.
pub struct Elements {
    mask: AlphaMask,
    /// In each view.
    views: Vec<Vec<Triangle>>,
}

/// A triangle of an element, in pixels.
struct Triangle {
    uvs: [Vec2; 3],
    /// Where the element's centre is.
    centre: Vec2,
    /// Where the corners are from there.
    corners: [Vec2; 3],
}

impl Elements {
    /// Projects what lives of a part.
    pub fn new(state: &State, span: &PartSpan, camera: &Camera, mask: AlphaMask) -> Self {
        let mut views: Vec<Vec<Triangle>> = camera.views.iter().map(|_| Vec::new()).collect();
        for element in state.living_elements(span) {
            let [ids, range] = span.element(element);
            let centre = state.centre(ids);
            for t in range.filter(|&t| state.triangle_lives[t]) {
                let vertices = state.triangles[t].map(|v| state.vertices[v as usize]);
                let uvs = vertices.map(|v| Vec2::from_array(v.uv));
                let offsets = vertices.map(|v| Vec3::from_array(v.position) - centre);
                for (&view, triangles) in camera.views.iter().zip(&mut views) {
                    let corners = offsets.map(|by| camera.offset(view, by));
                    triangles.push(Triangle { uvs, centre: camera.place(view, centre), corners });
                }
            }
        }
        Self { mask, views }
    }

    /// Draws the elements, each scaled about its centre.
    pub fn draw(&self, scale: f32, canvas: &mut Canvas) {
        for (triangles, pixels) in self.views.iter().zip(&mut canvas.views) {
            for triangle in triangles {
                let corners = triangle.corners.map(|by| triangle.centre + by * scale);
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
