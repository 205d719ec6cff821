//! The genes that trees are made of, named and measured as in `configs/space.ron`.

use serde::{Deserialize, Serialize};

/// Genes of form and foliage, for [`super::template`]. Names in brackets are those of Weber & Penn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TreeParams {
    /// Which individual of its species.
    pub tree_seed: u32,
    /// Envelope of the crown, 0–7 (Shape).
    pub crown_shape: u32,
    /// Height in metres (Scale).
    pub height_m: f32,
    /// How much templates differ in height (ScaleV / Scale).
    pub height_variation: f32,
    /// Part of the trunk without branches (BaseSize).
    pub clear_trunk: f32,
    /// Levels of branching, 1–4 (Levels).
    pub levels: u32,
    /// Radius of the trunk over its length (Ratio).
    pub radius_ratio: f32,
    /// How fast radius falls from parent to child (RatioPower).
    pub radius_power: f32,
    /// How far the trunk widens into its roots (Flare).
    pub root_flare: f32,
    /// Times that the trunk forks near its base (BaseSplits).
    pub base_splits: u32,
    /// Forks per segment (SegSplits).
    pub segment_splits: f32,
    /// Angle between the arms of a fork in degrees (SplitAngle).
    pub split_angle_deg: f32,
    /// Branches on the trunk (1Branches).
    pub primary_branches: u32,
    /// Branches on each primary branch (2Branches).
    pub secondary_branches: u32,
    /// Length of primary branches over the trunk (1Length).
    pub primary_length: f32,
    /// Length of secondary branches over their parents (2Length).
    pub secondary_length: f32,
    /// Angle of a branch away from its parent in degrees (DownAngle).
    pub down_angle_deg: f32,
    /// Its change: negative from base to tip, positive at random (DownAngleV).
    pub down_angle_variation_deg: f32,
    /// Turn around the parent from branch to branch in degrees (Rotate).
    pub rotation_deg: f32,
    /// Bend of a branch over its whole length in degrees, positive away from its parent (Curve).
    pub curve_deg: f32,
    /// Random bend on top of it (CurveV).
    pub curve_variation_deg: f32,
    /// Further bend of the outer half, with the same sign (CurveBack).
    pub curve_back_deg: f32,
    /// Upward (+) or downward (−) pull on branches (AttractionUp).
    pub tropism: f32,
    /// Taper of trunk and branches: 1 is a cone to a point (Taper).
    pub taper: f32,
    /// Leaf cards on each outermost branch; 0 is a bare tree (Leaves).
    pub leaves_per_stem: u32,
    /// Kind of leaf, 0–7 (LeafShape).
    pub leaf_shape: u32,
    /// Length of one leaf in metres (LeafScale).
    pub leaf_size_m: f32,
    /// Hue of the leaves in degrees: autumn leaves differ more from twig to twig.
    pub leaf_hue_deg: f32,
    /// Part of the leaf cards that are blossom.
    pub blossom: f32,
    /// 0 dark furrowed bark, 0.5 brown, 1 pale birch: moss grows on dark bark.
    pub bark_tone: f32,
}

/// Genes of leaf, blossom and bark textures, for [`super::textures`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TreeTextureParams {
    /// Which individual of its species.
    pub tree_seed: u32,
    /// Height in metres: how large a twig a card holds.
    pub height_m: f32,
    /// Levels of branching; with 1, every leaf shape is set out along a frond.
    pub levels: u32,
    /// Kind of leaf, 0–7.
    pub leaf_shape: u32,
    /// Length of one leaf in metres: how many fit on a card.
    pub leaf_size_m: f32,
    /// Width of a leaf over its length.
    pub leaf_aspect: f32,
    /// Hue of the leaves in degrees.
    pub leaf_hue_deg: f32,
    /// Part of the leaf cards that are blossom; 0 paints none (a picture of one texel).
    pub blossom: f32,
    /// 0 dark furrowed bark, 0.5 brown, 1 pale birch.
    pub bark_tone: f32,
}

/// How the foliage of a species is set out on cards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Habit {
    /// Twigs of broad leaves: flat cards.
    Broad,
    /// Long hanging twigs: cards bent once.
    Willow,
    /// Needle sprays: cards bent once, lying along the branch.
    Needle,
    /// Fronds: folded, arching strips.
    Frond,
}

impl Habit {
    /// From the genes `leaf_shape` and `levels`.
    pub fn of(leaf_shape: u32, levels: u32) -> Self {
        match (levels, leaf_shape) {
            (0 | 1, _) | (_, 7) => Self::Frond,
            (_, 2) => Self::Willow,
            (_, 6) => Self::Needle,
            _ => Self::Broad,
        }
    }

    /// Rows of vertices along a card, and vertices in a row.
    pub fn grid(self) -> (u32, u32) {
        match self {
            Self::Broad => (2, 2),
            Self::Willow | Self::Needle => (3, 2),
            Self::Frond => (6, 3),
        }
    }

    /// Triangles of one card.
    pub fn triangles(self) -> u32 {
        let (rows, columns) = self.grid();
        (rows - 1) * (columns - 1) * 2
    }

    /// Width of a card over its length.
    pub fn card_aspect(self) -> f32 {
        match self {
            Self::Broad => 0.92,
            Self::Willow => 0.42,
            Self::Needle => 0.78,
            Self::Frond => 0.42,
        }
    }
}

/// Length in metres of the twig that one card holds, before budget and chance change it.
///
/// A twig is several leaves long; a low tree has short twigs, and a high tree is never dressed in thousands of tiny
/// cards but in cards of more leaves.
pub(super) fn card_length_m(habit: Habit, levels: u32, height_m: f32, leaf_size_m: f32) -> f32 {
    match habit {
        Habit::Broad => (leaf_size_m * 4.5).clamp(0.16 + 0.022 * height_m, 0.25 + 0.05 * height_m),
        Habit::Willow => (leaf_size_m * 7.0).clamp(0.3 + 0.04 * height_m, 0.4 + 0.075 * height_m),
        Habit::Needle => (leaf_size_m * 10.0).clamp(0.25 + 0.038 * height_m, 0.35 + 0.055 * height_m),
        Habit::Frond if levels <= 1 => (1.1 + 0.17 * height_m + 3.5 * leaf_size_m).min(0.7 * height_m),
        Habit::Frond => 0.35 + 0.035 * height_m + 1.5 * leaf_size_m,
    }
}
