//! Placement as a stage: results of earlier stages → instances, as values and as a file.

use genescape_schema::scene::write_instances;
use serde::{Deserialize, Serialize};

use super::{PlacementParams, TreeFootprint, clear_around, place};
use crate::graph::{Context, File, Input, Stage, StageError};
use crate::model::{Landform, Placement};
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
    const VERSION: u32 = 8;
    type Output = PlacementFiles;

    fn run(&self, context: &Context<'_>) -> Result<PlacementFiles, StageError> {
        let footprints = self.footprints.iter().map(|footprint| Ok(*context.get(footprint)?));
        let footprints = footprints.collect::<Result<Vec<_>, StageError>>()?;
        let landform = context.get(&self.landform)?;
        let snow = snow_map(self.params.terrain_seed, &landform);
        let mut instances = place(&self.params, &landform, snow.as_ref(), &footprints);
        clear_around(&landform, &mut instances);
        let file = context.file("bin", write_instances(&instances));
        Ok(PlacementFiles { placement: Placement { instances }, instances: file })
    }
}
