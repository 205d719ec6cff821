//! What paints the image of a card: a canvas, chance, and the twigs that all else is joined to.

use glam::{Vec2, Vec3};

use super::canvas::Canvas;
use super::leaf_outline::Outline;
use super::mips::{self, Chain};
use super::params::{Habit, TreeTextureParams};
use crate::math::{cell, lerp};
use crate::seed::Dice;

/// Texels a side.
const SIZE: usize = 256;
/// Albedo of young wood, linear.
pub(super) const TWIG: Vec3 = Vec3::new(0.10, 0.062, 0.033);
/// The same in winter, when nothing green is among it.
pub(super) const WINTER_TWIG: Vec3 = Vec3::new(0.078, 0.053, 0.038);

/// What paints one card: `leaf_texture` and `needle_texture` say how.
pub(super) struct Brush {
    pub canvas: Canvas,
    pub outline: Outline,
    pub dice: Dice,
    pub hue_deg: f32,
    /// Pairs of side veins of a leaf.
    pub pairs: f32,
    twig: Vec3,
}

impl Brush {
    pub fn new(params: &TreeTextureParams, habit: Habit, outline: Outline, card: u64) -> Self {
        Self {
            canvas: Canvas::new(SIZE, habit.card_aspect()),
            outline,
            dice: Dice::new(params.tree_seed, "tree texture", card),
            hue_deg: params.leaf_hue_deg,
            twig: if habit == Habit::Twigs { WINTER_TWIG } else { TWIG },
            pairs: [7.0, 8.0, 9.0, 8.0, 6.0, 6.0, 0.0, 0.0][params.leaf_shape.min(7) as usize],
        }
    }

    /// With a transparent rim: beyond a card's picture nothing is shown.
    pub fn finished(mut self, small: usize) -> Chain {
        self.canvas.clear_rim();
        mips::chain(&self.canvas, small)
    }

    /// A curved twig; returns points with their angles from base to tip.
    pub fn twig(&mut self, base: Vec2, angle: f32, length: f32, bend: f32, radius: f32) -> Vec<(Vec2, f32)> {
        const STEPS: usize = 8;
        let mut points = vec![(base, angle)];
        let (mut at, mut angle) = (base, angle);
        for step in 0..STEPS {
            let t = step as f32 / STEPS as f32;
            let next = at + towards(angle) * (length / STEPS as f32);
            let radii = (radius * (1.0 - 0.7 * t), radius * (1.0 - 0.7 * (t + 1.0 / STEPS as f32)));
            self.canvas.stroke(at, next, radii, self.twig * (0.9 + 0.2 * t));
            angle += bend / STEPS as f32;
            at = next;
            points.push((at, angle));
        }
        points
    }
}

/// The side of the kth leaf of a twig: 1 or −1.
pub(super) fn alternating(k: usize) -> f32 {
    if k.is_multiple_of(2) { 1.0 } else { -1.0 }
}

pub(super) fn length(twig: &[(Vec2, f32)]) -> f32 {
    twig.windows(2).map(|p| (p[1].0 - p[0].0).length()).sum()
}

/// The unit vector at an angle from straight up, positive to the right.
pub(super) fn towards(angle: f32) -> Vec2 {
    let (sin, cos) = libm::sincosf(angle);
    Vec2::new(sin, cos)
}

/// Place and angle at `t` in 0..1 of a twig.
pub(super) fn point(twig: &[(Vec2, f32)], t: f32) -> (Vec2, f32) {
    let (i, f) = cell(t.clamp(0.0, 1.0) * (twig.len() - 1) as f32, twig.len());
    let (a, b) = (twig[i], twig[i + 1]);
    (a.0.lerp(b.0, f), lerp(a.1, b.1, f))
}
