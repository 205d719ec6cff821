//! Plan → results, through the cache and in parallel.
//!
//! Executor threads look actions up, take their locks and store their results; the computing itself goes to a rayon
//! pool that never takes a lock. Were both done by the same threads, a stage waiting for its inner loop could steal
//! another action whose lock another process holds, while that process waits for ours.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use genescape_cache::{BlobRef, Cache, How};

use crate::events::{Event, Listener};
use crate::graph::{Context, Done, File, Finished, NodeId, StageError};
use crate::plan::Plan;

/// What a run needs besides the plan.
pub struct Runner<'a> {
    /// Where results are kept.
    pub cache: &'a Cache,
    /// The threads that compute.
    pub pool: &'a rayon::ThreadPool,
    /// Receives the events of the run.
    pub listener: &'a dyn Listener,
    /// Whether to stop; asked before each stage.
    pub cancelled: &'a (dyn Fn() -> bool + Sync),
    /// Called with each result.
    pub finished: &'a (dyn Fn(&Done) + Sync),
    /// Called for each scene, as soon as all of it is complete; `false` if the scene's blob turns out to be lost.
    pub scene_ready: &'a (dyn Fn(usize, &BlobRef) -> anyhow::Result<bool> + Sync),
}

/// Why a run ended early.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// On request.
    #[error("interrupted; what was finished is kept, and the next bake goes on from there")]
    Cancelled,
    /// A stage could not do its work.
    #[error("stage \"{label}\" failed")]
    Stage {
        /// The node's label.
        label: String,
        /// Why.
        source: StageError,
    },
    /// The results could not be looked up or stored.
    #[error(transparent)]
    Cache(#[from] genescape_cache::Error),
    /// A scene's files could not be put in place.
    #[error("{0:#}")]
    Publish(anyhow::Error),
}

impl Runner<'_> {
    /// Runs `plan`; the results in the order of its nodes.
    pub fn run(&self, plan: &Plan) -> Result<Vec<Arc<Done>>, RunError> {
        // A blob that turns out lost or damaged is gone from the cache by then: the next attempt finds its action
        // missing and builds it again. Each attempt mends one action at least, so there are no more attempts to make
        // than there are actions.
        let mut attempts = plan.nodes.len();
        loop {
            attempts -= 1;
            match self.attempt(plan).and_then(|done| self.still_there(plan, done)) {
                Err(RunError::Stage { source: StageError::InputLost, .. }) if attempts > 0 => {
                    tell_notices(self.cache, self.listener)
                }
                result => {
                    tell_notices(self.cache, self.listener);
                    return result;
                }
            }
        }
    }

    /// The results, if none was lost or damaged while others were made: a person may clear the folder at any time.
    fn still_there(&self, plan: &Plan, done: Vec<Arc<Done>>) -> Result<Vec<Arc<Done>>, RunError> {
        for (node, done) in plan.nodes.iter().zip(&done) {
            if !self.cache.is_whole(&done.record)? {
                return Err(RunError::Stage { label: node.label.clone(), source: StageError::InputLost });
            }
        }
        Ok(done)
    }

    fn attempt(&self, plan: &Plan) -> Result<Vec<Arc<Done>>, RunError> {
        let board = Board::new(plan);
        std::thread::scope(|scope| {
            // One more than compute: while one stores its results, the others keep the pool busy.
            let executor = |_| scope.spawn(|| self.executor(plan, &board));
            let executors: Vec<_> = (0..=self.pool.current_num_threads()).map(executor).collect();
            for executor in executors {
                // With its own message, where the scope would only say that there was one.
                executor.join().unwrap_or_else(|panic| resume_unwind(panic));
            }
        });
        let state = board.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        match state.error {
            Some(error) => Err(error),
            None => Ok(state.done.into_iter().map(|d| d.expect("every node ran")).collect()),
        }
    }

    fn executor(&self, plan: &Plan, board: &Board) {
        while let Some((id, inputs)) = board.take(plan) {
            let perform = || match (self.cancelled)() {
                true => Err(RunError::Cancelled),
                false => self.perform(plan, id, inputs),
            };
            // Were this executor to end by a panic, the others would wait for its node for ever.
            match catch_unwind(AssertUnwindSafe(perform)) {
                Ok(result) => board.put(plan, id, result),
                Err(panic) => {
                    board.put(plan, id, Err(RunError::Cancelled));
                    resume_unwind(panic);
                }
            }
        }
    }

    fn perform(&self, plan: &Plan, id: NodeId, inputs: Finished) -> Result<Arc<Done>, RunError> {
        let node = &plan.nodes[id];
        let start = Instant::now();
        let (stage, scenes) = (|| node.label.clone(), || node.scenes.clone());
        let started = || self.listener.tell(&Event::Started { stage: stage(), scenes: scenes() });
        let context = Context::new(self.cache, &plan.nodes, inputs);
        let done = context
            .perform(node, self.pool, started)
            .map_err(|source| RunError::Stage { label: stage(), source })?;
        (self.finished)(&done);
        let reused = done.how == How::Reused;
        let ms = if reused { 0.0 } else { start.elapsed().as_secs_f64() * 1e3 };
        self.listener.tell(&Event::Finished { stage: stage(), scenes: scenes(), reused, ms });
        let failed = |source| RunError::Stage { label: stage(), source };
        for (scene, _) in plan.scenes.iter().enumerate().filter(|&(_, &node)| node == id) {
            let json: File = done.reread(self.cache).map_err(failed)?;
            if !(self.scene_ready)(scene, json.blob()).map_err(RunError::Publish)? {
                return Err(failed(StageError::InputLost));
            }
        }
        Ok(Arc::new(done))
    }
}

/// Tells what was found wrong in the cache since the last time.
pub fn tell_notices(cache: &Cache, listener: &dyn Listener) {
    for notice in cache.take_notices() {
        listener.tell(&Event::Notice { message: notice.to_string() });
    }
}

/// The progress of a run, shared by the executors.
struct Board {
    state: Mutex<State>,
    changed: Condvar,
}

struct State {
    done: Vec<Option<Arc<Done>>>,
    /// Nodes that have not yet read a node's outputs.
    readers: Vec<usize>,
    /// Nodes whose inputs are complete; those that come first in the plan, which others wait for, are taken first.
    ready: BinaryHeap<Reverse<NodeId>>,
    running: usize,
    error: Option<RunError>,
}

impl State {
    fn release(&self, id: NodeId) {
        if let Some(done) = &self.done[id] {
            done.release();
        }
    }
}

impl Board {
    fn new(plan: &Plan) -> Self {
        let mut readers = vec![0; plan.nodes.len()];
        for (_, input) in plan.nodes.iter().flat_map(|node| &node.inputs) {
            readers[input.node] += 1;
        }
        let ready =
            (0..plan.nodes.len()).filter(|&id| plan.nodes[id].inputs.is_empty()).map(Reverse).collect();
        let state = State { done: vec![None; plan.nodes.len()], readers, ready, running: 0, error: None };
        Self { state: Mutex::new(state), changed: Condvar::new() }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next node to run, with its inputs' results; waits for one. `None` when nothing is left to do.
    fn take(&self, plan: &Plan) -> Option<(NodeId, Finished)> {
        let mut state = self.lock();
        loop {
            if state.error.is_some() {
                return None;
            }
            if let Some(Reverse(id)) = state.ready.pop() {
                state.running += 1;
                let mut inputs: Vec<_> = plan.nodes[id].inputs.iter().map(|(_, input)| input.node).collect();
                inputs.sort_unstable();
                inputs.dedup();
                let done = |input: NodeId| state.done[input].clone().expect("inputs come first");
                return Some((id, inputs.into_iter().map(|input| (input, done(input))).collect()));
            }
            if state.running == 0 {
                return None;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn put(&self, plan: &Plan, id: NodeId, result: Result<Arc<Done>, RunError>) {
        let mut state = self.lock();
        state.running -= 1;
        match result {
            Ok(done) => {
                state.done[id] = Some(done);
                if state.readers[id] == 0 {
                    state.release(id);
                }
                for (_, input) in &plan.nodes[id].inputs {
                    state.readers[input.node] -= 1;
                    // Memory holds only what some stage may still read.
                    if state.readers[input.node] == 0 {
                        state.release(input.node);
                    }
                }
                for (reader, node) in plan.nodes.iter().enumerate() {
                    let mut inputs = node.inputs.iter().map(|(_, input)| input.node);
                    if inputs.clone().any(|input| input == id)
                        && inputs.all(|input| state.done[input].is_some())
                    {
                        state.ready.push(Reverse(reader));
                    }
                }
            }
            Err(error) => {
                state.error.get_or_insert(error);
            }
        }
        drop(state);
        self.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering};

    use genescape_schema::{Population, Space};

    use super::*;
    use crate::plan::Resolution;

    /// Falls over the first stage that is done.
    #[derive(Default)]
    struct Clumsy(AtomicBool);

    impl Listener for Clumsy {
        fn tell(&self, event: &Event) {
            let done = matches!(event, Event::Finished { .. });
            assert!(!done || self.0.swap(true, Ordering::SeqCst), "fell over a stage");
        }
    }

    #[test]
    fn a_panic_beside_the_stages_ends_the_run_with_its_own_words() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let cache = Cache::open(folder.path()).expect("a cache");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
        let space = Space::builtin();
        let population =
            Population::load(&space, "starter.ron", genescape_world::STARTER_RON).expect("valid").population;
        let side = Resolution::of_side(65).expect("a side");
        let plan = Plan::new(&space, &population, side).expect("a plan");
        let runner = Runner {
            cache: &cache,
            pool: &pool,
            listener: &Clumsy::default(),
            cancelled: &|| false,
            finished: &|_| (),
            scene_ready: &|_, _| Ok(true),
        };
        let panic = catch_unwind(AssertUnwindSafe(|| runner.run(&plan))).expect_err("it panics");
        assert_eq!(panic.downcast_ref::<&str>(), Some(&"fell over a stage"));
    }
}
