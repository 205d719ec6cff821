//! Landform and templates → where the trees stand: instances with affine transforms, metres.
//!
//! 1. `site` says how well trees grow at a point, 0 to 1: slope, altitude, water, river beds, climate, groves and
//!    clearings.
//! 2. `scatter` draws points by that weight and keeps those that are far enough from the others: Poisson-disc
//!    sampling by dart throwing (Cook, "Stochastic Sampling in Computer Graphics", 1986) with a radius a tree.
//! 3. `stand` gives each its transform: size, stretch, turn, lean, and a foot that is in the ground all around.
//!
//! 4. `clearing` takes those away that stand where a person may first stand.
//! 5. `far` lets the forest go on beyond the field.
//!
//! A scene holds at most [`MAX_TREES`]. Where n trees would grow by density and area, n·M/(n+M) are planted: nearly
//! all of a few, half of 4000, never more than M, and more of them for a higher density.

mod clearing;
mod far;
mod scatter;
mod site;
mod stage;
mod stand;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use crate::model::{Landform, Placement, SnowMap, TreeFootprint};

pub use clearing::clear_around;
pub use far::{MAX_FAR_TREES, place_far};
pub use stage::{FarTreesStage, PlacementFiles, PlacementStage};

/// The number of trees that a scene approaches but never exceeds.
pub const MAX_TREES: u32 = 4000;

/// Metres between any trunk and the edge of the field.
pub const EDGE_MARGIN_M: f32 = 4.0;

/// The genes that this stage reads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlacementParams {
    /// Which forest of its kind.
    pub tree_seed: u32,
    /// Sizes lie within 1 ± this before the forest's edge and the tree line make them smaller.
    pub height_variation: f32,
    /// Trees per hectare where trees grow.
    pub density_per_ha: f32,
    /// 0 evenly spread, 1 in groves with clearings.
    pub clustering: f32,
    /// Steepest slope that trees grow on.
    pub steepest_slope_deg: f32,
    /// Tree line as part of the relief (above the water, if there is a lake).
    pub altitude_limit: f32,
    /// Mean temperature of a year that they need.
    pub hardiness_c: f32,
    /// Chooses where snow lies in patches.
    pub terrain_seed: u32,
    /// Mean of the year where the land lies lowest.
    pub temperature_c: f32,
    /// A year's rain.
    pub rain_mm: f32,
}

/// Plants a scene: up to [`MAX_TREES`] instances of `trees`, in a fixed order. None if there are no templates or
/// no tree can grow on this land. `snow` says where it may lie.
pub fn place(
    params: &PlacementParams,
    land: &Landform,
    snow: Option<&SnowMap>,
    trees: &[TreeFootprint],
) -> Placement {
    if trees.is_empty() {
        return Placement::default();
    }
    scatter::scatter(params, &site::Site::new(params, land, snow), trees)
}
