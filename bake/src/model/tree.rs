//! Trees: templates, their levels of detail, and where they stand.

use genescape_schema::scene::{IMPOSTOR_PICTURES, Instance};
use glam::Vec3;
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

/// What casts a template's shadow.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Caster {
    /// Some hundred to two thousand triangles.
    pub mesh: Mesh,
    /// The part of the light that a triangle of each of its parts holds back, on average: 1 for bark.
    pub opacities: Vec<f32>,
}

/// The textures that all templates of a scene share, as images `P`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TreeTextures<P> {
    /// Tiling bark colour, sRGB, RGB. u runs around the branch, v along it.
    pub bark_color: P,
    /// Tiling tangent-space bark normals, RGB.
    pub bark_normal: P,
    /// Leaf card with its mip levels, sRGB with alpha, RGBA; colour bled under the transparent texels. Every level's
    /// alpha keeps the coverage of level 0 at the cutoff, as it is drawn between texels; only level 0 of what is thin, since
    /// alpha of plain averages is the share that is covered.
    pub leaf: Vec<P>,
    /// Blossom card, likewise.
    pub blossom: Vec<P>,
    /// Whether the leaf card holds bare twigs, lines thinner than the texels of most of its mip levels.
    pub is_thin: bool,
    /// Mean colour of the bark, linear RGB.
    pub bark_linear: [f32; 3],
    /// The leaf card's mip level of 32 × 32 pixels, 64 × 64 of fronds, of which as many texels reach the cutoff as of level 0:
    /// templates are simplified and their impostors made from it, who need a card's shape and colours, but nothing finer.
    pub leaf_small: Image8,
    /// Blossom card, likewise.
    pub blossom_small: Image8,
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
            is_thin: self.is_thin,
            bark_linear: self.bark_linear,
            leaf_small: self.leaf_small.clone(),
            blossom_small: self.blossom_small.clone(),
            alpha_cutoff: self.alpha_cutoff,
        })
    }
}

/// Pictures of clusters of leaves, on the cards that stand for them in coarse levels.
#[derive(Clone, Debug, PartialEq)]
pub struct Clusters {
    /// Albedo in sRGB, and alpha as a leaf card has it: RGBA.
    pub colors: Image8,
    /// Normals of the leaves, turned to the side from which the picture was taken, in the space of the card: RGB.
    pub normals: Image8,
}

/// Pictures of a template from four sides, side by side, as `schema/docs/GSC_impostor.md` defines them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Impostor {
    /// Albedo in sRGB, and alpha for a cutoff of [`Impostor::ALPHA_CUTOFF`]: RGBA.
    pub colors: Image8,
    /// Red is how far what a pixel shows lies before the axis, 0.5 for none and 1 for half of the width; green the share
    /// of leaves and blossom in it, blue the share of the pixel that the tree covers. RGB, linear.
    pub relief: Image8,
    /// x and z of the vertical axis.
    pub axis_m: [f32; 2],
    /// y of the lower edge.
    pub low_m: f32,
    /// Width and height of a picture; positive.
    pub size_m: [f32; 2],
    /// From this error on the pictures serve as well as any mesh; positive.
    pub error_m: f32,
}

impl Impostor {
    /// Alpha below this is cut away.
    pub const ALPHA_CUTOFF: f32 = 0.5;
    /// Azimuths from which the pictures are taken, as (sin, cos): every eighth of a turn, up to opposite directions.
    pub const AZIMUTHS: [[f32; 2]; IMPOSTOR_PICTURES as usize] = {
        const R: f32 = std::f32::consts::FRAC_1_SQRT_2;
        [[0.0, 1.0], [R, R], [1.0, 0.0], [R, -R]]
    };

    /// Directions towards the eye and to the right of picture `k`, horizontal unit vectors.
    pub fn eye_and_right(k: usize) -> [Vec3; 2] {
        let [sin, cos] = Self::AZIMUTHS[k];
        [Vec3::new(sin, 0.0, cos), Vec3::new(cos, 0.0, -sin)]
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
    /// How far this level is from the original, in metres: of trees, by how far pictures of the two differ (`tree::seen`), so
    /// that a coarser level may have less; of solid meshes, from the collapses made, more from level to level. For D_0
    /// extrapolated so that log q is a number (thesis 4.3.3 left that open).
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
    /// The share of the pictures by which errors were measured that D_0 covers; none where errors are of shape.
    pub coverage: Option<f32>,
}

/// All trees of a scene, in a fixed order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Placement {
    pub instances: Vec<Instance>,
    /// How many of them stand on a square metre where they grow best.
    pub per_m2: f32,
}

/// Whether trees of these genes are dead: they have lost their twigs with their leaves.
pub fn is_dead(leaves_per_stem: u32, secondary_branches: u32) -> bool {
    leaves_per_stem == 0 && secondary_branches == 0
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
    /// Part of the height at which the crown begins.
    pub clear_trunk: f32,
}

impl TreeFootprint {
    /// Where a crown begins by the genes of a tree: lower than its lowest branch, which hangs; what does not branch has its
    /// leaves at the top.
    pub fn clear_trunk(levels: u32, clear_trunk: f32) -> f32 {
        if levels <= 1 { 0.7 } else { (0.7 * clear_trunk).max(0.05) }
    }
}
