//! `GSC_heightfield`, on the terrain's node: the land as a heightfield with its levels of detail and its surface.

use serde::{Deserialize, Serialize};

use super::Resource;

/// The extension's name.
pub const GSC_HEIGHTFIELD: &str = "GSC_heightfield";

/// The extension's object on a node.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct HeightfieldExtension {
    /// Samples a side, 2^k+1. The field is centred on the node's origin; rows run south (+z), columns east (+x).
    pub side: u32,
    /// Metres between samples.
    pub spacing_m: f32,
    /// Height in metres of value 0 of `heights`.
    pub min_m: f32,
    /// Height in metres of value 65535 of `heights`.
    pub max_m: f32,
    /// Surface of the lake in metres; absent when the land is dry.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub water_level_m: Option<f32>,
    /// The heights as a 16-bit grey PNG of side² pixels.
    pub heights: Resource,
    /// Wedgies, displacements, levels and block ranges.
    pub lod: Resource,
    /// What the ground looks like.
    pub surface: GroundSurface,
}

/// The pictures that cover the field: row 0 is its north edge (−z), column 0 its west edge (−x).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct GroundSurface {
    /// Albedo, sRGB.
    pub color: Resource,
    /// How much of `details` 1 to 4 there is, in RGBA; what remains up to 255 is `details` 0.
    pub weights: Resource,
    /// R: part of the sky's irradiance that arrives; G: the sun's irradiance relative to a surface that faces it;
    /// B: visibility of the sun's disc. Linear.
    pub light: Resource,
    /// Grass, rock, scree, snow and mud.
    pub details: Vec<GroundDetail>,
}

/// A tiling texture for the ground nearby.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct GroundDetail {
    /// What it is.
    pub name: String,
    /// sRGB; (128, 128, 128) leaves the ground's colour as it is, since it is multiplied by twice this.
    pub detail: Resource,
    /// Tangent-space normals.
    pub normal: Resource,
    /// Metres that one tile covers.
    pub tile_m: f32,
}
