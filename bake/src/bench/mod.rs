//! `bake bench`: times the parts of a bake on this machine.

pub mod breeding;
#[cfg(feature = "cmaes")]
mod cma_es;
pub mod person;
pub mod preprocessing;
pub mod reuse;
pub mod visibility;

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use anyhow::Result;
use genescape_cache::{BlobRef, Cache, How};
use genescape_schema::{Category, Population, Space};

use crate::events::{Event, Listener};
use crate::graph::Done;
use crate::plan::{Plan, Resolution, TEMPLATES};
use crate::run::Runner;
use crate::say;

/// Bakes the starters `runs` times into folders of their own and prints what each stage took, in the manner of the
/// thesis's tables 1 and 2; then what it takes when nothing, or one category, has changed.
pub fn bench(runs: u32, pool: &rayon::ThreadPool, resolution: Resolution) -> Result<()> {
    let space = Space::builtin();
    let starter = Population::load(&space, "configs/starter.ron", genescape_world::STARTER_RON)?.population;
    say!(
        "{} cores, computing on {}; heightfield {}², {} templates a scene; {runs} runs\n",
        std::thread::available_parallelism().map_or(0, usize::from),
        pool.current_num_threads(),
        resolution.side,
        TEMPLATES,
    );
    let mut stages = Samples::default();
    let mut whole = Samples::default();
    for _ in 0..runs.max(1) {
        let folder = tempfile::tempdir()?;
        let cache = Cache::open(folder.path())?;
        let bake = |population: &Population, listener: &dyn Listener| {
            bake(&space, population, resolution, &cache, pool, listener)
        };
        let clock = Stages::default();
        let (ms, built) = bake(&starter, &clock)?;
        whole.add("four fresh scenes", ms, Some(built));
        for (stage, ms) in clock.times() {
            stages.add(&stage, ms, None);
        }
        let (ms, built) = bake(&starter, &Stages::default())?;
        whole.add("unchanged", ms, Some(built));
        for category in [Category::Tree, Category::Terrain, Category::Sky] {
            let mut changed = starter.clone();
            let other = &Population::random(&space, u64::from(runs), 0).individuals[0];
            *changed.individuals[0].genome.chromosome_mut(category) =
                other.genome.chromosome(category).clone();
            let (ms, built) = bake(&changed, &Stages::default())?;
            whole.add(&format!("one {} chromosome changed", category.name()), ms, Some(built));
        }
    }
    whole.print("The whole", "stages built");
    stages.print("Each stage, wall-clock while others run beside it", "times");
    tree_costs(&space, &starter, runs)?;
    if let Some(kib) = peak_memory_kib() {
        say!("peak memory of this process: {:.0} MiB", kib / 1024.0);
    }
    Ok(())
}

/// Milliseconds and the number of stages that were built.
fn bake(
    space: &Space,
    population: &Population,
    resolution: Resolution,
    cache: &Cache,
    pool: &rayon::ThreadPool,
    listener: &dyn Listener,
) -> Result<(f64, usize)> {
    let start = Instant::now();
    let plan = Plan::new(space, population, resolution)?;
    let (finished, scene_ready) = (&|_: &Done| (), &|_: usize, _: &BlobRef| Ok(true));
    let runner = Runner { cache, pool, listener, cancelled: &|| false, finished, scene_ready };
    let done = runner.run(&plan)?;
    let built = done.iter().filter(|d| d.how == How::Built).count();
    Ok((start.elapsed().as_secs_f64() * 1e3, built))
}

/// Collects stage times; templates of trees count as one stage.
#[derive(Default)]
struct Stages(Mutex<Vec<(String, f64)>>);

impl Stages {
    fn times(self) -> Vec<(String, f64)> {
        self.0.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Listener for Stages {
    fn tell(&self, event: &Event) {
        if let Event::Finished { stage, reused: false, ms, .. } = event {
            let name = if stage.starts_with("tree ") && stage.ends_with(|c: char| c.is_ascii_digit()) {
                "tree (one template)".to_owned()
            } else {
                stage.clone()
            };
            self.0.lock().unwrap_or_else(PoisonError::into_inner).push((name, *ms));
        }
    }
}

/// What becomes of one template, step by step, on one core (the thesis's table 1).
fn tree_costs(space: &Space, starter: &Population, runs: u32) -> Result<()> {
    let one_core = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut samples = Samples::default();
    let (mut triangles, mut trees) = (0, 0);
    for individual in &starter.individuals {
        for _ in 0..runs.max(1) {
            let templates = one_core.install(|| preprocessing::template_steps(space, &individual.genome))?;
            templates.steps.iter().for_each(|(task, ms)| samples.add(task, *ms, None));
            triangles += templates.triangles;
            trees += TEMPLATES as usize;
        }
    }
    say!("templates have {} triangles on average", triangles / trees.max(1));
    samples.print("One tree template, on one core", "times");
    Ok(())
}

/// Durations by name, in the order of first appearance.
#[derive(Default)]
struct Samples(Vec<Sample>);

struct Sample {
    name: String,
    ms: Vec<f64>,
    /// Stages that were built the last time.
    built: Option<usize>,
}

impl Samples {
    fn add(&mut self, name: &str, ms: f64, built: Option<usize>) {
        match self.0.iter_mut().find(|sample| sample.name == name) {
            Some(sample) => {
                sample.ms.push(ms);
                sample.built = built;
            }
            None => self.0.push(Sample { name: name.to_owned(), ms: vec![ms], built }),
        }
    }

    /// The last column holds what was built or, for a stage, how often it was timed.
    fn print(&self, title: &str, last_column: &str) {
        say!("{title:<36} {:>9} {:>9} {:>9} {last_column:>13}", "min ms", "mean ms", "std dev");
        for Sample { name, ms, built } in &self.0 {
            let mean = ms.iter().sum::<f64>() / ms.len() as f64;
            let variance = ms.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / ms.len() as f64;
            let min = ms.iter().copied().fold(f64::MAX, f64::min);
            let count = built.unwrap_or(ms.len());
            say!("  {name:<34} {min:>9.2} {mean:>9.2} {:>9.2} {count:>13}", variance.sqrt());
        }
        say!("");
    }
}

/// Peak memory of this process, where the system reports it.
fn peak_memory_kib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.split_whitespace().next()?.parse().ok()
}
