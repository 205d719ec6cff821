//! Follows a person's work: bakes what they save, breeds what they vote for, until told to stop.
//!
//! - A population file that was saved is baked, even if nothing in it changed: to save it is to ask for its scenes.
//!   What was saved last comes first and becomes `current.ron`; what waited for it is baked after it, aside.
//! - A save during a bake ends that bake: what it has finished is kept, and the newer input is baked.
//! - Votes ask for a generation bred from them. As long as no population file says that it was bred from that
//!   generation by these votes (see [`genescape_schema::unanswered`]), a new file is, with the next free number. So an
//!   old generation can be voted on again, nothing is overwritten, and who starts late or twice breeds nothing twice.
//! - A mistake in a file is told and ends nothing.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use anyhow::{Context, Result, anyhow};
use genescape_schema::{Parent, names, unanswered};

use crate::events::{Event, Listener};
use crate::inputs::Inputs;
use crate::run::RunError;
use crate::session::{Baked, Session};
use crate::watch::Watch;

/// Some editors save by moving the old file away before they write the new one: a child that is gone for no longer
/// than this is not bred again.
const REPLACING: Duration = Duration::from_millis(250);

/// What to follow.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Only this population file, from whose votes nothing is bred; `None` for all of the world's.
    pub population: Option<PathBuf>,
    /// Look every half second, for folders that send no events.
    pub poll: bool,
}

/// Who is told how it goes, and says when to end. All of it but `stopped` is asked from the following thread alone.
pub trait Audience: Sync {
    /// Who hears of the next bake.
    fn listener(&self) -> Box<dyn Listener + '_>;
    /// Asked several times a second, from several threads: stop?
    fn stopped(&self) -> bool;
    /// A bake is done.
    fn baked(&self, _: &Baked) {}
    /// Something went wrong; it goes on nevertheless.
    fn failed(&self, error: &anyhow::Error);
    /// There is nothing to do until something is saved.
    fn waiting(&self) {}
}

/// Bakes the newest population, then what is saved, until `audience` says stop.
///
/// # Errors
/// If the folders cannot be watched; [`RunError::Cancelled`] if a bake was going on when the end came.
pub fn follow(session: &mut Session, options: &Options, audience: &dyn Audience) -> Result<()> {
    let watch = watch(session.world().root(), options)?;
    let mut follower = Follower::new(session, options.population.as_deref());
    loop {
        // From before the look on, lest a save after it be missed.
        let seen = watch.count();
        match follower.look(audience) {
            Ok(()) => {
                if let Some(path) = follower.next() {
                    match follower.bake(path, &watch, seen, audience) {
                        Err(error) if audience.stopped() => return Err(error),
                        Err(error) => audience.failed(&error),
                        Ok(()) => {}
                    }
                    continue;
                }
            }
            Err(error) => audience.failed(&error),
        }
        audience.waiting();
        if !watch.wait_beyond(seen, &|| audience.stopped()) {
            return Ok(());
        }
    }
}

fn watch(root: &Path, options: &Options) -> Result<Watch> {
    let mut folders = vec![root.to_owned(), root.join(names::POPULATIONS)];
    if let Some(folder) = options.population.as_deref().and_then(Path::parent) {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        if !folders.iter().any(|known| known == folder) {
            folders.push(folder.to_owned());
        }
    }
    Watch::new(&folders.iter().map(PathBuf::as_path).collect::<Vec<_>>(), options.poll)
}

struct Follower<'a> {
    session: &'a mut Session,
    only: Option<&'a Path>,
    /// What was there at the last look.
    known: Option<Inputs>,
    /// `space.ron` is as it should be.
    space_is_good: bool,
    /// Files to bake.
    due: BTreeSet<PathBuf>,
    /// What `current.ron` shows since we follow.
    shown: Option<PathBuf>,
}

impl<'a> Follower<'a> {
    fn new(session: &'a mut Session, only: Option<&'a Path>) -> Self {
        // The session has read the space.
        Self { session, only, known: None, space_is_good: true, due: BTreeSet::new(), shown: None }
    }

    fn read(&self, before: &Inputs) -> Result<Inputs> {
        Inputs::read(self.session.world().root(), self.only, before)
    }

    /// Finds out what was saved, breeds what is wanted, and notes what to bake.
    fn look(&mut self, audience: &dyn Audience) -> Result<()> {
        let nothing = Inputs::default();
        let before = self.known.as_ref().unwrap_or(&nothing);
        let mut now = self.read(before)?;
        if now.lacks_some_of(before) {
            std::thread::sleep(REPLACING);
            now = self.read(before)?;
        }
        let first = self.known.is_none();
        if !first && self.known.as_ref() == Some(&now) {
            return Ok(());
        }
        let space_changed = self.known.as_ref().is_some_and(|known| known.space != now.space);
        if space_changed {
            self.due.extend(self.shown.clone());
            let reloaded = self.session.world_mut().reload_space();
            self.space_is_good = reloaded.is_ok();
            if let Err(error) = reloaded {
                audience.failed(&error);
            }
        }
        if self.only.is_none() && self.space_is_good && self.breed(&now, audience) {
            now = self.read(&now)?;
        }
        if first {
            // What lay there before is not asked for, except the newest.
            let newest = match self.only {
                Some(only) => only.to_owned(),
                None => self.session.world().newest_population()?,
            };
            self.due.insert(newest);
        } else if let Some(known) = &self.known {
            self.due.extend(now.saved_since(known).cloned());
        }
        self.known = Some(now);
        Ok(())
    }

    /// Breeds every generation that is wanted and missing; true if there are new files.
    fn breed(&self, now: &Inputs, audience: &dyn Audience) -> bool {
        let wanted = unanswered(&now.lineages());
        for parent in &wanted {
            match self.breed_one(*parent, now) {
                Ok(Some(path)) => {
                    let path = path.display().to_string();
                    audience.listener().tell(&Event::Bred { parent: parent.generation, path });
                }
                // Another process was faster.
                Ok(None) => {}
                Err(error) => audience.failed(&error),
            }
        }
        !wanted.is_empty()
    }

    fn breed_one(&self, parent: Parent, known: &Inputs) -> Result<Option<PathBuf>> {
        const ATTEMPTS: usize = 3;
        let mut attempt = 1;
        loop {
            let wishes = |path: &&PathBuf| {
                known.populations[*path].lineage.and_then(|lineage| lineage.wanted()) == Some(parent)
            };
            let path = known.populations.keys().find(wishes);
            let path = path.ok_or_else(|| anyhow!("generation {} vanished", parent.generation))?;
            match self.session.breed_file(path) {
                Ok(child) => return Ok(Some(child)),
                // Two may breed at the same time; the number is then taken, and by a sibling if not by the child itself.
                Err(_) if !unanswered(&self.read(known)?.lineages()).contains(&parent) => return Ok(None),
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

    fn bake(&mut self, path: PathBuf, watch: &Watch, seen: u64, audience: &dyn Audience) -> Result<()> {
        let known = self.known.clone().unwrap_or_default();
        let (seen, newer) = (AtomicU64::new(seen), AtomicBool::new(false));
        let superseded = || {
            // Most events are of our own files: only a look says whether there is something newer.
            let count = watch.count();
            if seen.swap(count, Ordering::SeqCst) != count && self.read(&known).is_ok_and(|now| now != known)
            {
                newer.store(true, Ordering::SeqCst);
            }
            newer.load(Ordering::SeqCst)
        };
        let cancelled = || audience.stopped() || superseded();
        let listener = audience.listener();
        let shows = self.shown.as_ref().is_none_or(|shown| known.age(shown) <= known.age(&path));
        let result = match shows {
            true => self.session.bake_file(&path, &*listener, &cancelled),
            false => self.session.bake_aside(&path, &*listener, &cancelled),
        };
        match result {
            Err(error) if is_cancelled(&error) && !audience.stopped() => {
                listener.tell(&Event::Superseded);
                self.due.insert(path);
                Ok(())
            }
            result => {
                if shows {
                    self.shown = Some(path);
                }
                result.map(|baked| audience.baked(&baked))
            }
        }
    }
}

fn is_cancelled(error: &anyhow::Error) -> bool {
    matches!(error.downcast_ref(), Some(RunError::Cancelled))
}
