//! Carries out each command of the command line and reports the outcome.

use std::hash::{BuildHasher, RandomState};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context, Result};
use genescape_schema::{Kinds, Population, Space, Strategy, Variety};
use genescape_world::output::BadOutput;
use genescape_world::{World, WorldError, file_limit};
use signal_hook::consts::SIGINT;
use signal_hook::flag;

use crate::audition::{self, Auditioned};
use crate::bad_input::BadInput;
use crate::breed::NoVotes;
use crate::cache_commands::GaveUp;
use crate::chosen_parents::ChosenParents;
use crate::cli::{Cli, Command, RunArgs, meant_command};
use crate::events::{Event, Listener};
use crate::export::InTheWay;
use crate::kinds;
use crate::landscape::{self, Landscape};
use crate::progress::{JsonLines, ProgressBar};
use crate::run::RunError;
use crate::say;
use crate::session::{self, Baked, Publish, Session};
use crate::watch_loop::{self, Host};
use crate::{
    bench, cache_commands, distance_command, explain_command, export_command, kinds_command, lineage_command,
    lod_command, manual,
};

/// Set by Ctrl-C.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

const FAILED: u8 = 1;
const BAD_INPUT: u8 = 2;
const INTERRUPTED_CODE: u8 = 130;

/// Carries out the command line; returns the process's exit code.
pub fn run(cli: Cli) -> u8 {
    file_limit::is_an_error();
    // The second time, the person means it.
    let end = flag::register_conditional_shutdown(SIGINT, i32::from(INTERRUPTED_CODE), &INTERRUPTED);
    if let Err(error) = end.and_then(|_| flag::register(SIGINT, &INTERRUPTED)) {
        eprintln!("note: Ctrl-C will end the bake at once: {error}");
    }
    match dispatch(&cli) {
        Ok(()) => 0,
        Err(error) => {
            if cli.run.json {
                JsonLines.tell(&Event::Failed { message: format!("{error:#}") });
            }
            say::warn(format_args!("error: {error:#}"));
            exit_code(&error)
        }
    }
}

fn stopped() -> bool {
    INTERRUPTED.load(Ordering::SeqCst)
}

fn exit_code(error: &anyhow::Error) -> u8 {
    if matches!(error.downcast_ref(), Some(RunError::Cancelled)) || error.is::<GaveUp>() {
        return INTERRUPTED_CODE;
    }
    let world = error.downcast_ref().is_some_and(WorldError::is_bad_input);
    let way = error.is::<BadOutput>() || error.is::<InTheWay>();
    if world || way || error.is::<NoVotes>() || error.is::<BadInput>() { BAD_INPUT } else { FAILED }
}

fn dispatch(cli: &Cli) -> Result<()> {
    let Cli { command: Some(command), run, .. } = cli else { return bake(cli) };
    if cli.population.is_some() || cli.watch {
        let text = "POPULATION.ron and --watch belong to `bake` without a command; see `bake --help`";
        return Err(BadInput(text.into()).into());
    }
    if run.json && !command.has_json() {
        let text = "--json prints the events of bakes and exports, kinds, distances, explanations, and a lineage instead of its \
             page; this command has none and prints text";
        return Err(BadInput(text.into()).into());
    }
    match command {
        Command::Random { seed, kinds, uniform } => random(*seed, kinds, *uniform, run),
        Command::Kinds { action } => kinds_command::run(action.as_ref(), run),
        Command::Next { from, strategy, variety } => next(*from, *strategy, *variety, run),
        Command::Breed(parents) => breed(parents, run),
        Command::Distance { one, other } => distance_command::run([one, other], run),
        Command::Lineage { out } => lineage_command::run(out.as_deref(), run),
        Command::Params { markdown } => params(&run.world, *markdown),
        Command::Explain { landscape } => explain_command::run(*landscape, run),
        Command::Export { scene, out, options } => export_command::run(scene, out, *options, run),
        Command::Lod { input, out, crease_deg, placement } => {
            lod_command::convert(input, out, *crease_deg, *placement)
        }
        Command::Cache { action } => cache_commands::look_after(&run.world, action, &stopped),
        Command::Bench { breeding: true, persons, only, .. } => {
            bench::breeding::breeding(*persons, &pool(run.threads)?, only.as_deref())
        }
        Command::Bench { reuse: true, generations, .. } => {
            bench::reuse::reuse(*generations, &pool(run.threads)?)
        }
        Command::Bench { visibility: true, .. } => bench::visibility::visibility(&pool(run.threads)?),
        Command::Bench { runs, .. } => bench::bench(*runs, &pool(run.threads)?, run.size),
        Command::Completions { shell } => manual::completions(*shell),
        Command::Man { folder } => manual::man(folder.as_deref()),
    }
}

fn pool(threads: Option<usize>) -> Result<rayon::ThreadPool> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0));
    builder.build().context("cannot start threads")
}

fn open_session(args: &RunArgs) -> Result<Session> {
    Session::new(World::open_or_create(&args.world)?, pool(args.threads)?, args.size)
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

    /// Bakes a population file that was just bred.
    fn bake_bred(&self, session: &Session, parent: u32, path: &Path) -> Result<()> {
        if self.json {
            let path = path.display().to_string();
            JsonLines.tell(&Event::Bred { parent, path });
        }
        self.bake_new(session, path)
    }

    /// Bakes one population file and reports the outcome.
    fn bake(&self, session: &Session, path: &Path) -> Result<()> {
        self.baked(&session.bake_file(path, Publish::AsCurrent, &*self.listener(), &stopped)?);
        Ok(())
    }
}

impl Host for Console {
    fn listener(&self) -> Box<dyn Listener + '_> {
        if self.json { Box::new(JsonLines) } else { Box::new(ProgressBar::new()) }
    }

    fn stopped(&self) -> bool {
        stopped()
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
        say::warn(format_args!("error: {error:#}"));
    }

    fn waiting(&self) {
        if !self.json {
            say!("watching {} (Ctrl-C ends)", self.root.display());
        }
    }
}

fn summary(baked: &Baked) {
    let Baked { file, scenes, built, reused, ms, publish, .. } = baked;
    if *publish == Publish::Aside {
        // What is to be looked at and edited has been told already.
        say!("{} in {:.2} s: {built} stages built, {reused} reused", file.path.display(), ms / 1e3);
        return;
    }
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
    // Before a world is made for it.
    if let Some(path) = population.as_ref().filter(|path| !path.exists()) {
        let Some(word) = path.to_str().filter(|word| !word.contains(['/', '\\', '.'])) else {
            return Err(WorldError::NoFile(path.clone()).into());
        };
        let meant = meant_command(word)
            .map_or("`bake --help` lists those".into(), |meant| format!("did you mean {meant}?"));
        return Err(BadInput(format!("{word} is neither a population file nor a command; {meant}")).into());
    }
    let (mut session, console) = (open_session(run)?, Console::new(run));
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

fn random(seed: Option<u64>, wanted: &[String], uniform: bool, args: &RunArgs) -> Result<()> {
    let seed = seed.unwrap_or_else(drawn_seed);
    let (session, console) = (open_session(args)?, Console::new(args));
    let (space, listener) = (session.space(), console.listener());
    let kinds = if uniform { Kinds::default() } else { session.kinds(&*listener) };
    let wanted = kinds::called(&kinds, wanted)?;
    let make = |generation| {
        // The thesis's flat space stays as flat as it is.
        if uniform {
            return Ok(Population::random(space, seed, generation));
        }
        let draw = |attempt| audition::drawn(space, &kinds, &wanted, seed, generation, attempt);
        draw(0).notices.into_iter().for_each(|message| listener.tell(&Event::Notice { message }));
        let Auditioned { population, redrawn } =
            audition::audition(space, |attempt| draw(attempt).population);
        audition::tell(&*listener, &redrawn);
        Ok::<_, WorldError>(population)
    };
    let path = session.world().create_next_population(space, make)?;
    listener.end();
    if !args.json {
        say!("seed {seed}");
    }
    console.bake_new(&session, &path)
}

/// A seed by chance, short enough to be told: what std seeds its hash maps with.
fn drawn_seed() -> u64 {
    RandomState::new().hash_one(()) % 1_000_000
}

fn next(from: Option<u32>, strategy: Strategy, variety: Option<Variety>, args: &RunArgs) -> Result<()> {
    // Nothing can be bred in a world that would have to be made.
    World::open(&args.world)?;
    let (session, console) = (open_session(args)?, Console::new(args));
    let world = session.world();
    let parents = match from {
        Some(generation) => world.population_path(generation),
        None => world.newest_population()?,
    };
    let parents = World::read_population(session.space(), &parents)?.population;
    let parents = Population { variety: variety.or(parents.variety), ..parents };
    let kinds = session.kinds(&*console.listener());
    let path =
        session::breed_another(world, session.space(), &kinds, strategy, &parents, &*console.listener())?;
    console.bake_bred(&session, parents.generation, &path)
}

fn breed(parents: &ChosenParents, args: &RunArgs) -> Result<()> {
    World::open(&args.world)?;
    let (session, console) = (open_session(args)?, Console::new(args));
    let (space, listener) = (session.space(), console.listener());
    let kinds = session.kinds(&*listener);
    let parent = landscape::current(session.world())?;
    let path = parents.breed(session.world(), space, &kinds, parent, &*listener)?;
    listener.end();
    console.bake_bred(&session, parent, &path)
}

fn params(world: &Path, markdown: bool) -> Result<()> {
    let (space, notices) = match world.exists() {
        true => World::open(world)?.space()?,
        // Without a world there is still the space that one would begin with.
        false => (Space::builtin(), Vec::new()),
    };
    notices.iter().for_each(|notice| say::warn(format_args!("note: {notice}")));
    say!("{}", if markdown { space.to_markdown() } else { space.to_table() }.trim_end());
    Ok(())
}
