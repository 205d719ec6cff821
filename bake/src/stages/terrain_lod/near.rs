//! Heightfield → an adaptive, conforming mesh of right triangles within a vertical error bound in metres.
//!
//! Top-down as the thesis's ROAM (3.2.1): a triangle whose error exceeds the bound is split, and so is its neighbour
//! across the hypotenuse, if need be after larger triangles (Lindstrom et al. 1996), so that no T-junction arises. The
//! error is the greatest vertical distance over all samples that the triangle covers, not the deviation of its middle
//! alone (as in Martini, which delivers twice the error that it claims) nor the wedgie (a sum that overstates it). As
//! the mesh's edges run along those of the uniform triangulation of all samples (see
//! [`genescape_schema::scene::bintree`]), that distance bounds the one between the two surfaces everywhere.

use genescape_schema::scene::bintree::{Sample, Triangle, requires};

use super::apron;
use super::data::{displacements_m, nested};
use super::verify::max_error_m;
use crate::model::{FarGround, Heightfield, Landform, Material, Mesh, Part, PartKind, TerrainMesh};

/// The smallest error bound that [`default_error_m`] gives, in metres.
const MIN_DEFAULT_M: f32 = 0.15;
/// Triangles per cell along a side that [`default_error_m`] aims at: about 100,000 at 513².
const TRIANGLES_PER_CELL_OF_A_SIDE: usize = 200;

const USED: u8 = 1;
/// The triangle at the split sample with the apex before (after) it in the field's order is known to be good.
const GOOD_BEFORE: u8 = 2;
const GOOD_AFTER: u8 = 4;

/// The land as triangles. `near` lies within `max_error_m` metres (vertically) of the triangulation of all samples
/// with diagonals as in the bintree; 0 or less keeps every sample. The true maximum, measured afterwards on the
/// finished mesh at every sample, is `error_m`. `far_ground` says what the ground is like at each sample of the apron
/// (missing ones are white, and of grass). No triangle crosses the lines every `block_m` metres from the north-west corner
/// (rounded down to a power of two in cells), so that scenes can cut out squares. Triangles are in the order of
/// Sierpiński's curve, which suits vertex caches.
pub fn mesh(land: &Landform, max_error_m: f32, block_m: f32, far_ground: &[FarGround]) -> TerrainMesh {
    let field = &land.field;
    let mut refiner = Refiner::new(field, max_error_m);
    for sample in apron::border_samples(land).into_iter().chain(block_corners(field, block_m)) {
        refiner.use_sample(sample);
    }
    refiner.refine_all();
    let near = refiner.triangles();
    let error_m = self::max_error_m(field, &near);
    let used = |[i, j]: Sample| refiner.marks[(j * field.side + i) as usize] & USED != 0;
    let (apron, apron_weights) = apron::ring(land, used, far_ground);
    TerrainMesh { error_m, apron, apron_weights, water: apron::water(land), near }
}

/// The corners of square blocks of 2^n cells, at most `block_m` wide but at least one cell. Where both ends of a
/// block's sides and diagonal are vertices, bintree triangles are no larger than half a block.
fn block_corners(field: &Heightfield, block_m: f32) -> impl Iterator<Item = Sample> {
    let cells = (block_m / field.spacing_m).clamp(1.0, (field.side - 1) as f32) as u32;
    let cells = 1 << cells.ilog2();
    let across = (field.side - 1) / cells;
    (0..=across).flat_map(move |j| (0..=across).map(move |i| [i * cells, j * cells]))
}

/// An error bound in metres that suits the land: 0.15 m, or on rough land more, the smallest that keeps the
/// mesh at roughly 200·(side−1) triangles (100,000 at 513²).
pub fn default_error_m(field: &Heightfield) -> f32 {
    let mut errors = nested(field.side, &displacements_m(field), f32::max);
    let vertices = TRIANGLES_PER_CELL_OF_A_SIDE * (field.side as usize - 1) / 2;
    if vertices >= errors.len() {
        return MIN_DEFAULT_M;
    }
    let (_, error, _) = errors.select_nth_unstable_by(vertices, |a, b| b.total_cmp(a));
    error.max(MIN_DEFAULT_M)
}

/// Marks on samples while triangles are split.
struct Refiner<'a> {
    field: &'a Heightfield,
    bound_m: f32,
    marks: Vec<u8>,
    changed: bool,
}

impl<'a> Refiner<'a> {
    fn new(field: &'a Heightfield, max_error_m: f32) -> Self {
        let (side, last) = (field.side as usize, field.side as usize - 1);
        let mut marks = vec![0; side * side];
        for corner in [0, last, last * side, last * side + last] {
            marks[corner] = USED;
        }
        // Room for the rounding of f32 in `exceeds`, so that the promise holds exactly.
        let [lowest, highest] = field.range_m();
        let bound_m = max_error_m.max(0.0) - 5.0e-7 * lowest.abs().max(highest.abs());
        Self { field, bound_m, marks, changed: false }
    }

    fn index(&self, [i, j]: Sample) -> usize {
        (j * self.field.side + i) as usize
    }

    /// Makes a sample a vertex, and first those on which it depends.
    fn use_sample(&mut self, sample: Sample) {
        let index = self.index(sample);
        if self.marks[index] & USED != 0 {
            return;
        }
        self.marks[index] |= USED;
        self.changed = true;
        for required in requires(sample, self.field.side - 1).into_iter().flatten() {
            self.use_sample(required);
        }
    }

    /// Splits until every triangle is good. A split forced upon a good triangle may leave children that are not,
    /// hence the repetition; samples only ever become vertices, so it ends.
    fn refine_all(&mut self) {
        loop {
            self.changed = false;
            for root in Triangle::roots(self.field.side) {
                self.refine(root);
            }
            if !self.changed {
                return;
            }
        }
    }

    fn refine(&mut self, triangle: Triangle) {
        let Some(middle) = triangle.middle() else { return };
        let index = self.index(middle);
        if self.marks[index] & USED == 0 {
            let good = if self.index(triangle.apex) < index { GOOD_BEFORE } else { GOOD_AFTER };
            if self.marks[index] & good != 0 {
                return;
            }
            if !exceeds(self.field, &triangle, middle, self.bound_m) {
                self.marks[index] |= good;
                return;
            }
            self.use_sample(middle);
        }
        for child in triangle.children(middle) {
            self.refine(child);
        }
    }

    /// The finished mesh.
    fn triangles(&self) -> Mesh {
        let used = self.marks.iter().filter(|&&mark| mark & USED != 0).count();
        let (numbers, triangles) = (vec![u32::MAX; self.marks.len()], Vec::with_capacity(2 * used));
        let mut walk = Walk { refiner: self, numbers, mesh: Mesh::default(), triangles };
        for root in Triangle::roots(self.field.side) {
            walk.emit(root, true);
        }
        let parts =
            vec![Part { material: Material::Ground, kind: PartKind::Surface, triangles: walk.triangles }];
        Mesh { parts, ..walk.mesh }
    }
}

/// Whether some sample lies more than `bound_m` above or below the triangle.
fn exceeds(field: &Heightfield, triangle: &Triangle, middle: Sample, bound_m: f32) -> bool {
    let height = |[i, j]: Sample| field.at(i, j);
    let (ha, hb, hc) = (height(triangle.a), height(triangle.b), height(triangle.apex));
    let off_middle = (0.5 * (ha + hb) - height(middle)).abs();
    if off_middle > bound_m || off_middle.is_nan() {
        return true;
    }
    let [a, b, c] = [triangle.a, triangle.b, triangle.apex].map(|s| [s[0] as i32, s[1] as i32]);
    let ([bx, bz], [cx, cz]) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
    let scale = 1.0 / (bx * cz - cx * bz) as f32;
    let east = ((hb - ha) * cz as f32 - (hc - ha) * bz as f32) * scale;
    let south = ((hc - ha) * bx as f32 - (hb - ha) * cx as f32) * scale;
    let mut corners = [a, b, c];
    corners.sort_unstable_by_key(|corner| corner[1]);
    for z in corners[0][1]..=corners[2][1] {
        let (first, last) = row(&corners, z);
        let start = (z * field.side as i32 + first) as usize;
        let heights = &field.heights_m[start..=start + (last - first) as usize];
        let plane = ha + (z - a[1]) as f32 * south + (first - a[0]) as f32 * east;
        // As integers: the compiler does not vectorise the maximum of floats.
        let mut worst = 0;
        for (k, height) in heights.iter().enumerate() {
            worst = worst.max((height - (plane + k as i32 as f32 * east)).abs().to_bits() as i32);
        }
        let worst = f32::from_bits(worst as u32);
        if worst > bound_m || worst.is_nan() {
            return true;
        }
    }
    false
}

/// First and last column of a triangle's row `z`; corners sorted by row. All edges have slope 0, 1 or −1.
fn row(corners: &[[i32; 2]; 3], z: i32) -> (i32, i32) {
    let [top, middle, bottom] = *corners;
    let along =
        |from: [i32; 2], to: [i32; 2]| from[0] + (to[0] - from[0]) / (to[1] - from[1]) * (z - from[1]);
    let long = along(top, bottom);
    let short =
        if z >= middle[1] && middle[1] < bottom[1] { along(middle, bottom) } else { along(top, middle) };
    (long.min(short), long.max(short))
}

/// Numbers vertices as triangles first need them.
struct Walk<'a> {
    refiner: &'a Refiner<'a>,
    numbers: Vec<u32>,
    mesh: Mesh,
    triangles: Vec<[u32; 3]>,
}

impl Walk<'_> {
    /// `forward`: from the hypotenuse's end a to b, so that each triangle shares an edge with the next.
    fn emit(&mut self, triangle: Triangle, forward: bool) {
        let middle = triangle.middle().filter(|&m| self.refiner.marks[self.refiner.index(m)] & USED != 0);
        let Some(middle) = middle else {
            let corners = [triangle.a, triangle.b, triangle.apex].map(|sample| self.number(sample));
            self.triangles.push(corners);
            return;
        };
        let mut children = triangle.children(middle);
        if !forward {
            children.reverse();
        }
        children.into_iter().for_each(|child| self.emit(child, !forward));
    }

    fn number(&mut self, sample: Sample) -> u32 {
        let index = self.refiner.index(sample);
        if self.numbers[index] == u32::MAX {
            self.numbers[index] = self.mesh.positions.len() as u32;
            let (position, normal) = apron::vertex(self.refiner.field, sample);
            let last = (self.refiner.field.side - 1) as f32;
            self.mesh.positions.push(position);
            self.mesh.normals.push(normal);
            self.mesh.uvs.push(sample.map(|n| n as f32 / last));
        }
        self.numbers[index]
    }
}
