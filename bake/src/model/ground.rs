//! What the ground looks like.

use serde::{Deserialize, Serialize};

use super::{GroundPlants, Mesh};

/// Images that cover the field once, as those of `GroundSurface`, which says what they hold.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GroundMaps<P> {
    /// RGB; where the land has fields, RGBA: A is how much of the ground is not under their water.
    pub color: P,
    /// RGBA.
    pub weights: P,
    pub plants: GroundPlants<P>,
}

/// Surfaces with tiling textures of the ground: core glTF cannot blend these by a map, so what has the kth of them is a part
/// of its own, `Material::Foreign(k)`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tiled {
    /// Parts with vertices of their own; uvs count tiles; colours times the kind's tile give the albedo.
    pub mesh: Mesh,
    /// For each vertex its place on the maps over the whole field, as the uvs of `TerrainMesh::near`.
    pub map_uvs: Vec<[f32; 2]>,
}

/// The ground around the start, finely meshed, and what stands and lies on it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Foreground {
    pub ground: Tiled,
    /// Stones, fallen trunks and stumps.
    pub stones: Tiled,
    /// The triangles of `TerrainMesh::near` that it does not replace.
    pub rest: Vec<[u32; 3]>,
    /// Blades of grass and small plants: no uvs, colours that are to be multiplied by `ground::BLADE_WHITE`.
    pub grass: Mesh,
}
