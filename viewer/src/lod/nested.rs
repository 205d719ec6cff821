//! A heightfield → triangles of its bintree for a view, and how far each of their corners has risen. Metres, pixels.
//!
//! A sample is in use while the land would look more than the bound away from what is drawn without it. Its error E is the greatest
//! distance between the land and the one or two triangles that it splits, all samples in them counted; its radius R reaches over
//! them. From the distance d, less R, it is drawn in the middle of the hypotenuse that it splits at d = P·E, where a metre of error
//! looks as large as the bound, P being pixels a radian for each pixel allowed; and has risen to the land at d = P·E/k, in a straight
//! line of d. So level of detail follows both distance and roughness, which the thesis (9) asks for and leaves open.
//!
//! Both E and R are nested, as Lindstrom and Pascucci ("Terrain simplification simplified", 2002) have them for meshes without
//! morphs: what a sample requires has an error at least k times as great, and a ball that holds the sample's. Then:
//! - *No T-junction.* What a sample requires is in use while the sample is, whatever is in sight: nobody has to ask.
//! - *No crack, no recursion.* While a sample rises, all it requires have risen, the ends of its hypotenuse among them. So where it is
//!   follows from three heights and the eye alone, whichever triangle asks.
//! - *No pop.* It begins in the middle of an edge that was drawn before it.
//! - *Within the bound.* Of a triangle at most one corner is rising, and the surface is a mean of those before and after, which are
//!   P·E and P·E/k away at most: (1 − w)·E + w·E/k ≤ d/P for w = (1 − d/(P·E))/(1 − 1/k). Nothing is spared for the morph.

use genescape_schema::scene::bintree::{Sample, Triangle, parents, requires, step};
use glam::Vec3;

use super::block::top_level;
use super::morph::sample_m;
use crate::camera::Frustum;
use crate::scene::Heightfield;

/// k: the error of what a sample requires over its own, at least. The less, the fewer samples are in use for others' sake, and the
/// sooner one rises. Land is smooth enough that errors fall by more from level to level nearly everywhere.
pub const RATIO: f32 = 1.2;
/// The least P that is tried to keep to a number of triangles, and how many are tried: to a part in a hundred.
const MIN_PIXELS: f32 = 1e-2;
const TRIES: u32 = 12;
/// All planes of a frustum still to be tested.
const ALL_PLANES: u32 = (1 << 5) - 1;

/// When a sample is in use.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Bounds {
    /// E, of it and of all that require it.
    pub error_m: f32,
    /// R: what it splits, and all that require it, lies so near at most.
    pub radius_m: f32,
}

/// How far a field's coarser triangulations are from it. To be computed once a field.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Nested {
    /// Of all samples, by row.
    pub bounds: Vec<Bounds>,
    /// The greatest error of the uniform triangulation of each level from 1 on, anywhere.
    pub levels_m: Vec<f32>,
}

/// What is asked of one picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    pub eye_m: Vec3,
    /// P: pixels that a radian covers, ½·height/tan(½·fov), over the pixels of error that are allowed. Infinite for every sample.
    pub pixels: f32,
}

impl Bounds {
    /// Whether a sample there is in use.
    #[inline]
    fn is_used(self, sight: &Sight, at_m: Vec3) -> bool {
        let reach_m = sight.pixels * self.error_m + self.radius_m;
        self.error_m > 0.0 && at_m.distance_squared(sight.eye_m) < reach_m * reach_m
    }

    /// How far it has risen from the middle of its hypotenuse, 0 to 1, as the shader has it.
    #[inline]
    pub fn risen(self, sight: &Sight, at_m: Vec3) -> f32 {
        let part = (at_m.distance(sight.eye_m) - self.radius_m) / (sight.pixels * self.error_m);
        ((1.0 - part) / (1.0 - 1.0 / RATIO)).clamp(0.0, 1.0)
    }
}

impl Nested {
    /// Measures a field.
    pub fn of(field: &Heightfield) -> Self {
        let mut nested =
            Self { bounds: vec![Bounds::default(); field.heights_m.len()], levels_m: Vec::new() };
        if field.side > 2 {
            Triangle::roots(field.side).into_iter().for_each(|root| nested.measure(field, root));
            // Cells of a level have the diagonals that the centres of their blocks split.
            let greatest_m = |finer: u32| {
                let mut greatest_m = 0.0f32;
                for_each_of(field.side - 1, 1 << finer, true, |sample| {
                    greatest_m = greatest_m.max(nested.bounds[entry(field, sample)].error_m);
                });
                greatest_m
            };
            nested.levels_m = (0..top_level(field)).map(greatest_m).collect();
            nested.nest(field);
        }
        nested
    }

    /// Enters the errors and radii of a triangle and of all below it.
    fn measure(&mut self, field: &Heightfield, triangle: Triangle) {
        let Some(middle) = triangle.middle() else { return };
        let error_m = error_m(field, &triangle);
        let at_m = sample_m(field, middle);
        let corners = [triangle.a, triangle.b, triangle.apex];
        let radius_m = corners.map(|c| sample_m(field, c).distance(at_m)).into_iter().fold(0.0, f32::max);
        let own = &mut self.bounds[entry(field, middle)];
        *own = Bounds { error_m: own.error_m.max(error_m), radius_m: own.radius_m.max(radius_m) };
        triangle.children(middle).into_iter().for_each(|child| self.measure(field, child));
    }

    /// Raises what is required: from the finest level to the coarsest, edges' middles before blocks' centres.
    fn nest(&mut self, field: &Heightfield) {
        let last = field.side - 1;
        for level in 0..last.trailing_zeros() {
            for is_center in [false, true] {
                for_each_of(last, 1 << level, is_center, |sample| {
                    let (own, at_m) = (self.bounds[entry(field, sample)], sample_m(field, sample));
                    for needed in requires(sample, last).into_iter().flatten() {
                        let radius_m = own.radius_m + sample_m(field, needed).distance(at_m);
                        let bounds = &mut self.bounds[entry(field, needed)];
                        bounds.error_m = bounds.error_m.max(RATIO * own.error_m);
                        bounds.radius_m = bounds.radius_m.max(radius_m);
                    }
                });
            }
        }
    }

    /// Replaces `triangles` by those to draw, the nearest first; those that `frustum` doesn't see are left out. Corners are
    /// counter-clockwise from above, and the first is the one of the finest level.
    pub fn select(
        &self,
        field: &Heightfield,
        sight: &Sight,
        frustum: Option<&Frustum>,
        triangles: &mut Vec<[u32; 3]>,
    ) {
        triangles.clear();
        if field.side < 2 {
            return;
        }
        let planes = if frustum.is_some() { ALL_PLANES } else { 0 };
        let mut selection = Selection { nested: self, field, sight, frustum, triangles };
        let mut roots = Triangle::roots(field.side);
        if !selection.is_nearer(&roots[0], &roots[1]) {
            roots.reverse();
        }
        roots.into_iter().for_each(|root| selection.visit(root, planes));
    }

    /// The same for the sight with nearly the largest P, at most the one given, that asks for no more than `budget` triangles; tells
    /// which. A few hundred around the eye are always there, for radii do not shrink with errors.
    pub fn select_within(
        &self,
        field: &Heightfield,
        sight: Sight,
        frustum: Option<&Frustum>,
        budget: u32,
        triangles: &mut Vec<[u32; 3]>,
    ) -> Sight {
        let mut fits = |pixels: f32| {
            self.select(field, &Sight { pixels, ..sight }, frustum, triangles);
            triangles.len() <= budget as usize
        };
        if fits(sight.pixels) {
            return sight;
        }
        let (mut low, mut high) = (MIN_PIXELS, sight.pixels);
        for _ in 0..TRIES {
            let middle = (low * high).sqrt();
            *(if fits(middle) { &mut low } else { &mut high }) = middle;
        }
        fits(low);
        Sight { pixels: low, ..sight }
    }

    /// Where the shader draws the corners of triangles.
    pub fn drawn(&self, field: &Heightfield, sight: &Sight, triangles: &[[u32; 3]]) -> Vec<[Vec3; 3]> {
        let place_m = |number| self.drawn_m(field, sight, [number % field.side, number / field.side]);
        triangles.iter().map(|corners| corners.map(place_m)).collect()
    }

    /// Where the shader draws a sample that is in use.
    fn drawn_m(&self, field: &Heightfield, sight: &Sight, sample: Sample) -> Vec3 {
        let at_m = sample_m(field, sample);
        if sample.map(|line| line % (field.side - 1)) == [0, 0] {
            return at_m;
        }
        let [a, b] = parents(sample).map(|end| field.at(end[0], end[1]));
        let risen = self.bounds[entry(field, sample)].risen(sight, at_m);
        at_m.with_y(0.5 * (a + b) + risen * (at_m.y - 0.5 * (a + b)))
    }
}

#[inline]
fn entry(field: &Heightfield, [i, j]: Sample) -> usize {
    (j * field.side + i) as usize
}

/// All samples of a step that are centres of blocks, or all that are middles of their edges.
fn for_each_of(last: u32, of_step: u32, is_center: bool, mut each: impl FnMut(Sample)) {
    for j in (0..=last).step_by(of_step as usize) {
        let is_odd = j & of_step != 0;
        let (first, by) = match (is_center, is_odd) {
            (true, false) => continue,
            (true, true) | (false, false) => (of_step, 2 * of_step),
            (false, true) => (0, 2 * of_step),
        };
        (first..=last).step_by(by as usize).for_each(|i| {
            debug_assert_eq!(step([i, j]), of_step);
            each([i, j]);
        });
    }
}

/// The greatest vertical distance between the samples in a triangle and its plane.
fn error_m(field: &Heightfield, triangle: &Triangle) -> f32 {
    let Triangle { a, b, apex } = *triangle;
    let from = |p: Sample, q: Sample| [0, 1].map(|axis| q[axis] as f32 - p[axis] as f32);
    let height = |[i, j]: Sample| field.at(i, j);
    let ([ui, uj], [vi, vj]) = (from(apex, a), from(apex, b));
    let (du, dv) = (height(a) - height(apex), height(b) - height(apex));
    let whole = ui * vj - uj * vi;
    let (per_i, per_j) = ((du * vj - dv * uj) / whole, (dv * ui - du * vi) / whole);
    let rows = a[1].min(b[1]).min(apex[1])..=a[1].max(b[1]).max(apex[1]);
    let mut greatest_m = 0.0f32;
    for j in rows {
        let [first, last] = columns([a, b, apex], j);
        let row = &field.heights_m[entry(field, [first, j])..=entry(field, [last, j])];
        let start =
            height(apex) + per_j * (j as f32 - apex[1] as f32) + per_i * (first as f32 - apex[0] as f32);
        let off = row.iter().enumerate().map(|(n, land_m)| (land_m - (start + per_i * n as f32)).abs());
        greatest_m = off.fold(greatest_m, |most, one| if one > most { one } else { most });
    }
    greatest_m
}

/// The first and last column of a triangle in one of its rows: its edges run along rows, columns or diagonals.
#[inline]
fn columns(corners: [Sample; 3], row: u32) -> [u32; 2] {
    let mut span = [u32::MAX, 0];
    let mut note = |column: u32| span = [span[0].min(column), span[1].max(column)];
    for k in 0..3 {
        let (p, q) = (corners[k], corners[(k + 1) % 3]);
        if !(p[1].min(q[1])..=p[1].max(q[1])).contains(&row) {
            continue;
        }
        // Where an edge runs along the row, the other two end at its ends.
        let side = (i64::from(q[0]) - i64::from(p[0])).signum() as i32;
        note(p[0].saturating_add_signed(side * p[1].abs_diff(row) as i32));
    }
    span
}

struct Selection<'a> {
    nested: &'a Nested,
    field: &'a Heightfield,
    sight: &'a Sight,
    frustum: Option<&'a Frustum>,
    triangles: &'a mut Vec<[u32; 3]>,
}

impl Selection<'_> {
    /// `planes`: those of the frustum that may cut the triangle.
    fn visit(&mut self, triangle: Triangle, mut planes: u32) {
        let Some(middle) = triangle.middle() else { return self.draw(&triangle) };
        let (bounds, at_m) = (self.nested.bounds[entry(self.field, middle)], sample_m(self.field, middle));
        for (number, plane) in self.frustum.iter().flat_map(|frustum| frustum.planes.iter().enumerate()) {
            if planes >> number & 1 == 0 {
                continue;
            }
            let inside_m = plane.dot(at_m.extend(1.0));
            if inside_m < -bounds.radius_m {
                return;
            }
            if inside_m >= bounds.radius_m {
                planes &= !(1 << number);
            }
        }
        if !bounds.is_used(self.sight, at_m) {
            return self.draw(&triangle);
        }
        let [first, second] = triangle.children(middle);
        let (first, second) = if self.is_nearer(&first, &second) { (first, second) } else { (second, first) };
        self.visit(first, planes);
        self.visit(second, planes);
    }

    /// Of two halves that face each other across the edge that both have: whether the eye is on the first one's side.
    fn is_nearer(&self, first: &Triangle, second: &Triangle) -> bool {
        let middle = |t: &Triangle| 0.5 * (sample_m(self.field, t.a) + sample_m(self.field, t.b));
        let [one, other] = [first, second].map(middle);
        let flat_m2 = |p: Vec3| (p - self.sight.eye_m).with_y(0.0).length_squared();
        flat_m2(one) <= flat_m2(other)
    }

    fn draw(&mut self, triangle: &Triangle) {
        let corners = [triangle.apex, triangle.a, triangle.b];
        self.triangles.push(corners.map(|sample| entry(self.field, sample) as u32));
    }
}
