//! Bakes without the program: a plan, a runner and a cache, and what each stage gave.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::Result;
use genescape_bake::events::{Event, Listener};
use genescape_bake::graph::{Done, Node};
use genescape_bake::plan::{Plan, Resolution};
use genescape_bake::run::Runner;
use genescape_cache::{ActionKey, Cache, Digest, How};
use genescape_schema::{Population, Space};

/// Tells nothing.
struct Silent;

impl Listener for Silent {
    fn tell(&self, _: &Event) {}
}

/// What one node of a plan gave.
pub struct NodeOutputs {
    /// The action key, with the stage's name and version.
    pub key: ActionKey,
    /// For people: "tree 3".
    pub label: String,
    /// It came from the cache.
    pub reused: bool,
    pub outputs: Vec<Digest>,
}

/// Runs the plan of a population at the smallest size, with the cache in `baked`; the nodes in the plan's order.
pub fn run(population: &Population, baked: &Path, threads: usize) -> Result<Vec<NodeOutputs>> {
    let side = Resolution::of_side(65).map_err(anyhow::Error::msg)?;
    let plan = Plan::new(&Space::builtin(), population, side)?;
    let cache = Cache::open(baked)?;
    let scenes = AtomicUsize::new(0);
    let runner = Runner {
        cache: &cache,
        pool: &rayon::ThreadPoolBuilder::new().num_threads(threads).build()?,
        listener: &Silent,
        cancelled: &|| false,
        finished: &|_| (),
        scene_ready: &|_, _| {
            scenes.fetch_add(1, Ordering::SeqCst);
            Ok(true)
        },
    };
    let done = runner.run(&plan)?;
    assert_eq!(scenes.into_inner(), population.individuals.len());
    let outputs = |(node, done): (&Node, &Arc<Done>)| NodeOutputs {
        label: node.label.clone(),
        reused: done.how == How::Reused,
        outputs: done.record.outputs.iter().map(|(_, blob)| blob.digest).collect(),
        key: done.key.clone(),
    };
    Ok(plan.nodes.iter().zip(&done).map(outputs).collect())
}
