//! What the ground looks like.

use serde::{Deserialize, Serialize};

use super::{Image8, Mesh};

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

/// The ground around the start, finely meshed for tiling textures: core glTF cannot blend these by a map, so each
/// kind of ground is a part of its own, `Material::Foreign(k)` for the kth of `GroundTextures`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Foreground {
    /// Parts with vertices of their own; uvs count tiles; colours times the kind's tile give the albedo.
    pub mesh: Mesh,
    /// For each vertex its place on the maps over the whole field, as the uvs of `TerrainMesh::near`.
    pub map_uvs: Vec<[f32; 2]>,
    /// The triangles of `TerrainMesh::near` that it does not replace.
    pub rest: Vec<[u32; 3]>,
    /// Blades of grass that stand on it: no uvs, colours that are to be multiplied by `ground::BLADE_WHITE`.
    pub grass: Mesh,
}
