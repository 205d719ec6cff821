//! `bake --watch`: bakes what a person saves, breeds what they vote for, until told to stop.
//!
//! - A population file that was saved is baked, even if nothing in it changed: to save it is to ask for its scenes.
//!   What was saved last comes first and becomes `current.ron`; what waited for it is baked after it, aside.
//! - A save during a bake ends that bake: what it has finished is kept, and the newer input is baked.
//! - Votes ask for a generation bred from them. As long as no population file says that it was bred from that
//!   generation by these votes (see [`genescape_schema::unanswered`]), a new file is, with the next free number. So an
//!   old generation can be voted on again, nothing is overwritten, and a second watch breeds nothing twice.
//! - A mistake in a file is reported; the loop goes on.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::Duration;

use anyhow::{Context, Result, anyhow};
use genescape_schema::{Lineage, Parent, unanswered};
use genescape_world::{Change, Scope, Snapshot, Watch};

use crate::ahead::{self, Ahead};
use crate::events::{Event, Listener};
use crate::pedigree::Pedigree;
use crate::run::RunError;
use crate::session::{Baked, Publish, Session};

/// Some editors save by moving the old file away before they write the new one: a child that is gone for no longer
/// than this is not bred again.
const REPLACING: Duration = Duration::from_millis(250);
/// How often a waiting loop asks whether it should stop.
const STOP_CHECK: Duration = Duration::from_millis(100);

#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Only this population file, from whose votes nothing is bred; `None` for all of the world's.
    pub population: Option<PathBuf>,
    /// Look several times a second, for folders that send no events.
    pub poll: bool,
}

/// The program that the loop runs in. All of it but `stopped` is called from the loop's thread alone.
pub trait Host: Sync {
    /// For the next bake.
    fn listener(&self) -> Box<dyn Listener + '_>;
    /// Asked several times a second, from several threads: stop?
    fn stopped(&self) -> bool;
    fn baked(&self, _: &Baked) {}
    /// Something went wrong; the loop goes on nevertheless.
    fn failed(&self, error: &anyhow::Error);
    /// There is nothing to do until something is saved.
    fn waiting(&self) {}
    /// Whether, and how, to bake what may be voted for while there is nothing else to do.
    fn ahead(&self) -> Option<ahead::Options> {
        None
    }
}

/// Bakes the newest population, then what is saved, until `host` says stop.
///
/// # Errors
/// If the world cannot be watched; [`RunError::Cancelled`] if a bake was going on when the end came.
pub fn run(session: &mut Session, options: &Options, host: &dyn Host) -> Result<()> {
    let scope = Scope { population: options.population.clone(), ..Scope::of(session.world().clone()) };
    let (signals, this) = (Arc::new(AtomicU64::new(0)), thread::current());
    let wake = {
        let signals = Arc::clone(&signals);
        move || {
            signals.fetch_add(1, Ordering::SeqCst);
            this.unpark();
        }
    };
    let watch = Watch::start(scope.clone(), options.poll, wake)
        .with_context(|| format!("cannot watch {}", session.world().root().display()))?;
    // The session has read the space.
    let ahead = host.ahead().map(Ahead::new);
    let (due, shown) = (BTreeSet::new(), None);
    let mut state = State { session, host, scope, known: None, space_is_good: true, due, shown, ahead };
    loop {
        // Read before the look, so that no save after it is missed; the snapshot says what changed.
        let seen = signals.load(Ordering::SeqCst);
        watch.changes().for_each(drop);
        match state.look().map(|()| state.next()) {
            Ok(Some(path)) => {
                match state.bake(path, &signals, seen) {
                    Err(error) if host.stopped() => return Err(error),
                    Err(error) => host.failed(&error),
                    Ok(()) => {}
                }
                continue;
            }
            Ok(None) => {}
            Err(error) => host.failed(&error),
        }
        host.waiting();
        state.look_ahead();
        while signals.load(Ordering::SeqCst) == seen {
            if host.stopped() {
                return Ok(());
            }
            thread::park_timeout(STOP_CHECK);
        }
    }
}

struct State<'a> {
    session: &'a mut Session,
    host: &'a dyn Host,
    scope: Scope,
    /// What was there at the last look.
    known: Option<Snapshot>,
    space_is_good: bool,
    /// Files to bake.
    due: BTreeSet<PathBuf>,
    /// What this loop made current.
    shown: Option<PathBuf>,
    ahead: Option<Ahead>,
}

impl State<'_> {
    /// Finds out what was saved, breeds what is wanted, and notes what to bake.
    fn look(&mut self) -> Result<()> {
        let first = self.known.is_none();
        let known = self.known.clone().unwrap_or_default();
        let mut now = Snapshot::take(&self.scope, &known);
        if now.has_lost_since(&known) {
            thread::sleep(REPLACING);
            now = Snapshot::take(&self.scope, &known);
        }
        if self.scope.population.is_none() && now.populations().next().is_none() {
            // A folder that went away or cannot be read: when it is back, nothing of it was saved.
            self.session.world().newest_population()?;
        }
        if !first && now == known {
            return Ok(());
        }
        // What is asked for comes before what may be.
        self.ahead.iter_mut().for_each(Ahead::stop);
        if !first && now.changes_since(&known).contains(&Change::Space) {
            self.due.extend(self.shown.clone());
            let reloaded = self.session.reload_space();
            self.space_is_good = reloaded.is_ok();
            if let Err(error) = reloaded {
                self.host.failed(&error);
            }
        }
        if self.scope.population.is_none() && self.space_is_good && self.breed(&now) {
            now = Snapshot::take(&self.scope, &now);
        }
        if first {
            // What lay there before is not asked for, except the newest.
            let only = self.scope.population.clone();
            self.due.insert(only.map_or_else(|| self.session.world().newest_population(), Ok)?);
        } else {
            self.due.extend(now.saved_since(&known).cloned());
        }
        self.known = Some(now);
        Ok(())
    }

    /// Breeds every generation that is wanted and missing; true if there are new files.
    fn breed(&self, now: &Snapshot) -> bool {
        let wanted = wanted(now);
        for parent in &wanted {
            match self.breed_one(*parent, now) {
                Ok(Some(path)) => {
                    let path = path.display().to_string();
                    self.host.listener().tell(&Event::Bred { parent: parent.generation, path });
                }
                // Another process was faster.
                Ok(None) => {}
                Err(error) => self.host.failed(&error),
            }
        }
        !wanted.is_empty()
    }

    fn breed_one(&self, parent: Parent, known: &Snapshot) -> Result<Option<PathBuf>> {
        const ATTEMPTS: usize = 3;
        let mut attempt = 1;
        loop {
            let path = known.lineages().find(|(_, lineage)| lineage.wanted() == Some(parent));
            let (path, _) = path.ok_or_else(|| anyhow!("generation {} vanished", parent.generation))?;
            let guessed =
                |pedigree: &Pedigree| self.ahead.as_ref().and_then(|ahead| ahead.children(pedigree));
            match self.session.breed_file(path, &*self.host.listener(), guessed) {
                Ok(child) => return Ok(Some(child)),
                // Two may breed at the same time; the number is then taken, and by a sibling if not by the child itself.
                Err(_) if !wanted(&Snapshot::take(&self.scope, known)).contains(&parent) => return Ok(None),
                Err(error) if attempt == ATTEMPTS => {
                    return Err(error)
                        .with_context(|| format!("cannot breed from generation {}", parent.generation));
                }
                Err(_) => attempt += 1,
            }
        }
    }

    /// Of the files to bake, the one that was saved last.
    fn next(&mut self) -> Option<PathBuf> {
        let known = self.known.as_ref().filter(|_| self.space_is_good)?;
        let next = self.due.iter().max_by_key(|path| known.age(path))?.clone();
        self.due.remove(&next);
        Some(next)
    }

    fn bake(&mut self, path: PathBuf, signals: &AtomicU64, seen: u64) -> Result<()> {
        let (host, scope, known) = (self.host, &self.scope, self.known.clone().unwrap_or_default());
        let (seen, newer) = (AtomicU64::new(seen), AtomicBool::new(false));
        let superseded = || {
            // It may be our own new child: only a look says whether there is something newer.
            let count = signals.load(Ordering::SeqCst);
            if seen.swap(count, Ordering::SeqCst) != count && Snapshot::take(scope, &known) != known {
                newer.store(true, Ordering::SeqCst);
            }
            newer.load(Ordering::SeqCst)
        };
        let cancelled = || host.stopped() || superseded();
        let listener = host.listener();
        let is_newest = self.shown.as_ref().is_none_or(|shown| known.age(shown) <= known.age(&path));
        let publish = if is_newest { Publish::AsCurrent } else { Publish::Aside };
        match self.session.bake_file(&path, publish, &*listener, &cancelled) {
            Err(error) if is_cancelled(&error) && !host.stopped() => {
                listener.tell(&Event::Superseded);
                self.due.insert(path);
                Ok(())
            }
            result => {
                if is_newest {
                    self.shown = Some(path);
                }
                let baked = result?;
                self.ahead.iter().for_each(|ahead| ahead.keep(&baked.actions));
                host.baked(&baked);
                Ok(())
            }
        }
    }

    /// Guesses what will be voted for, in the background.
    fn look_ahead(&mut self) {
        let (Some(ahead), Some(shown)) = (&mut self.ahead, &self.shown) else { return };
        if let Err(error) = ahead.begin(self.session, shown) {
            self.host.failed(&error);
        }
    }
}

/// Generations that votes ask for and that are not there.
fn wanted(snapshot: &Snapshot) -> Vec<Parent> {
    let lineages: Vec<Lineage> = snapshot.lineages().map(|(_, lineage)| lineage).collect();
    unanswered(&lineages)
}

fn is_cancelled(error: &anyhow::Error) -> bool {
    matches!(error.downcast_ref(), Some(RunError::Cancelled))
}
