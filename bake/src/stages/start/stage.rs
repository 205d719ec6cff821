//! The first look as a stage: results of earlier stages → a view.

use serde::{Deserialize, Serialize};

use super::{Appraisal, first_look};
use crate::graph::{Context, Input, Stage, StageError};
use crate::model::TreeFootprint;
use crate::model::{Instance, Landform, SkyLight, StartView};

/// Landform, trees, light → where the walk starts.
#[derive(Serialize)]
pub struct StartStage {
    pub landform: Input<Landform>,
    pub footprints: Vec<Input<TreeFootprint>>,
    pub trees: Input<Vec<Instance>>,
    pub light: Input<SkyLight>,
}

#[derive(Serialize, Deserialize)]
pub struct StartFiles {
    /// The best view.
    pub view: StartView,
    /// How good it is.
    pub appraisal: Appraisal,
    /// Factor by which its picture is to be made brighter: `SkyLight::exposure` without the gene's offset.
    pub exposure: f32,
}

impl Stage for StartStage {
    const NAME: &'static str = "start";
    const VERSION: u32 = 22;
    type Output = StartFiles;

    fn run(&self, context: &Context<'_>) -> Result<StartFiles, StageError> {
        let footprints = context.get_all(&self.footprints)?;
        let (landform, trees) = (context.get(&self.landform)?, context.get(&self.trees)?);
        let look = first_look(&landform, &trees, &footprints, &*context.get(&self.light)?);
        Ok(StartFiles { view: look.view, appraisal: look.appraisal, exposure: look.exposure })
    }
}
