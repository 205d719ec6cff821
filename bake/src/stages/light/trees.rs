//! Trees and their shadows → the part of the sun and of the sky that trees let through, per texel of the light map,
//! 0–1.
//!
//! A shadow is drawn once per template and direction from which the sun strikes it ([`Shadow`]), and laid onto the
//! ground for each instance by its affine transform: affine maps keep parallel projections, so this is exact except for
//! the rounding of the direction, and the trunk's base and axis are always exact. Each texel of the ground is looked up
//! where it really lies, along the ray from the sun: on the land, not on a plane. Trees are multiplied in their order,
//! within bands of rows, so the number of threads changes nothing.

use glam::{Mat3, Vec2, Vec3};
use rayon::prelude::*;

use super::caster::{Crown, Shadow};
use super::sun::Sun;
use crate::model::{Caster, Instance};

/// Directions around a template for which shadows are drawn.
const DIRECTIONS: usize = 16;
/// Rows of texels that one task works on.
const BAND_ROWS: usize = 32;
/// Shadows end here, in metres, however low the sun.
const MAX_LENGTH_M: f32 = 1000.0;
/// A crown that hides less of the sky than this is left out.
const MIN_CROWN: f32 = 0.008;

/// The part of sun and sky that trees let through.
pub(super) struct Shade {
    /// Sun, a value per texel of the light map.
    pub sun: Vec<f32>,
    /// Sky, a square of half as many values a side.
    pub crowns: Vec<f32>,
}

/// Lays all trees' shadows on the ground.
pub(super) fn shade(sun: &Sun, trees: &[Instance], casters: &[&Caster], ground: &Ground) -> Shade {
    let Texels { side, extent_m } = ground.texels;
    let texels = Texels { side: side.div_ceil(2), extent_m };
    let mut shade = Shade { sun: vec![1.0; side * side], crowns: vec![1.0; texels.side * texels.side] };
    let crowns: Vec<Crown> = casters.iter().map(|caster| Crown::of(caster)).collect();
    let poses: Vec<Pose> = trees.iter().filter_map(|i| Pose::of(i, sun, casters)).collect();
    let crowns: Vec<_> =
        poses.iter().filter_map(|pose| CrownShade::of(pose, &crowns[pose.template])).collect();
    bands(&mut shade.crowns, texels.side, |first, rows| {
        crowns.iter().for_each(|crown| crown.darken(&texels, first, rows));
    });
    if sun.is_up() {
        let shadows = draw_shadows(sun, casters, &poses, ground.texels.texel_m());
        let placed = poses.par_iter().map(|pose| {
            let shadow = shadows[pose.template * DIRECTIONS + pose.direction].as_ref()?;
            PlacedShadow::of(pose, shadow, sun, ground)
        });
        let placed: Vec<Option<PlacedShadow>> = placed.collect();
        bands(&mut shade.sun, side, |first, rows| {
            placed.iter().flatten().for_each(|shadow| shadow.darken(ground, first, rows));
        });
    }
    shade
}

/// Runs `work(first row, rows)` on bands of a square image.
fn bands(image: &mut [f32], side: usize, work: impl Fn(usize, &mut [f32]) + Sync) {
    let bands = image.par_chunks_mut(BAND_ROWS * side).enumerate();
    bands.for_each(|(band, rows)| work(band * BAND_ROWS, rows));
}

/// The shadows that some instance needs.
fn draw_shadows(sun: &Sun, casters: &[&Caster], poses: &[Pose], texel_m: f32) -> Vec<Option<Shadow>> {
    let mut wanted = vec![false; casters.len() * DIRECTIONS];
    poses.iter().for_each(|pose| wanted[pose.template * DIRECTIONS + pose.direction] = true);
    let draw = |(index, &wanted): (usize, &bool)| {
        let (caster, front) = (casters[index / DIRECTIONS], front(index % DIRECTIONS));
        wanted.then(|| Shadow::draw(caster, sun, front, texel_m)).flatten()
    };
    wanted.par_iter().enumerate().map(draw).collect()
}

/// Unit vector (x, z) of a direction.
fn front(direction: usize) -> [f32; 2] {
    let angle = direction as f32 * (std::f32::consts::TAU / DIRECTIONS as f32);
    [libm::cosf(angle), libm::sinf(angle)]
}

/// Where the texels of an image lie.
pub(super) struct Texels {
    pub side: usize,
    pub extent_m: f32,
}

impl Texels {
    fn texel_m(&self) -> f32 {
        self.extent_m / self.side as f32
    }

    /// World coordinate of a texel's middle along either axis.
    #[inline]
    fn place(&self, texel: usize) -> f32 {
        (texel as f32 + 0.5) * self.texel_m() - 0.5 * self.extent_m
    }

    /// The texel at a world coordinate, as a real number whose whole values are middles.
    #[inline]
    fn texel(&self, along_m: f32) -> f32 {
        (along_m + 0.5 * self.extent_m) / self.texel_m() - 0.5
    }
}

/// The light map's texels and their heights.
pub(super) struct Ground<'a> {
    pub heights_m: &'a [f32],
    pub texels: Texels,
}

impl Ground<'_> {
    /// Height of the texel nearest to a point; `None` off the field.
    fn height_m(&self, x_m: f32, z_m: f32) -> Option<f32> {
        let (i, j) = (self.texels.texel(x_m) + 0.5, self.texels.texel(z_m) + 0.5);
        let inside = |at: f32| at >= 0.0 && at < self.texels.side as f32;
        (inside(i) && inside(j)).then(|| self.heights_m[j as usize * self.texels.side + i as usize])
    }
}

/// An instance ready to cast a shadow.
struct Pose {
    template: usize,
    /// The one around the template that is nearest to the sun's.
    direction: usize,
    world_from_tree: Mat3,
    foot: Vec3,
}

impl Pose {
    fn of(instance: &Instance, sun: &Sun, casters: &[&Caster]) -> Option<Self> {
        let template = instance.template as usize;
        let [x, y, z] = instance.world_from_tree.map(|row| Vec3::new(row[0], row[1], row[2]));
        let world_from_tree = Mat3::from_cols(x, y, z).transpose();
        let determinant = world_from_tree.determinant();
        let foot = Vec3::from_array(instance.world_from_tree.map(|row| row[3]));
        if template >= casters.len() || !determinant.is_finite() || determinant < 1.0e-9 || !foot.is_finite()
        {
            return None;
        }
        let to_sun = world_from_tree.inverse() * sun.direction;
        let turns = libm::atan2f(to_sun.z, to_sun.x) / std::f32::consts::TAU;
        let direction = ((turns + 1.0) * DIRECTIONS as f32 + 0.5) as usize % DIRECTIONS;
        Some(Self { template, direction, world_from_tree, foot })
    }

    /// How much it is widened in plan.
    fn widening(&self) -> f32 {
        let (x, z) = (self.world_from_tree.x_axis, self.world_from_tree.z_axis);
        (x.x * z.z - x.z * z.x).abs().sqrt()
    }
}

/// A shadow in its place on the ground. `u` and `v` are world metres in the plane across the light from the tree's
/// foot, to the right as the sun sees it and up; `away` is metres in plan from the foot away from the sun.
struct PlacedShadow<'a> {
    shadow: &'a Shadow,
    sun: &'a Sun,
    foot: Vec3,
    /// Cells of the shadow per metre of u and of v, and the foot's cell.
    per_u: Vec2,
    per_v: Vec2,
    foot_cell: Vec2,
    u: [f32; 2],
    away: [f32; 2],
    rows: [usize; 2],
}

impl<'a> PlacedShadow<'a> {
    fn of(pose: &Pose, shadow: &'a Shadow, sun: &'a Sun, ground: &Ground) -> Option<Self> {
        let [fx, fz] = sun.towards;
        let project = |p: Vec3| {
            let up = p.y * sun.cos_elevation - (p.x * fx + p.z * fz) * sun.sin_elevation;
            Vec2::new(p.z * fx - p.x * fz, up)
        };
        // Directions of the tree's space that stand for the image's a and c: c is the trunk's direction while
        // the sun sees it from the side, and that away from the sun when it stands overhead.
        let [ahead, aside] = front(pose.direction);
        let right = Vec3::new(-aside, 0.0, ahead);
        let up = if sun.cos_elevation > 0.26 {
            Vec3::Y / sun.cos_elevation
        } else {
            Vec3::new(-ahead, 0.0, -aside) / sun.sin_elevation
        };
        let (a, c) = (project(pose.world_from_tree * right), project(pose.world_from_tree * up));
        let area = a.perp_dot(c);
        if !area.is_finite() || area.abs() < 1.0e-6 {
            return None;
        }
        let (mut low, mut high) = (Vec2::MAX, Vec2::MIN);
        for ka in [shadow.low.x, shadow.high.x] {
            for kc in [shadow.low.y, shadow.high.y] {
                let corner = a * ka + c * kc;
                (low, high) = (low.min(corner), high.max(corner));
            }
        }
        let cells = shadow.cells_per_m;
        let mut placed = Self {
            shadow,
            sun,
            foot: pose.foot,
            per_u: Vec2::new(c.y, -a.y) / area * cells,
            per_v: Vec2::new(-c.x, a.x) / area * cells,
            foot_cell: (Vec2::ZERO - shadow.origin) * cells,
            u: [low.x, high.x],
            away: [-(shadow.reach_m * pose.widening() + 2.0 * ground.texels.texel_m()), 0.0],
            rows: [0, 0],
        };
        placed.away[1] = placed.end_m(high.y, ground);
        placed.rows = placed.rows(ground);
        (placed.rows[0] < placed.rows[1]).then_some(placed)
    }

    /// How far from the foot the land rises above the rays that pass over the treetop (at height `top` across the
    /// light), on three lines along the light. Behind that the land itself hides the sun.
    fn end_m(&self, top: f32, ground: &Ground) -> f32 {
        let step_m = 2.0 * ground.texels.texel_m();
        let lines = [self.u[0], 0.5 * (self.u[0] + self.u[1]), self.u[1]];
        let mut away = step_m;
        while away < MAX_LENGTH_M {
            let rise_m = away * self.sun.sin_elevation;
            let above = |height_m: f32| (height_m - self.foot.y) * self.sun.cos_elevation + rise_m > top;
            if lines
                .map(|u| self.place(u, away))
                .iter()
                .all(|&(x, z)| ground.height_m(x, z).is_none_or(above))
            {
                return away + step_m;
            }
            away += step_m;
        }
        MAX_LENGTH_M
    }

    /// World (x, z) at u and away.
    fn place(&self, u: f32, away: f32) -> (f32, f32) {
        let [fx, fz] = self.sun.towards;
        (self.foot.x - fz * u - fx * away, self.foot.z + fx * u - fz * away)
    }

    /// First row and the one after the last that it may touch.
    fn rows(&self, ground: &Ground) -> [usize; 2] {
        let ends = self.u.iter().flat_map(|&u| self.away.map(|away| self.place(u, away).1));
        let (low, high) = ends.fold((f32::MAX, f32::MIN), |(low, high), z| (low.min(z), high.max(z)));
        let row = |at: f32| at.clamp(0.0, ground.texels.side as f32) as usize;
        [row(ground.texels.texel(low).ceil()), row(ground.texels.texel(high).floor() + 1.0)]
    }

    /// Darkens the texels of a band that it touches.
    fn darken(&self, ground: &Ground, first: usize, band: &mut [f32]) {
        let side = ground.texels.side;
        let rows = self.rows[0].max(first)..self.rows[1].min(first + band.len() / side);
        let [fx, fz] = self.sun.towards;
        let texel_m = ground.texels.texel_m();
        for j in rows {
            let dz = ground.texels.place(j) - self.foot.z;
            let mut span = [f32::MIN, f32::MAX];
            narrow(&mut span, -fz, dz * fx, self.u);
            narrow(&mut span, -fx, -dz * fz, self.away);
            if span[0] > span[1] {
                continue;
            }
            let column = |dx: f32| ground.texels.texel(self.foot.x + dx).clamp(-1.0, side as f32);
            let from = column(span[0]).ceil().max(0.0) as usize;
            let to = ((column(span[1]) + 1.0) as usize).min(side);
            if from >= to {
                continue;
            }
            let heights = &ground.heights_m[j * side + from..j * side + to];
            let texels = &mut band[(j - first) * side + from..(j - first) * side + to];
            let start = ground.texels.place(from) - self.foot.x;
            for (k, (texel, height)) in texels.iter_mut().zip(heights).enumerate() {
                let dx = start + k as f32 * texel_m;
                let u = dz * fx - dx * fz;
                let v = (height - self.foot.y) * self.sun.cos_elevation
                    - (dx * fx + dz * fz) * self.sun.sin_elevation;
                *texel *= self.transmittance(u, v);
            }
        }
    }

    #[inline]
    fn transmittance(&self, u: f32, v: f32) -> f32 {
        let Shadow { columns, rows, transmittance, .. } = self.shadow;
        let cell = self.foot_cell + self.per_u * u + self.per_v * v + 0.5;
        let inside = cell.x >= 0.0 && cell.y >= 0.0 && cell.x < *columns as f32 && cell.y < *rows as f32;
        if inside { transmittance[cell.y as usize * columns + cell.x as usize] } else { 1.0 }
    }
}

/// Keeps the part of `span` where slope·x + offset lies within a range.
fn narrow(span: &mut [f32; 2], slope: f32, offset: f32, range: [f32; 2]) {
    if slope.abs() < 1.0e-6 {
        if offset < range[0] || offset > range[1] {
            *span = [f32::MAX, f32::MIN];
        }
        return;
    }
    let ends = [(range[0] - offset) / slope, (range[1] - offset) / slope];
    span[0] = span[0].max(ends[0].min(ends[1]));
    span[1] = span[1].min(ends[0].max(ends[1]));
}

/// How a crown hides the sky around its foot.
struct CrownShade {
    foot: Vec3,
    crown: Crown,
    reach_m: f32,
}

impl CrownShade {
    fn of(pose: &Pose, template: &Crown) -> Option<Self> {
        let height_m = (template.height_m * pose.world_from_tree.y_axis.y).max(0.1);
        let crown = Crown { height_m, radius_m: template.radius_m * pose.widening(), ..*template };
        let square = crown.radius_m * crown.radius_m * height_m * crown.opacity / MIN_CROWN;
        let reach_m = libm::cbrtf(square).min(40.0);
        (reach_m > height_m).then_some(Self { foot: pose.foot, crown, reach_m })
    }

    /// Form factor of a sphere (radius R, h above, r aside) seen from level ground: R²h / (h²+r²)^{3/2}.
    fn darken(&self, texels: &Texels, first: usize, band: &mut [f32]) {
        let (side, texel_m) = (texels.side, texels.texel_m());
        let from = |at: f32, min: usize| (at - self.reach_m / texel_m).ceil().max(min as f32) as usize;
        let to = |at: f32, max: usize| ((at + self.reach_m / texel_m + 1.0).max(0.0) as usize).min(max);
        let (i, j) = (texels.texel(self.foot.x), texels.texel(self.foot.z));
        let Crown { height_m, radius_m, opacity } = self.crown;
        let strength = radius_m * radius_m * height_m;
        for row in from(j, first)..to(j, first + band.len() / side) {
            let dz = (row as f32 - j) * texel_m;
            let level = height_m * height_m + dz * dz;
            for column in from(i, 0)..to(i, side) {
                let dx = (column as f32 - i) * texel_m;
                let square = level + dx * dx;
                let hidden = (strength / (square * square.sqrt())).min(0.95) * opacity;
                // Reduced by its value at the end of its reach, so that no edge shows there.
                let hidden = (hidden - MIN_CROWN).max(0.0);
                band[(row - first) * side + column] *= 1.0 - hidden;
            }
        }
    }
}
