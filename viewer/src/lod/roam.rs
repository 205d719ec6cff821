//! A view of a heightfield → one generalised triangle strip of sample numbers (thesis 3.2, the ROAM-based algorithm).
//! Metres, pixels.
//!
//! Every frame anew from the two root triangles down (Duchaineau et al., "ROAMing terrain", 1997): a triangle is split while a
//! vertical segment through its wedgie may look longer than the bound. Where triangles are counted, those whose segments look
//! longest are split first, by a queue, as long as the count lasts (thesis 3.2.4). A split first splits
//! whatever it depends on, so that no T-junction appears. The land and the triangle drawn for it both lie in the slab of
//! some triangle that passed, 2w thick; so nowhere do they look farther apart than the bound. Triangles out of sight are
//! kept, but not refined, so the mesh always covers the square, and a walk of the hierarchy visits all triangles each
//! across an edge of the one before: one strip (Lindstrom et al., "Real-time, continuous level of detail rendering of
//! height fields", 1996), where a corner is turned by repeating a vertex.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use genescape_schema::scene::bintree::{Sample, requires};
use glam::Vec3;

use super::morph::sample_m;
use crate::camera::{Camera, Frustum};
use crate::scene::TerrainLod;

/// All planes of a frustum still to be tested.
const ALL_PLANES: u32 = (1 << 5) - 1;

/// Replaces `strip` by a triangle strip over the whole field: entries of its arrays, front faces counter-clockwise
/// from above with the first triangle as written. `aspect` is the picture's width over its height, `height_px` its
/// height; `error_px` is how far land and mesh may be apart in the picture: 0 uses every sample in sight that is not
/// on the plane around it. `culls` leaves what is out of sight coarse. At most `budget` triangles, but for the two that cover the
/// field: where they don't suffice, the land is off by more. Tells how many triangles are not degenerate.
pub fn triangulate(
    lod: &TerrainLod,
    camera: &Camera,
    (aspect, height_px): (f32, f32),
    error_px: f32,
    culls: bool,
    budget: Option<u32>,
    strip: &mut Vec<u32>,
) -> u32 {
    let field = &lod.field;
    strip.clear();
    if field.side < 2 {
        return 0;
    }
    let last = field.side - 1;
    let roots = [[[last, last], [0, 0], [0, last]], [[0, 0], [last, last], [last, 0]]];
    let mut marks = Marks { used: vec![false; field.heights_m.len()], side: field.side };
    let metric = Metric::new(lod, camera, (aspect, height_px), error_px);
    let planes = if culls { ALL_PLANES } else { 0 };
    let corners = roots.map(|root| root.map(|sample| metric.corner(sample)));
    match budget {
        None => corners.into_iter().for_each(|root| refine(&metric, &mut marks, root, planes)),
        Some(budget) => refine_worst(&metric, &mut marks, corners, planes, budget),
    }
    let mut walk = Walk { marks: &marks, strip, triangles: 0 };
    for root in roots {
        walk.visit(root, true);
    }
    walk.triangles
}

/// The middle of the hypotenuse a–b; `None` for half a cell.
#[inline]
fn middle(a: Sample, b: Sample) -> Option<Sample> {
    let sum = [a[0] + b[0], a[1] + b[1]];
    ((sum[0] | sum[1]) & 1 == 0).then_some([sum[0] / 2, sum[1] / 2])
}

/// Which samples are in use.
struct Marks {
    used: Vec<bool>,
    side: u32,
}

impl Marks {
    #[inline]
    fn entry(&self, [i, j]: Sample) -> usize {
        (j * self.side + i) as usize
    }

    #[inline]
    fn uses(&self, sample: Sample) -> bool {
        self.used[self.entry(sample)]
    }

    /// How many triangles more there would be if a sample (no corner of the field) were used.
    fn would_add(&self, sample: Sample) -> u32 {
        let last = self.side - 1;
        let (mut open, mut found) = (vec![sample], Vec::new());
        while let Some(sample) = open.pop() {
            // The field's corners are always in use.
            let is_corner = sample[0] % last == 0 && sample[1] % last == 0;
            if is_corner || self.uses(sample) || found.contains(&sample) {
                continue;
            }
            found.push(sample);
            open.extend(requires(sample, last).into_iter().flatten());
        }
        // It splits two triangles, or one at the border.
        let is_inside = |sample: &Sample| sample.iter().all(|line| line % last != 0);
        found.iter().map(|sample| 1 + u32::from(is_inside(sample))).sum()
    }

    /// Uses a sample (no corner of the field), and first what it depends on.
    fn enable(&mut self, sample: Sample) {
        let entry = self.entry(sample);
        if std::mem::replace(&mut self.used[entry], true) {
            return;
        }
        let last = self.side - 1;
        for needed in requires(sample, last).into_iter().flatten() {
            // The field's corners are always in use.
            if !(needed[0] % last == 0 && needed[1] % last == 0) {
                self.enable(needed);
            }
        }
    }
}

/// A sample with its place in the world and as the camera sees it.
#[derive(Clone, Copy)]
struct Corner {
    sample: Sample,
    world_m: Vec3,
    /// Right, up, and ahead of the eye.
    eye_m: Vec3,
}

/// The bound on the screen, ready for tests without roots or divisions.
struct Metric<'a> {
    lod: &'a TerrainLod,
    frustum: Frustum,
    position_m: Vec3,
    /// Rows: right, up, ahead.
    axes: [Vec3; 3],
    /// The world's vertical in these axes.
    vertical: Vec3,
    /// (error_px / (2·focal_px))².
    bound: f32,
}

impl<'a> Metric<'a> {
    fn new(lod: &'a TerrainLod, camera: &Camera, (aspect, height_px): (f32, f32), error_px: f32) -> Self {
        let (right, ahead) = (camera.right(), camera.forward());
        let axes = [right, right.cross(ahead), ahead];
        let half = 0.5 * error_px.max(0.0) / camera.focal_px(height_px);
        Self {
            lod,
            frustum: camera.frustum(aspect),
            position_m: camera.position_m,
            axes,
            vertical: Vec3::new(axes[0].y, axes[1].y, axes[2].y),
            bound: half * half,
        }
    }

    fn corner(&self, sample: Sample) -> Corner {
        let world_m = sample_m(&self.lod.field, sample);
        let from_eye_m = world_m - self.position_m;
        Corner { sample, world_m, eye_m: Vec3::from_array(self.axes.map(|axis| axis.dot(from_eye_m))) }
    }

    /// Of `planes` those that cut the slab; `None` if it lies outside one.
    fn cutting(&self, corners: &[Corner; 3], half_m: f32, planes: u32) -> Option<u32> {
        let mut cutting = planes;
        for (number, plane) in self.frustum.planes.iter().enumerate() {
            if planes >> number & 1 == 0 {
                continue;
            }
            let spread = plane.y.abs() * half_m;
            let inside = corners.map(|corner| plane.truncate().dot(corner.world_m) + plane.w);
            if inside.iter().all(|&inside| inside < -spread) {
                return None;
            }
            if inside.iter().all(|&inside| inside >= spread) {
                cutting &= !(1 << number);
            }
        }
        Some(cutting)
    }

    /// Where to split a triangle that cuts the frustum by some of `planes`, if the bound asks for it.
    fn candidate(&self, corners: [Corner; 3], planes: u32) -> Option<Candidate> {
        let sample = middle(corners[0].sample, corners[1].sample)?;
        let half_m = self.lod.wedgies_m[(sample[1] * self.lod.field.side + sample[0]) as usize];
        let planes = self.cutting(&corners, half_m, planes)?;
        let [numerator, denominator] = self.apparent(&corners, half_m);
        let is_off = numerator > self.bound * denominator;
        is_off.then(|| Candidate { apparent: numerator / denominator, corners, sample, planes })
    }

    /// The square of half the length that a vertical segment of ±`half_m` within the slab may have to the eye, as a fraction. For a segment around (p, q, r), half
    /// of it (a, b, c), that length is 2·√((ar − cp)² + (br − cq)²) / (r² − c²); over the slab the greatest numerator and the
    /// least denominator are found at corners.
    fn apparent(&self, corners: &[Corner; 3], half_m: f32) -> [f32; 2] {
        if half_m <= 0.0 {
            return [0.0, 1.0];
        }
        let half = self.vertical * half_m;
        let depth_m = corners.iter().fold(f32::MAX, |least, corner| least.min(corner.eye_m.z));
        if depth_m <= half.z.abs() {
            return [1.0, 0.0];
        }
        let numerator = corners.iter().fold(0.0f32, |greatest, corner| {
            let (x, y) = (
                half.x * corner.eye_m.z - half.z * corner.eye_m.x,
                half.y * corner.eye_m.z - half.z * corner.eye_m.y,
            );
            greatest.max(x * x + y * y)
        });
        let denominator = depth_m * depth_m - half.z * half.z;
        [numerator, denominator * denominator]
    }
}

/// Splits a triangle (ends of the hypotenuse, apex) and its halves as far as the metric asks for.
fn refine(metric: &Metric<'_>, marks: &mut Marks, corners: [Corner; 3], planes: u32) {
    let Some(candidate) = metric.candidate(corners, planes) else { return };
    marks.enable(candidate.sample);
    candidate.halves(metric).into_iter().for_each(|half| refine(metric, marks, half, candidate.planes));
}

/// A triangle that may be split, by how long its segment may look.
struct Candidate {
    apparent: f32,
    corners: [Corner; 3],
    sample: Sample,
    planes: u32,
}

impl Candidate {
    fn halves(&self, metric: &Metric<'_>) -> [[Corner; 3]; 2] {
        let ([a, b, apex], middle) = (self.corners, metric.corner(self.sample));
        [[apex, a, middle], [b, apex, middle]]
    }
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        self.apparent.total_cmp(&other.apparent).then_with(|| other.sample.cmp(&self.sample))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Candidate {}

/// Splits the triangles of a field, the worst first, down to the metric's bound or up to a number of triangles.
fn refine_worst(metric: &Metric<'_>, marks: &mut Marks, roots: [[Corner; 3]; 2], planes: u32, budget: u32) {
    let mut queue: BinaryHeap<Candidate> =
        roots.into_iter().filter_map(|root| metric.candidate(root, planes)).collect();
    let mut triangles = 2;
    while let Some(worst) = queue.pop() {
        let added = marks.would_add(worst.sample);
        if triangles + added > budget {
            return;
        }
        triangles += added;
        marks.enable(worst.sample);
        let halves = worst.halves(metric).into_iter();
        queue.extend(halves.filter_map(|half| metric.candidate(half, worst.planes)));
    }
}

/// Writes the strip.
struct Walk<'a> {
    marks: &'a Marks,
    strip: &'a mut Vec<u32>,
    triangles: u32,
}

impl Walk<'_> {
    /// The triangles within one (start, end of the hypotenuse, apex) on the way from start to end. Comes in across an
    /// edge at the start; leaves across the hypotenuse or across the edge from apex to end. The halves are crossed by
    /// way of the apex; the first leaves for the second across their common edge, a leg of both.
    fn visit(&mut self, [start, end, apex]: [Sample; 3], leaves_by_hypotenuse: bool) {
        match middle(start, end).filter(|&sample| self.marks.uses(sample)) {
            Some(middle) => {
                self.visit([start, apex, middle], false);
                self.visit([apex, end, middle], !leaves_by_hypotenuse);
            }
            None => self.leaf([start, end, apex], leaves_by_hypotenuse),
        }
    }

    fn leaf(&mut self, corners: [Sample; 3], leaves_by_hypotenuse: bool) {
        self.triangles += 1;
        let [start, end, apex] = corners.map(|sample| self.marks.entry(sample) as u32);
        let dropped = if leaves_by_hypotenuse { apex } else { start };
        let &[.., older, newer] = self.strip.as_slice() else {
            let kept = if leaves_by_hypotenuse { [start, end] } else { [end, apex] };
            return self.begin(corners, [dropped, kept[0], kept[1]]);
        };
        let new = [start, end, apex].into_iter().find(|&vertex| vertex != older && vertex != newer);
        if newer == dropped {
            // The older one must stay: turn the corner.
            self.strip.push(older);
        }
        self.strip.extend(new);
    }

    /// The first triangle, any edge of which may be the one it was entered by; its first vertex twice if it would be
    /// clockwise otherwise. (start, end, apex) has the sense of (`dropped`, `kept`), a rotation of it.
    fn begin(&mut self, [start, end, apex]: [Sample; 3], triangle: [u32; 3]) {
        let along = |from: Sample, to: Sample, axis: usize| i64::from(to[axis]) - i64::from(from[axis]);
        // j runs south: from above, with x to the right and z towards us, counter-clockwise is negative.
        let turn =
            along(start, end, 0) * along(start, apex, 1) - along(start, end, 1) * along(start, apex, 0);
        if turn > 0 {
            self.strip.push(triangle[0]);
        }
        self.strip.extend(triangle);
    }
}
