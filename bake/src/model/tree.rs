//! Trees: templates, their levels of detail, and where they stand.

use genescape_schema::scene::Instance;
use serde::{Deserialize, Serialize};

use super::{AlphaMask, Bounds, Mesh};

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

/// The textures that all templates of a scene share, as images `P`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TreeTextures<P> {
    /// Tiling bark colour, sRGB, RGB. u runs around the branch, v along it.
    pub bark_color: P,
    /// Tiling tangent-space bark normals, RGB.
    pub bark_normal: P,
    /// Leaf card with its mip levels, sRGB with alpha, RGBA; colour bled under the transparent texels. Every level's
    /// alpha keeps the coverage of level 0 at the cutoff. Empty on a bare tree.
    pub leaf: Vec<P>,
    /// Blossom card, likewise.
    pub blossom: Vec<P>,
    /// What the leaf card leaves opaque.
    pub leaf_mask: AlphaMask,
    /// What the blossom card leaves opaque.
    pub blossom_mask: AlphaMask,
    /// Alpha below this is cut away.
    pub alpha_cutoff: f32,
}

impl<P> TreeTextures<P> {
    /// The same with `f` of each image.
    pub fn map<'a, Q>(&'a self, mut f: impl FnMut(&'a P) -> Q) -> TreeTextures<Q> {
        let mapped: Result<_, std::convert::Infallible> = self.try_map(|image| Ok(f(image)));
        mapped.unwrap_or_else(|never| match never {})
    }

    /// The same with `f` of each image.
    ///
    /// # Errors
    /// The first that `f` gives.
    pub fn try_map<'a, Q, E>(
        &'a self,
        mut f: impl FnMut(&'a P) -> Result<Q, E>,
    ) -> Result<TreeTextures<Q>, E> {
        Ok(TreeTextures {
            bark_color: f(&self.bark_color)?,
            bark_normal: f(&self.bark_normal)?,
            leaf: self.leaf.iter().map(&mut f).collect::<Result<_, _>>()?,
            blossom: self.blossom.iter().map(&mut f).collect::<Result<_, _>>()?,
            leaf_mask: self.leaf_mask,
            blossom_mask: self.blossom_mask,
            alpha_cutoff: self.alpha_cutoff,
        })
    }
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

/// All trees of a scene, in a fixed order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Placement {
    pub instances: Vec<Instance>,
}

/// The size of a template of trees, in metres at scale 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TreeFootprint {
    /// From the foot to the top.
    pub height_m: f32,
    /// Of the trunk at breast height.
    pub trunk_radius_m: f32,
    /// Horizontal radius that holds nearly all of the crown.
    pub crown_radius_m: f32,
    /// How far the roots reach below the foot.
    pub root_depth_m: f32,
}
