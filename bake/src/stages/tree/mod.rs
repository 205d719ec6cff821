//! Genes → tree templates (metres, foot at the origin, +y up) and the textures that they share.
//!
//! The skeleton follows Weber & Penn, "Creation and Rendering of Realistic Trees" (SIGGRAPH 1995): stems in up to
//! four levels, an envelope for the crown, forks by error diffusion. Around it grow closed tubes of bark whose
//! texture follows the branch, and cards that each hold a twig of leaves or blossom. Counts come from a triangle
//! budget, so that no genome explodes.

mod bark;
mod bark_texture;
mod brush;
mod budget;
mod canvas;
mod cards;
mod clusters;
mod crease;
mod culms;
mod foliage;
mod impostor;
mod leaf_outline;
mod leaf_texture;
mod levelled;
mod measure;
mod mips;
mod needle_texture;
mod outline;
mod params;
mod picture;
mod raster;
mod seen;
mod shade;
mod skeleton;
mod stage;
mod surfaces;
#[cfg(test)]
mod tests;

use rayon::join;

use crate::model::{Image8, TreeTemplate, TreeTextures};
use crate::seed::Dice;
use budget::Budget;
pub use stage::{TreeFiles, TreeStage, TreeTexturesStage};

pub use crease::crease_normals;
pub use impostor::{drawn_from_afar, impostor};
pub use levelled::{Levelled, levelled};
pub use measure::{TreeMeasures, measure};
use params::Habit;
pub use params::{TreeParams, TreeTextureParams};

/// Texels of leaf and blossom cards with less alpha than this are not drawn.
pub const ALPHA_CUTOFF: f32 = 0.5;

/// Grows the `index`th template: a closed `Bark` surface, then `Leaf` and `Blossom` aggregates if it
/// bears any. Metres; at most about 26,000 triangles.
///
/// The elements of an aggregate are cards with consecutive vertices and triangles: 4 and 2 for broad leaves, 6 and
/// 4 for willow leaves and needles (bent once), 18 and 20 for fronds (a folded, arching strip). Rows of vertices run
/// from the root, which lies on a stem, to the tip; texture coordinate v is 1 at the root.
pub fn template(params: &TreeParams, index: u32) -> TreeTemplate {
    let mut dice = Dice::new(params.tree_seed, "tree", index.into());
    let budget = Budget::new(params);
    let skeleton = skeleton::grow(params, &budget, &mut dice);
    let cards = cards::place(params, &budget, &skeleton, &mut dice);
    let shade = shade::Shade::new(&skeleton, &cards, budget.habit.covered());

    let mut mesh = bark::skin(params, &budget, &skeleton, &shade);
    for blossom in [false, true] {
        foliage::build(budget.habit, &cards, blossom, &shade, &mut mesh);
    }
    TreeTemplate {
        bounds: mesh.bounds(),
        trunk_radius_m: skeleton.trunk_radius_m(params.height_m),
        crown_radius_m: cards::crown_radius_m(&skeleton, &cards),
        mesh,
    }
}

/// Paints the textures that all templates of a scene share: tiling bark with its normals, and cards of leaves
/// and of blossom with mip chains that keep their coverage. Square; sRGB where the field's name says so.
pub fn textures(params: &TreeTextureParams) -> TreeTextures<Image8> {
    let ((bark_color, bark_normal), (mut leaf, blossom)) = join(
        || bark_texture::paint(params),
        || join(|| leaf_texture::paint_leaves(params), || leaf_texture::paint_blossom(params)),
    );
    let is_thin = params.habit() == Habit::Twigs;
    if is_thin {
        leaf.levels.truncate(1);
    }
    TreeTextures {
        bark_linear: bark_texture::mean_linear(&bark_color),
        bark_color,
        bark_normal,
        leaf: leaf.levels,
        blossom: blossom.levels,
        is_thin,
        leaf_small: leaf.small,
        blossom_small: blossom.small,
        alpha_cutoff: ALPHA_CUTOFF,
    }
}
