//! The landform as a stage: genes → heights, flow and deposits.

use serde::Serialize;

use super::{LandParams, landform};
use crate::graph::{Context, Stage, StageError};
use crate::model::Landform;

/// Terrain genes → [`Landform`].
#[derive(Serialize)]
pub struct LandStage {
    pub params: LandParams,
    /// Samples a side.
    pub side: u32,
}

impl Stage for LandStage {
    const NAME: &'static str = "landform";
    const VERSION: u32 = 4;
    type Output = Landform;

    fn run(&self, _: &Context<'_>) -> Result<Landform, StageError> {
        Ok(landform(&self.params, self.side))
    }
}
