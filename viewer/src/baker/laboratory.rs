//! What the laboratory has baked: test scenes, and scenes whose preprocessing is measured.

use std::ops::Range;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow};
use genescape_bake::audition;
use genescape_bake::bench::preprocessing;
use genescape_bake::events::Untold;
use genescape_bake::plan::Resolution;
use genescape_bake::session::{Publish, Session};
use genescape_schema::{Category, INDIVIDUALS, LoadedPreset, Population, TreePreset};
use genescape_world::{MAX_TEXT_BYTES, STARTER_RON, World, regular_file};

pub use genescape_bake::bench::preprocessing::{OF_TERRAIN, Sample};

/// Bakes populations, given by the names of their files and their text, into the world `root`, and tells where their scenes
/// are, in order. What is there already is left as it is, and what was baked is not baked again.
///
/// # Errors
/// Faults of a population, or a folder that cannot be written to.
pub fn bake(root: &Path, populations: &[(&str, &str)]) -> Result<Vec<PathBuf>> {
    let load = |session: &Session| {
        let load =
            |(name, text): &(&str, &str)| Ok(Population::load(session.space(), name, text)?.population);
        populations.iter().map(load).collect()
    };
    bake_these(root, load)
}

/// The same of landscapes as they come: four of kinds for each seed. The first are called generation `first`.
///
/// # Errors
/// A folder that cannot be written to.
pub fn bake_random(root: &Path, seeds: Range<u64>, first: u32) -> Result<Vec<PathBuf>> {
    let draw = |session: &Session| {
        let (space, kinds) = (session.space(), session.kinds(&Untold));
        let draw = |(seed, generation)| audition::drawn(space, &kinds, &[], seed, generation, 0).population;
        Ok(seeds.zip(first..).map(draw).collect())
    };
    bake_these(root, draw)
}

fn bake_these(
    root: &Path,
    populations: impl FnOnce(&Session) -> Result<Vec<Population>>,
) -> Result<Vec<PathBuf>> {
    let world = World::open_or_create(root)?;
    let session = Session::new(world, super::pool(None)?, Resolution::default())?;
    let mut scenes = Vec::new();
    for population in populations(&session)? {
        let path = session.world().population_path(population.generation);
        if !path.exists() {
            session.world().create_population(session.space(), &population)?;
        }
        scenes.extend(session.bake_file(&path, Publish::Aside, &Untold, &|| false)?.scenes);
    }
    Ok(scenes)
}

/// Bakes what population files, or presets of trees on the starters' land, describe into the world `root`, which may hold
/// others from before, and tells where the scenes are, in order; of a preset there is one.
///
/// # Errors
/// Files that cannot be read or are neither, or a folder that cannot be written to.
pub fn bake_genomes(root: &Path, files: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let world = World::open_or_create(root)?;
    let session = Session::new(world, super::pool(None)?, Resolution::default())?;
    let space = session.space();
    let mut scenes = Vec::new();
    for file in files {
        let bytes = regular_file::read(file, MAX_TEXT_BYTES)
            .with_context(|| format!("cannot read {}", file.display()))?;
        let text = String::from_utf8(bytes).with_context(|| format!("{} is no text", file.display()))?;
        let name = file.display().to_string();
        let (mut population, count) = match TreePreset::load(space, &name, &text) {
            Ok(LoadedPreset { preset, .. }) => {
                let mut starters = Population::load(space, "starters", STARTER_RON)?.population;
                let first = &mut starters.individuals[0];
                *first.genome.chromosome_mut(Category::Tree) = preset.tree;
                first.name = preset.name;
                (starters, 1)
            }
            Err(_) => (Population::load(space, &name, &text)?.population, INDIVIDUALS),
        };
        population.generation = session.world().next_generation()?;
        let path = session.world().create_population(space, &population)?;
        let baked = session.bake_file(&path, Publish::Aside, &Untold, &|| false)?;
        scenes.extend(baked.scenes.into_iter().take(count));
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
