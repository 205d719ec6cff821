//! The ground as stages: results of earlier stages → maps, textures and the foreground, as files.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{BLADE_WHITE, GroundParams, TEXTURES, foreground, maps, textures, tile_srgb};
use crate::gltf::{foreground_glb, png};
use crate::graph::{Context, File, Input, Stage, StageError, Stored};
use crate::model::{GroundDetail, GroundMaps, Landform, Mesh, StartView};

/// Landform → albedo and blend weights.
#[derive(Serialize)]
pub struct GroundMapsStage {
    pub params: GroundParams,
    /// Pixels a side.
    pub side_px: u32,
    pub landform: Input<Landform>,
}

impl Stage for GroundMapsStage {
    const NAME: &'static str = "ground maps";
    const VERSION: u32 = 1;
    type Output = GroundMaps<File>;

    fn run(&self, context: &Context<'_>) -> Result<GroundMaps<File>, StageError> {
        let maps = maps(&self.params, &*context.get(&self.landform)?, self.side_px);
        let (color, weights) = rayon::join(
            || context.file("png", png::encode(&maps.color)),
            || context.file("png", png::encode_linear(&maps.weights)),
        );
        Ok(GroundMaps { color, weights })
    }
}

/// Nothing → the tiling textures that every scene shares.
#[derive(Serialize)]
pub struct GroundTexturesStage;

/// A tiling texture as files.
#[derive(Serialize, Deserialize)]
pub struct GroundTextureFiles {
    pub detail: GroundDetail<File>,
    /// The detail as a base colour, see [`tile_srgb`].
    pub tile: File,
}

impl Stage for GroundTexturesStage {
    const NAME: &'static str = "ground textures";
    const VERSION: u32 = 2;
    type Output = Vec<GroundTextureFiles>;

    fn run(&self, context: &Context<'_>) -> Result<Vec<GroundTextureFiles>, StageError> {
        let files = |(index, texture): (usize, GroundDetail<_>)| GroundTextureFiles {
            tile: context.file("png", png::encode(&tile_srgb(index, &texture.detail))),
            detail: GroundDetail {
                detail: context.file("png", png::encode(&texture.detail)),
                normal: context.file("png", png::encode_linear(&texture.normal)),
                name: texture.name,
                tile_m: texture.tile_m,
            },
        };
        Ok(textures().into_par_iter().enumerate().map(files).collect())
    }
}

/// Landform, near mesh, start → the ground around the start in finer triangles, as glTF.
#[derive(Serialize)]
pub struct ForegroundStage {
    pub params: GroundParams,
    /// Pixels a side of the ground map, whose look it continues.
    pub map_px: u32,
    pub landform: Input<Landform>,
    pub near: Input<Stored<Mesh>>,
    pub start: Input<StartView>,
}

impl Stage for ForegroundStage {
    const NAME: &'static str = "foreground";
    const VERSION: u32 = 2;
    type Output = File;

    fn run(&self, context: &Context<'_>) -> Result<File, StageError> {
        let (landform, start) = (context.get(&self.landform)?, context.get(&self.start)?);
        let near = context.load(&*context.get(&self.near)?)?;
        let triangles = &near.parts[0].triangles;
        let made = foreground(&self.params, &landform, self.map_px, &start, &near.positions, triangles);
        Ok(context.file("glb", foreground_glb(&made, &TEXTURES, BLADE_WHITE)?))
    }
}
