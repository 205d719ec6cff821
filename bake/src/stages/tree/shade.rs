//! Cards → how much daylight reaches each place in the crown.
//!
//! Leaf area is gathered in a coarse grid over the crown; light falls through it from above and from four sides
//! with Beer–Lambert extinction (Monsi & Saeki 1953). Leaves let light pass, so nothing gets darker than
//! [`MIN_LIGHT`].

use glam::Vec3;

use super::cards::Card;
use super::skeleton::Skeleton;
use crate::math::lerp;

/// Cells a side.
const SIDE: usize = 14;
/// The smallest factor on colours inside a crown.
const MIN_LIGHT: f32 = 0.62;

/// Light in [`MIN_LIGHT`]..1 on a grid over the crown.
pub(super) struct Shade {
    low: Vec3,
    cell_m: Vec3,
    light: Vec<f32>,
}

impl Shade {
    /// Gathers the cards, of which so much is not gaps.
    pub fn new(skeleton: &Skeleton, cards: &[Card], covered: f32) -> Self {
        let nodes = skeleton.nodes.iter().map(|node| node.at);
        let points = nodes.chain(cards.iter().map(Card::middle));
        let (lo, hi) = points.fold((Vec3::MAX, Vec3::MIN), |(lo, hi), p| (lo.min(p), hi.max(p)));
        let cell_m = ((hi - lo) / SIDE as f32).max(Vec3::splat(0.02));
        let mut area = vec![0.0; SIDE * SIDE * SIDE];
        for card in cards {
            let g = (card.middle() - lo) / cell_m;
            let [x, y, z] = g.to_array().map(|v| (v.max(0.0) as usize).min(SIDE - 1));
            area[(y * SIDE + z) * SIDE + x] += covered * card.length_m * card.width_m;
        }
        Self { low: lo, cell_m, light: fall(&area, cell_m) }
    }

    /// The factor on colours at a place, trilinear.
    pub fn at(&self, point: Vec3) -> f32 {
        let g = (point - self.low) / self.cell_m - 0.5;
        let g = g.clamp(Vec3::ZERO, Vec3::splat(SIDE as f32 - 1.001));
        let (x, y, z) = (g.x as usize, g.y as usize, g.z as usize);
        let f = Vec3::new(g.x - x as f32, g.y - y as f32, g.z - z as f32);
        let row = |y: usize, z: usize| {
            let i = (y * SIDE + z) * SIDE + x;
            lerp(self.light[i], self.light[i + 1], f.x)
        };
        let layer = |y: usize| lerp(row(y, z), row(y, z + 1), f.z);
        lerp(layer(y), layer(y + 1), f.y)
    }
}

/// Light in every cell from leaf area in square metres.
fn fall(area: &[f32], cell_m: Vec3) -> Vec<f32> {
    let across = [cell_m.y * cell_m.z, cell_m.x * cell_m.z, cell_m.x * cell_m.y];
    let mut light = vec![0.0; area.len()];
    // For y, x and z: the strides along the axis and along the other two, and the share of the light that comes from
    // either end; none comes from below.
    for (axis, stride, others, share) in [
        (1, SIDE * SIDE, [1, SIDE], 0.5),
        (0, 1, [SIDE * SIDE, SIDE], 0.125),
        (2, SIDE, [SIDE * SIDE, 1], 0.125),
    ] {
        let pass = |a: f32| libm::expf(-0.55 * a / across[axis]);
        for line in 0..SIDE * SIDE {
            let start = (line / SIDE) * others[0] + (line % SIDE) * others[1];
            let (mut down, mut up) = (1.0, 1.0);
            for k in 0..SIDE {
                let (i, j) = (start + (SIDE - 1 - k) * stride, start + k * stride);
                let (through_i, through_j) = (pass(area[i]), pass(area[j]));
                light[i] += share * down * through_i.sqrt();
                down *= through_i;
                if axis != 1 {
                    light[j] += share * up * through_j.sqrt();
                    up *= through_j;
                }
            }
        }
    }
    light.iter().map(|&l| MIN_LIGHT + (1.0 - MIN_LIGHT) * (l * 1.45).min(1.0)).collect()
}
