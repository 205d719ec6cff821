//! What the ground looks like.

use serde::{Deserialize, Serialize};

use super::Image8;

/// Pictures that cover the field once: row 0 is its north edge (−z), column 0 its west edge (−x).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GroundMaps {
    /// Albedo, sRGB, RGB.
    pub color_srgb: Image8,
    /// Blend weights of `GroundTextures` 1..=4 (rock, scree, snow, mud) in RGBA; the rest up to 255 is grass.
    pub weights: Image8,
}

/// A tiling texture, seen from near.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GroundTexture {
    /// "grass", "rock", "scree", "snow" or "mud".
    pub name: String,
    /// Detail around the ground's colour: sRGB RGB with mean (128, 128, 128), to multiply by two.
    pub detail_srgb: Image8,
    /// Tangent-space normals, RGB.
    pub normal: Image8,
    /// Metres that one tile covers.
    pub tile_m: f32,
}

/// Grass, rock, scree, snow and mud, in that order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GroundTextures {
    /// The five textures.
    pub textures: Vec<GroundTexture>,
}
