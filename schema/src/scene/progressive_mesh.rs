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
    /// The share (0 … 1) of the pictures by which errors were measured that D_0 covers; none where errors are of shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coverage: Option<f32>,
}

/// Trees cover so much of their pictures at least, but for bare ones and palms.
const USUAL_COVERAGE: f32 = 0.13;
/// Errors of nothing count so many times at most.
const MAX_WEIGHT: f32 = 5.0;

/// How many times the errors of a mesh with that `coverage` count for the eye, 1 … 5: a picture that is mostly sky differs
/// little from another, and yet everybody sees that a bare tree has half of its twigs. So what differs counts as a part of
/// what there is to be seen, where that is less than usual.
pub fn error_weight(coverage: Option<f32>) -> f32 {
    coverage.map_or(1.0, |coverage| (USUAL_COVERAGE / coverage).clamp(1.0, MAX_WEIGHT))
}

/// One distinguished mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct ProgressiveLevel {
    /// Its index in `meshes`.
    pub mesh: usize,
    /// How far it is from the original in metres; `error` in JSON. It may be less than that of a finer level: clusters are
    /// often nearer to a tree than the leaves before them.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_covers_little_counts_more_but_not_without_end() {
        assert_eq!([None, Some(0.3), Some(1.0)].map(error_weight), [1.0; 3]);
        assert!((error_weight(Some(0.065)) - 2.0).abs() < 1e-6);
        assert_eq!([Some(0.0), Some(1e-9)].map(error_weight), [5.0; 2]);
    }
}
