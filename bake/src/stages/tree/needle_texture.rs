//! Needles on a card: flat sprays, as firs and cypresses have them, or the tufts of pines.

use glam::Vec2;

use super::brush::{Brush, alternating, length, point, towards};
use crate::math::lerp;
use crate::model::leaf_color;

/// Needles narrower than this, as a part of their length, stand in tufts.
pub(super) const TUFTED_ASPECT: f32 = 0.4;

impl Brush {
    /// A flat spray of conifer twigs that branch once more, needles all along: no side twig is as long as the next, or the whole
    /// looks like a feather. Twigs lie in the shade of others, and their tips are out of it: a spray of one colour looks painted with one
    /// stroke of a brush, and a crown of them like a heap of such strokes.
    pub fn sprays(&mut self, leaf: f32) {
        const SIDE_TWIGS: usize = 12;
        let needle = (0.15 * leaf).clamp(0.027, 0.036);
        let bend = 0.22 * self.dice.signed();
        let main = self.twig(Vec2::ZERO, -0.4 * bend, 0.93, bend, 0.007);
        let mut twigs = Vec::new();
        for (k, sign) in (0..SIDE_TWIGS).flat_map(|k| [(k, -1.0), (k, 1.0)]) {
            let t = (0.05 + (k as f32 + 0.6 * self.dice.signed()) / 13.5).max(0.02);
            let (at, angle) = point(&main, t);
            let length = (0.47 - 0.32 * t) * (0.95 + 0.35 * self.dice.signed());
            let turn = angle + sign * (0.98 - 0.15 * t + 0.12 * self.dice.signed());
            let side = self.twig(at, turn, length, -0.3 * sign, 0.005);
            // Short ones bear none.
            let finer = match (length / 0.075) as usize {
                ..3 => 0,
                many => many,
            };
            for k in 0..finer {
                let t = 0.18 + 0.7 * (k as f32 + 0.5 * self.dice.unit()) / finer as f32;
                let ((at, angle), way) = (point(&side, t), alternating(k));
                let length = length * (0.42 - 0.3 * t) * (1.0 + 0.3 * self.dice.signed());
                let turn = angle + way * (0.75 + 0.15 * self.dice.signed());
                twigs.push(self.twig(at, turn, length, -0.2 * way, 0.003));
            }
            twigs.push(side);
        }
        twigs.push(main);
        // One before the other by chance.
        let mut twigs: Vec<(f32, _)> = twigs.into_iter().map(|twig| (self.dice.unit(), twig)).collect();
        twigs.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        for (place, twig) in &twigs {
            let before = lerp(0.52, 1.33, *place);
            let count = (length(twig) / 0.0095) as usize;
            for k in 0..count {
                let t = k as f32 / count as f32;
                let (base, angle) = point(twig, t);
                for sign in [-1.0, 1.0] {
                    let lean = angle + sign * (0.75 - 0.3 * t + 0.22 * self.dice.signed());
                    let size = needle * (1.0 - 0.3 * t) * (0.9 + 0.2 * self.dice.signed());
                    let color = leaf_color(self.hue_deg + 8.0 * self.dice.signed());
                    let light = before * (0.66 + 0.7 * t) * (1.0 + 0.22 * self.dice.signed());
                    self.canvas.stroke(base, base + towards(lean) * size, (0.0044, 0.0022), color * light);
                }
            }
        }
    }

    /// Shoots of a pine: each a brush of needles that point forward and outward, bare where it begins. Those behind lie in the
    /// shade of those before them. `needle`: length as a part of the card's.
    pub fn tufts(&mut self, needle: f32) {
        const SHOOTS: usize = 17;
        let needle = needle.clamp(0.085, 0.12);
        let bend = 0.3 * self.dice.signed();
        let main = self.twig(Vec2::ZERO, -0.4 * bend, 0.86 - needle, bend, 0.010);
        let mut shoots = Vec::new();
        for k in 0..SHOOTS {
            let t = (0.12 + (k as f32 + 0.5 * self.dice.signed()) / (SHOOTS as f32 + 1.5)).min(0.97);
            let ((at, angle), sign) = (point(&main, t), alternating(k));
            let turn = angle + sign * (1.0 - 0.45 * t + 0.15 * self.dice.signed());
            let reach = (0.44 - 0.26 * t) * (0.5 + 0.55 * self.dice.unit());
            shoots.push(self.twig(at, turn, (reach - 0.5 * needle).max(0.05), -0.35 * sign, 0.0055));
        }
        shoots.push(main);
        for (number, shoot) in shoots.iter().enumerate() {
            let bare = (1.0 - 1.3 * needle / length(shoot)).clamp(0.0, 0.75);
            let count = (length(shoot) * (1.0 - bare) / 0.0032) as usize;
            for k in 0..=count {
                let t = k as f32 / count.max(1) as f32;
                let (base, angle) = point(shoot, lerp(bare, 1.0, t));
                // They stand out to all sides, and those that point at the eye look short.
                let lean = alternating(k) * (1.25 - 0.35 * t) * self.dice.unit().sqrt();
                let size = needle * (0.65 + 0.4 * self.dice.unit());
                let color = leaf_color(self.hue_deg + 8.0 * self.dice.signed());
                let behind = 0.62 + 0.4 * (number as f32 / SHOOTS as f32) * (0.4 + 0.6 * self.dice.unit());
                let light = (behind + 0.25 * t) * (1.0 + 0.2 * self.dice.signed());
                self.canvas.stroke(
                    base,
                    base + towards(angle + lean) * size,
                    (0.0036, 0.0020),
                    color * light,
                );
            }
        }
    }
}
