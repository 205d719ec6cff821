//! The light map as a stage: results of earlier stages → a PNG.

use serde::Serialize;

use super::light_map;
use crate::gltf::png;
use crate::graph::{Context, File, Input, Stage, StageError, Stored};
use crate::model::{Caster, Instance, Landform, SkyLight};

/// Sun, landform, placement, trees → light on the ground, as PNG.
#[derive(Serialize)]
pub struct LightMapStage {
    /// Pixels a side.
    pub side_px: u32,
    pub landform: Input<Landform>,
    /// For each template what casts its shadow.
    pub casters: Vec<Input<Stored<Caster>>>,
    pub trees: Input<Vec<Instance>>,
    pub light: Input<SkyLight>,
}

impl Stage for LightMapStage {
    const NAME: &'static str = "light map";
    const VERSION: u32 = 4;
    type Output = File;

    fn run(&self, context: &Context<'_>) -> Result<File, StageError> {
        let (landform, light) = (context.get(&self.landform)?, context.get(&self.light)?);
        let casters = self.casters.iter().map(|caster| context.load(&*context.get(caster)?));
        let casters = casters.collect::<Result<Vec<_>, _>>()?;
        let trees = context.get(&self.trees)?;
        let map = light_map(&light, &landform, &trees, &casters, self.side_px);
        Ok(context.file("png", png::encode_linear(&map.image)))
    }
}
