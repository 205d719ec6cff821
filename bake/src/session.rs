//! Bakes of one world, for the command line, a watch, or the viewer's thread. Population file → scene files in place,
//! `current.ron`, and a note for `bake explain` of what became of each stage.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, Result, anyhow};
use genescape_cache::{BlobRef, Cache, Digest, How};
use genescape_schema::{Population, Space};
use genescape_world::{PopulationFile, World, atomic_write, names};

use crate::breed;
use crate::events::{Event, Listener};
use crate::graph::Done;
use crate::plan::{Plan, Resolution};
use crate::run::{RunError, Runner};

/// All that bakes of one world share.
pub struct Session {
    world: World,
    space: Space,
    /// Genes that the world's `space.ron` lacks.
    notices: Vec<String>,
    cache: Cache,
    pool: rayon::ThreadPool,
    resolution: Resolution,
}

/// What becomes of the scenes of a bake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Publish {
    /// `current.ron` says that they are the ones to look at.
    AsCurrent,
    /// `current.ron` stays as it is.
    Aside,
}

/// How a bake went.
#[derive(Debug)]
pub struct Baked {
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
    /// A wrong `space.ron`, or a folder that cannot be written to.
    pub fn new(world: World, pool: rayon::ThreadPool, resolution: Resolution) -> Result<Self> {
        let (space, notices) = world.space()?;
        let cache = Cache::open(world.baked())?;
        Ok(Self { world, space, notices, cache, pool, resolution })
    }

    pub fn world(&self) -> &World {
        &self.world
    }

    pub fn space(&self) -> &Space {
        &self.space
    }

    /// Reads `space.ron` again.
    ///
    /// # Errors
    /// A file that cannot be read or is wrong; the space stays as it was.
    pub fn reload_space(&mut self) -> Result<()> {
        (self.space, self.notices) = self.world.space()?;
        Ok(())
    }

    /// Bakes one population file. `cancelled` is asked before each stage; what was finished by then is kept.
    ///
    /// # Errors
    /// Faults of the file; [`RunError`], with [`RunError::Cancelled`] for a bake that was told to stop.
    pub fn bake_file(
        &self,
        path: &Path,
        publish: Publish,
        listener: &dyn Listener,
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<Baked> {
        let start = Instant::now();
        let file = World::read_population(&self.space, path)?;
        for message in self.notices.iter().chain(&file.notices).cloned() {
            listener.tell(&Event::Notice { message });
        }
        let population = &file.population;
        let plan = Plan::new(&self.space, population, self.resolution)?;
        let generation = population.generation;
        let needs = |scene: usize| plan.nodes.iter().filter(|node| node.scenes.contains(&scene)).count();
        let of_scenes = (0..plan.scenes.len()).map(needs).collect();
        listener.tell(&Event::Planned { generation, stages: plan.nodes.len(), of_scenes });
        let result = self.run(&plan, population, listener, cancelled);
        // The bar must not stand between the person and the message.
        listener.end();
        let done = result?;
        if publish == Publish::AsCurrent {
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
    /// Faults of the file, [`breed::NoVotes`], a file that cannot be written.
    pub fn breed_file(&self, path: &Path) -> Result<PathBuf> {
        let parents = World::read_population(&self.space, path)?.population;
        let children = breed::breed(&self.space, &parents, self.world.next_generation()?)?;
        Ok(self.world.create_population(&self.space, &children)?)
    }

    fn run(
        &self,
        plan: &Plan,
        population: &Population,
        listener: &dyn Listener,
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<Vec<Arc<Done>>, RunError> {
        let scene_ready = |scene: usize, blob: &BlobRef| -> Result<()> {
            let path = self.world.scene_path(population.generation, scene);
            if !fs::read(&path).is_ok_and(|there| Digest::of(&there) == blob.digest) {
                let json = self.cache.get_blob(blob)?;
                let json = json.ok_or_else(|| anyhow!("the scene vanished from the cache; bake again"))?;
                let written = atomic_write::replace_unsynced(&path, &*json);
                written.with_context(|| format!("cannot write {}", path.display()))?;
            }
            let (name, path) = (population.individuals[scene].name.clone(), path.display().to_string());
            listener.tell(&Event::SceneReady { scene, name, path });
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
            let mut history = self.cache.history(&names::scene_id(generation, scene))?;
            if let Some(parent) = parent {
                history.inherit(&self.cache.history(&names::scene_id(parent, scene))?);
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
