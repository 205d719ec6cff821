//! A point and a size → a tree's transform, with its foot in the ground, and its trunk's cylinder.
//!
//! The transform is Lean · Turn(φ) · Stretch · Turn(θ), then a translation. Lean is a shear along the ground, so the
//! trunk's base stays level; stretch along a turned axis makes the whole non-orthogonal. Its singular values lie
//! within about ±20 % of the size: well-conditioned, with a positive determinant.

use glam::{Mat3, Vec2, Vec3};

use crate::math::quarter_turns;
use crate::model::{Instance, Landform};
use crate::seed::Dice;

use super::TreeFootprint;
use super::site::Site;

/// The largest size that `scale` gives.
pub(super) const MAX_SCALE: f32 = 1.5;
/// Greatest stretch across the trunk, and along it.
const STRETCH: f32 = 0.1;
const STRETCH_UP: f32 = 0.08;
/// Greatest lean: metres to the side per metre of height.
pub(super) const LEAN: f32 = 0.07;
/// Metres above the ground up to which the cylinder holds the trunk.
const WALKER_M: f32 = 2.0;
/// How much wider a trunk is at its foot than at breast height, where it meets the ground.
const FOOT: f32 = 1.5;
/// The same for collision, where a walker touches it.
const TAPER: f32 = 1.25;
/// Metres that every foot is below the lowest ground around it, so that no light shows.
const SUNK_M: f32 = 0.03;
/// Part of its height that a tree may be sunk on its uphill side, its roots not counted.
const BURIED: f32 = 0.07;
/// More metres than the lean moves a cylinder.
pub(super) const TRUNK_RESERVE_M: f32 = 0.25;

/// Sixteen points of the ring around a trunk, in order.
const RING: [[f32; 2]; 16] = {
    let [c, h, s] = [0.923_879_5, std::f32::consts::FRAC_1_SQRT_2, 0.382_683_43];
    quarter_turns([[1.0, 0.0], [c, s], [h, h], [s, c]])
};

/// The size of a tree of that vigour: within 1 ± `variation` for full vigour.
pub(super) fn scale(variation: f32, vigour: f32, dice: &mut Dice) -> f32 {
    ((1.0 + variation * dice.around_zero()) * vigour).clamp(0.2, MAX_SCALE)
}

/// Radius in metres that holds a trunk's cylinder, however it leans, for a tree of that size.
pub(super) fn trunk_reach_m(tree: &TreeFootprint, scale: f32) -> f32 {
    TAPER * tree.trunk_radius_m * scale * (1.0 + STRETCH) + 2.0 * TRUNK_RESERVE_M
}

/// Stands a tree at (x, z), where `foot` tells the ground within so many metres; `None` where it would be buried on one side
/// or wet on the other.
pub(super) fn stand(
    tree: &TreeFootprint,
    template: u32,
    [x, z]: [f32; 2],
    scale: f32,
    dice: &mut Dice,
    foot: impl Fn(f32) -> Foot,
) -> Option<Instance> {
    let (up, across, along) =
        (1.0 + STRETCH_UP * dice.around_zero(), 1.0, 1.0 + STRETCH * dice.around_zero());
    let stretch = Mat3::from_diagonal(scale * Vec3::new(across, up, along));
    let (phi, theta) = (dice.unit() * std::f32::consts::TAU, dice.unit() * std::f32::consts::TAU);
    let lean = LEAN * dice.unit();
    let (sin, cos) = libm::sincosf(dice.unit() * std::f32::consts::TAU);
    let lean = lean * Vec2::new(cos, sin);
    let shear = Mat3::from_cols(Vec3::X, Vec3::new(lean.x, 1.0, lean.y), Vec3::Z);
    let linear = shear * turn(phi) * stretch * turn(theta);

    let wide = scale * across.max(along);
    let foot = foot(FOOT * tree.trunk_radius_m * wide);
    let foot_m = foot.lowest_m - SUNK_M;
    let sunk = foot.centre_m - foot_m;
    let buried = sunk > scale * up * (BURIED * tree.height_m + tree.root_depth_m) + SUNK_M;
    if buried || foot.lowest_m < foot.shore_m {
        return None;
    }
    Some(Instance {
        template,
        world_from_tree: rows(linear, Vec3::new(x, foot_m, z)),
        trunk_cylinder_m: cylinder([x, z], TAPER * tree.trunk_radius_m * wide, lean, sunk),
    })
}

/// The cylinder around a leaning trunk from its foot to the walker's height: the lean's middle is its axis.
fn cylinder([x, z]: [f32; 2], radius_m: f32, lean: Vec2, sunk_m: f32) -> [f32; 3] {
    let aside = lean * 0.5 * (WALKER_M + sunk_m);
    [x + aside.x, z + aside.y, radius_m + aside.length()]
}

/// The ground around a trunk.
pub(super) struct Foot {
    pub centre_m: f32,
    pub lowest_m: f32,
    /// How low trees stand by the water.
    pub shore_m: f32,
}

impl Foot {
    /// On the field.
    pub fn on(site: &Site, [x, z]: [f32; 2], radius_m: f32) -> Self {
        let land = site.land;
        let centre_m = land.field.height_m(x, z);
        let around = RING.map(|[dx, dz]| land.field.height_m(x + dx * radius_m, z + dz * radius_m));
        let low =
            around.iter().fold(centre_m, |low, &y| low.min(y)).min(lowest_sample(land, [x, z], radius_m));
        let step = (0..around.len()).map(|k| (around[k] - around[(k + 1) % around.len()]).abs());
        // A gully between two points, with sides as steep as any beside it, is half a step deep.
        let lowest_m = low - 0.5 * step.fold(0.0, f32::max);
        Self { centre_m, lowest_m, shore_m: site.shore_m }
    }
}

/// The lowest sample within the radius, along x and z. A bilinear height has its least value over a disc either at
/// a sample or on the rim, so with the ring this misses no pit.
fn lowest_sample(land: &Landform, [x, z]: [f32; 2], radius_m: f32) -> f32 {
    let field = &land.field;
    let last = (field.side - 1) as f32;
    let grid = |m: f32| (m / field.spacing_m + 0.5 * last).clamp(0.0, last);
    let span = |m: f32| grid(m - radius_m).ceil() as u32..=grid(m + radius_m).floor() as u32;
    let samples = span(z).flat_map(|j| span(x).map(move |i| field.at(i, j)));
    samples.fold(f32::INFINITY, f32::min)
}

fn turn(angle_rad: f32) -> Mat3 {
    let (sin, cos) = libm::sincosf(angle_rad);
    Mat3::from_cols(Vec3::new(cos, 0.0, -sin), Vec3::Y, Vec3::new(sin, 0.0, cos))
}

fn rows(linear: Mat3, translation: Vec3) -> [[f32; 4]; 3] {
    [0, 1, 2].map(|k| linear.row(k).extend(translation[k]).to_array())
}
