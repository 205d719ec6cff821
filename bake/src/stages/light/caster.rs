//! A tree's coarse mesh and the sun → its shadow as a small image of transmittance (0–1), in the plane across the
//! light, in metres of the tree's own space.
//!
//! Coordinates in that plane, from the tree's foot: `a` to the right as the sun sees it, `c` up. Front faces count
//! like back faces, so that the ground under the trunk is shadowed and no gap opens at its base (thesis 4.4.2).
//! The image is drawn finely and then filtered: by a texel of the light map as the sun sees it, so that edges are
//! smooth; and by the sun's disc, more the higher a part stands, so that the trunk's shadow is sharp and the
//! crown's is soft.

use std::ops::Range;

use glam::{Vec2, Vec3};

use super::sun::Sun;
use crate::model::Caster;

/// Greatest number of cells of an image, across and up.
const MAX_CELLS: [usize; 2] = [96, 192];
/// Cells per texel of the light map.
const CELLS_PER_TEXEL: f32 = 4.0;
/// Triangles wholly below this height are roots in the ground.
const MIN_HEIGHT_M: f32 = -0.25;

/// A crown as it hides the sky: a sphere squashed to its height.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crown {
    /// Height of its middle and horizontal radius in metres.
    pub height_m: f32,
    pub radius_m: f32,
    /// Part of the light that it holds back.
    pub opacity: f32,
}

impl Crown {
    /// From the spread of leaves and wood, weighted by area.
    pub fn of(Caster { mesh, opacities }: &Caster) -> Self {
        let (mut area, mut height, mut spread, mut plan) = (0.0_f32, 0.0, 0.0, 0.0);
        for (part, opacity) in mesh.parts.iter().zip(opacities) {
            for triangle in &part.triangles {
                let [a, b, c] = triangle.map(|v| Vec3::from_array(mesh.positions[v as usize]));
                let (middle, normal) = ((a + b + c) / 3.0, (b - a).cross(c - a) * 0.5);
                let weight = normal.length() * opacity;
                area += weight;
                height += weight * middle.y;
                spread += weight * (middle.x * middle.x + middle.z * middle.z);
                plan += normal.y.abs() * opacity;
            }
        }
        if area <= 0.0 {
            return Self { height_m: 1.0, radius_m: 0.0, opacity: 0.0 };
        }
        // An even disc's mean square radius is half its radius squared.
        let radius_m = (2.0 * spread / area).sqrt();
        let depth = plan / (std::f32::consts::PI * radius_m * radius_m).max(1.0e-3);
        Self { height_m: (height / area).max(0.3), radius_m, opacity: 1.0 - libm::expf(-depth) }
    }
}

/// A tree's shadow.
pub(super) struct Shadow {
    /// Rows from low `c` to high.
    pub transmittance: Vec<f32>,
    pub columns: usize,
    pub rows: usize,
    /// Plane coordinates of the first cell's middle, and cells per metre.
    pub origin: Vec2,
    pub cells_per_m: Vec2,
    /// Least and greatest (a, c) that it covers.
    pub low: Vec2,
    pub high: Vec2,
    /// Greatest distance of the tree's parts from its axis in metres.
    pub reach_m: f32,
}

impl Shadow {
    /// Of a tree seen from the sun if it stood in plan direction `front` (x, z; unit), with texels of `texel_m`.
    pub fn draw(caster: &Caster, sun: &Sun, front: [f32; 2], texel_m: f32) -> Option<Self> {
        let mesh = &caster.mesh;
        let project = |p: &[f32; 3]| {
            let (away, right) = (p[0] * front[0] + p[2] * front[1], p[2] * front[0] - p[0] * front[1]);
            Vec2::new(right, p[1] * sun.cos_elevation - away * sun.sin_elevation)
        };
        let points: Vec<Vec2> = mesh.positions.iter().map(project).collect();
        let first = *points.first()?;
        let (low, high) = points.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p)));
        let squares = mesh.positions.iter().map(|p| p[0] * p[0] + p[2] * p[2]);
        let reach_m = squares.fold(0.0, f32::max).sqrt();
        let top_m = mesh.positions.iter().fold(0.0_f32, |top, p| top.max(p[1]));
        let filter = Filter::new(sun, texel_m, top_m);
        let border = Vec2::from_array(filter.widths(top_m)) + texel_m * 0.25;
        let (low, high) = (low - border, high + border);
        let cells = |axis: usize, texel_m: f32| {
            let wanted = ((high[axis] - low[axis]) * CELLS_PER_TEXEL / texel_m) as usize + 1;
            wanted.clamp(4, MAX_CELLS[axis])
        };
        let (columns, rows) = (cells(0, texel_m), cells(1, texel_m * sun.sin_elevation.max(0.02)));
        let cells_per_m = Vec2::new(columns as f32, rows as f32) / (high - low);
        let origin = low + 0.5 / cells_per_m;
        let transmittance = vec![1.0; columns * rows];
        let mut shadow = Self { transmittance, columns, rows, origin, cells_per_m, low, high, reach_m };
        // In cells; whole numbers are middles.
        let grid: Vec<Vec2> = points.iter().map(|&p| (p - origin) * cells_per_m).collect();
        let slabs = filter.slabs(top_m);
        for (slab, range) in slabs.windows(2).enumerate() {
            let mut layer = vec![1.0; columns * rows];
            let widths = filter.widths(0.5 * (range[0] + range[1].min(top_m)));
            let range = [if slab == 0 { f32::MIN } else { range[0] }, range[1]];
            if let Some(drawn) = shadow.slab(caster, &grid, range, &mut layer) {
                let blurred = shadow.blur(&mut layer, drawn, widths);
                let cells = blurred.start * columns..blurred.end * columns;
                let whole = &mut shadow.transmittance[cells.clone()];
                whole.iter_mut().zip(&layer[cells]).for_each(|(whole, slab)| *whole *= slab);
            }
        }
        Some(shadow)
    }

    /// Draws the triangles whose middle lies in a range of heights; the rows that it touched.
    fn slab(
        &self,
        Caster { mesh, opacities }: &Caster,
        grid: &[Vec2],
        range: [f32; 2],
        layer: &mut [f32],
    ) -> Option<Range<usize>> {
        let mut drawn: Option<Range<usize>> = None;
        for (part, opacity) in mesh.parts.iter().zip(opacities) {
            let left = 1.0 - opacity;
            for triangle in &part.triangles {
                let heights = triangle.map(|v| mesh.positions[v as usize][1]);
                let middle = (heights[0] + heights[1] + heights[2]) / 3.0;
                if middle >= range[0] && middle < range[1] && heights.iter().any(|&y| y > MIN_HEIGHT_M) {
                    let rows = self.fill(triangle.map(|v| grid[v as usize]), left, layer);
                    let before = drawn.unwrap_or(rows.clone());
                    drawn = Some(before.start.min(rows.start)..before.end.max(rows.end));
                }
            }
        }
        drawn
    }

    /// Multiplies the cells whose middle lies in a triangle; edges belong to one of the triangles that share them.
    /// Returns its rows.
    fn fill(&self, [a, b, c]: [Vec2; 3], left: f32, layer: &mut [f32]) -> Range<usize> {
        let corners = if (b - a).perp_dot(c - a) > 0.0 { [a, b, c] } else { [a, c, b] };
        // Each edge as its crossing with row 0 and its run per row; rising edges bound the right, falling the left.
        let edges: [(f32, f32, f32); 3] = std::array::from_fn(|k| {
            let (p, q) = (corners[k], corners[(k + 1) % 3]);
            let rise = q.y - p.y;
            let run = if rise == 0.0 { 0.0 } else { (q.x - p.x) / rise };
            (p.x - p.y * run, run, rise)
        });
        let low = ceil(a.y.min(b.y).min(c.y));
        let high = ceil(a.y.max(b.y).max(c.y)).min(self.rows);
        for row in low..high {
            let (mut from, mut to) = (0.0_f32, self.columns as f32);
            for (start, run, rise) in edges {
                let cross = start + run * row as f32;
                if rise > 0.0 {
                    to = to.min(cross);
                } else if rise < 0.0 {
                    from = from.max(cross);
                }
            }
            let (first, end) = (ceil(from), ceil(to));
            if first < end {
                let start = row * self.columns;
                layer[start + first..start + end].iter_mut().for_each(|cell| *cell *= left);
            }
        }
        low..high.max(low)
    }

    /// A tent, as two boxes after each other, along both axes, of the rows that were drawn; the rows it changed.
    fn blur(&self, layer: &mut [f32], drawn: Range<usize>, widths_m: [f32; 2]) -> Range<usize> {
        let radius = |axis: usize| (widths_m[axis] * self.cells_per_m[axis] * 0.5) as usize;
        let (across, up) = (radius(0), radius(1));
        let rows = drawn.start.saturating_sub(2 * up)..(drawn.end + 2 * up).min(self.rows);
        let layer = &mut layer[rows.start * self.columns..rows.end * self.columns];
        let mut copy = vec![0.0; layer.len()];
        for _ in 0..if across > 0 { 2 } else { 0 } {
            copy.copy_from_slice(layer);
            let lines = layer.chunks_exact_mut(self.columns).zip(copy.chunks_exact(self.columns));
            lines.for_each(|(to, from)| box_filter(to, from, 1, across));
        }
        for _ in 0..if up > 0 { 2 } else { 0 } {
            copy.copy_from_slice(layer);
            box_filter(layer, &copy, self.columns, up);
        }
        rows
    }
}

/// Smallest whole number not below a number; 0 for negative ones.
#[inline]
fn ceil(value: f32) -> usize {
    let whole = value.max(0.0) as i32;
    (whole + i32::from((whole as f32) < value)) as usize
}

/// Mean over 2·radius+1 lines of `width` values each; beyond the ends everything is lit.
fn box_filter(to: &mut [f32], from: &[f32], width: usize, radius: usize) {
    let count = from.len() / width;
    let line = |at: usize| &from[at * width..(at + 1) * width];
    let scale = 1.0 / (2 * radius + 1) as f32;
    // The sum of what is held back, so that nothing need be added beyond the ends.
    let mut sums = vec![0.0; width];
    let change = |sums: &mut [f32], at: usize, sign: f32| {
        sums.iter_mut().zip(line(at)).for_each(|(sum, value)| *sum += sign * (1.0 - value));
    };
    (0..radius.min(count)).for_each(|at| change(&mut sums, at, 1.0));
    for at in 0..count {
        if at + radius < count {
            change(&mut sums, at + radius, 1.0);
        }
        if at > radius {
            change(&mut sums, at - radius - 1, -1.0);
        }
        let values = to[at * width..(at + 1) * width].iter_mut();
        values.zip(&sums).for_each(|(value, sum)| *value = (1.0 - sum * scale).clamp(0.0, 1.0));
    }
}

/// How wide the shadow's filter is.
struct Filter {
    texel_m: [f32; 2],
    /// Radius of the sun's disc on the ground's side, per metre of height.
    spread: f32,
    max_disc_m: f32,
}

impl Filter {
    fn new(sun: &Sun, texel_m: f32, top_m: f32) -> Self {
        let sin_elevation = sun.sin_elevation.max(0.02);
        let texel_m = [texel_m, texel_m * sin_elevation];
        Self { texel_m, spread: sun.sin_radius / sin_elevation, max_disc_m: 0.6 * top_m.max(0.0) }
    }

    /// Widths across and up of a box that, applied twice, spreads as much as a texel and the disc together, for
    /// parts at a height (the variance of a box is width²/12, of a disc radius²/4).
    fn widths(&self, height_m: f32) -> [f32; 2] {
        let disc = (height_m * self.spread).min(self.max_disc_m);
        self.texel_m.map(|texel| (6.0 * (disc * disc / 4.0 + texel * texel / 4.0)).sqrt())
    }

    /// Limits of the slabs of height that are filtered separately: more the softer the sun, thinner near the ground.
    fn slabs(&self, top_m: f32) -> Vec<f32> {
        let disc = top_m * self.spread;
        let count = match disc {
            _ if disc < 0.5 * self.texel_m[1] => 1,
            _ if disc < 0.7 * self.texel_m[0] => 2,
            _ => 4,
        };
        let limit = |k: u32| k as f32 / count as f32;
        let limits = (0..count).map(|k| limit(k) * limit(k) * top_m);
        limits.chain([f32::INFINITY]).collect::<Vec<f32>>()
    }
}
