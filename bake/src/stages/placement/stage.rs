//! Placement as a stage: results of earlier stages → instances, as values and as a file.

use genescape_schema::scene::write_instances;
use serde::{Deserialize, Serialize};

use super::{PlacementParams, TreeFootprint, clear_around, place, place_far};
use crate::graph::{Context, File, Input, Stage, StageError, Stored};
use crate::model::{Landform, Mesh, Placement};
use crate::stages::ground::snow_map;

/// Placement genes, landform, trees → where trees stand: none where a person may first stand.
#[derive(Serialize)]
pub struct PlacementStage {
    pub params: PlacementParams,
    pub landform: Input<Landform>,
    pub footprints: Vec<Input<TreeFootprint>>,
}

#[derive(Serialize, Deserialize)]
pub struct PlacementFiles {
    pub placement: Placement,
    /// The same as the binary data of `GSC_instances`.
    pub instances: File,
}

impl Stage for PlacementStage {
    const NAME: &'static str = "placement";
    const VERSION: u32 = 10;
    type Output = PlacementFiles;

    fn run(&self, context: &Context<'_>) -> Result<PlacementFiles, StageError> {
        let footprints = context.get_all(&self.footprints)?;
        let landform = context.get(&self.landform)?;
        let snow = snow_map(self.params.terrain_seed, &landform);
        let mut placement = place(&self.params, &landform, snow.as_ref(), &footprints);
        clear_around(&landform, &mut placement.instances);
        let file = context.file("bin", write_instances(&placement.instances));
        Ok(PlacementFiles { placement, instances: file })
    }
}

/// Placement genes, landform, its ring, trees → the binary data of `GSC_instances` of those beyond the field.
#[derive(Serialize)]
pub struct FarTreesStage {
    pub params: PlacementParams,
    pub landform: Input<Landform>,
    pub ring: Input<Stored<Mesh>>,
    pub footprints: Vec<Input<TreeFootprint>>,
    /// How many stand on a square metre of the field where they grow best.
    pub per_m2: Input<f32>,
}

impl Stage for FarTreesStage {
    const NAME: &'static str = "far trees";
    const VERSION: u32 = 2;
    type Output = File;

    fn run(&self, context: &Context<'_>) -> Result<File, StageError> {
        let footprints = context.get_all(&self.footprints)?;
        let (landform, ring) = (context.get(&self.landform)?, context.load(&*context.get(&self.ring)?)?);
        let per_m2 = *context.get(&self.per_m2)?;
        let trees = place_far(&self.params, &landform, &ring, &footprints, per_m2);
        Ok(context.file("bin", write_instances(&trees)))
    }
}
