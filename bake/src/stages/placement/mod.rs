//! Landform and templates → where the trees stand: instances with affine transforms, metres.
//!
//! 1. `site` says how well trees grow at a point, 0 to 1: slope, altitude, water, river beds, groves and clearings.
//! 2. `scatter` draws points by that weight and keeps those that are far enough from the others: Poisson-disc
//!    sampling by dart throwing (Cook, "Stochastic Sampling in Computer Graphics", 1986) with a radius a tree.
//! 3. `stand` gives each its transform: size, stretch, turn, lean, and a foot that is in the ground all around.
//!
//! A scene holds at most [`MOST_TREES`]. Where n trees would grow by density and area, n·M/(n+M) are planted: nearly
//! all of a few, half of 4000, never more than M, and more wherever more were asked for.

mod scatter;
mod site;
mod stand;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use crate::model::{Heightfield, Landform, Placement};

/// The number of trees that a scene approaches but never exceeds.
pub const MOST_TREES: u32 = 4000;

/// Metres between any trunk and the edge of the field.
pub const EDGE_MARGIN_M: f32 = 4.0;

/// Metres around the walker's start in which no trunk stands.
pub const START_CLEARING_M: f32 = 6.0;

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
}

/// What this stage has to know of a template, in metres at scale 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TreeFootprint {
    /// From the foot to the top.
    pub height_m: f32,
    /// Of the trunk at breast height.
    pub trunk_radius_m: f32,
    /// Horizontal radius that holds nearly all of the crown.
    pub crown_radius_m: f32,
    /// How far the roots reach below the foot.
    pub root_depth_m: f32,
}

/// Plants a scene: up to [`MOST_TREES`] instances of `trees`, in a fixed order. None if there are no templates or
/// no tree can grow on this land.
pub fn place(params: &PlacementParams, land: &Landform, trees: &[TreeFootprint]) -> Placement {
    if trees.is_empty() {
        return Placement::default();
    }
    let site = site::Site::new(params, land);
    Placement { instances: scatter::scatter(params, &site, trees) }
}

/// Where the walker starts: the highest sample within 128 m of the centre, in world metres; of several, the
/// northernmost, then the westernmost. It may lie under water: that is for the viewer to know.
pub fn start_point(field: &Heightfield) -> [f32; 3] {
    const RADIUS_M: f32 = 128.0;
    let middle = (field.side - 1) as f32 / 2.0;
    let along = |i: u32| (i as f32 - middle) * field.spacing_m;
    let reach = (RADIUS_M / field.spacing_m) as u32 + 1;
    let first = (field.side / 2).saturating_sub(reach);
    let last = (field.side / 2 + reach).min(field.side - 1);
    let mut best = [0.0, f32::NEG_INFINITY, 0.0];
    for j in first..=last {
        for i in first..=last {
            let (x, y, z) = (along(i), field.at(i, j), along(j));
            if x * x + z * z <= RADIUS_M * RADIUS_M && y > best[1] {
                best = [x, y, z];
            }
        }
    }
    best
}
