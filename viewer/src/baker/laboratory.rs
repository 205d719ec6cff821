//! What the laboratory has baked: test scenes, and scenes whose preprocessing is measured.

use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use genescape_bake::bench::preprocessing;
use genescape_bake::events::Untold;
use genescape_bake::plan::Resolution;
use genescape_bake::session::{Publish, Session};
use genescape_schema::Population;
use genescape_world::World;

pub use genescape_bake::bench::preprocessing::{OF_TERRAIN, Sample};

/// Bakes populations, given by the names of their files and their text, into the world `root`, and tells where their scenes
/// are, in order. What is there already is left as it is, and what was baked is not baked again.
///
/// # Errors
/// Faults of a population, or a folder that cannot be written to.
pub fn bake(root: &Path, populations: &[(&str, &str)]) -> Result<Vec<PathBuf>> {
    let world = World::open_or_create(root)?;
    let session = Session::new(world, super::pool(None)?, Resolution::default())?;
    let mut scenes = Vec::new();
    for (name, text) in populations {
        let population = Population::load(session.space(), name, text)?.population;
        let path = session.world().population_path(population.generation);
        if !path.exists() {
            session.world().create_population(session.space(), &population)?;
        }
        scenes.extend(session.bake_file(&path, Publish::Aside, &Untold, &|| false)?.scenes);
    }
    Ok(scenes)
}

/// Breeds that many scenes and measures what a bake takes for each. `tell` hears how many are done.
///
/// # Errors
/// A temporary folder that cannot be written to.
pub fn preprocessing(scenes: u32, tell: impl FnMut(u32)) -> Result<Vec<Sample>> {
    preprocessing::preprocessing(scenes, Resolution::default(), tell)
        .map_err(|error| anyhow!("preprocessing cannot be measured: {error:#}"))
}
