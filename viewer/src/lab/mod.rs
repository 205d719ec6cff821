//! `viewer lab`: the experiments of the thesis (sections 7 and 8) on this renderer, and a report of what came out.
//!
//! [`scenes`] are those of figure 29; [`experiment`] says what is drawn of them by which schemes; [`walk`], [`popping`],
//! [`equal_cost`], [`bark`], [`tree_levels`], [`fly_out`] and [`preprocessing`] measure, each into a table of [`store`];
//! [`report`] makes a page of the tables beside what the thesis found, [`compare`] one of two folders.

mod answers;
mod bark;
mod bench;
mod chain;
mod compare;
mod equal_cost;
mod experiment;
mod fly_out;
mod meshoptimizer;
mod page;
mod popping;
mod preprocessing;
mod report;
mod scenes;
mod store;
mod tree_levels;
mod trees;
mod walk;

use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::{Args, Subcommand};
use genescape_schema::INDIVIDUALS;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::headless::Headless;
use crate::image_file::{check_size, parse_size};
use crate::measure::Machine;
use crate::passes::Shaders;
use crate::say;
pub use answers::read_sheet;
use bench::Bench;
use experiment::Experiment;
use scenes::{TestScene, TestScenes};
use store::{Configuration, Store};

/// What `viewer lab` can be asked for.
#[derive(Clone, Debug, Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct LabArgs {
    #[command(subcommand)]
    pub command: Option<LabCommand>,

    /// The folder for scenes, tables and report; what it holds already is not measured again
    #[arg(value_name = "OUT", default_value = "laboratory")]
    pub out: PathBuf,

    /// Fewer places, frames and scenes: for a look at what is measured
    #[arg(long)]
    pub quick: bool,

    /// Size of a picture; by default that of the thesis
    #[arg(long, value_name = "WxH", default_value = "400x300", value_parser = parse_size)]
    pub size: [u32; 2],

    /// Places of the camera on its way across the land, where time and quality are measured; it goes there and back
    /// [default: 48, with --quick 6]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=2000))]
    pub steps: Option<u32>,

    /// Frames across the land, where popping is measured [default: 256, with --quick 16]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=20000))]
    pub frames: Option<u32>,

    /// Bred scenes whose preprocessing is measured [default: 48, with --quick 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub scenes: Option<u32>,
}

/// What else the laboratory does.
#[derive(Clone, Debug, Subcommand)]
pub enum LabCommand {
    /// Show each tree's levels of detail at equal size, with what they cover and how far they are from the full tree
    Trees(trees::TreesArgs),
    /// Set two folders of measurements side by side, as ratios
    Compare(compare::CompareArgs),
    /// Analyse answers to the questionnaire, as the thesis does
    Answers(answers::AnswersArgs),
}

impl LabArgs {
    fn configuration(&self, machine: Machine) -> Result<Configuration> {
        let usual = |full: u32, quick: u32| if self.quick { quick } else { full };
        let words = std::env::args().skip(1);
        Ok(Configuration {
            command: std::iter::once("viewer".to_owned()).chain(words).collect::<Vec<_>>().join(" "),
            program: store::this_program()?,
            commit: store::commit(),
            size_px: self.size,
            steps: self.steps.unwrap_or(usual(48, 6)),
            frames: self.frames.unwrap_or(usual(256, 16)),
            scenes: self.scenes.unwrap_or(usual(48, 4)),
            machine,
        })
    }
}

/// Measures what is missing in the folder, and writes the report.
///
/// # Errors
/// If nothing can draw, or the folder cannot be written to or holds something else.
pub fn run(args: &LabArgs) -> Result<()> {
    match &args.command {
        Some(LabCommand::Trees(args)) => return trees::run(args),
        Some(LabCommand::Compare(args)) => return compare::run(args),
        Some(LabCommand::Answers(args)) => return answers::run(args),
        None => {}
    }
    let headless = Headless::open(&Shaders::from(None), 1)?;
    check_size(&headless.gpu, args.size)?;
    let configuration = args.configuration(Machine::of(&headless.gpu))?;
    let store = Store::open(&args.out, &configuration)?;
    say!("{}", configuration.machine.told());
    let scenes = TestScenes::bake(&world(&args.out))?;
    let bench = Bench::new(headless, scenes, args.size);
    let lab = Lab { bench, store, configuration };
    lab.measure()?;
    report::write(&lab.store, &lab.configuration)?;
    say!("wrote {}", args.out.join("report.html").display());
    Ok(())
}

/// A run of the laboratory.
struct Lab {
    bench: Bench,
    store: Store,
    configuration: Configuration,
}

impl Lab {
    fn measure(&self) -> Result<()> {
        let Configuration { steps, frames, scenes, .. } = self.configuration;
        let walks = 2 * u64::from(steps);
        for experiment in Experiment::of_land() {
            self.walk(&experiment, true)?;
            self.popping(&experiment)?;
        }
        for mut experiment in Experiment::of_trees() {
            let name = equal_cost_table(experiment.name);
            let allowed = self.table(&name, 3, |bench| equal_cost::measure(bench, &experiment))?;
            equal_cost::apply(&mut experiment, &allowed);
            // Millions of triangles: once is enough.
            self.walk(&experiment, false)?;
            self.popping(&experiment)?;
        }
        self.walk(&Experiment::of_bark(), false)?;
        self.table(BARK_INDICES, 1, bark::measure)?;
        for experiment in Experiment::of_all() {
            self.walk(&experiment, false)?;
        }
        let seeds = u64::from(scenes.div_ceil(8));
        let trees = TestScene::ALL.len() as u64 + seeds * INDIVIDUALS as u64;
        let root = world(self.store.root());
        self.table(TREE_LEVELS, trees, |bench| tree_levels::measure(bench, &root, seeds))?;
        let flight = fly_out::frames(frames);
        self.table(FLY_OUT, fly_out::pairs(flight), |bench| fly_out::measure(bench, flight))?;
        self.table(FOUR_VIEWS, walks, |bench| walk::four_views(bench, steps))?;
        self.table(PREPROCESSING, u64::from(scenes), |bench| preprocessing::measure(bench, scenes))?;
        Ok(())
    }

    fn walk(&self, experiment: &Experiment, reference_back: bool) -> Result<()> {
        let steps = self.configuration.steps;
        let measure = |bench: &Bench| walk::measure(bench, experiment, steps, reference_back);
        self.table(&walk_table(experiment.name), 2 * u64::from(steps), measure).map(drop)
    }

    fn popping(&self, experiment: &Experiment) -> Result<()> {
        let frames = self.configuration.frames;
        let measure = |bench: &Bench| popping::measure(bench, experiment, frames);
        self.table(&popping_table(experiment.name), u64::from(frames) - 1, measure).map(drop)
    }

    /// A table: read if it is there, else measured and written. `places` are what the progress bar counts.
    fn table<R: Serialize + DeserializeOwned>(
        &self,
        name: &str,
        places: u64,
        measure: impl FnOnce(&Bench) -> Result<Vec<R>>,
    ) -> Result<Vec<R>> {
        if self.store.has(name) {
            return self.store.rows(name);
        }
        let bar = &self.bench.bar;
        bar.set_length(places);
        bar.reset();
        bar.set_message(name.to_owned());
        let rows = measure(&self.bench)?;
        self.store.keep(name, &rows)?;
        let seconds = bar.elapsed().as_secs_f64();
        bar.suspend(|| say!("{name}: {} rows in {seconds:.0} s", rows.len()));
        Ok(rows)
    }
}

/// Where the laboratory's landscapes are.
fn world(out: &Path) -> PathBuf {
    out.join("world")
}

const BARK_INDICES: &str = "bark-indices";
const TREE_LEVELS: &str = "tree-levels";
const FLY_OUT: &str = "fly-out";
const FOUR_VIEWS: &str = "four-views";
const PREPROCESSING: &str = "preprocessing";

fn walk_table(experiment: &str) -> String {
    format!("walk-{experiment}")
}

fn popping_table(experiment: &str) -> String {
    format!("popping-{experiment}")
}

fn equal_cost_table(experiment: &str) -> String {
    format!("equal-cost-{experiment}")
}
