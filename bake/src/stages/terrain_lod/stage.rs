//! The terrain as a stage: landform → mesh, levels of detail and heights, as files.

use rayon::join;
use serde::{Deserialize, Serialize};

use super::{default_error_m, lod, mesh};
use crate::gltf::{png, terrain_glb};
use crate::graph::{Context, File, Input, Stage, StageError, Stored};
use crate::model::{Heightfield, Landform, Mesh};
use crate::stages::ground::{self, GroundParams, Season};

/// Landform → mesh for any viewer, data for the levels of detail, 16-bit heights.
#[derive(Serialize)]
pub struct TerrainStage {
    /// Genes of what covers the land beyond the field.
    pub params: GroundParams,
    pub season: Season,
    pub landform: Input<Landform>,
}

#[derive(Serialize, Deserialize)]
pub struct TerrainFiles {
    /// The adaptive mesh of the field, for [`ground::ForegroundStage`].
    pub near: Stored<Mesh>,
    /// The ring of land around it, places and triangles alone, for [`super::super::placement::FarTreesStage`].
    pub ring: Stored<Mesh>,
    /// The land as triangles, glTF.
    pub mesh: File,
    /// `TerrainLod` as bytes.
    pub lod: File,
    /// 16-bit grey PNG: 0 is the lowest sample, 65535 the highest.
    pub heights: File,
}

impl Stage for TerrainStage {
    const NAME: &'static str = "terrain";
    const VERSION: u32 = 20;
    type Output = TerrainFiles;

    fn run(&self, context: &Context<'_>) -> Result<TerrainFiles, StageError> {
        let landform = context.get(&self.landform)?;
        let field = &landform.field;
        let far_ground = ground::far_ground(&self.params, self.season, &landform);
        let triangles = || -> Result<_, StageError> {
            let mesh = mesh(&landform, default_error_m(field), ground::BLOCK_M, &far_ground);
            let glb = terrain_glb(&mesh)?;
            let Mesh { positions, parts, .. } = mesh.apron;
            let ring = Mesh { positions, parts, ..Mesh::default() };
            Ok((context.store(mesh.near), context.store(ring), context.file("glb", glb)))
        };
        let ((triangles, lod), heights) = join(
            || join(triangles, || context.file("bin", lod(field).to_bytes())),
            || context.file("png", heights_png(field)),
        );
        let (near, ring, mesh) = triangles?;
        Ok(TerrainFiles { near, ring, mesh, lod, heights })
    }
}

fn heights_png(field: &Heightfield) -> Vec<u8> {
    let [low, high] = field.range_m();
    let scale = if high > low { 65535.0 / (high - low) } else { 0.0 };
    let heights: Vec<u16> = field.heights_m.iter().map(|h| ((h - low) * scale + 0.5) as u16).collect();
    png::encode_gray16(field.side, field.side, &heights)
}
