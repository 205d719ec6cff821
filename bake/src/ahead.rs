//! Votes that somebody may cast → bakes of what would be bred from them, while that person still looks. What the vote then
//! asks for is in the cache, or much of it: all that the new landscapes share with a guess.
//!
//! A guess is a bake of the same population that [`Session::breed_file`] would write, which nobody sees: it writes into the
//! cache alone. So a wrong one costs disk and idle time, and what it made goes when the next landscapes are there.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use anyhow::Result;
use genescape_cache::{Cache, Digest, How};
use genescape_schema::{Category, Population, Votes};
use genescape_world::World;

use crate::audition::Auditioned;
use crate::breed::likely_votes;
use crate::events::Untold;
use crate::graph::Done;
use crate::pedigree::Pedigree;
use crate::plan::{Plan, Resolution};
use crate::run::{RunError, Runner};
use crate::session::Session;

/// What somebody has voted so far, by category; `None` where it is open.
pub type Cast = [Option<Option<usize>>; 3];

/// How much may be baked ahead, and by what.
#[derive(Clone, Debug)]
pub struct Options {
    /// Guesses are of votes that agree with these, once there are any.
    pub cast: Arc<Mutex<Cast>>,
    /// Of files that nobody has asked for.
    pub max_bytes: u64,
    pub threads: usize,
    /// Called at the start of each thread: to lower its priority.
    pub thread_started: fn(),
}

/// Bakes ahead, on threads of its own, until told to stop.
pub struct Ahead {
    options: Options,
    made: Arc<Made>,
    /// What is guessed from, or was until the last stop.
    from: Option<Arc<Basis>>,
    guessing: Option<Guessing>,
}

/// What is guessed from, and what was bred from it for votes.
struct Basis {
    pedigree: Pedigree,
    bred: Mutex<Vec<(Votes, Auditioned)>>,
}

/// A thread that guesses from the population in a file.
struct Guessing {
    path: PathBuf,
    stop: Arc<AtomicBool>,
}

/// Actions that were built for nobody yet, and their bytes.
#[derive(Debug, Default)]
struct Made(Mutex<BTreeMap<Digest, u64>>);

impl Made {
    fn lock(&self) -> MutexGuard<'_, BTreeMap<Digest, u64>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn note(&self, done: &Done) {
        if done.how == How::Built {
            self.lock().insert(done.key.digest(), done.record.bytes);
        }
    }

    fn bytes(&self) -> u64 {
        self.lock().values().sum()
    }
}

impl Ahead {
    pub fn new(options: Options) -> Self {
        Self { options, made: Arc::default(), from: None, guessing: None }
    }

    /// Begins to guess from the population in a file, unless it does already, or somebody has voted on it. What was made for
    /// another population goes.
    ///
    /// # Errors
    /// A file that cannot be read, a cache that cannot be opened, or if the system gives no thread.
    pub fn begin(&mut self, session: &Session, path: &Path) -> Result<()> {
        if self.guessing.as_ref().is_some_and(|guessing| guessing.path == path) {
            return Ok(());
        }
        let shown = World::read_population(session.space(), path)?.population;
        if shown.votes.is_some() {
            return self.discard(session);
        }
        let pedigree = session.pedigree(shown, &Untold)?;
        let basis = match self.from.take().filter(|basis| basis.pedigree == pedigree) {
            Some(basis) => basis,
            None => {
                self.discard(session)?;
                Arc::new(Basis { pedigree, bred: Mutex::default() })
            }
        };
        self.from = Some(Arc::clone(&basis));
        let stop = Arc::new(AtomicBool::new(false));
        let guesser = self.guesser(session, basis, Arc::clone(&stop))?;
        let start = self.options.thread_started;
        thread::Builder::new().name("ahead".into()).spawn(move || {
            start();
            // Whatever is wrong, a bake that somebody asked for will say.
            let _ = guesser.run();
        })?;
        self.guessing = Some(Guessing { path: path.to_owned(), stop });
        Ok(())
    }

    fn guesser(&self, session: &Session, basis: Arc<Basis>, stop: Arc<AtomicBool>) -> Result<Guesser> {
        Ok(Guesser {
            basis,
            cache: Cache::open(session.world().baked())?,
            resolution: session.resolution(),
            options: self.options.clone(),
            made: Arc::clone(&self.made),
            stop,
        })
    }

    /// Ends guessing without waiting: what is being built is finished in the background.
    pub fn stop(&mut self) {
        if let Some(guessing) = self.guessing.take() {
            guessing.stop.store(true, Ordering::SeqCst);
        }
    }

    /// The children of the parents' votes, if these were guessed.
    pub fn children(&self, pedigree: &Pedigree) -> Option<Auditioned> {
        let votes = pedigree.parents.votes?;
        let unvoted =
            Pedigree { parents: Population { votes: None, ..pedigree.parents.clone() }, ..pedigree.clone() };
        let basis = self.from.as_ref().filter(|basis| basis.pedigree == unvoted)?;
        basis.children(votes)
    }

    /// Somebody has asked for these actions after all.
    pub fn keep<'a>(&self, actions: impl IntoIterator<Item = &'a Digest>) {
        let mut made = self.made.lock();
        for action in actions {
            made.remove(action);
        }
    }

    /// Removes what nobody has asked for, unless some program is counting on what there is.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    fn discard(&self, session: &Session) -> Result<()> {
        let unwanted: BTreeSet<Digest> = self.made.lock().keys().copied().collect();
        if unwanted.is_empty() {
            return Ok(());
        }
        let cache = Cache::open(session.world().baked())?;
        if let Some(gc) = cache.begin_gc(|| false)? {
            gc.discard(&unwanted)?;
            self.made.lock().retain(|action, _| !unwanted.contains(action));
        }
        Ok(())
    }
}

impl Drop for Ahead {
    fn drop(&mut self) {
        self.stop();
    }
}

impl Basis {
    fn children(&self, votes: Votes) -> Option<Auditioned> {
        self.bred().iter().find(|(guessed, _)| *guessed == votes).map(|(_, children)| children.clone())
    }

    fn bred(&self) -> MutexGuard<'_, Vec<(Votes, Auditioned)>> {
        self.bred.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// All that the thread needs.
struct Guesser {
    basis: Arc<Basis>,
    cache: Cache,
    resolution: Resolution,
    options: Options,
    made: Arc<Made>,
    stop: Arc<AtomicBool>,
}

impl Guesser {
    fn run(&self) -> Result<()> {
        let pool = self.pool()?;
        let (guesses, mut done) = (pool.install(|| self.guesses()), Vec::new());
        while let Some(votes) = self.next(&guesses, &done).filter(|_| !self.is_to_stop()) {
            let plan = self.plan(&pool.install(|| self.bred(votes))?)?;
            let is_off = || self.next(&guesses, &done) != Some(votes);
            match self.bake(&plan, &pool, &is_off) {
                // Somebody has voted otherwise; what is left of it may still be guessed later.
                Err(RunError::Cancelled) if !self.is_to_stop() => {}
                result => {
                    result?;
                    done.push(votes);
                }
            }
        }
        Ok(())
    }

    /// The first guess that is not done, as far as it is not decided yet what is voted for; if all of these are, any.
    fn next(&self, guesses: &[Votes], done: &[Votes]) -> Option<Votes> {
        let cast = *self.options.cast.lock().unwrap_or_else(PoisonError::into_inner);
        let agreeing = guesses.iter().map(|guess| {
            let mut votes = *guess;
            for (category, cast) in Category::ALL.into_iter().zip(cast) {
                votes.set(category, cast.unwrap_or_else(|| guess.get(category)));
            }
            votes
        });
        agreeing.chain(guesses.iter().copied()).find(|votes| !done.contains(votes))
    }

    fn pool(&self) -> Result<rayon::ThreadPool> {
        let start = self.options.thread_started;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(self.options.threads)
            .thread_name(|index| format!("ahead {index}"))
            .start_handler(move |_| start());
        Ok(pool.build()?)
    }

    fn is_to_stop(&self) -> bool {
        self.stop.load(Ordering::SeqCst) || self.made.bytes() >= self.options.max_bytes
    }

    fn guesses(&self) -> Vec<Votes> {
        let Pedigree { space, kinds, past, parents, .. } = &self.basis.pedigree;
        likely_votes(space, kinds, past, parents)
    }

    /// What these votes would be answered with.
    fn bred(&self, votes: Votes) -> Result<Population> {
        let known = self.basis.children(votes);
        let children = known.map_or_else(|| self.basis.pedigree.children(Some(votes)), Ok)?;
        self.basis.bred().push((votes, children.clone()));
        Ok(children.population)
    }

    fn plan(&self, population: &Population) -> Result<Plan> {
        Ok(Plan::new(&self.basis.pedigree.space, population, self.resolution)?)
    }

    /// Until somebody says that it `is_off`.
    fn bake(
        &self,
        plan: &Plan,
        pool: &rayon::ThreadPool,
        is_off: &(dyn Fn() -> bool + Sync),
    ) -> Result<(), RunError> {
        let runner = Runner {
            cache: &self.cache,
            pool,
            listener: &Untold,
            cancelled: &|| self.is_to_stop() || is_off(),
            finished: &|done| self.made.note(done),
            scene_ready: &|_, _| Ok(true),
        };
        runner.run(plan)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::Publish;

    const THREADS: usize = 2;

    fn options(max_bytes: u64) -> Options {
        Options { max_bytes, threads: THREADS, thread_started: || (), cast: Arc::default() }
    }

    struct Setting {
        _folder: tempfile::TempDir,
        session: Session,
        /// The starters' file.
        path: PathBuf,
    }

    fn setting() -> Setting {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let world = World::open_or_create(folder.path()).expect("a world");
        world.begin().expect("the starters");
        let path = world.newest_population().expect("the starters");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
        let side = Resolution::of_side(65).expect("a side");
        let session = Session::new(world, pool, side).expect("a session");
        Setting { _folder: folder, session, path }
    }

    fn bake(session: &Session, path: &Path) -> crate::session::Baked {
        session.bake_file(path, Publish::AsCurrent, &Untold, &|| false).expect("baked")
    }

    fn guesser(ahead: &mut Ahead, Setting { session, path, .. }: &Setting) -> Guesser {
        let parents = World::read_population(session.space(), path).expect("the starters").population;
        let pedigree = session.pedigree(parents, &Untold).expect("readable");
        let basis = Arc::new(Basis { pedigree, bred: Mutex::default() });
        ahead.from = Some(Arc::clone(&basis));
        ahead.guesser(session, basis, Arc::default()).expect("a cache")
    }

    /// What these votes on the starters are answered with, as a watch does it.
    fn answered(
        ahead: &Ahead,
        Setting { session, path, .. }: &Setting,
        votes: Votes,
    ) -> crate::session::Baked {
        let text = std::fs::read_to_string(path).expect("the starters");
        let voted =
            genescape_schema::edit::set_votes("g0000.ron", &text, Some(votes)).expect("a population file");
        std::fs::write(path, voted).expect("saved");
        let child = session.breed_file(path, &Untold, |pedigree| {
            let known = ahead.children(pedigree).expect("guessed");
            assert_eq!(known, pedigree.children(Some(votes)).expect("voted"));
            Some(known)
        });
        bake(session, &child.expect("bred"))
    }

    #[test]
    fn what_a_guess_has_baked_is_there_when_it_is_voted_for_and_the_rest_goes() {
        let setting = setting();
        let session = &setting.session;
        bake(session, &setting.path);
        let mut ahead = Ahead::new(options(u64::MAX));
        let guesser = guesser(&mut ahead, &setting);
        let guesses = guesser.guesses();
        let pool = guesser.pool().expect("threads");
        for votes in &guesses[..2] {
            let population = guesser.bred(*votes).expect("voted");
            let plan = guesser.plan(&population).expect("a plan");
            guesser.bake(&plan, &pool, &|| false).expect("baked");
        }
        assert_eq!(session.world().generations().expect("listed"), [0], "nobody sees a guess");
        let baked = answered(&ahead, &setting, guesses[1]);
        assert_eq!(baked.built, 0, "{} were reused", baked.reused);

        ahead.keep(&baked.actions);
        let unwanted: Vec<Digest> = ahead.made.lock().keys().copied().collect();
        assert!(!unwanted.is_empty() && unwanted.iter().all(|action| !baked.actions.contains(action)));
        let blobs = || guesser.cache.stats().expect("counted").blobs;
        let with_guesses = blobs();
        let child = session.world().newest_population().expect("the child");
        ahead.begin(session, &child).expect("begun");
        ahead.stop();
        assert!(ahead.made.lock().keys().all(|action| !unwanted.contains(action)));
        assert!(blobs() < with_guesses);
        for path in [&setting.path, &child] {
            assert_eq!(bake(session, path).built, 0, "what was asked for stays");
        }
    }

    #[test]
    fn no_more_is_baked_ahead_than_is_allowed() {
        let setting = setting();
        bake(&setting.session, &setting.path);
        let mut ahead = Ahead::new(options(1));
        guesser(&mut ahead, &setting).run().expect_err("told to stop in the midst of a guess");
        let made = ahead.made.lock().len();
        // Each executor may be at a stage when the limit is reached.
        assert!((1..=THREADS + 1).contains(&made), "{made}");
    }

    #[test]
    fn guesses_agree_with_what_is_voted_so_far() {
        let setting = setting();
        let mut ahead = Ahead::new(options(u64::MAX));
        let guesser = guesser(&mut ahead, &setting);
        let guesses = guesser.guesses();
        let likeliest = guesses[0];
        assert_eq!(guesser.next(&guesses, &[]), Some(likeliest));
        *guesser.options.cast.lock().expect("no panic") = [Some(Some(3)), None, Some(None)];
        let mut done = Vec::new();
        while let Some(votes) = guesser.next(&guesses, &done).filter(|votes| votes.sky.is_none()) {
            assert_eq!(votes.tree, Some(3));
            done.push(votes);
        }
        let mut lands: Vec<_> = done.iter().map(|votes| votes.terrain).collect();
        assert_eq!(lands[0], likeliest.terrain);
        lands.sort_unstable();
        assert_eq!(lands, [Some(0), Some(1), Some(2), Some(3)]);
        assert_eq!(guesser.next(&guesses, &done), Some(likeliest), "then what is likely otherwise");
    }
}
