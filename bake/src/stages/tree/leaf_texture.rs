//! Genes → images of a twig with leaves, needles, leaflets or blossom, as mip chains of sRGB with alpha.
//!
//! The twig starts at the bottom centre, where a card is joined to its stem, and fills the card.

use glam::{Vec2, Vec3};

use super::brush::{Brush, TWIG, alternating, length, point, towards};
use super::canvas::Paint;
use super::leaf_outline::Outline;
use super::mips::Chain;
use super::needle_texture::TUFTED_ASPECT;
use super::params::{Habit, TreeTextureParams, autumn, card_length_m};
use crate::model::Image8;
use crate::model::leaf_color;

/// The mip level from which trees are simplified: 32 × 32 texels.
const SMALL_LEVEL: usize = 3;
/// The same of fronds. In 32 × 32 they lose the gaps between their leaflets: D_3, where few of them overlap, then covered .95 of
/// what it should.
const SMALL_LEVEL_OF_FRONDS: usize = 2;

/// The blossom card; one transparent texel if the template does not blossom.
pub(super) fn paint_blossom(params: &TreeTextureParams) -> Chain {
    let habit = params.habit();
    if params.blossom <= 0.0 || habit == Habit::Frond {
        return Chain { levels: vec![Image8::new(1, 1, 4)], small: Image8::new(1, 1, 4) };
    }
    let mut brush = Brush::new(params, habit, Outline::petal(), 1);
    brush.flowers();
    brush.finished(SMALL_LEVEL)
}

/// The leaf card.
pub(super) fn paint_leaves(params: &TreeTextureParams) -> Chain {
    let habit = params.habit();
    let mut brush = Brush::new(params, habit, Outline::new(params.leaf_shape, params.leaf_aspect), 0);
    let card_m = card_length_m(habit, params.levels, params.height_m, params.leaf_size_m);
    let leaf = (params.leaf_size_m / card_m).clamp(0.16, 0.36);
    match habit {
        Habit::Frond => brush.frond(params),
        Habit::Needle if params.leaf_aspect < TUFTED_ASPECT => brush.tufts(params.leaf_size_m / card_m),
        Habit::Needle => brush.sprays(leaf),
        Habit::Willow => brush.willow(leaf.clamp(0.2, 0.3)),
        Habit::Broad => brush.broad(leaf),
        Habit::Twigs => brush.bare_twigs(),
    }
    brush.finished(if habit == Habit::Frond { SMALL_LEVEL_OF_FRONDS } else { SMALL_LEVEL })
}

impl Brush {
    /// One leaf's paint: no two are quite alike; those laid on later are lighter.
    fn paint(&mut self, light: f32) -> Paint {
        let hue = self.hue_deg + (8.0 + 8.0 * autumn(self.hue_deg)) * self.dice.signed();
        let color = leaf_color(hue) * light * (1.0 + 0.26 * self.dice.signed());
        let fold = 0.13 * if self.dice.unit() < 0.5 { 1.0 } else { -1.0 };
        Paint { color, veins: 0.3, pairs: self.pairs, fold }
    }

    fn leaf(&mut self, base: Vec2, angle: f32, length: f32, light: f32) {
        let paint = self.paint(light);
        let axis = towards(angle);
        let stalk = base + axis * (0.12 * length);
        self.canvas.stroke(base, stalk, (0.005, 0.004), paint.color * 0.8);
        self.canvas.leaf(&self.outline, stalk, axis, 0.94 * length, &paint);
    }

    /// Broad leaves: a main twig with side twigs, leaves alternating along each.
    fn broad(&mut self, leaf: f32) {
        let bend = 0.25 * self.dice.signed();
        let main = self.twig(Vec2::ZERO, -0.4 * bend, 0.97 - 0.8 * leaf, bend, 0.011);
        let mut spots = Vec::new();
        let fine = leaf < 0.3;
        if fine {
            // Side twigs in alternation; lower ones longer, so that the whole is round.
            // None like another, or the whole looks like one large lobed leaf.
            let count = (1.7 / leaf * (0.35 / self.outline.area).min(1.0)).round().clamp(4.0, 10.0) as usize;
            for k in 0..count {
                let t = 0.10 + 0.78 * (k as f32 + 0.4 * self.dice.signed()).max(0.0) / count as f32;
                let (at, angle) = point(&main, t);
                let sign = if self.dice.unit() < 0.2 { -alternating(k) } else { alternating(k) };
                let turn = sign * (0.85 + 0.35 * self.dice.signed()) + angle;
                let length = (0.44 - 0.75 * leaf * 0.5) * libm::sinf(0.7 + 1.9 * t).max(0.35);
                let length = length * (0.8 + 0.38 * self.dice.signed());
                let side = self.twig(at, turn, length, -0.35 * sign, 0.007);
                self.spots(&side, leaf, 0.25, &mut spots);
            }
        }
        self.spots(&main, leaf, if fine { 0.45 } else { 0.16 }, &mut spots);
        self.leaves(&spots, leaf, (0.95, 0.15));
    }

    /// A twig in winter, which forks and forks again: few lines, for what is finer than a texel of the mip levels would clot.
    fn bare_twigs(&mut self) {
        const SIDE_TWIGS: usize = 7;
        let bend = 0.3 * self.dice.signed();
        let main = self.twig(Vec2::ZERO, -0.4 * bend, 0.95, bend, 0.0095);
        for k in 0..SIDE_TWIGS {
            let place = (k as f32 + 0.3 * self.dice.signed()).max(0.0) / SIDE_TWIGS as f32;
            let (at, angle) = point(&main, 0.08 + 0.85 * place);
            let sign = alternating(k);
            let turn = angle + sign * (0.7 + 0.2 * self.dice.signed());
            let length = (0.55 - 0.38 * place) * (1.0 + 0.2 * self.dice.signed());
            let side = self.twig(at, turn, length, -0.5 * sign, 0.0075);
            if length > 0.3 {
                let (at, angle) = point(&side, 0.45 + 0.1 * self.dice.signed());
                self.twig(at, angle + 0.75 * sign, 0.4 * length, -0.4 * sign, 0.006);
            }
        }
    }

    /// Leaves at these places; those laid on later are lighter.
    fn leaves(&mut self, spots: &[(Vec2, f32)], leaf: f32, (size, variation): (f32, f32)) {
        for (i, &(at, angle)) in spots.iter().enumerate() {
            let length = leaf * (size + variation * self.dice.signed());
            let length = self.fit(at, angle, length);
            self.leaf(at, angle, length, 0.58 + 0.62 * i as f32 / spots.len() as f32);
        }
    }

    /// Places of leaves along a twig: alternating, the last at its tip.
    fn spots(&mut self, twig: &[(Vec2, f32)], leaf: f32, from: f32, spots: &mut Vec<(Vec2, f32)>) {
        // Wide leaves stand farther apart: where all overlap, a card looks like one large leaf.
        let apart = leaf * self.outline.area.max(0.35);
        let count = ((1.0 - from) * length(twig) / apart).round().max(2.0) as usize;
        for k in 0..count {
            let t = from + (1.0 - from) * k as f32 / count as f32;
            let (at, angle) = point(twig, t);
            let sign = alternating(k);
            spots.push((at, angle + sign * (0.95 - 0.35 * t + 0.2 * self.dice.signed())));
        }
        spots.push(point(twig, 1.0));
    }

    /// Shortens a leaf so that it stays on the card.
    fn fit(&self, at: Vec2, angle: f32, length: f32) -> f32 {
        let axis = towards(angle);
        let side = Vec2::new(-axis.y, axis.x).abs() * (self.outline.widest * length);
        let half = 0.5 * self.canvas.width - 0.006;
        let room_x = (half - side.x * 0.9 - at.x.abs()).max(0.02) / axis.x.abs().max(1e-3);
        let room_y = if axis.y > 0.0 { 0.994 - side.y * 0.6 - at.y } else { at.y - 0.006 - side.y * 0.6 };
        let room_y = room_y.max(0.02) / axis.y.abs().max(1e-3);
        length.min(room_x).min(room_y).max(0.3 * length)
    }

    /// A hanging willow twig: long leaves at narrow angles.
    fn willow(&mut self, leaf: f32) {
        let sway = 0.16 * self.dice.signed();
        let main = self.twig(Vec2::ZERO, -0.5 * sway, 0.82, sway, 0.009);
        let mut spots = Vec::new();
        let side_twigs = [0, 1, 2, 3].map(|k| {
            let sign = alternating(k);
            let (at, angle) = point(&main, 0.06 + 0.18 * k as f32);
            self.twig(at, angle + 0.42 * sign, 0.34, -0.3 * sign, 0.005)
        });
        for twig in side_twigs.iter().chain([&main]) {
            let count = (length(twig) / 0.036) as usize;
            for k in 0..=count {
                let (at, angle) = point(twig, 0.06 + 0.94 * k as f32 / count as f32);
                let sign = alternating(k);
                spots.push((at, angle + sign * (0.5 + 0.2 * self.dice.signed())));
            }
        }
        self.leaves(&spots, leaf, (0.9, 0.2));
    }

    /// Leaflets along a rib; leaflets of the leaf's own shape on a trunk without branches.
    fn frond(&mut self, params: &TreeTextureParams) {
        let feather = params.leaf_shape >= 6;
        if feather {
            self.outline = Outline::new(7, params.leaf_aspect);
        }
        let half = 0.5 * self.canvas.width;
        let pairs = if feather { 36 } else { 13 };
        let color = leaf_color(self.hue_deg) * 1.1 + Vec3::new(0.03, 0.02, 0.0);
        for k in 0..pairs {
            let t = (k as f32 + 0.5) / pairs as f32;
            for sign in [-1.0, 1.0] {
                let shape = libm::powf((t + 0.06).min(1.0), 0.35) * (1.04 - t * t * 0.8);
                let angle = sign * (1.12 - 0.75 * t + 0.07 * self.dice.signed());
                let mut length = half * if feather { 1.12 } else { 0.92 } * shape;
                if feather {
                    length = length.min((half - 0.004) / libm::sinf(angle.abs()).max(0.2));
                }
                let base = Vec2::new(0.0, 0.03 + 0.93 * t);
                let length = length.min((0.995 - base.y) / libm::cosf(angle).max(0.1)).max(0.015);
                let mut paint = self.paint(0.84 + 0.25 * t);
                paint.veins = if feather { 0.12 } else { 0.3 };
                self.canvas.leaf(&self.outline, base, towards(angle), length, &paint);
            }
        }
        self.canvas.stroke(Vec2::ZERO, Vec2::new(0.0, 0.97), (0.011, 0.002), color);
    }

    /// Clusters of five-petalled flowers along a twig, among young leaves.
    fn flowers(&mut self) {
        const CLUSTERS: usize = 13;
        const FLOWERS: usize = 10;
        let bend = 0.25 * self.dice.signed();
        let half = 0.5 * self.canvas.width;
        let main = self.twig(Vec2::ZERO, -0.4 * bend, 0.9, bend, 0.013);
        let pink = 0.75 * self.dice.unit();
        let clusters: Vec<(Vec2, f32)> = (0..CLUSTERS)
            .map(|k| {
                let (at, angle) = point(&main, (k as f32 + 0.9) / CLUSTERS as f32);
                let turn = angle + alternating(k) * (1.05 + 0.25 * self.dice.signed());
                let reach = if k + 1 == CLUSTERS { 0.0 } else { half * (0.42 + 0.36 * self.dice.signed()) };
                let middle = at + towards(turn) * reach;
                self.canvas.stroke(at, middle, (0.007, 0.004), TWIG);
                let radius = 0.075 + 0.025 * self.dice.signed();
                let room = radius + 0.045;
                (middle.clamp(Vec2::new(room - half, room), Vec2::new(half - room, 1.0 - room)), radius)
            })
            .collect();
        for (k, &(middle, _)) in clusters.iter().enumerate() {
            for way in [-1.1, 0.6] {
                let (angle, light) =
                    (alternating(k) * way + 0.5 * self.dice.signed(), 0.6 + 0.3 * self.dice.unit());
                let paint =
                    Paint { veins: 0.3, pairs: 5.0, fold: 0.1, color: leaf_color(self.hue_deg) * light };
                self.canvas.leaf(&self.outline, middle, towards(angle), 0.11, &paint);
            }
        }
        for (middle, radius) in clusters {
            // From behind to the front: of a ball of flowers those in front have the light.
            for k in 0..FLOWERS {
                let front = k as f32 / FLOWERS as f32;
                let away = radius * (1.0 - front).sqrt() * (0.75 + 0.35 * self.dice.unit());
                let at = middle + towards(2.4 * k as f32 + 0.6 * self.dice.signed()) * away;
                let size = 0.037 + 0.012 * self.dice.unit();
                let lift = 0.2 * (at.y - middle.y) / radius;
                let light = 0.5 + 0.5 * front + lift + 0.1 * self.dice.signed();
                self.flower(at, size, pink, light);
            }
        }
    }

    fn flower(&mut self, at: Vec2, size: f32, pink: f32, light: f32) {
        let turn = self.dice.unit() * std::f32::consts::TAU;
        let white = Vec3::new(0.9, 0.88, 0.84);
        let rose = Vec3::new(0.88, 0.53, 0.6);
        for petal in 0..5 {
            let angle = turn + petal as f32 * std::f32::consts::TAU / 5.0;
            let color = white.lerp(rose, pink * (0.5 + 0.5 * self.dice.unit())) * light.clamp(0.3, 1.0);
            let paint = Paint { color, veins: -0.1, pairs: 0.0, fold: 0.05 };
            self.canvas.leaf(&self.outline, at, towards(angle), size, &paint);
        }
        self.canvas.stroke(at, at, (0.009, 0.009), Vec3::new(0.55, 0.45, 0.12) * light);
    }
}
