//! What each command of the command line does, and how it tells the outcome.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use anyhow::{Context, Result, anyhow, bail};
use genescape_cache::{Cache, GcOptions, How};
use genescape_schema::{Population, Report, Space, names};

use crate::cli::{BakeArgs, CacheCommand, Cli, Command, RunArgs, WorldArgs};
use crate::events::{Bar, Event, JsonLines, Listener};
use crate::plan::{Plan, Resolution};
use crate::run::{Done, RunError, Runner};
use crate::say;
use crate::watch::Watch;
use crate::world::{self, PopulationFile, World};
use crate::{bench, breed, lod_file};

/// Set by Ctrl-C.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

const FAILED: u8 = 1;
const BAD_INPUT: u8 = 2;
const INTERRUPTED_CODE: u8 = 130;

/// Does what the command line says; the process's exit code.
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
    let json = is_json(&cli);
    match dispatch(cli) {
        Ok(()) => 0,
        Err(error) => {
            if json {
                JsonLines.tell(&Event::Failed { message: format!("{error:#}") });
            }
            eprintln!("error: {error:#}");
            exit_code(&error)
        }
    }
}

fn is_json(cli: &Cli) -> bool {
    match &cli.command {
        None => cli.bake.run.json,
        Some(Command::Random { run, .. } | Command::Next { run }) => run.json,
        Some(_) => false,
    }
}

fn exit_code(error: &anyhow::Error) -> u8 {
    if matches!(error.downcast_ref(), Some(RunError::Cancelled)) {
        return INTERRUPTED_CODE;
    }
    let bad_input = error.is::<Report>() || error.is::<breed::BreedError>() || error.is::<BadInput>();
    if bad_input { BAD_INPUT } else { FAILED }
}

/// Input that is the person's to mend, not a failure of ours.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct BadInput(pub String);

fn dispatch(cli: Cli) -> Result<()> {
    match cli.command {
        None => bake(&cli.bake),
        Some(Command::Random { seed, run }) => {
            let session = Session::new(&run)?;
            let generation = session.world.newest_generation()?.map_or(0, |newest| newest + 1);
            let population = Population::random(session.world.space(), seed, generation);
            session.bake_new(&population)
        }
        Some(Command::Next { run }) => {
            let session = Session::new(&run)?;
            let newest = session.world.load_population(&session.world.newest_population()?)?;
            let children = breed::breed(session.world.space(), &newest.loaded.population)?;
            session.bake_new(&children)
        }
        Some(Command::Params { markdown, world }) => params(&world, markdown),
        Some(Command::Explain { scene, world }) => explain(&world, scene),
        Some(Command::Export { scene, out, world }) => export(&world, &scene, &out),
        Some(Command::Lod { input, out, crease_deg }) => lod_file::convert(&input, &out, crease_deg),
        Some(Command::Cache { action }) => look_after_cache(&action),
        Some(Command::Bench { runs, threads, size }) => {
            bench::bench(runs, &pool(threads)?, resolution(size)?)
        }
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

/// All that bakes of one world share.
struct Session {
    world: World,
    cache: Cache,
    pool: rayon::ThreadPool,
    resolution: Resolution,
    json: bool,
}

impl Session {
    fn new(args: &RunArgs) -> Result<Self> {
        let resolution = resolution(args.size)?;
        let world = World::open_or_create(&args.world.world)?;
        let cache = Cache::open(world.root().join(names::BAKED))?;
        Ok(Self { world, cache, pool: pool(args.threads)?, resolution, json: args.json })
    }

    fn bake_new(&self, population: &Population) -> Result<()> {
        let path = self.world.save_population(population)?;
        if !self.json {
            say!("made {}", path.display());
        }
        self.bake_file(&path)
    }

    /// Bakes one population file and tells the outcome.
    fn bake_file(&self, path: &Path) -> Result<()> {
        let start = Instant::now();
        let file = self.world.load_population(path)?;
        let listener: Box<dyn Listener> = if self.json { Box::new(JsonLines) } else { Box::new(Bar::new()) };
        for snap in &file.loaded.snaps {
            listener.tell(&Event::Notice { message: snap.to_string() });
        }
        let plan = Plan::new(self.world.space(), &file.loaded.population, self.resolution)?;
        let generation = file.loaded.population.generation;
        listener.tell(&Event::Planned { generation, stages: plan.nodes.len() });
        let result = self.run(&plan, &file, &*listener);
        // The bar must not stand between the person and the message.
        listener.end();
        let done = result?;
        self.world.publish_current(&file)?;
        self.remember(&plan, &done, generation)?;

        let built = done.iter().filter(|d| d.how == How::Built).count();
        let ms = start.elapsed().as_secs_f64() * 1e3;
        listener.tell(&Event::Done { built, reused: done.len() - built, ms });
        if !self.json {
            self.summary(&file, built, done.len() - built, ms);
        }
        Ok(())
    }

    fn run(
        &self,
        plan: &Plan,
        file: &PopulationFile,
        listener: &dyn Listener,
    ) -> Result<Vec<Done>, RunError> {
        let population = &file.loaded.population;
        let scene_ready = |scene: usize, blob: &genescape_cache::BlobRef| -> Result<()> {
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
        let cancelled = || INTERRUPTED.load(Ordering::SeqCst);
        let runner = Runner {
            cache: &self.cache,
            pool: &self.pool,
            listener,
            cancelled: &cancelled,
            scene_ready: &scene_ready,
        };
        runner.run(plan)
    }

    fn summary(&self, file: &PopulationFile, built: usize, reused: usize, ms: f64) {
        let Population { generation, individuals, .. } = &file.loaded.population;
        if built == 0 {
            say!("nothing to do: all {reused} stages are up to date ({ms:.0} ms)");
        } else {
            say!("four landscapes in {:.2} s: {built} stages built, {reused} reused", ms / 1e3);
        }
        let width = individuals.iter().map(|i| i.name.chars().count()).max().unwrap_or(0);
        for (scene, individual) in individuals.iter().enumerate() {
            let path = self.world.scene_path(*generation, scene);
            say!("  {scene}  {:width$}  {}", individual.name, path.display());
        }
        say!(
            "Look at them: import a scene.gltf in Blender, or drop it on any glTF viewer;\n\
             `bake export 0 scene.glb` makes one self-contained file of scene 0.\n\
             Change them: edit {} and bake again.",
            file.path.display()
        );
    }
}

fn bake(args: &BakeArgs) -> Result<()> {
    let mut session = Session::new(&args.run)?;
    if args.population.is_none() && session.world.begin()? && !session.json {
        say!("made {} from the starter landscapes", session.world.root().display());
    }
    let target = |session: &Session| match &args.population {
        Some(path) => Ok(path.clone()),
        None => session.world.newest_population(),
    };
    if !args.watch {
        return target(&session).and_then(|path| session.bake_file(&path));
    }
    let populations = session.world.root().join(names::POPULATIONS);
    let mut folders = vec![session.world.root().to_owned(), populations];
    if let Some(folder) = args.population.as_ref().and_then(|path| path.parent()) {
        let folder = if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder.to_owned() };
        if !folders.contains(&folder) {
            folders.push(folder);
        }
    }
    // From before the first bake on, lest a save during it be missed.
    let watch = Watch::new(&folders.iter().map(PathBuf::as_path).collect::<Vec<_>>(), args.poll)?;
    let mut last = target(&session).and_then(|path| session.bake_file(&path));
    loop {
        if let Err(error) = &last {
            if matches!(error.downcast_ref(), Some(RunError::Cancelled)) {
                return last;
            }
            if session.json {
                JsonLines.tell(&Event::Failed { message: format!("{error:#}") });
            }
            eprintln!("error: {error:#}");
        }
        if !session.json {
            say!("watching {} (Ctrl-C ends)", session.world.root().display());
        }
        if !watch.wait(&|| INTERRUPTED.load(Ordering::SeqCst)) {
            return Ok(());
        }
        last =
            session.world.reload_space().and_then(|()| target(&session)).and_then(|p| session.bake_file(&p));
    }
}

fn params(args: &WorldArgs, markdown: bool) -> Result<()> {
    let space = match World::open(&args.world) {
        Ok(world) => world.space().clone(),
        // Without a world there is still the space that one would begin with.
        Err(_) if !args.world.exists() => Space::builtin(),
        Err(error) => return Err(error),
    };
    say!("{}", if markdown { space.to_markdown() } else { space.to_table() }.trim_end());
    Ok(())
}

fn export(args: &WorldArgs, scene: &str, out: &Path) -> Result<()> {
    let path = match scene.parse::<usize>() {
        Ok(index) => {
            let world = World::open(&args.world)?;
            let current = world.current()?;
            let file = current.scenes.get(index);
            let file = file.ok_or_else(|| BadInput(format!("scene {index}: there are scenes 0 to 3")))?;
            world.root().join(file)
        }
        Err(_) => PathBuf::from(scene),
    };
    let json = std::fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let folder = path.parent().unwrap_or(Path::new("."));
    let read = |uri: &str| std::fs::read(folder.join(uri)).map_err(|error| error.to_string());
    let glb = crate::stages::export::single_glb(&json, read).with_context(|| {
        format!("{}: cannot be made one file; bake again if blobs are missing", path.display())
    })?;
    world::write_synced(out, &glb)?;
    say!("wrote {} ({:.1} MB)", out.display(), glb.len() as f64 / 1e6);
    Ok(())
}

fn open_cache(args: &WorldArgs) -> Result<(World, Cache)> {
    let world = World::open(&args.world)?;
    let cache = Cache::open(world.root().join(names::BAKED))?;
    Ok((world, cache))
}

/// What `explain` calls a scene.
fn scope(generation: u32, scene: usize) -> String {
    format!("g{generation:04}-scene-{scene}")
}

impl Session {
    /// Notes for `explain` what became of each stage of each scene.
    fn remember(&self, plan: &Plan, done: &[Done], generation: u32) -> Result<()> {
        for scene in 0..plan.scenes.len() {
            let mut history = self.cache.history(&scope(generation, scene))?;
            if let Some(parent) = generation.checked_sub(1) {
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

fn explain(args: &WorldArgs, scene: Option<usize>) -> Result<()> {
    let (world, cache) = open_cache(args)?;
    let current = world.current()?;
    if scene.is_some_and(|scene| scene >= current.scenes.len()) {
        return Err(BadInput("there are scenes 0 to 3".into()).into());
    }
    for index in (0..current.scenes.len()).filter(|index| scene.is_none_or(|scene| scene == *index)) {
        say!("{} in the last bake:", current.scenes[index]);
        let history = cache.history(&scope(current.generation, index))?;
        for (stage, explanation) in history.last() {
            say!("  {stage:<16} {explanation}");
        }
    }
    Ok(())
}

fn look_after_cache(action: &CacheCommand) -> Result<()> {
    match action {
        CacheCommand::Stats { world } => stats(&open_cache(world)?.1),
        CacheCommand::Verify { world } => verify(&open_cache(world)?.1),
        CacheCommand::Gc { max_size, world } => {
            let (world, cache) = open_cache(world)?;
            gc(&world, &cache, *max_size)
        }
    }
}

fn megabytes(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}

fn stats(cache: &Cache) -> Result<()> {
    let stats = cache.stats()?;
    say!("{} blobs, {}; {} actions", stats.blobs, megabytes(stats.blob_bytes), stats.actions);
    say!("{:<18} {:>8} {:>12} {:>12}", "stage", "actions", "size", "cost");
    for (name, stage) in &stats.stages {
        let cost = format!("{:.0} ms", stage.cost_ms);
        say!("{name:<18} {:>8} {:>12} {cost:>12}", stage.actions, megabytes(stage.bytes));
    }
    Ok(())
}

fn verify(cache: &Cache) -> Result<()> {
    let report = cache.verify()?;
    say!("read {} blobs ({}) and {} actions", report.blobs, megabytes(report.bytes), report.actions);
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
    let current = world.current().ok();
    let mut roots = std::collections::BTreeSet::new();
    for (scene, generation) in current.iter().flat_map(|c| (0..c.scenes.len()).map(|s| (s, c.generation))) {
        roots.extend(cache.roots_of(&scope(generation, scene))?);
    }
    let options = GcOptions::to(max_size);
    let grace_min = options.grace.as_secs() / 60;
    let report = cache.gc(options, &roots)?;
    say!(
        "removed {} blobs and {} actions; {} → {} ({} of it in use by the current scenes)",
        report.blobs_removed,
        report.actions_removed,
        megabytes(report.bytes_before),
        megabytes(report.bytes_left),
        megabytes(report.bytes_of_roots),
    );
    if report.bytes_left > max_size {
        say!(
            "more is left than asked for: what current scenes use stays, and what was used within {grace_min} min"
        );
    }
    let kept: Vec<PathBuf> = current.iter().flat_map(|c| &c.scenes).map(|s| world.root().join(s)).collect();
    for file in world.scene_files()?.into_iter().filter(|file| !kept.contains(file)) {
        if !world::is_whole(&file)? {
            // A scene with holes is worse than none; its population file makes it again.
            std::fs::remove_file(&file).with_context(|| format!("cannot remove {}", file.display()))?;
            say!("removed {}: parts of it are gone; bake its population to have it again", file.display());
        }
    }
    Ok(())
}
