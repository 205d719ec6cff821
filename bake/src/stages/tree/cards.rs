//! Outer stems → cards, each a twig of leaves or blossom rooted on a stem, in metres.
//!
//! Where a template asks for more cards than the budget allows, fewer cards grow larger so that the leaf area stays
//! (Cook, Halstead, Planck & Ryu, "Stochastic simplification of aggregate detail", 2007).

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::budget::Budget;
use super::params::{Habit, TreeParams, autumn, card_length_m};
use super::skeleton::{Skeleton, Stem, perpendicular};
use crate::seed::Dice;

/// Cards on each outermost branch of a tree in winter.
const BARE_TWIGS: u32 = 3;
/// Golden angle: successive twigs around a stem.
const GOLDEN_RAD: f32 = 2.399_963;
/// How much a card may grow to make up for cards that the budget does not allow.
const MAX_GROWTH: f32 = 1.5;

/// One twig.
#[derive(Clone, Debug, Default)]
pub(super) struct Card {
    /// Where it is joined to a stem.
    pub root: Vec3,
    /// Unit vector from root to tip.
    pub axis: Vec3,
    /// Unit normal of its front.
    pub normal: Vec3,
    /// Length and width in metres.
    pub length_m: f32,
    pub width_m: f32,
    /// Angle by which it bends down over its length.
    pub droop_rad: f32,
    /// Which primary branch bears it, as [`Stem::clump`].
    clump: u32,
    /// Middle of the mass of leaves that it belongs to.
    pub mass: Vec3,
    /// Middle of the crown.
    pub crown: Vec3,
    /// Factor on its colour, linear RGB.
    pub tint: Vec3,
    pub mirrored: bool,
    /// Blossom rather than leaves.
    pub blossom: bool,
}

impl Card {
    /// A point half way along.
    pub fn middle(&self) -> Vec3 {
        self.root + self.axis * (0.5 * self.length_m)
    }
}

/// A stem that bears leaves: from where on, and its share.
struct Bearer<'a> {
    stem: &'a Stem,
    from: f32,
    share: f32,
}

/// Places all cards of an individual.
pub(super) fn place(params: &TreeParams, budget: &Budget, skeleton: &Skeleton, dice: &mut Dice) -> Vec<Card> {
    let length_m = card_length_m(budget.habit, params.levels, params.height_m, params.leaf_size_m);
    let (clump, clump_tint, cards) = (u32::MAX, Vec2::ZERO, Vec::with_capacity(budget.max_cards as usize));
    let mut placer = Placer { params, budget, skeleton, dice, length_m, clump, clump_tint, cards };
    match (budget.levels, budget.habit) {
        _ if budget.dead => {}
        (1, _) => placer.palm(),
        (_, Habit::Frond) => placer.tufts(),
        _ => placer.twigs(),
    }
    let mut cards = placer.cards;
    let masses = masses(skeleton, &cards);
    for card in &mut cards {
        (card.crown, card.mass) = (masses[0], masses[card.clump as usize]);
    }
    cards
}

/// Middles of the crown (entry 0) and of the leaves of each primary branch.
fn masses(skeleton: &Skeleton, cards: &[Card]) -> Vec<Vec3> {
    let mut sums = vec![(Vec3::ZERO, 0.0_f32); skeleton.clumps as usize + 1];
    for card in cards {
        for i in [0, card.clump as usize] {
            sums[i].0 += card.middle();
            sums[i].1 += 1.0;
        }
        if card.clump == 0 {
            sums[0].1 -= 1.0;
            sums[0].0 -= card.middle();
        }
    }
    sums.iter().map(|&(sum, count)| sum / count.max(1.0)).collect()
}

/// The stems that bear twigs: those of the last level, and the outer ends of the others.
fn bearers<'a>(budget: &Budget, skeleton: &'a Skeleton) -> Vec<Bearer<'a>> {
    let last = budget.levels - 1;
    let shared = skeleton.stems.iter().filter_map(|stem| {
        let (from, weight) = match last - stem.level {
            0 => (if last == 1 { 0.25 } else { 0.18 }, 1.0),
            1 if stem.level == 0 => (0.93, 1.0),
            1 if budget.habit == Habit::Needle => (0.3, 0.8),
            1 => (0.62, 0.8),
            _ if stem.level == 0 => (0.93, 1.0),
            _ => (0.85, 0.6),
        };
        let from = stem.from.max(from);
        (from < 0.99).then_some(Bearer { stem, from, share: weight * stem.length_m * (1.0 - from) })
    });
    shared.collect()
}

/// The unit vector at right angles to `along` that lies at an angle around it.
fn sideways(along: Vec3, turn: f32) -> Vec3 {
    let x = perpendicular(along);
    let (sin, cos) = libm::sincosf(turn);
    x * cos + along.cross(x) * sin
}

/// Cards being placed and coloured: each twig differs by a few per cent, each branch too; autumn differs more.
struct Placer<'a> {
    params: &'a TreeParams,
    budget: &'a Budget,
    skeleton: &'a Skeleton,
    dice: &'a mut Dice,
    /// Length of a card in metres, before chance changes it.
    length_m: f32,
    /// Which branch `clump_tint` belongs to.
    clump: u32,
    clump_tint: Vec2,
    cards: Vec<Card>,
}

impl Placer<'_> {
    fn is_full(&self) -> bool {
        self.cards.len() >= self.budget.max_cards as usize
    }

    /// Twigs all along the outer stems.
    fn twigs(&mut self) {
        let (budget, skeleton) = (self.budget, self.skeleton);
        let bearers = bearers(budget, skeleton);
        let outer = skeleton.stems.iter().filter(|stem| stem.level == budget.levels - 1).count();
        let per_stem = if budget.habit == Habit::Twigs { BARE_TWIGS } else { self.params.leaves_per_stem };
        let wish = (per_stem * outer as u32) as f32 * 1.15;
        // However few its stems, a tree in leaf has a crown.
        let wish = wish.max(0.12 * budget.max_cards as f32);
        let count = wish.min(budget.max_cards as f32);
        self.length_m *= (wish / count.max(1.0)).sqrt().clamp(1.0, MAX_GROWTH);
        let whole: f32 = bearers.iter().map(|bearer| bearer.share).sum();
        let (mut error, mut turn) = (0.5, self.dice.unit() * TAU);
        for bearer in &bearers {
            error += count * bearer.share / whole.max(1e-3);
            let here = error.floor() as u32;
            error -= here as f32;
            for k in 0..here {
                if self.is_full() {
                    return;
                }
                // The last twig carries on from the stem's tip.
                let place = 1.0 - (k as f32 + 0.35 * self.dice.unit()) / here as f32;
                let z = bearer.from + (1.0 - bearer.from) * place;
                turn += GOLDEN_RAD + 0.4 * self.dice.signed();
                self.twig(bearer.stem, z, turn, k == 0);
            }
        }
    }

    /// A twig at `z` of a stem, at an angle around it; `ends` if it carries on from the tip.
    fn twig(&mut self, stem: &Stem, z: f32, turn: f32, ends: bool) {
        let (root, along, _) = self.skeleton.along(stem, z);
        let side = sideways(along, turn);
        let out = Vec3::new(root.x, 0.0, root.z).normalize_or(side);
        let vary = 1.0 + 0.22 * self.dice.signed();
        let any = Vec3::new(self.dice.signed(), self.dice.signed(), self.dice.signed());
        let (axis, facing, droop_rad) = match self.budget.habit {
            Habit::Needle => {
                let side = Vec3::new(side.x, 0.35 * side.y, side.z).normalize_or(perpendicular(along));
                let lean = if ends { 0.15 } else { 0.75 };
                (along + side * lean + Vec3::Y * 0.08, Vec3::Y * 0.75 + out * 0.45 + any * 0.5, 0.35)
            }
            Habit::Willow => {
                let lean = if ends { 0.1 } else { 0.4 };
                // Leaves of a stem that points up hang from it, too.
                let hang = 0.5 + 0.9 * along.y.max(0.0);
                (along + side * lean - Vec3::Y * hang, out * 0.6 + any * 0.9, 0.3)
            }
            _ => {
                let lean = if ends { 0.2 } else { 0.95 };
                let axis = along + side * lean + Vec3::Y * 0.22 + out * 0.1;
                (axis, Vec3::Y * 0.5 + out * 0.55 + any * 0.75, 0.0)
            }
        };
        let axis = axis.normalize_or(along);
        let across = axis.cross(facing).normalize_or(perpendicular(axis));
        let mut normal = across.cross(axis).normalize_or(Vec3::Y);
        if normal.dot(facing) < 0.0 {
            normal = -normal;
        }
        let length_m = self.length_m * vary;
        self.push(Card { root, axis, normal, length_m, droop_rad, clump: stem.clump, ..Card::default() });
    }

    /// Fronds around the top of a trunk that has no branches.
    fn palm(&mut self) {
        let crowns = self.skeleton.stems.len().max(1) as u32;
        let count = (self.params.leaves_per_stem.clamp(11, 48) / crowns.min(3)).max(9);
        for stem in &self.skeleton.stems {
            let mut turn = self.dice.unit() * TAU;
            for k in 0..count {
                // From the youngest, upright, to the oldest, hanging.
                let age = (k as f32 + 0.5) / count as f32;
                turn += GOLDEN_RAD + 0.15 * self.dice.signed();
                let z = 1.0 - 0.05 * age * (1.0 - self.params.clear_trunk);
                let (root, along, radius_m) = self.skeleton.along(stem, z);
                let side = sideways(along, turn);
                let rise = (78.0 - 88.0 * age - 12.0 * age * age + 7.0 * self.dice.signed()).to_radians();
                let (sin, cos) = libm::sincosf(rise);
                let axis = (along * sin + side * cos).normalize_or(side);
                let droop_deg = 62.0 + 26.0 * age - 14.0 * self.params.tropism + 10.0 * self.dice.signed();
                let grown = (0.7 + 0.6 * age).min(1.0) * (1.0 + 0.1 * self.dice.signed());
                self.frond(root + side * (0.3 * radius_m), axis, grown, droop_deg, 0);
            }
        }
    }

    /// A rosette of fronds at the tip of every outer stem.
    fn tufts(&mut self) {
        let stems = &self.skeleton.stems;
        let wish = 3 + self.params.leaves_per_stem as usize / 6;
        let each = (self.budget.max_cards as usize / stems.len().max(1)).min(wish).max(2);
        for stem in stems {
            let mut turn = self.dice.unit() * TAU;
            for k in 0..each {
                if self.is_full() {
                    return;
                }
                let age = (k as f32 + 0.5) / each as f32;
                turn += GOLDEN_RAD;
                let (root, along, _) = self.skeleton.along(stem, 1.0 - 0.18 * age);
                let side = sideways(along, turn);
                let axis = (along * (1.1 - 0.9 * age) + side + Vec3::Y * 0.35).normalize_or(side);
                let grown = 1.0 + 0.18 * self.dice.signed();
                self.frond(root, axis, grown, 45.0 + 45.0 * age, stem.clump);
            }
        }
    }

    /// A frond that faces up.
    fn frond(&mut self, root: Vec3, axis: Vec3, grown: f32, droop_deg: f32, clump: u32) {
        let across = axis.cross(Vec3::Y).normalize_or(perpendicular(axis));
        let normal = across.cross(axis).normalize_or(Vec3::Y);
        let (length_m, droop_rad) = (self.length_m * grown, droop_deg.to_radians());
        self.push(Card { root, axis, normal, length_m, droop_rad, clump, ..Card::default() });
    }

    /// Gives a card its width and its colour, as leaves or as blossom.
    fn push(&mut self, mut card: Card) {
        let habit = self.budget.habit;
        card.width_m = card.length_m * habit.card_aspect();
        if card.clump != self.clump {
            self.clump = card.clump;
            self.clump_tint = Vec2::new(self.dice.signed(), self.dice.signed());
        }
        let bright = self.dice.signed() + 0.7 * self.clump_tint.x;
        let hue = self.dice.signed() + self.clump_tint.y;
        // Palms and ferns do not blossom.
        let blossom = if habit == Habit::Frond { 0.0 } else { self.params.blossom };
        card.blossom = self.dice.unit() < blossom;
        card.mirrored = self.dice.unit() < 0.5;
        let spread = match habit {
            _ if card.blossom => 0.03,
            Habit::Twigs => 0.05,
            _ => 0.05 + 0.13 * autumn(self.params.leaf_hue_deg),
        };
        let light = 0.9 + 0.06 * bright;
        card.tint = Vec3::new(1.0 + spread * hue, 1.0 - 0.4 * spread * hue, 1.0 - spread * hue) * light;
        // Blossom comes before the leaves are grown.
        let size = if card.blossom { 1.3 } else { 1.0 - 0.7 * blossom };
        card.length_m *= size;
        card.width_m *= size;
        if card.blossom {
            card.tint = card.tint * 0.5 + 0.5;
        }
        self.cards.push(card);
    }
}

/// Horizontal radius in metres that holds 95 % of the crown.
pub(super) fn crown_radius_m(skeleton: &Skeleton, cards: &[Card]) -> f32 {
    let aside = |p: Vec3| (p.x * p.x + p.z * p.z).sqrt();
    let mut radii: Vec<f32> = if cards.is_empty() {
        skeleton.nodes.iter().map(|node| aside(node.at)).collect()
    } else {
        cards.iter().map(|card| aside(card.root + card.axis * (0.8 * card.length_m))).collect()
    };
    radii.sort_by(f32::total_cmp);
    radii.get(radii.len() * 95 / 100).copied().unwrap_or(0.1).max(0.1)
}
