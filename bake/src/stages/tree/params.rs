//! The genes that trees are made of: names, units, ranges and meanings as in `configs/space.ron`.

use serde::{Deserialize, Serialize};

/// Radius over length below which a stem is a cane.
const CANE_RATIO: f32 = 0.01;

/// Genes of form and foliage, for [`super::template`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TreeParams {
    pub tree_seed: u32,
    pub crown_shape: u32,
    pub height_m: f32,
    /// How much templates differ.
    pub height_variation: f32,
    pub clear_trunk: f32,
    pub levels: u32,
    pub radius_ratio: f32,
    pub radius_power: f32,
    pub root_flare: f32,
    pub base_splits: u32,
    pub segment_splits: f32,
    pub split_angle_deg: f32,
    pub primary_branches: u32,
    pub secondary_branches: u32,
    pub primary_length: f32,
    pub secondary_length: f32,
    pub down_angle_deg: f32,
    pub down_angle_variation_deg: f32,
    pub rotation_deg: f32,
    pub curve_deg: f32,
    pub curve_variation_deg: f32,
    pub curve_back_deg: f32,
    pub tropism: f32,
    pub taper: f32,
    pub leaves_per_stem: u32,
    pub leaf_shape: u32,
    pub leaf_size_m: f32,
    /// Autumn leaves differ more from twig to twig.
    pub leaf_hue_deg: f32,
    pub blossom: f32,
    /// Moss grows on dark bark; twigs of trees with pale bark are brown.
    pub bark_tone: f32,
}

impl TreeParams {
    /// Whether it grows canes, green and without bark, instead of a trunk.
    pub(super) fn is_cane(&self) -> bool {
        self.radius_ratio < CANE_RATIO
    }

    pub(super) fn habit(&self) -> Habit {
        Habit::of(self.leaf_shape, self.levels, self.leaves_per_stem)
    }
}

/// Genes of leaf, blossom and bark textures, for [`super::textures`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TreeTextureParams {
    pub tree_seed: u32,
    /// How large a twig a card holds.
    pub height_m: f32,
    /// With 1, every leaf shape is set out along a frond.
    pub levels: u32,
    /// With 0, a card holds bare twigs; else all is the same.
    pub leaves_per_stem: u32,
    pub leaf_shape: u32,
    /// How many leaves fit on a card.
    pub leaf_size_m: f32,
    pub leaf_aspect: f32,
    pub leaf_hue_deg: f32,
    /// The most slender stems are canes and have no bark.
    pub radius_ratio: f32,
    /// 0 paints no blossom (an image of one texel).
    pub blossom: f32,
    pub bark_tone: f32,
}

impl TreeTextureParams {
    pub(super) fn habit(&self) -> Habit {
        Habit::of(self.leaf_shape, self.levels, self.leaves_per_stem)
    }
}

/// How foliage is set out on cards.
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
    /// Bare twigs of a tree in winter: flat cards.
    Twigs,
}

impl Habit {
    /// From the genes of these names.
    fn of(leaf_shape: u32, levels: u32, leaves_per_stem: u32) -> Self {
        match (levels, leaf_shape) {
            (2.., _) if leaves_per_stem == 0 => Self::Twigs,
            (0 | 1, _) | (_, 7) => Self::Frond,
            (_, 2) => Self::Willow,
            (_, 6) => Self::Needle,
            _ => Self::Broad,
        }
    }

    /// Rows of vertices along a card, and vertices in a row.
    pub fn grid(self) -> (u32, u32) {
        match self {
            Self::Broad | Self::Twigs => (2, 2),
            Self::Willow | Self::Needle => (3, 2),
            Self::Frond => (6, 3),
        }
    }

    /// Triangles of one card.
    pub fn triangles(self) -> u32 {
        let (rows, columns) = self.grid();
        (rows - 1) * (columns - 1) * 2
    }

    /// The part of a card that is not gaps.
    pub fn covered(self) -> f32 {
        if self == Self::Twigs { 0.1 } else { 0.5 }
    }

    /// Width of a card over its length.
    pub fn card_aspect(self) -> f32 {
        match self {
            Self::Broad | Self::Twigs => 0.92,
            Self::Needle => 0.78,
            Self::Willow | Self::Frond => 0.42,
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
        Habit::Twigs => 0.25 + 0.035 * height_m,
        Habit::Frond if levels <= 1 => (1.1 + 0.17 * height_m + 3.5 * leaf_size_m).min(0.7 * height_m),
        Habit::Frond => 0.35 + 0.035 * height_m + 1.5 * leaf_size_m,
    }
}

/// How far the leaves have turned, from 0 (green) to 1.
pub(super) fn autumn(leaf_hue_deg: f32) -> f32 {
    ((78.0 - leaf_hue_deg) / 25.0).clamp(0.0, 1.0)
}
