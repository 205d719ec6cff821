//! Carries out each command of the command line and reports the outcome.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context, Result, bail};
use bytesize::ByteSize;
use genescape_cache::{Cache, GcOptions};
use genescape_schema::{Current, INDIVIDUALS, Population, Space};
use genescape_world::{World, WorldError, names};
use serde_json::Value;

use crate::breed::NoVotes;
use crate::cli::{BadInput, CacheCommand, Cli, Command, Landscape, RunArgs, meant_command};
use crate::events::{Event, Listener};
use crate::export::InTheWay;
use crate::gltf::for_each_object;
use crate::plan::Resolution;
use crate::progress::{JsonLines, ProgressBar};
use crate::run::RunError;
use crate::say;
use crate::session::{Baked, Publish, Session};
use crate::watch_loop::{self, Host};
use crate::{bench, export_command, lod_command};

/// Set by Ctrl-C.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

const FAILED: u8 = 1;
const BAD_INPUT: u8 = 2;
const INTERRUPTED_CODE: u8 = 130;

/// Carries out the command line; returns the process's exit code.
pub fn run(cli: Cli) -> u8 {
    let listen = ctrlc::set_handler(|| {
        // The second time, the person means it.
        if INTERRUPTED.swap(true, Ordering::SeqCst) {
            std::process::exit(i32::from(INTERRUPTED_CODE));
        }
    });
    if let Err(error) = listen {
        eprintln!("note: Ctrl-C will end the bake at once: {error}");
    }
    match dispatch(&cli) {
        Ok(()) => 0,
        Err(error) => {
            if cli.run.json {
                JsonLines.tell(&Event::Failed { message: format!("{error:#}") });
            }
            eprintln!("error: {error:#}");
            exit_code(&error)
        }
    }
}

fn exit_code(error: &anyhow::Error) -> u8 {
    if matches!(error.downcast_ref(), Some(RunError::Cancelled)) {
        return INTERRUPTED_CODE;
    }
    let world = matches!(error.downcast_ref(), Some(WorldError::Faulty(_) | WorldError::LastGeneration(_)));
    if world || error.is::<NoVotes>() || error.is::<InTheWay>() || error.is::<BadInput>() {
        BAD_INPUT
    } else {
        FAILED
    }
}

fn dispatch(cli: &Cli) -> Result<()> {
    let Cli { command: Some(command), run, .. } = cli else { return bake(cli) };
    if cli.population.is_some() || cli.watch {
        let text = "POPULATION.ron and --watch belong to `bake` without a command; see `bake --help`";
        return Err(BadInput(text.into()).into());
    }
    match command {
        Command::Random { seed } => random(*seed, run),
        Command::Next { from } => next(*from, run),
        Command::Params { markdown } => params(&run.world, *markdown),
        Command::Explain { landscape } => explain(&run.world, *landscape),
        Command::Export { scene, out, options } => export_command::run(scene, out, *options, run),
        Command::Lod { input, out, crease_deg } => lod_command::convert(input, out, *crease_deg),
        Command::Cache { action } => look_after_cache(&run.world, action),
        Command::Bench { runs } => bench::bench(*runs, &pool(run.threads)?, resolution(run.size)?),
    }
}

fn pool(threads: Option<usize>) -> Result<rayon::ThreadPool> {
    if threads == Some(0) {
        return Err(BadInput("--threads 0: at least one thread is needed".into()).into());
    }
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0));
    builder.build().context("cannot start threads")
}

fn resolution(size: u32) -> Result<Resolution> {
    Resolution::of_side(size).map_err(|text| BadInput(text).into())
}

fn session(args: &RunArgs) -> Result<Session> {
    let resolution = resolution(args.size)?;
    Session::new(World::open_or_create(&args.world)?, pool(args.threads)?, resolution)
}

/// Reports bakes to a person or to a program.
struct Console {
    json: bool,
    root: PathBuf,
}

impl Console {
    fn new(args: &RunArgs) -> Self {
        Self { json: args.json, root: args.world.clone() }
    }

    /// Bakes a population file that was just made.
    fn bake_new(&self, session: &Session, path: &Path) -> Result<()> {
        if !self.json {
            say!("made {}", path.display());
        }
        self.bake(session, path)
    }

    /// Bakes one population file and reports the outcome.
    fn bake(&self, session: &Session, path: &Path) -> Result<()> {
        self.baked(&session.bake_file(path, Publish::AsCurrent, &*self.listener(), &|| self.stopped())?);
        Ok(())
    }
}

impl Host for Console {
    fn listener(&self) -> Box<dyn Listener + '_> {
        if self.json { Box::new(JsonLines) } else { Box::new(ProgressBar::new()) }
    }

    fn stopped(&self) -> bool {
        INTERRUPTED.load(Ordering::SeqCst)
    }

    fn baked(&self, baked: &Baked) {
        if !self.json {
            summary(baked);
        }
    }

    fn failed(&self, error: &anyhow::Error) {
        if self.json {
            JsonLines.tell(&Event::Failed { message: format!("{error:#}") });
        }
        eprintln!("error: {error:#}");
    }

    fn waiting(&self) {
        if !self.json {
            say!("watching {} (Ctrl-C ends)", self.root.display());
        }
    }
}

fn summary(baked: &Baked) {
    let Baked { file, scenes, built, reused, ms } = baked;
    if *built == 0 {
        say!("nothing to do: all {reused} stages are up to date ({ms:.0} ms)");
    } else {
        say!("four landscapes in {:.2} s: {built} stages built, {reused} reused", ms / 1e3);
    }
    let individuals = &file.population.individuals;
    let width = individuals.iter().map(|i| i.name.chars().count()).max().unwrap_or(0);
    for ((landscape, individual), path) in Landscape::all().zip(individuals).zip(scenes) {
        say!("  {landscape}  {:width$}  {}", individual.name, path.display());
    }
    say!(
        "Look at them: import a scene.gltf in Blender, or drop it on any glTF viewer;\n\
         `bake export 1 valley/` writes landscape 1, its sky and its trees for other programs.\n\
         Change them: edit {} and bake again.",
        file.path.display()
    );
}

fn bake(Cli { run, population, watch, poll, .. }: &Cli) -> Result<()> {
    if let Some(path) = population.as_ref().filter(|path| !path.exists())
        && let Some(meant) = path.to_str().and_then(meant_command)
    {
        let word = path.display();
        return Err(BadInput(format!(
            "{word} is neither a population file nor a command; did you mean {meant}?"
        ))
        .into());
    }
    let (mut session, console) = (session(run)?, Console::new(run));
    if population.is_none() && session.world().begin()? && !run.json {
        say!("made {} from the starter landscapes", session.world().root().display());
    }
    if *watch {
        let options = watch_loop::Options { population: population.clone(), poll: *poll };
        return watch_loop::run(&mut session, &options, &console);
    }
    let path = population.clone().map_or_else(|| session.world().newest_population(), Ok)?;
    console.bake(&session, &path)
}

fn random(seed: u64, args: &RunArgs) -> Result<()> {
    let (session, console) = (session(args)?, Console::new(args));
    let (world, space) = (session.world(), session.space());
    let path = world.create_population(space, &Population::random(space, seed, world.next_generation()?))?;
    console.bake_new(&session, &path)
}

fn next(from: Option<u32>, args: &RunArgs) -> Result<()> {
    let (session, console) = (session(args)?, Console::new(args));
    let world = session.world();
    let parents = match from {
        Some(generation) => world.population_path(generation),
        None => world.newest_population()?,
    };
    let path = session.breed_file(&parents)?;
    console.bake_new(&session, &path)
}

fn params(world: &Path, markdown: bool) -> Result<()> {
    let (space, notices) = match world.exists() {
        true => World::open(world)?.space()?,
        // Without a world there is still the space that one would begin with.
        false => (Space::builtin(), Vec::new()),
    };
    notices.iter().for_each(|notice| eprintln!("note: {notice}"));
    say!("{}", if markdown { space.to_markdown() } else { space.to_table() }.trim_end());
    Ok(())
}

fn open_cache(world: &Path) -> Result<(World, Cache)> {
    let world = World::open(world)?;
    let cache = Cache::open(world.baked())?;
    Ok((world, cache))
}

fn explain(world: &Path, landscape: Option<Landscape>) -> Result<()> {
    let (world, cache) = open_cache(world)?;
    let current = export_command::current(&world)?;
    for landscape in landscape.map_or_else(|| Landscape::all().collect(), |one| vec![one]) {
        say!("landscape {landscape} ({}) in the last bake:", current.scenes[landscape.index()]);
        let history = cache.history(&names::scene_id(current.generation, landscape.index()))?;
        for (stage, explanation) in history.last() {
            say!("  {stage:<16} {explanation}");
        }
    }
    Ok(())
}

fn look_after_cache(world: &Path, action: &CacheCommand) -> Result<()> {
    let (world, cache) = open_cache(world)?;
    match action {
        CacheCommand::Stats => stats(&cache),
        CacheCommand::Verify => verify(&cache),
        CacheCommand::Gc { max_size } => gc(&world, &cache, max_size.0),
    }
}

fn size(bytes: u64) -> bytesize::Display {
    ByteSize(bytes).display().si()
}

fn stats(cache: &Cache) -> Result<()> {
    let stats = cache.stats()?;
    say!("{} blobs, {}; {} actions", stats.blobs, size(stats.blob_bytes), stats.actions);
    say!("{:<18} {:>8} {:>12} {:>12}", "stage", "actions", "size", "cost");
    for (name, stage) in &stats.stages {
        let cost = format!("{:.0} ms", stage.cost_ms);
        say!("{name:<18} {:>8} {:>12} {cost:>12}", stage.actions, size(stage.bytes));
    }
    Ok(())
}

fn verify(cache: &Cache) -> Result<()> {
    let report = cache.verify()?;
    say!("read {} blobs ({}) and {} actions", report.blobs, size(report.bytes), report.actions);
    for fault in &report.faults {
        say!("  {fault}");
    }
    for foreign in &report.foreign {
        say!("  {foreign}: none of ours, left alone");
    }
    match report.faults.len() {
        0 => {
            say!("all is well");
            Ok(())
        }
        n => bail!("{n} damaged or missing; `bake` makes them again"),
    }
}

fn gc(world: &World, cache: &Cache, max_size: u64) -> Result<()> {
    let current = world.current().ok().flatten();
    let mut roots = BTreeSet::new();
    if let Some(Current { generation, .. }) = current {
        for scene in 0..INDIVIDUALS {
            roots.extend(cache.roots_of(&names::scene_id(generation, scene))?);
        }
    }
    let options = GcOptions::to(max_size);
    let grace_min = options.grace.as_secs() / 60;
    let report = cache.gc(options, &roots)?;
    say!(
        "removed {} blobs and {} actions; {} → {} ({} of it in use by the current scenes)",
        report.blobs_removed,
        report.actions_removed,
        size(report.bytes_before),
        size(report.bytes_left),
        size(report.bytes_of_roots),
    );
    if report.bytes_left > max_size {
        say!(
            "more is left than asked for: what current scenes use stays, and what was used within {grace_min} min"
        );
    }
    let is_current = |generation| current.as_ref().is_some_and(|current| current.generation == generation);
    for (generation, _, file) in world.scenes()? {
        if !is_current(generation) && !is_whole(&file)? {
            // A scene with holes is worse than none; its population file makes it again.
            fs::remove_file(&file).with_context(|| format!("cannot remove {}", file.display()))?;
            say!("removed {}: parts of it are gone; bake its population to have it again", file.display());
        }
    }
    Ok(())
}

/// Whether all files that a scene names exist.
fn is_whole(scene: &Path) -> Result<bool> {
    let text = fs::read_to_string(scene).with_context(|| format!("cannot read {}", scene.display()))?;
    let folder = scene.parent().unwrap_or(Path::new("."));
    let Ok(mut json) = serde_json::from_str(&text) else { return Ok(false) };
    let found = for_each_object(&mut json, &mut |object| match object.get("uri").and_then(Value::as_str) {
        Some(uri) if !folder.join(uri).is_file() => Err(()),
        _ => Ok(()),
    });
    Ok(found.is_ok())
}
