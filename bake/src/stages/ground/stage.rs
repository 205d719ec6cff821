//! The ground as stages: results of earlier stages → maps, textures and the foreground, as files.

use serde::{Deserialize, Serialize};

use super::{
    BLADE_WHITE, Ground, GroundParams, LitterParams, Loose, TEXTURES, Woods, foreground, maps, texture,
    tile_srgb,
};
use crate::gltf::{foreground_glb, png};
use crate::graph::{Context, File, Input, Stage, StageError, Stored};
use crate::model::TreeFootprint;
use crate::model::{GroundDetail, GroundMaps, GroundPlants, Image8, Instance, Landform, Mesh, StartView};

/// Landform and trees → what the stages of the ground know of the trees on it.
#[derive(Clone, Serialize)]
pub struct WoodsInput {
    pub params: LitterParams,
    pub trees: Input<Vec<Instance>>,
    pub footprints: Vec<Input<TreeFootprint>>,
}

impl WoodsInput {
    fn get(&self, context: &Context<'_>, land: &Landform) -> Result<Woods, StageError> {
        let footprints = context.get_all(&self.footprints)?;
        let crowns_m: Vec<f32> = footprints.iter().map(|footprint| footprint.crown_radius_m).collect();
        Ok(Woods::new(&self.params, land, &context.get(&self.trees)?, &crowns_m))
    }
}

/// Landform and trees → albedo, blend weights, and what grows and lies on the ground.
#[derive(Serialize)]
pub struct GroundMapsStage {
    pub params: GroundParams,
    /// Pixels a side.
    pub side_px: u32,
    pub landform: Input<Landform>,
    pub woods: WoodsInput,
}

#[derive(Serialize, Deserialize)]
pub struct GroundMapsFiles {
    pub maps: GroundMaps<File>,
    /// Those of `maps` as pixels.
    pub plants: Stored<GroundPlants<Image8>>,
}

impl Stage for GroundMapsStage {
    const NAME: &'static str = "ground maps";
    const VERSION: u32 = 36;
    type Output = GroundMapsFiles;

    fn run(&self, context: &Context<'_>) -> Result<GroundMapsFiles, StageError> {
        let landform = context.get(&self.landform)?;
        let maps = maps(&self.params, &self.woods.get(context, &landform)?, &landform, self.side_px);
        let (color, weights) = rayon::join(
            || context.file("png", png::encode(&maps.color)),
            || context.file("png", png::encode_linear(&maps.weights)),
        );
        let file = |map: &Image8| Ok(context.file("png", png::encode_linear(map)));
        let plants = maps.plants.try_map::<_, StageError>(file)?;
        let maps = (GroundMaps { color, weights, plants }, context.store(maps.plants));
        Ok(GroundMapsFiles { maps: maps.0, plants: maps.1 })
    }
}

/// Nothing → a tiling texture, which scenes share.
#[derive(Serialize)]
pub struct GroundTextureStage {
    /// Number of the kind of ground.
    pub kind: usize,
    /// What the last kind is.
    pub loose: Loose,
}

impl GroundTextureStage {
    /// Lands whose loose ground differs share all other textures.
    pub fn new(kind: usize, loose: Loose) -> Self {
        Self { kind, loose: if kind + 1 == TEXTURES.len() { loose } else { Loose::Earth } }
    }
}

/// A tiling texture as files.
#[derive(Serialize, Deserialize)]
pub struct GroundTextureFiles {
    pub detail: GroundDetail<File>,
    /// The detail as a base colour, see [`tile_srgb`].
    pub tile: File,
}

impl Stage for GroundTextureStage {
    const NAME: &'static str = "ground texture";
    const VERSION: u32 = 4;
    type Output = GroundTextureFiles;

    fn run(&self, context: &Context<'_>) -> Result<GroundTextureFiles, StageError> {
        let made = texture(self.kind, self.loose);
        Ok(GroundTextureFiles {
            tile: context.file("png", png::encode(&tile_srgb(self.kind, &made.detail))),
            detail: GroundDetail {
                detail: context.file("png", png::encode(&made.detail)),
                normal: context.file("png", png::encode_linear(&made.normal)),
                name: made.name,
                tile_m: made.tile_m,
            },
        })
    }

    fn label(&self) -> String {
        format!("{} {}", Self::NAME, self.kind)
    }
}

/// Landform, near mesh, start → the ground around the start in finer triangles, as glTF.
#[derive(Serialize)]
pub struct ForegroundStage {
    pub params: GroundParams,
    pub landform: Input<Landform>,
    pub woods: WoodsInput,
    pub plants: Input<Stored<GroundPlants<Image8>>>,
    pub near: Input<Stored<Mesh>>,
    pub start: Input<StartView>,
}

impl Stage for ForegroundStage {
    const NAME: &'static str = "foreground";
    const VERSION: u32 = 32;
    type Output = File;

    fn run(&self, context: &Context<'_>) -> Result<File, StageError> {
        let (landform, start) = (context.get(&self.landform)?, context.get(&self.start)?);
        let near = context.load(&*context.get(&self.near)?)?;
        let triangles = &near.parts[0].triangles;
        let (woods, plants) =
            (self.woods.get(context, &landform)?, context.load(&*context.get(&self.plants)?)?);
        let ground = Ground { params: &self.params, woods: &woods, land: &landform, plants: &plants };
        let made = foreground(&ground, &start, &near.positions, triangles);
        Ok(context.file("glb", foreground_glb(&made, &TEXTURES, BLADE_WHITE)?))
    }
}
