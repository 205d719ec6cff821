//! Outer stems → cards, each a twig of leaves or blossom rooted on a stem, in metres.
//!
//! Where a template asks for more cards than the budget allows, fewer cards grow larger so that the leaf area stays
//! (Cook, Halstead, Planck & Ryu, "Stochastic simplification of aggregate detail", 2007).

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::budget::Budget;
use super::params::{Habit, TreeParams, card_length_m};
use super::skeleton::{Skeleton, Stem, perpendicular};
use crate::seed::Dice;

/// Golden angle: successive twigs around a stem.
const GOLDEN_RAD: f32 = 2.399_963;
/// How much a card may grow to make up for cards that the budget does not allow.
const MAX_GROWTH: f32 = 1.5;

/// One twig.
#[derive(Clone, Debug)]
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
struct Bearer {
    stem: usize,
    from: f32,
    share: f32,
}

/// Places all cards of an individual.
pub(super) fn place(params: &TreeParams, budget: &Budget, skeleton: &Skeleton, dice: &mut Dice) -> Vec<Card> {
    let mut cards = match (budget.levels, budget.habit) {
        _ if budget.bare => Vec::new(),
        (1, _) => palm(params, budget, skeleton, dice),
        (_, Habit::Frond) => tufts(params, budget, skeleton, dice),
        _ => twigs(params, budget, skeleton, dice),
    };
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
fn bearers(budget: &Budget, skeleton: &Skeleton) -> Vec<Bearer> {
    let last = budget.levels - 1;
    let shared = skeleton.stems.iter().enumerate().filter_map(|(index, stem)| {
        let (from, weight) = match last - stem.level {
            0 => (if last == 1 { 0.25 } else { 0.18 }, 1.0),
            1 if stem.level == 0 => (0.93, 1.0),
            1 if budget.habit == Habit::Needle => (0.3, 0.8),
            1 => (0.62, 0.8),
            _ if stem.level == 0 => (0.93, 1.0),
            _ => (0.85, 0.6),
        };
        let from = stem.from.max(from);
        (from < 0.99).then_some(Bearer { stem: index, from, share: weight * stem.length_m * (1.0 - from) })
    });
    shared.collect()
}

fn twigs(params: &TreeParams, budget: &Budget, skeleton: &Skeleton, dice: &mut Dice) -> Vec<Card> {
    let bearers = bearers(budget, skeleton);
    let outer = skeleton.stems.iter().filter(|stem| stem.level == budget.levels - 1).count();
    let wish = (params.leaves_per_stem * outer as u32) as f32 * 1.15;
    // However few its stems, a tree in leaf has a crown.
    let wish = wish.max(0.12 * budget.max_cards as f32);
    let count = wish.min(budget.max_cards as f32);
    let growth = (wish / count.max(1.0)).sqrt().clamp(1.0, MAX_GROWTH);
    let whole: f32 = bearers.iter().map(|bearer| bearer.share).sum();
    let length_m = growth * card_length_m(budget.habit, params.levels, params.height_m, params.leaf_size_m);
    let mut painter = Painter::new(params);
    let mut cards = Vec::with_capacity(budget.max_cards as usize);
    let (mut error, mut turn) = (0.5, dice.unit() * TAU);
    for bearer in &bearers {
        let stem = &skeleton.stems[bearer.stem];
        error += count * bearer.share / whole.max(1e-3);
        let here = error.floor() as u32;
        error -= here as f32;
        for k in 0..here {
            if cards.len() >= budget.max_cards as usize {
                return cards;
            }
            // The last twig carries on from the stem's tip.
            let place = 1.0 - (k as f32 + 0.35 * dice.unit()) / here as f32;
            let z = bearer.from + (1.0 - bearer.from) * place;
            turn += GOLDEN_RAD + 0.4 * dice.signed();
            let twig = Twig { z, turn, ends: k == 0, length_m };
            let card = twig.card(budget.habit, skeleton, stem, dice);
            cards.push(painter.paint(card, stem.clump, dice));
        }
    }
    cards
}

/// The unit vector at right angles to `along` that lies at an angle around it.
fn sideways(along: Vec3, turn: f32) -> Vec3 {
    let x = perpendicular(along);
    let (sin, cos) = libm::sincosf(turn);
    x * cos + along.cross(x) * sin
}

/// A twig about to be placed.
struct Twig {
    z: f32,
    turn: f32,
    ends: bool,
    length_m: f32,
}

impl Twig {
    fn card(&self, habit: Habit, skeleton: &Skeleton, stem: &Stem, dice: &mut Dice) -> Card {
        let (root, along, _) = skeleton.along(stem, self.z);
        let side = sideways(along, self.turn);
        let out = Vec3::new(root.x, 0.0, root.z).normalize_or(side);
        let vary = 1.0 + 0.22 * dice.signed();
        let any = Vec3::new(dice.signed(), dice.signed(), dice.signed());
        let (axis, facing, droop_rad) = match habit {
            Habit::Needle => {
                let side = Vec3::new(side.x, 0.35 * side.y, side.z).normalize_or(perpendicular(along));
                let lean = if self.ends { 0.15 } else { 0.75 };
                (along + side * lean + Vec3::Y * 0.08, Vec3::Y * 0.75 + out * 0.45 + any * 0.5, 0.35)
            }
            Habit::Willow => {
                let lean = if self.ends { 0.1 } else { 0.4 };
                (along + side * lean - Vec3::Y * 0.5, out * 0.6 + any * 0.9, 0.3)
            }
            _ => {
                let lean = if self.ends { 0.2 } else { 0.95 };
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
        Card::new(root, axis, normal, self.length_m * vary, habit.card_aspect(), droop_rad)
    }
}

impl Card {
    fn new(root: Vec3, axis: Vec3, normal: Vec3, length_m: f32, aspect: f32, droop_rad: f32) -> Self {
        Self {
            root,
            axis,
            normal,
            length_m,
            width_m: length_m * aspect,
            droop_rad,
            clump: 0,
            mass: root,
            crown: root,
            tint: Vec3::ONE,
            mirrored: false,
            blossom: false,
        }
    }
}

/// Fronds around the top of a trunk that has no branches.
fn palm(params: &TreeParams, budget: &Budget, skeleton: &Skeleton, dice: &mut Dice) -> Vec<Card> {
    let mut painter = Painter::new(params);
    let mut cards = Vec::new();
    let crowns = skeleton.stems.len().max(1) as u32;
    let count = (params.leaves_per_stem.clamp(11, 48) / crowns.min(3)).max(9);
    let length_m = card_length_m(budget.habit, 1, params.height_m, params.leaf_size_m);
    for stem in &skeleton.stems {
        let mut turn = dice.unit() * TAU;
        for k in 0..count {
            // From the youngest, upright, to the oldest, hanging.
            let age = (k as f32 + 0.5) / count as f32;
            turn += GOLDEN_RAD + 0.15 * dice.signed();
            let (root, along, radius_m) = skeleton.along(stem, 1.0 - 0.05 * age * (1.0 - params.clear_trunk));
            let side = sideways(along, turn);
            let rise = (78.0 - 88.0 * age - 12.0 * age * age + 7.0 * dice.signed()).to_radians();
            let (sin, cos) = libm::sincosf(rise);
            let axis = (along * sin + side * cos).normalize_or(side);
            let droop_rad = (62.0 + 26.0 * age - 14.0 * params.tropism + 10.0 * dice.signed()).to_radians();
            let grown = (0.7 + 0.6 * age).min(1.0) * (1.0 + 0.1 * dice.signed());
            let card = frond(root + side * (0.3 * radius_m), axis, length_m * grown, droop_rad);
            cards.push(painter.paint(card, 0, dice));
        }
    }
    cards
}

/// A rosette of fronds at the tip of every outer stem.
fn tufts(params: &TreeParams, budget: &Budget, skeleton: &Skeleton, dice: &mut Dice) -> Vec<Card> {
    let stems = &skeleton.stems;
    let each =
        (budget.max_cards as usize / stems.len().max(1)).min(3 + params.leaves_per_stem as usize / 6).max(2);
    let length_m = card_length_m(budget.habit, params.levels, params.height_m, params.leaf_size_m);
    let mut painter = Painter::new(params);
    let mut cards = Vec::new();
    for stem in stems {
        let mut turn = dice.unit() * TAU;
        for k in 0..each {
            if cards.len() >= budget.max_cards as usize {
                return cards;
            }
            let age = (k as f32 + 0.5) / each as f32;
            turn += GOLDEN_RAD;
            let (root, along, _) = skeleton.along(stem, 1.0 - 0.18 * age);
            let side = sideways(along, turn);
            let axis = (along * (1.1 - 0.9 * age) + side + Vec3::Y * 0.35).normalize_or(side);
            let droop_rad = (45.0 + 45.0 * age).to_radians();
            let size = length_m * (1.0 + 0.18 * dice.signed());
            cards.push(painter.paint(frond(root, axis, size, droop_rad), stem.clump, dice));
        }
    }
    cards
}

/// A frond that faces up.
fn frond(root: Vec3, axis: Vec3, length_m: f32, droop_rad: f32) -> Card {
    let across = axis.cross(Vec3::Y).normalize_or(perpendicular(axis));
    let normal = across.cross(axis).normalize_or(Vec3::Y);
    Card::new(root, axis, normal, length_m, Habit::Frond.card_aspect(), droop_rad)
}

/// Gives cards their colours: each twig differs by a few per cent, each branch too; autumn differs more.
struct Painter {
    autumn: f32,
    blossom: f32,
    clump: u32,
    clump_tint: Vec2,
}

impl Painter {
    fn new(params: &TreeParams) -> Self {
        let autumn = ((78.0 - params.leaf_hue_deg) / 25.0).clamp(0.0, 1.0);
        // Palms and ferns do not blossom.
        let frond = Habit::of(params.leaf_shape, params.levels) == Habit::Frond;
        let blossom = if frond { 0.0 } else { params.blossom };
        Self { autumn, blossom, clump: u32::MAX, clump_tint: Vec2::ZERO }
    }

    fn paint(&mut self, mut card: Card, clump: u32, dice: &mut Dice) -> Card {
        if clump != self.clump {
            self.clump = clump;
            self.clump_tint = Vec2::new(dice.signed(), dice.signed());
        }
        let (bright, hue) = (dice.signed() + 0.7 * self.clump_tint.x, dice.signed() + self.clump_tint.y);
        card.blossom = dice.unit() < self.blossom;
        card.mirrored = dice.unit() < 0.5;
        let spread = if card.blossom { 0.03 } else { 0.05 + 0.13 * self.autumn };
        let light = 0.9 + 0.06 * bright;
        card.tint = Vec3::new(1.0 + spread * hue, 1.0 - 0.4 * spread * hue, 1.0 - spread * hue) * light;
        // Blossom comes before the leaves are grown.
        card.clump = clump;
        let size = if card.blossom { 1.3 } else { 1.0 - 0.7 * self.blossom };
        card.length_m *= size;
        card.width_m *= size;
        if card.blossom {
            card.tint = card.tint * 0.5 + 0.5;
        }
        card
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
