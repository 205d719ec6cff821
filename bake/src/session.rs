//! Bakes of one world, for whoever asks: the command line, a watch, the viewer's thread. Population file → scene
//! files in place, `current.ron`, and a note for `bake explain` of what became of each stage.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Result, anyhow};
use genescape_cache::{BlobRef, Cache, How};
use genescape_schema::{Population, names};

use crate::breed;
use crate::events::{Event, Listener};
use crate::graph::Done;
use crate::plan::{Plan, Resolution};
use crate::run::{RunError, Runner};
use crate::world::{PopulationFile, World};

/// All that bakes of one world share.
pub struct Session {
    world: World,
    cache: Cache,
    pool: rayon::ThreadPool,
    resolution: Resolution,
}

/// How a bake went.
#[derive(Debug)]
pub struct Baked {
    /// What was baked.
    pub file: PopulationFile,
    /// The four scene files.
    pub scenes: Vec<PathBuf>,
    /// Stages computed.
    pub built: usize,
    /// Stages whose results came from the cache.
    pub reused: usize,
    /// Milliseconds of wall-clock time.
    pub ms: f64,
}

impl Session {
    /// Bakes `world` into its own folder. `pool` computes; the results do not depend on how many threads it has.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn new(world: World, pool: rayon::ThreadPool, resolution: Resolution) -> Result<Self> {
        let cache = Cache::open(world.root().join(names::BAKED))?;
        Ok(Self { world, cache, pool, resolution })
    }

    /// The world.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The world, for its space to be read again.
    pub fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }

    /// Bakes one population file and says in `current.ron` that its scenes are the ones to look at. `cancelled` is
    /// asked before each stage; what was finished by then is kept.
    ///
    /// # Errors
    /// Faults of the file; [`RunError`], with [`RunError::Cancelled`] for a bake that was told to stop.
    pub fn bake_file(
        &self,
        path: &Path,
        listener: &dyn Listener,
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<Baked> {
        self.bake(path, true, listener, cancelled)
    }

    /// The same, but `current.ron` stays as it is.
    ///
    /// # Errors
    /// As [`Session::bake_file`].
    pub fn bake_aside(
        &self,
        path: &Path,
        listener: &dyn Listener,
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<Baked> {
        self.bake(path, false, listener, cancelled)
    }

    fn bake(
        &self,
        path: &Path,
        shows: bool,
        listener: &dyn Listener,
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<Baked> {
        let start = Instant::now();
        let file = self.world.load_population(path)?;
        for snap in &file.loaded.snaps {
            listener.tell(&Event::Notice { message: snap.to_string() });
        }
        let population = &file.loaded.population;
        let plan = Plan::new(self.world.space(), population, self.resolution)?;
        let generation = population.generation;
        listener.tell(&Event::Planned { generation, stages: plan.nodes.len() });
        let result = self.run(&plan, population, listener, cancelled);
        // The bar must not stand between the person and the message.
        listener.end();
        let done = result?;
        if shows {
            self.world.publish_current(&file)?;
        }
        self.remember(&plan, &done, population)?;

        let built = done.iter().filter(|d| d.how == How::Built).count();
        let (reused, ms) = (done.len() - built, start.elapsed().as_secs_f64() * 1e3);
        listener.tell(&Event::Done { built, reused, ms });
        let scenes = (0..plan.scenes.len()).map(|scene| self.world.scene_path(generation, scene)).collect();
        Ok(Baked { file, scenes, built, reused, ms })
    }

    /// Breeds from the votes in a population file, and writes the child as a new file with the next free number.
    ///
    /// # Errors
    /// Faults of the file, [`breed::BreedError`], a file that cannot be written.
    pub fn breed_file(&self, path: &Path) -> Result<PathBuf> {
        let parents = self.world.load_population(path)?;
        let next = self.world.next_generation()?;
        let children = breed::breed(self.world.space(), &parents.loaded.population, next)?;
        self.world.save_population(&children)
    }

    fn run(
        &self,
        plan: &Plan,
        population: &Population,
        listener: &dyn Listener,
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<Vec<Arc<Done>>, RunError> {
        let scene_ready = |scene: usize, blob: &BlobRef| -> Result<()> {
            let json = || -> Result<Vec<u8>> {
                let bytes = self.cache.get_blob(blob)?;
                Ok(bytes.ok_or_else(|| anyhow!("the scene vanished from the cache; bake again"))?.to_vec())
            };
            self.world.publish_scene(population.generation, scene, blob.digest, &json)?;
            listener.tell(&Event::SceneReady {
                scene,
                name: population.individuals[scene].name.clone(),
                path: self.world.scene_path(population.generation, scene).display().to_string(),
            });
            Ok(())
        };
        let (cache, pool) = (&self.cache, &self.pool);
        Runner { cache, pool, listener, cancelled, scene_ready: &scene_ready }.run(plan)
    }

    /// Notes for `explain` what became of each stage of each scene.
    fn remember(&self, plan: &Plan, done: &[Arc<Done>], population: &Population) -> Result<()> {
        let generation = population.generation;
        let parent = population.parent.map_or(generation.checked_sub(1), |parent| Some(parent.generation));
        for scene in 0..plan.scenes.len() {
            let mut history = self.cache.history(&scope(generation, scene))?;
            if let Some(parent) = parent {
                history.inherit(&self.cache.history(&scope(parent, scene))?);
            }
            let nodes = || plan.nodes.iter().zip(done).filter(|(node, _)| node.scenes.contains(&scene));
            for (node, done) in nodes() {
                history.note(&node.label, &done.key, done.how);
            }
            history.retain(|item| nodes().any(|(node, _)| node.label == item));
            self.cache.save_history(&history)?;
        }
        Ok(())
    }
}

/// What the cache's history calls a scene.
pub fn scope(generation: u32, scene: usize) -> String {
    format!("g{generation:04}-scene-{scene}")
}
