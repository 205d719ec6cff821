//! How many pixels elements cover when seen from the sides: rows of bits, filled triangle by triangle.
//!
//! Orthographic views of 64 × 64 pixels; a pixel counts when its centre is inside a triangle.

use glam::{Vec2, Vec3};

use super::state::{PartSpan, State};

const SIDE: usize = 64;
/// Unit vectors to the right in each view; up is +y.
const RIGHT: [Vec3; 3] =
    [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.5, 0.0, 0.866_025_4), Vec3::new(-0.5, 0.0, 0.866_025_4)];

/// Elements as seen from the sides.
pub struct Silhouettes {
    /// Triangles by element, their vertices counted from the part's first.
    triangles: Vec<[u32; 3]>,
    /// Triangles of an element.
    per_element: usize,
    views: Vec<View>,
    /// Pixels that all elements cover at their own size.
    pub full: u32,
}

/// Each element's centre, and the offset of each vertex from it, in pixels.
struct View {
    centres: Vec<Vec2>,
    offsets: Vec<Vec2>,
}

impl Silhouettes {
    /// Projects the elements of a part, whose centres and box are given, with their area reduced by the factor `fill`.
    pub fn new(state: &State, span: &PartSpan, centres: &[Vec3], [low, high]: [Vec3; 2], fill: f32) -> Self {
        let middle = (low + high) * 0.5;
        // Room for elements to grow beyond the box.
        let extent = (high - low).length().max(f32::MIN_POSITIVE) * 1.1;
        let (pixels, shrink) = (SIDE as f32 / extent, fill.clamp(0.01, 1.0).sqrt());
        let first = span.element(0);
        let vertices = &state.vertices[first[0].start..][..centres.len() * first[0].len()];
        let view = |right: &Vec3| {
            let flat = |v: Vec3| Vec2::new(v.dot(*right), v.y) * pixels;
            let elements = vertices.chunks_exact(first[0].len()).zip(centres);
            let offsets = elements.flat_map(|(vertices, &centre)| {
                vertices.iter().map(move |v| flat(Vec3::from_array(v.position) - centre) * shrink)
            });
            View {
                centres: centres.iter().map(|&v| flat(v - middle) + 0.5 * SIDE as f32).collect(),
                offsets: offsets.collect(),
            }
        };
        let triangles = state.triangles[span.range()].iter().map(|t| t.map(|v| v - span.first_vertex));
        let mut silhouettes = Self {
            triangles: triangles.collect(),
            per_element: first[1].len(),
            views: RIGHT.iter().map(view).collect(),
            full: 0,
        };
        silhouettes.full = silhouettes.covered(&vec![true; centres.len()], 1.0);
        silhouettes
    }

    /// Pixels that the living elements cover when each is scaled about its centre.
    pub fn covered(&self, lives: &[bool], scale: f32) -> u32 {
        let cover = |view: &View| {
            let mut rows = [0_u64; SIDE];
            let elements = self.triangles.chunks_exact(self.per_element).zip(&view.centres).zip(lives);
            for ((triangles, &centre), _) in elements.filter(|(_, lives)| **lives) {
                for triangle in triangles {
                    fill(&mut rows, triangle.map(|v| centre + view.offsets[v as usize] * scale));
                }
            }
            rows.iter().map(|row| row.count_ones()).sum::<u32>()
        };
        self.views.iter().map(cover).sum()
    }
}

/// Sets the bits of pixels whose centres lie in a triangle.
fn fill(rows: &mut [u64; SIDE], [a, b, c]: [Vec2; 3]) {
    let (low, high) = (a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
    let first = (low - 0.5).max(-1.0).ceil() as i32;
    let last = (high - 0.5).min(SIDE as f32).floor() as i32;
    let slopes = [(a, b), (b, c), (c, a)].map(|(p, q)| (q.x - p.x) / (q.y - p.y));
    for row in first.max(0)..=last.min(SIDE as i32 - 1) {
        let y = row as f32 + 0.5;
        let (mut left, mut right) = (f32::MAX, f32::MIN);
        for ((p, q), slope) in [(a, b), (b, c), (c, a)].into_iter().zip(slopes) {
            if (p.y <= y) != (q.y <= y) {
                let x = p.x + (y - p.y) * slope;
                left = left.min(x);
                right = right.max(x);
            }
        }
        let start = (left - 0.5).ceil().max(0.0) as u32;
        let end = ((right - 0.5).ceil()).clamp(0.0, SIDE as f32) as u32;
        if start < end {
            let ones = if end - start >= 64 { u64::MAX } else { (1_u64 << (end - start)) - 1 };
            rows[row as usize] |= ones << start;
        }
    }
}
