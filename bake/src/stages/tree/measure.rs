//! Genes → what one sees of a tree as a whole, in a few numbers, without its mesh and its textures.

use glam::Vec3;

use super::brush::WINTER_TWIG;
use super::budget::Budget;
use super::cards::{self, Card};
use super::params::{Habit, TreeParams};
use super::skeleton;
use crate::model::leaf_color;
use crate::seed::Dice;

/// Heights at which the width of the crown is measured, from its base to its top.
pub const PROFILE: usize = 5;
/// The part of a card that its leaves cover.
const LEAFY: f32 = 0.45;

/// What one sees of a tree.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeMeasures {
    pub height_m: f32,
    pub crown_radius_m: f32,
    /// Part of the height below which there are hardly any leaves.
    pub crown_base: f32,
    /// Width of the crown in equal bands of its height, from the lowest, over its greatest.
    pub profile: [f32; PROFILE],
    /// Area of leaves over that of the crown's outline: 0 for a bare tree, about 5 for a dense one.
    pub density: f32,
    /// Part of the crown's outline that leaves fill, or twigs of a tree in winter, from 0 to 1.
    pub veil: f32,
    /// Mean colour of leaves and blossom, or of twigs, linear RGB.
    pub foliage_linear: [f32; 3],
    /// Part of the leaves that is blossom.
    pub blossom: f32,
    /// How far twigs point up, from -1 to 1.
    pub upward: f32,
    pub trunk_radius_m: f32,
    /// Broad leaves, willow leaves, needles, fronds: 1 for what it has.
    pub habit: [f32; 4],
}

/// Measures the first template of these genes.
pub fn measure(params: &TreeParams) -> TreeMeasures {
    let mut dice = Dice::new(params.tree_seed, "tree", 0);
    let budget = Budget::new(params);
    let skeleton = skeleton::grow(params, &budget, &mut dice);
    let cards = cards::place(params, &budget, &skeleton, &mut dice);
    let trunk_radius_m = skeleton.trunk_radius_m(params.height_m);
    let crown_radius_m = cards::crown_radius_m(&skeleton, &cards);
    let points: Vec<Vec3> = match cards.is_empty() {
        true => skeleton
            .stems
            .iter()
            .filter(|stem| stem.level > 0)
            .map(|stem| skeleton.along(stem, 1.0).0)
            .collect(),
        false => cards.iter().map(Card::middle).collect(),
    };
    let mut heights: Vec<f32> = points.iter().map(|point| point.y).collect();
    heights.sort_by(f32::total_cmp);
    let at =
        |part: f32| heights.get((part * heights.len() as f32) as usize).copied().unwrap_or(params.height_m);
    let (base_m, top_m) = (at(0.03), at(0.99));
    let height_m = skeleton.nodes.iter().map(|node| node.at.y).fold(top_m, f32::max).max(0.1);
    let outline_m2 = (1.6 * crown_radius_m * (top_m - base_m).max(crown_radius_m)).max(0.1);
    let cards_m2: f32 = cards.iter().map(|card| card.length_m * card.width_m).sum();
    let in_winter = budget.habit == Habit::Twigs;
    let covered = if in_winter { budget.habit.covered() } else { LEAFY };
    let depth = covered * cards_m2 / outline_m2;
    let count = cards.len().max(1) as f32;
    TreeMeasures {
        height_m,
        crown_radius_m,
        crown_base: (base_m / height_m).clamp(0.0, 1.0),
        profile: profile(&points, base_m, top_m),
        density: if in_winter { 0.0 } else { depth },
        veil: 1.0 - libm::expf(-depth),
        foliage_linear: foliage(
            if in_winter { WINTER_TWIG } else { leaf_color(params.leaf_hue_deg) },
            &cards,
        ),
        blossom: cards.iter().filter(|card| card.blossom).count() as f32 / count,
        upward: cards.iter().map(|card| card.axis.y - 0.5 * card.droop_rad).sum::<f32>() / count,
        trunk_radius_m,
        habit: [Habit::Broad, Habit::Willow, Habit::Needle, Habit::Frond]
            .map(|one| f32::from(one == budget.habit)),
    }
}

/// The widths of the bands, each the root mean square of how far its points are from the trunk.
fn profile(points: &[Vec3], base_m: f32, top_m: f32) -> [f32; PROFILE] {
    let mut bands = [(0.0f32, 1e-6f32); PROFILE];
    for point in points {
        let part = (point.y - base_m) / (top_m - base_m).max(0.01);
        let band = ((part * PROFILE as f32).max(0.0) as usize).min(PROFILE - 1);
        bands[band].0 += point.x * point.x + point.z * point.z;
        bands[band].1 += 1.0;
    }
    let widths = bands.map(|(sum, count)| (sum / count).sqrt());
    let widest = widths.iter().copied().fold(1e-3, f32::max);
    widths.map(|width| width / widest)
}

/// What cards of leaves of this colour, and of blossom among leaves, look like from afar.
fn foliage(leaf: Vec3, cards: &[Card]) -> [f32; 3] {
    const BLOSSOM: Vec3 = Vec3::new(0.58, 0.48, 0.48);
    let of = |card: &Card| card.tint * if card.blossom { BLOSSOM } else { leaf };
    let sum: Vec3 = cards.iter().map(of).sum();
    if cards.is_empty() { leaf.to_array() } else { (sum / cards.len() as f32).to_array() }
}
