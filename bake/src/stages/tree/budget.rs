//! Genes → how many stems and cards a tree may have, so that its triangles stay within budget.
//!
//! A forked, four-level tree of 71 × 31 branches would have hundreds of thousands of triangles. Instead of cutting
//! afterwards, the numbers of thin stems are scaled down beforehand; the cards then grow to keep the leaf area.

use super::culms;
use super::params::{Habit, TreeParams};
use crate::model::is_dead;

/// Triangles that leaves and blossom may use.
const LEAF_BUDGET: u32 = 10_600;
/// Triangles that twigs of a tree in winter may use.
const TWIG_BUDGET: u32 = 5_200;
/// Triangles of bark to aim for, and those that are never exceeded: under leaves, in winter, and of dead wood, which has no cards.
const BARK_BUDGET: (f32, u32) = (7_600.0, 12_500);
const WINTER_BUDGET: (f32, u32) = (11_000.0, 16_500);
const DEAD_BUDGET: (f32, u32) = (16_000.0, 22_500);
/// Primary branches on all culms of a clump.
const MAX_ON_CULMS: f32 = 260.0;
/// What a stem of level 2 and one of level 3 cost, in triangles.
const SECONDARY_COST: f32 = 16.0;
const TERTIARY_COST: f32 = 10.0;

/// How many of everything a tree may have.
#[derive(Clone, Debug)]
pub(super) struct Budget {
    pub habit: Habit,
    /// Levels of stems that are really grown.
    pub levels: u32,
    /// Whether the tree is dead, and bears nothing.
    pub dead: bool,
    /// Segments of a stem by level.
    pub segments: [u32; 4],
    /// Arms that one stem may fork into, by level.
    pub max_arms: [u32; 4],
    /// Primary branches of the whole tree.
    pub primaries: f32,
    /// The most secondary branches on a primary one, and tertiary ones on a secondary one.
    pub max_children: [f32; 2],
    pub max_cards: u32,
    pub max_bark_triangles: u32,
}

impl Budget {
    /// Shares out the budget.
    pub fn new(params: &TreeParams) -> Self {
        let habit = params.habit();
        let palm = params.levels <= 1;
        let dead = is_dead(params.leaves_per_stem, params.secondary_branches) && !palm;
        let levels = match (palm, params.secondary_branches, dead) {
            (true, ..) => 1,
            (false, 0, false) => 2,
            (false, _, true) => (params.levels + 1).clamp(3, 4),
            _ if habit == Habit::Twigs => params.levels.clamp(3, 4),
            _ => params.levels.min(4),
        };
        let forks = (params.segment_splits * 1.2).min(2.0);
        let culms = culms::count(params);
        let max_primaries = if culms > 1 { MAX_ON_CULMS } else { 90.0 };
        let primaries = (params.primary_branches * culms) as f32;
        let primaries = primaries.min(max_primaries / (1.0 + 0.5 * forks)).max(1.0);
        let arms = primaries * (1.0 + 0.5 * forks);
        let inner = ((300.0 / arms) as u32).clamp(4, 8);
        let trunk = 1_300.0 + 220.0 * params.base_splits.max(culms - 1) as f32;
        let (bark, max_bark_triangles) = match habit {
            _ if dead => DEAD_BUDGET,
            Habit::Twigs => WINTER_BUDGET,
            _ => BARK_BUDGET,
        };
        let cards = if habit == Habit::Twigs { TWIG_BUDGET } else { LEAF_BUDGET };
        let left = (bark - trunk - arms * inner as f32 * 11.0).max(1_200.0);
        let mut budget = Self {
            habit,
            levels,
            dead,
            segments: [if palm { 14 } else { 12 }, inner, if levels == 4 { 3 } else { 4 }, 3],
            max_arms: [8, 3, 1, 1],
            primaries,
            max_children: [0.0, 0.0],
            max_cards: cards / habit.triangles(),
            max_bark_triangles,
        };
        if levels > 2 {
            budget.max_children = budget.children(params.secondary_branches as f32, arms, left);
        }
        budget
    }

    /// `max_children`, as many as `left` triangles pay for.
    fn children(&self, wish: f32, arms: f32, left: f32) -> [f32; 2] {
        let wish = wish.max(if self.dead { 8.0 } else { 1.0 });
        // By Weber & Penn's rule a branch bears about two thirds of the greatest number.
        let borne = 0.66 * arms;
        if self.habit == Habit::Frond {
            return [wish.min(70.0 / borne), if self.levels == 4 { 1.0 } else { 0.0 }];
        }
        if self.levels == 3 {
            return [wish.min(left / (borne * SECONDARY_COST)), 0.0];
        }
        let share = if self.dead { 0.36 } else { 0.55 };
        let secondaries = wish.min(share * left / (borne * SECONDARY_COST));
        let rest = left - secondaries * borne * SECONDARY_COST;
        let tertiaries = (0.7 * wish + 2.0).min(rest / (secondaries * borne * 0.75 * TERTIARY_COST));
        [secondaries, tertiaries]
    }
}
