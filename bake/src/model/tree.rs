//! Trees: templates, their levels of detail, and where they stand.

use serde::{Deserialize, Serialize};

use super::{Bounds, Image8, Mesh};

/// One tree: its foot at the origin (roots reach a little below y = 0), growing along +y.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TreeTemplate {
    /// A `Bark` part (surface) first, then `Leaf` and `Blossom` parts (aggregates) if any.
    pub mesh: Mesh,
    /// The box around it.
    pub bounds: Bounds,
    /// Radius in metres of the trunk at breast height (1.3 m, or a tenth of a lower tree): for collision.
    pub trunk_radius_m: f32,
    /// Horizontal radius in metres that holds 95 % of the crown: for spacing.
    pub crown_radius_m: f32,
}

/// The textures that all templates of a scene share.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TreeTextures {
    /// Tiling bark colour, sRGB, RGB. u runs around the branch, v along it.
    pub bark_color_srgb: Image8,
    /// Tiling tangent-space bark normals, RGB.
    pub bark_normal: Image8,
    /// Leaf card, sRGB with alpha, RGBA; colour bled under the transparent texels. Every mip level's alpha keeps
    /// the coverage of level 0 at the cutoff.
    pub leaf_srgb: Vec<Image8>,
    /// Blossom card, likewise.
    pub blossom_srgb: Vec<Image8>,
    /// Alpha below this is cut away.
    pub alpha_cutoff: f32,
}

/// What moves a vertex of one level towards the next.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Morph {
    /// Change of each vertex's position in metres; one entry a vertex.
    pub positions: Vec<[f32; 3]>,
    /// Change of each normal.
    pub normals: Vec<[f32; 3]>,
    /// Change of each texture coordinate.
    pub uvs: Vec<[f32; 2]>,
}

/// One distinguished mesh D_i.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// The mesh itself; same parts, in the same order, as D_0 (a part may be empty).
    pub mesh: Mesh,
    /// At weight 1, the mesh coincides with D_{i+1}; `None` for the last level.
    pub morph: Option<Morph>,
    /// How far this level is from the original, in metres, from the collapses made; for D_0 extrapolated from the
    /// first collapses so that log q is a number (thesis 4.3.3 left that open). Increases from level to level.
    pub error_m: f32,
    /// For each part, one generalised triangle strip (with degenerate triangles) over the same vertices.
    pub strips: Vec<Vec<u32>>,
}

/// A mesh with all its levels of detail.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelledMesh {
    /// D_0 … D_k, each with half the vertices of the one before. D_0 is the original.
    pub levels: Vec<Level>,
    /// The payload of `GSC_progressive_mesh`: the coarsest mesh and the vertex splits that lead back to D_0.
    pub progressive: Vec<u8>,
}

/// One tree that stands in the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Instance {
    /// Which template.
    pub template: u32,
    /// The affine transform from the template's space to the world: 3 rows of 4, row-major, metres. Determinant > 0.
    pub world_from_tree: [[f32; 4]; 3],
    /// The infinite vertical cylinder around the trunk for collision: x, z and radius in metres.
    pub trunk_cylinder_m: [f32; 3],
}

/// All trees of a scene, in a fixed order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Placement {
    /// The instances.
    pub instances: Vec<Instance>,
}
