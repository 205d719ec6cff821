//! Bakes of one world, for the command line, a watch, or the viewer's thread. Population file → scene files in place,
//! `current.ron`, and a note for `bake explain` of what became of each stage.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use std::time::Instant;

use anyhow::Result;
use genescape_cache::{BlobRef, Cache, Digest, How};
use genescape_schema::{Kinds, Population, Report, Space, Strategy};
use genescape_world::{PopulationFile, World, WorldKinds, names};

use crate::audition::{self, Auditioned};
use crate::breed::Breeder;
use crate::events::{Event, Listener};
use crate::graph::Done;
use crate::pedigree::Pedigree;
use crate::plan::{Plan, Resolution};
use crate::run::{self, RunError, Runner};

/// All that bakes of one world share.
pub struct Session {
    world: World,
    space: Space,
    /// Kinds that ship, as read with this space.
    shipped: OnceLock<(Kinds, Vec<Report>)>,
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
    pub publish: Publish,
    /// What it was made by.
    pub actions: BTreeSet<Digest>,
}

impl Session {
    /// Bakes `world` into its own folder. `pool` computes; the results do not depend on how many threads it has.
    ///
    /// # Errors
    /// A wrong `space.ron`, or a folder that cannot be written to.
    pub fn new(world: World, pool: rayon::ThreadPool, resolution: Resolution) -> Result<Self> {
        let (space, notices) = world.space()?;
        let cache = Cache::open(world.baked())?;
        Ok(Self { world, space, shipped: OnceLock::new(), notices, cache, pool, resolution })
    }

    pub fn world(&self) -> &World {
        &self.world
    }

    pub fn space(&self) -> &Space {
        &self.space
    }

    pub fn resolution(&self) -> Resolution {
        self.resolution
    }

    /// Reads `space.ron` again.
    ///
    /// # Errors
    /// A file that cannot be read or is wrong; the space stays as it was.
    pub fn reload_space(&mut self) -> Result<()> {
        (self.space, self.notices) = self.world.space()?;
        self.shipped = OnceLock::new();
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
        // Until current.ron says that it is in use, too.
        let _nothing_is_evicted = self.cache.lease()?;
        let result = self.run(&plan, population, listener, cancelled);
        // The bar must not stand between the person and the message.
        listener.end();
        let done = result?;
        if publish == Publish::AsCurrent {
            self.cache.put_file(in_baked(names::CURRENT), World::current_after(&file).to_ron().as_bytes())?;
        }
        self.remember(&plan, &done, population)?;
        run::tell_notices(&self.cache, listener);

        let built = done.iter().filter(|d| d.how == How::Built).count();
        let (reused, ms) = (done.len() - built, start.elapsed().as_secs_f64() * 1e3);
        listener.tell(&Event::Done { built, reused, ms });
        let scenes = (0..plan.scenes.len()).map(|scene| self.world.scene_path(generation, scene)).collect();
        let actions = done.iter().map(|done| done.key.digest()).collect();
        Ok(Baked { file, scenes, built, reused, ms, publish, actions })
    }

    /// The kinds that landscapes are drawn and bred from. What is wrong with a file of a kind is told, and it is left out.
    pub fn kinds(&self, listener: &dyn Listener) -> Kinds {
        // Read for each vote, they would be a quarter of the wait for children that were guessed.
        let shipped = self.shipped.get_or_init(|| Kinds::shipped(&self.space)).clone();
        let WorldKinds { kinds, faults } = self.world.kinds_beside(shipped, &self.space);
        for fault in faults {
            listener.tell(&Event::Notice { message: format!("a kind is left out: {fault}") });
        }
        kinds
    }

    /// A population with all that its next children depend on.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn pedigree(&self, parents: Population, listener: &dyn Listener) -> Result<Pedigree> {
        let next = self.world.next_generation()?;
        let past = votes_before(&self.world, &self.space, Some(parents.generation), next, listener);
        Ok(Pedigree { space: self.space.clone(), kinds: self.kinds(listener), past, parents, next })
    }

    /// Breeds from the votes in a population file, and writes the child as a new file with the next free number.
    /// `known` may have bred it already.
    ///
    /// # Errors
    /// Faults of the file, [`crate::breed::NoVotes`], a number that somebody else has taken meanwhile, a file that cannot be
    /// written.
    pub fn breed_file(
        &self,
        path: &Path,
        listener: &dyn Listener,
        known: impl FnOnce(&Pedigree) -> Option<Auditioned>,
    ) -> Result<PathBuf> {
        let parents = World::read_population(&self.space, path)?.population;
        let votes = parents.votes;
        let pedigree = self.pedigree(parents, listener)?;
        let children = known(&pedigree).map_or_else(|| pedigree.children(votes), Ok)?;
        let Auditioned { population, redrawn } = children;
        audition::tell(listener, &redrawn);
        Ok(self.world.create_population(&self.space, &population)?)
    }

    fn run(
        &self,
        plan: &Plan,
        population: &Population,
        listener: &dyn Listener,
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<Vec<Arc<Done>>, RunError> {
        let generation = population.generation;
        let scene_ready = |scene: usize, blob: &BlobRef| -> Result<bool> {
            let is_there = self.cache.put_copy(in_baked(&names::scene(generation, scene)), blob)?;
            if is_there {
                let path = self.world.scene_path(generation, scene).display().to_string();
                let name = population.individuals[scene].name.clone();
                listener.tell(&Event::SceneReady { scene, name, path });
            }
            Ok(is_there)
        };
        let (cache, pool) = (&self.cache, &self.pool);
        Runner { cache, pool, listener, cancelled, finished: &|_| (), scene_ready: &scene_ready }.run(plan)
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

/// Breeds from the votes on a population, and writes the child as a new file with the next free number. If there are
/// children of these votes already, it is another: its seed is the parents' plus their number. Who breeds at the same time
/// gets a number and a child of his own.
///
/// # Errors
/// [`crate::breed::NoVotes`], a folder that cannot be read or written to.
pub fn breed_another(
    world: &World,
    space: &Space,
    kinds: &Kinds,
    strategy: Strategy,
    parents: &Population,
    listener: &dyn Listener,
) -> Result<PathBuf> {
    world.create_next_population(space, |generation| {
        // All files with lower numbers are there by now, so that every number has a seed of its own.
        let is_sibling = |other: &u32| {
            let parent = world.parent_of(*other);
            parent.is_some_and(|parent| {
                parent.generation == parents.generation && Some(parent.votes) == parents.votes
            })
        };
        let siblings = (0..generation).filter(is_sibling).count();
        let seed = parents.seed.wrapping_add(siblings as u64);
        let parents = Population { seed, ..parents.clone() };
        let past = votes_before(world, space, Some(parents.generation), generation, listener);
        let breeder = Breeder::new(space, kinds, strategy, &past, &parents)?;
        let Auditioned { population, redrawn } = audition::next_generation(&breeder, generation);
        audition::tell(listener, &redrawn);
        Ok(population)
    })
}

/// The populations with lower numbers than `next` that were voted on, but for the parents themselves, if they are `parents`.
/// What cannot be read is told, and breeding does without.
pub fn votes_before(
    world: &World,
    space: &Space,
    parents: Option<u32>,
    next: u32,
    listener: &dyn Listener,
) -> Vec<Population> {
    let read = |generation: u32| match world.population(space, generation) {
        Ok(file) => file.population.votes.is_some().then_some(file.population),
        Err(error) => {
            let message = format!("its votes are not used: {error:#}");
            listener.tell(&Event::Notice { message });
            None
        }
    };
    let others = world.generations().unwrap_or_default().into_iter();
    others.filter(|other| *other < next && Some(*other) != parents).filter_map(read).collect()
}

/// A name in the world as one in the cache's folder.
fn in_baked(name: &str) -> &str {
    name.strip_prefix(names::BAKED).map_or(name, |name| name.trim_start_matches('/'))
}
