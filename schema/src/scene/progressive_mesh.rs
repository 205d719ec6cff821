//! `GSC_progressive_mesh`, on the glTF mesh that is D_0: all levels of detail of a mesh.

use serde::{Deserialize, Serialize};

/// The extension's name.
pub const GSC_PROGRESSIVE_MESH: &str = "GSC_progressive_mesh";

/// The extension's object on a mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct ProgressiveMeshExtension {
    /// The bufferView with the coarsest mesh and the vertex splits that lead back to D_0.
    pub buffer_view: usize,
    /// D_0 … D_k, finest first; the first is the mesh that carries this extension.
    pub levels: Vec<ProgressiveLevel>,
    /// The first level in which clusters stand for single leaves; none if there is no such level.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clusters: Option<usize>,
}

/// One distinguished mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct ProgressiveLevel {
    /// Its index in `meshes`.
    pub mesh: usize,
    /// How far it is from the original in metres; `error` in JSON.
    #[serde(rename = "error")]
    pub error_m: f32,
    /// Its vertices, all primitives together.
    pub vertices: usize,
    /// Its triangles, all primitives together.
    pub triangles: usize,
    /// For each primitive, the accessor (VEC2, float) with what the geomorph adds to TEXCOORD_0 at weight 1.
    /// Absent on the last level.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub texcoord_deltas: Vec<usize>,
    /// For each primitive, the accessor (SCALAR, unsigned) of one generalised triangle strip, with degenerate
    /// triangles, over the primitive's vertices; the same triangles as the primitive's indices.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub strips: Vec<usize>,
}
