//! Start view → the piece of land around it that is meshed finely, and its height at any point, in metres.

use glam::Vec2;

use crate::math::hermite;
use crate::model::{Heightfield, Landform, StartView};
use crate::noise::fbm2;

/// Metres a side of the blocks that the near mesh is made of; the piece is a whole number of them.
pub const BLOCK_M: f32 = 16.0;
pub(super) const SIDE_M: f32 = 6.0 * BLOCK_M;
/// Metres ahead of the eye where the middle of the piece should lie: the ground behind is rarely seen.
const AHEAD_M: f32 = 26.0;
/// Metres over which the piece takes on the look of the land around it.
const FADE_M: f32 = 14.0;
/// Height in metres of the humps that the heightfield is too coarse for.
const HUMPS_M: f32 = 0.07;

/// The piece of land.
pub(super) struct Patch<'a> {
    pub land: &'a Landform,
    pub corner: Vec2,
    pub seed: u32,
}

impl Patch<'_> {
    /// 0 on the border, 1 from `FADE_M` inside.
    pub fn inward(&self, p: Vec2) -> f32 {
        let from_border = (p - self.corner).min(self.corner + SIDE_M - p).min_element();
        hermite((from_border / FADE_M).clamp(0.0, 1.0))
    }

    pub fn height_m(&self, p: Vec2) -> f32 {
        let inward = self.inward(p);
        let humps = if inward > 0.0 { fbm2(self.seed, p.x / 2.6, p.y / 2.6, 2, 0.5, 0) } else { 0.0 };
        self.land.field.height_m(p.x, p.y) + HUMPS_M * inward * humps
    }
}

/// The north-west corner of the square of blocks that suits a view best.
pub(super) fn corner(field: &Heightfield, view: &StartView) -> Option<Vec2> {
    let extent_m = field.extent_m();
    if extent_m < SIDE_M || field.spacing_m > BLOCK_M {
        return None;
    }
    let along = Vec2::new(view.direction.x, view.direction.z).normalize_or_zero();
    let wanted = plan(view.position_m.to_array()) + along * AHEAD_M - 0.5 * SIDE_M + 0.5 * extent_m;
    let blocks = (wanted / BLOCK_M + 0.5)
        .floor()
        .clamp(Vec2::ZERO, Vec2::splat((extent_m - SIDE_M) / BLOCK_M).floor());
    Some(blocks * BLOCK_M - 0.5 * extent_m)
}

/// A point seen from above.
pub(super) fn plan(p: [f32; 3]) -> Vec2 {
    Vec2::new(p[0], p[2])
}
