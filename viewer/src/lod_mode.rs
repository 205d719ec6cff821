//! How trees and terrain get their level of detail: the one list of modes for the command line, the settings file and
//! panel, the keys, the bench and the shaders. A variant's first line of documentation is its help everywhere, and its
//! number is what shaders know it by.

use serde::{Deserialize, Serialize};
use strum::{EnumMessage, VariantArray};

/// LOD modes of trees (thesis 4.3.2 and 4.3.3).
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    Hash,
    Serialize,
    Deserialize,
    clap::ValueEnum,
    strum::EnumMessage,
    strum::IntoStaticStr,
    strum::VariantArray,
)]
#[repr(u32)]
pub enum TreeLodMode {
    /// Continuous, by the error of each mesh on the screen
    // q(f(d)) ∝ d for the error q in metres.
    #[default]
    Quality,
    /// Continuous, by the number of vertices alone
    // 2·log₂ d + β.
    Simple,
    /// By error, without morphing between levels
    Discrete,
    /// Always the finest mesh, on the field
    Off,
}

/// LOD modes of the terrain (thesis 3.2).
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    Hash,
    Serialize,
    Deserialize,
    clap::ValueEnum,
    strum::EnumMessage,
    strum::IntoStaticStr,
    strum::VariantArray,
)]
#[repr(u32)]
pub enum TerrainLodMode {
    /// Triangles that rise as one comes near, sooner where the land is rough
    #[default]
    Morph,
    /// Blocks of a quadtree that morph with distance alone
    // As in the thesis, 3.2: to compare with.
    Distance,
    /// Triangles split on the CPU where the land is rough, drawn as one strip
    // A bintree, split by wedgies.
    #[strum(to_string = "ROAM")]
    Roam,
    /// Every sample
    Off,
}

/// What both have in common.
pub trait LodMode: Copy + PartialEq + EnumMessage + Into<&'static str> + VariantArray {
    /// A word for buttons and messages.
    fn label(self) -> &'static str {
        self.into()
    }

    /// A line of help.
    fn help(self) -> &'static str {
        self.get_documentation().unwrap_or_default()
    }

    /// The mode after this one, and after the last the first.
    fn next(self) -> Self {
        let after = Self::VARIANTS.iter().skip_while(|&&mode| mode != self).nth(1);
        *after.unwrap_or(&Self::VARIANTS[0])
    }
}

impl LodMode for TreeLodMode {}
impl LodMode for TerrainLodMode {}

#[cfg(test)]
mod tests {
    use super::*;

    fn each_has_words_and_comes_once_around<M: LodMode + std::fmt::Debug>() {
        let mut mode = M::VARIANTS[0];
        for &expected in M::VARIANTS {
            assert_eq!(mode, expected);
            assert!(!mode.label().is_empty() && !mode.help().is_empty(), "{mode:?}");
            mode = mode.next();
        }
        assert_eq!(mode, M::VARIANTS[0]);
    }

    #[test]
    fn modes_have_words_and_follow_each_other_in_a_circle() {
        each_has_words_and_comes_once_around::<TreeLodMode>();
        each_has_words_and_comes_once_around::<TerrainLodMode>();
        assert_eq!(TerrainLodMode::Roam.label(), "ROAM");
    }
}
