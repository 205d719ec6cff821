//! Trees as stages: genes → textures and templates, as files.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{
    Levelled, TreeParams, TreeTextureParams, drawn_from_afar, impostor, levelled, template, textures,
};
use crate::gltf::{Picture, TreePictures, png, tree_glb};
use crate::graph::{Context, File, Input, Stage, StageError, Stored};
use crate::model::TreeFootprint;
use crate::model::{Caster, Image8, TreeTextures};

/// Mip levels of a card smaller than this are left to the viewer: at that distance a crown covers a few pixels.
const MIN_MIP_PX: u32 = 16;

/// Tree genes → bark, leaf and blossom.
#[derive(Serialize)]
pub struct TreeTexturesStage {
    params: TreeTextureParams,
}

impl Stage for TreeTexturesStage {
    const NAME: &'static str = "tree textures";
    const VERSION: u32 = 14;
    type Output = TreeTextures<File>;

    fn run(&self, context: &Context<'_>) -> Result<TreeTextures<File>, StageError> {
        let textures = textures(&self.params);
        let card = |levels: &[Image8]| {
            let kept = levels.par_iter().filter(|level| level.width >= MIN_MIP_PX);
            kept.map(|level| context.file("png", png::encode(level))).collect()
        };
        let color = || context.file("png", png::encode(&textures.bark_color));
        let normal = || context.file("png", png::encode_linear(&textures.bark_normal));
        let ((bark_color, bark_normal), (leaf, blossom)) = rayon::join(
            || rayon::join(color, normal),
            || rayon::join(|| card(&textures.leaf), || card(&textures.blossom)),
        );
        Ok(TreeTextures {
            bark_color,
            bark_normal,
            leaf,
            blossom,
            is_thin: textures.is_thin,
            bark_linear: textures.bark_linear,
            leaf_small: textures.leaf_small,
            blossom_small: textures.blossom_small,
            alpha_cutoff: textures.alpha_cutoff,
        })
    }
}

impl TreeTexturesStage {
    /// How many leaves a tree has is nothing to its textures.
    pub fn new(params: TreeTextureParams) -> Self {
        Self { params: TreeTextureParams { leaves_per_stem: params.leaves_per_stem.min(1), ..params } }
    }

    /// The textures that a template's own file embeds.
    pub fn without_mip_levels(textures: &TreeTextures<File>) -> TreeTextures<File> {
        let mut textures = textures.clone();
        textures.leaf.truncate(1);
        textures.blossom.truncate(1);
        textures
    }
}

/// Tree genes and textures → one template with all its levels, as a file.
#[derive(Serialize)]
pub struct TreeStage {
    pub params: TreeParams,
    /// Which of the templates.
    pub index: u32,
    /// Without mip levels: the file brings its own copies of the textures.
    pub textures: Input<TreeTextures<File>>,
}

#[derive(Serialize, Deserialize)]
pub struct TreeFiles {
    /// The template with all its levels, self-contained.
    pub glb: File,
    pub footprint: TreeFootprint,
    /// What casts the template's shadow.
    pub caster: Stored<Caster>,
}

impl Stage for TreeStage {
    const NAME: &'static str = "tree";
    const VERSION: u32 = 49;
    type Output = TreeFiles;

    fn run(&self, context: &Context<'_>) -> Result<TreeFiles, StageError> {
        let template = template(&self.params, self.index);
        let textures = context.get(&self.textures)?.try_map(|file| context.bytes(file))?;
        let Levelled { mesh, clusters, caster } = levelled(&template.mesh, &textures, &mut |_| ());
        let impostor = impostor(drawn_from_afar(&mesh.levels, &textures), &textures);
        let embedded = textures.map(|bytes| Picture::Embedded { bytes, mime_type: "image/png" });
        let pictures = TreePictures { impostor: Some(&impostor), clusters: clusters.as_ref() };
        let glb = tree_glb(&format!("tree-{}", self.index), &mesh, &embedded, &pictures)?;
        let footprint = TreeFootprint {
            height_m: template.bounds.max.y,
            trunk_radius_m: template.trunk_radius_m,
            crown_radius_m: template.crown_radius_m,
            root_depth_m: -template.bounds.min.y,
            clear_trunk: TreeFootprint::clear_trunk(self.params.levels, self.params.clear_trunk),
        };
        Ok(TreeFiles { glb: context.file("glb", glb), footprint, caster: context.store(caster) })
    }

    fn label(&self) -> String {
        format!("tree {}", self.index)
    }
}
