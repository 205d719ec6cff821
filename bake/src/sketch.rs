//! A genome → its landscape as far as it has to be drawn to say what is seen from where, before it is baked: coarser land, and
//! trees that are all like the first. They stand where the landscape will have them, as far as the land is the same.

use genescape_schema::{Genome, GenomeError, Space};

use crate::model::{Instance, Landform, SkyLight, TreeFootprint};
use crate::stages::ground::snow_map;
use crate::stages::land;
use crate::stages::placement::{PlacementParams, clear_around, place};
use crate::stages::sky;
use crate::stages::start::{Appraisal, any_good_look};
use crate::stages::tree::{TreeMeasures, TreeParams, measure};

/// Such a landscape.
pub struct Sketch {
    land: Landform,
    footprint: TreeFootprint,
    trees: Vec<Instance>,
    light: SkyLight,
}

impl Sketch {
    /// That of a genome.
    ///
    /// # Errors
    /// A gene that `space` does not declare.
    pub fn of(space: &Space, genome: &Genome) -> Result<Self, GenomeError> {
        let light = sky::light(&genome.read(space)?);
        let land = land::sketch(&genome.read(space)?);
        let footprint = footprint(&genome.read(space)?);
        let placement: PlacementParams = genome.read(space)?;
        let snow = snow_map(placement.terrain_seed, &land);
        let mut trees = place(&placement, &land, snow.as_ref(), &[footprint]).instances;
        clear_around(&land, &mut trees);
        Ok(Self { land, footprint, trees, light })
    }

    /// See [`any_good_look`].
    pub fn any_good_look(&self, enough: f32) -> Appraisal {
        any_good_look(&self.land, &self.trees, &[self.footprint], &self.light, enough)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinds::testing::{drawn, kinds};
    use crate::stages::start::looks;
    use crate::stages::tree::template;

    /// Correlation (Pearson) of the scores of the same looks.
    fn agreement(pairs: &[(f32, f32)]) -> f32 {
        let mean = |of: &dyn Fn(&(f32, f32)) -> f32| pairs.iter().map(of).sum::<f32>() / pairs.len() as f32;
        let (a, b) = (mean(&|pair| pair.0), mean(&|pair| pair.1));
        let covariance = mean(&|pair| (pair.0 - a) * (pair.1 - b));
        let [of_a, of_b] =
            [mean(&|pair| (pair.0 - a) * (pair.0 - a)), mean(&|pair| (pair.1 - b) * (pair.1 - b))];
        covariance / (of_a * of_b).sqrt()
    }

    #[test]
    fn looks_are_as_good_as_in_the_landscape_itself() {
        let space = Space::builtin();
        for one in drawn(&space, &kinds(&space), 4, 0).individuals {
            let (space, genome) = (&space, &one.genome);
            let params: TreeParams = genome.read(space).expect("valid");
            let clear_trunk = TreeFootprint::clear_trunk(params.levels, params.clear_trunk);
            let footprints = [0, 1, 2, 3, 4].map(|index| {
                let template = template(&params, index);
                TreeFootprint {
                    height_m: template.bounds.max.y,
                    trunk_radius_m: template.trunk_radius_m,
                    crown_radius_m: template.crown_radius_m,
                    root_depth_m: -template.bounds.min.y,
                    clear_trunk,
                }
            });
            let land = land::landform(&genome.read(space).expect("valid"), 513);
            let placement: PlacementParams = genome.read(space).expect("valid");
            let snow = snow_map(placement.terrain_seed, &land);
            let mut trees = place(&placement, &land, snow.as_ref(), &footprints).instances;
            clear_around(&land, &mut trees);
            let sketch = Sketch::of(space, genome).expect("valid");
            let itself = looks(&land, &trees, &footprints, &sketch.light, 4);
            let sketched = looks(&sketch.land, &sketch.trees, &[sketch.footprint], &sketch.light, 4);
            let scores: Vec<_> =
                sketched.iter().zip(&itself).map(|(one, other)| (one.score(), other.score())).collect();
            let agreement = agreement(&scores);
            assert!(agreement > 0.6, "{}: {agreement}", one.name);
        }
    }
}
