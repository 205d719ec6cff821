//! A genome → its landscape as far as it has to be drawn to say what is seen from where, before it is baked: coarser land, and
//! trees that are all like the first. They stand where the landscape will have them, as far as the land is the same.

use genescape_schema::{Genome, GenomeError, Space};

use crate::model::{Instance, Landform, SkyLight, TreeFootprint};
use crate::stages::ground::snow_map;
use crate::stages::land::{self, Brush};
use crate::stages::placement::{PlacementParams, clear_around, place};
use crate::stages::start::{Appraisal, any_good_look, looks};
use crate::stages::tree::{TreeMeasures, TreeParams, measure};

/// Such a landscape.
pub struct Sketch {
    land: Landform,
    footprint: TreeFootprint,
    trees: Vec<Instance>,
    light: SkyLight,
}

impl Sketch {
    /// One in that light, which is to be the genome's.
    ///
    /// # Errors
    /// A gene that `space` does not declare.
    pub fn under(light: SkyLight, space: &Space, genome: &Genome, brush: Brush) -> Result<Self, GenomeError> {
        let land = land::sketch(&genome.read(space)?, brush);
        let footprint = footprint(&genome.read(space)?);
        let placement: PlacementParams = genome.read(space)?;
        let snow = snow_map(placement.terrain_seed, &land);
        let mut trees = place(&placement, &land, snow.as_ref(), &[footprint]);
        clear_around(&land, &mut trees);
        Ok(Self { land, footprint, trees, light })
    }

    /// See [`any_good_look`].
    pub fn any_good_look(&self, enough: f32) -> Appraisal {
        any_good_look(&self.land, &self.trees, &[self.footprint], &self.light, enough)
    }

    /// How good the looks are from one in so many of the places that there are, but for those where one stands so badly that
    /// none can score `least`.
    pub fn looks(&self, one_in: usize, least: f32) -> Vec<Appraisal> {
        looks(&self.land, &self.trees, &[self.footprint], &self.light, one_in, least)
    }
}

/// The first of a genome's trees, which the others are like.
fn footprint(params: &TreeParams) -> TreeFootprint {
    let TreeMeasures { height_m, crown_radius_m, trunk_radius_m, .. } = measure(params);
    TreeFootprint {
        height_m,
        trunk_radius_m,
        crown_radius_m,
        root_depth_m: 0.02 * height_m,
        clear_trunk: TreeFootprint::clear_trunk(params.levels, params.clear_trunk),
    }
}
