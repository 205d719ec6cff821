//! Starts the bake in the background: a thread that watches the world folder as `bake --watch` does, at a lower priority
//! than what draws. With [`export`] the only file of the viewer that knows the bake; its results are in the world's files,
//! and its progress comes as [`Event`]s.
//!
//! Nothing that happens in here ends the viewer: a mistake in a file, a full disk, even a panic is reported as
//! [`Event::Failed`], and the watch begins again.

pub mod export;
pub mod laboratory;

use std::any::Any;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryIter, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use genescape_bake::ahead;
use genescape_bake::breed::Settled;
use genescape_bake::chosen_parents::ChosenParents;
use genescape_bake::cli::{bytes, threads};
use genescape_bake::events::{Listener, Untold};
use genescape_bake::landscape::{Landscape, ParentArg, Reference};
use genescape_bake::origin;
use genescape_bake::plan::Resolution;
use genescape_bake::session::{self, Session};
use genescape_bake::watch_loop::{self, Host};
use genescape_schema::{Category, Parent, Population, Space, Strategy};
use genescape_world::World;
use thread_priority::{ThreadPriority, set_current_thread_priority};

use crate::ballots::Ballots;

pub use genescape_bake::events::Event;

/// Priority of threads that bake, from 0 to 99: half way down. At the very bottom a bake would never get on where the
/// pictures are drawn by the processor, too.
const BAKING: u8 = 25;
/// Of threads that bake what nobody has asked for yet.
const AHEAD: u8 = 15;
/// What was baked is read before more is baked: somebody waits for it.
const READING: u8 = 40;
/// Until the first new attempt after a failure; each further pause is twice as long.
const MIN_PAUSE: Duration = Duration::from_millis(250);
/// The longest of these pauses. An attempt that lasted longer was a good one.
const MAX_PAUSE: Duration = Duration::from_secs(8);
/// How long closing the window may wait for the bake, which ends after the stages that it is at. What is left ends with
/// the process, and the cache doesn't mind.
const END_TIMEOUT: Duration = Duration::from_millis(500);

/// How to bake: a part of the command line, whose help these comments are.
#[derive(Clone, Debug, clap::Args)]
pub struct BakerOptions {
    /// Threads that bake, at a lower priority than what draws [default: as many as there are cores]
    #[arg(long, value_name = "N", value_parser = threads)]
    pub threads: Option<usize>,

    /// Samples a side of the heightfields that are baked, as in `bake --size`: 65, 129, 257, 513, 1025 or 2049
    #[arg(long, value_name = "N", default_value_t)]
    pub heightfield: Resolution,

    /// Bake what may be voted for while somebody looks, up to this size; 0 bakes nothing ahead
    #[arg(long, value_name = "SIZE", default_value = "1GB", value_parser = bytes)]
    pub ahead: u64,

    /// Look several times a second instead of waiting for events, for network folders that send none
    #[arg(long)]
    pub poll: bool,
}

/// A bake in the background. Dropped, it ends.
pub struct Baker {
    events: Receiver<Event>,
    stop: Arc<AtomicBool>,
    /// Nothing ever comes; it closes when the thread ends.
    ended: Receiver<()>,
    cast: Arc<Mutex<ahead::Cast>>,
}

impl Baker {
    /// Bakes the world in `root`, which is made from the starter landscapes if there is none. `wake` is called, from any
    /// thread, when there is something new in [`Baker::events`].
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn start(
        root: &Path,
        options: BakerOptions,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> std::io::Result<Self> {
        let (sender, events) = channel();
        let (alive, ended) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let cast = Arc::default();
        let ahead = ahead::Options {
            cast: Arc::clone(&cast),
            max_bytes: options.ahead,
            threads: cores_or(options.threads),
            thread_started: || lower_priority_to(AHEAD),
        };
        let reporter = Reporter { sender, wake: Box::new(wake), stop: Arc::clone(&stop), ahead };
        let root = root.to_owned();
        thread::Builder::new().name("baker".into()).spawn(move || {
            let _alive: Sender<()> = alive;
            lower_priority_to(BAKING);
            let attempt = || bake(&root, &options, &reporter);
            supervise(attempt, |message| (&reporter).tell(&Event::Failed { message }), &|| {
                reporter.stopped()
            });
        })?;
        Ok(Self { events, stop, ended, cast })
    }

    /// What happened since the last call. Never waits.
    pub fn events(&self) -> TryIter<'_, Event> {
        self.events.try_iter()
    }

    /// Says what is voted so far, so that what is baked ahead agrees with it.
    pub fn cast(&self, ballots: Ballots) {
        let cast = Category::ALL.map(|category| ballots.get(category).cast());
        *self.cast.lock().unwrap_or_else(PoisonError::into_inner) = cast;
    }
}

impl Drop for Baker {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::SeqCst);
        let _ = self.ended.recv_timeout(END_TIMEOUT);
    }
}

/// Watches and bakes until told to stop, or until it can't go on.
fn bake(root: &Path, options: &BakerOptions, reporter: &Reporter) -> Result<()> {
    let world = World::open_or_create(root)?;
    world.begin()?;
    let mut session = Session::new(world, pool(options.threads)?, options.heightfield)?;
    let options = watch_loop::Options { population: None, poll: options.poll };
    watch_loop::run(&mut session, &options, reporter)
}

fn pool(threads: Option<usize>) -> Result<rayon::ThreadPool> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(cores_or(threads))
        .thread_name(|index| format!("baker {index}"))
        .start_handler(|_| lower_priority_to(BAKING))
        .build()
        .context("cannot start threads")
}

/// None is left to what draws: where that is the processor, it rests meanwhile.
fn cores_or(threads: Option<usize>) -> usize {
    let cores = || thread::available_parallelism().map_or(1, |cores| cores.get());
    threads.unwrap_or_else(cores).max(1)
}

/// Threads to read what was baked: behind the one that draws and before those that bake.
///
/// # Errors
/// If the system gives no threads.
pub fn readers() -> Result<rayon::ThreadPool, rayon::ThreadPoolBuildError> {
    rayon::ThreadPoolBuilder::new()
        .thread_name(|index| format!("reader {index}"))
        .start_handler(|_| lower_priority())
        // It has told of itself; the pictures go on.
        .panic_handler(drop)
        .build()
}

/// Puts the calling thread behind the one that draws and before those that bake.
fn lower_priority() {
    lower_priority_to(READING);
}

/// Without the right to do so a thread is merely less polite.
fn lower_priority_to(priority: u8) {
    if let Ok(priority) = priority.try_into() {
        let _ = set_current_thread_priority(ThreadPriority::Crossplatform(priority));
    }
}

/// Breeds once more from votes that were answered already: the new file's path. The bake finds it by itself.
///
/// # Errors
/// Parents that cannot be read, a file that cannot be written.
pub fn breed_another(world: &World, space: &Space, parent: &Parent) -> Result<PathBuf> {
    let parents = world.population(space, parent.generation)?.population;
    // The bake tells what is wrong with them.
    let kinds = world.kinds(space).kinds;
    let parents = Population { votes: Some(parent.votes), ..parents };
    session::breed_another(world, space, &kinds, Strategy::default(), &parents, &Untold)
}

/// Breeds beside a generation, with one category of a landscape of any generation as a parent: the new file's path. The bake
/// finds it by itself.
///
/// # Errors
/// Parents that cannot be read, a file that cannot be written.
pub fn breed_with(
    world: &World,
    space: &Space,
    beside: u32,
    (generation, landscape): (u32, usize),
    category: Category,
) -> Result<PathBuf> {
    let landscape = Landscape::all().nth(landscape).context("there are four landscapes")?;
    let parent = Some(ParentArg::Landscape(Reference::Of(generation, landscape)));
    let mut chosen = ChosenParents::default();
    *[&mut chosen.tree, &mut chosen.terrain, &mut chosen.sky][category as usize] = parent;
    chosen.breed(world, space, &world.kinds(space).kinds, beside, &Untold)
}

/// Finds out, on a thread of its own, what the votes that a generation was bred from say of each gene, in words. `wake` is
/// called from there when it is known.
///
/// # Errors
/// If the system gives no thread.
pub fn taught(
    world: World,
    space: Arc<Space>,
    generation: u32,
    wake: impl FnOnce() + Send + 'static,
) -> std::io::Result<Receiver<BTreeMap<String, String>>> {
    let (sender, told) = channel();
    thread::Builder::new().name("votes".into()).spawn(move || {
        lower_priority();
        let population = world.population(&space, generation).ok();
        let accounts = population.map(|file| origin::taught(&space, &file.population, &world));
        let genes = accounts.into_iter().flatten().flat_map(|account| account.genes);
        let all = genes.filter(Settled::is_told).map(|gene| {
            let words = in_words(&gene);
            (gene.gene, words)
        });
        // Who has asked may be gone.
        let _ = sender.send(all.collect());
        wake();
    })?;
    Ok(told)
}

fn in_words(Settled { text, part, .. }: &Settled) -> String {
    let sure = match part {
        0.75.. => "quite sure",
        0.5.. => "fairly sure",
        _ => "a first hint",
    };
    format!("Votes want {text}: {sure}")
}

/// Sends the bake's events to the owner of the [`Baker`].
struct Reporter {
    sender: Sender<Event>,
    wake: Box<dyn Fn() + Send + Sync>,
    stop: Arc<AtomicBool>,
    ahead: ahead::Options,
}

impl Listener for &Reporter {
    fn tell(&self, event: &Event) {
        // The receiver is gone only when this thread is to end.
        if self.sender.send(event.clone()).is_ok() {
            (self.wake)();
        }
    }
}

impl Host for Reporter {
    fn listener(&self) -> Box<dyn Listener + '_> {
        Box::new(self)
    }

    fn stopped(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }

    fn ahead(&self) -> Option<ahead::Options> {
        (self.ahead.max_bytes > 0).then(|| self.ahead.clone())
    }

    fn failed(&self, error: &anyhow::Error) {
        self.tell(&Event::Failed { message: format!("{error:#}") });
    }
}

/// Runs `attempt` again and again until it ends by itself or `stopped` says so, with growing pauses. The same failure
/// is reported once.
fn supervise(mut attempt: impl FnMut() -> Result<()>, tell: impl Fn(String), stopped: &dyn Fn() -> bool) {
    let (mut told, mut pause) = (None, MIN_PAUSE);
    while !stopped() {
        let start = Instant::now();
        let message = match catch_unwind(AssertUnwindSafe(&mut attempt)) {
            Ok(Ok(())) => return,
            Ok(Err(_)) if stopped() => return,
            Ok(Err(error)) => format!("{error:#}"),
            Err(panic) => format!(
                "the bake stumbled over a bug in Genescape and starts again; please report it: {}",
                panic_text(&*panic)
            ),
        };
        if start.elapsed() > MAX_PAUSE {
            (told, pause) = (None, MIN_PAUSE);
        }
        if told.as_ref() != Some(&message) {
            tell(message.clone());
            told = Some(message);
        }
        rest(pause, stopped);
        pause = (2 * pause).min(MAX_PAUSE);
    }
}

fn panic_text(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no reason given")
}

fn rest(pause: Duration, stopped: &dyn Fn() -> bool) {
    let end = Instant::now() + pause;
    while Instant::now() < end && !stopped() {
        thread::sleep(Duration::from_millis(20).min(pause));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::{Cell, RefCell};

    /// Runs attempts that go as told by number, and stops before attempt `last`; what was told.
    fn supervised(last: u32, how: impl Fn(u32) -> Result<()>) -> Vec<String> {
        let (count, told) = (Cell::new(0), RefCell::new(Vec::new()));
        let attempt = || {
            count.set(count.get() + 1);
            how(count.get())
        };
        supervise(attempt, |message| told.borrow_mut().push(message), &|| count.get() >= last);
        assert_eq!(count.get(), last);
        told.into_inner()
    }

    #[test]
    fn a_panic_is_told_and_the_bake_starts_again() {
        let told = supervised(2, |attempt| {
            assert!(attempt > 1, "a stage's bug");
            Ok(())
        });
        assert!(told.len() == 1 && told[0].contains("a stage's bug"), "{told:?}");
    }

    #[test]
    fn the_same_failure_is_told_once_and_another_again() {
        let told = supervised(4, |attempt| {
            Err(anyhow::Error::msg(if attempt < 3 { "no disk" } else { "no folder" }))
        });
        assert_eq!(told, ["no disk", "no folder"]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn only_the_bakes_threads_have_a_lower_priority() {
        let nice = || {
            let stat = std::fs::read_to_string("/proc/thread-self/stat").expect("Linux tells");
            let (_, fields) = stat.rsplit_once(')').expect("after the name");
            fields.split_whitespace().nth(16).expect("nice").parse::<i32>().expect("a number")
        };
        let (before, of_the_bake) = (nice(), pool(Some(1)).expect("threads").install(nice));
        assert!(of_the_bake > before, "{of_the_bake} > {before}");
        assert_eq!(nice(), before);
    }

    fn wait_for(baker: &Baker, what: impl Fn(&Event) -> bool) -> Event {
        loop {
            let event = baker.events.recv_timeout(Duration::from_secs(60)).expect("the baker goes on");
            if what(&event) {
                return event;
            }
        }
    }

    #[test]
    fn a_broken_space_is_told_and_its_repair_seen() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let space = folder.path().join("space.ron");
        std::fs::write(&space, "Space(").expect("written");
        let options = BakerOptions {
            threads: Some(1),
            heightfield: Resolution::of_side(65).expect("a side"),
            poll: false,
            ahead: 0,
        };
        let baker = Baker::start(folder.path(), options, || {}).expect("a thread");
        let failed = wait_for(&baker, |event| matches!(event, Event::Failed { .. }));
        assert!(matches!(failed, Event::Failed { message } if message.contains("space.ron:1:")));
        std::fs::write(&space, genescape_schema::Space::BUILTIN).expect("written");
        wait_for(&baker, |event| matches!(event, Event::Planned { generation: 0, .. }));
    }
}
