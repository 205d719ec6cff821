//! Watches a world, or some files, and reports what changed.
//!
//! Folders are watched, never files: an atomic save replaces the file, and a watch on it would end there. Events may
//! be lost, or come before their folder is watched; so an event is only the occasion to take another snapshot, and what
//! differs from the last one is what changed. Folders that send no events are simply looked at more often.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryIter, channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use notify_debouncer_full::notify::{Config, EventKind, RecommendedWatcher, RecursiveMode};
use notify_debouncer_full::{DebounceEventResult, Debouncer, NoCache, new_debouncer_opt};

use crate::snapshot::{Change, Scope, Snapshot};

/// An editor's save is several events; they are gathered for this long, and never longer.
const SETTLE: Duration = Duration::from_millis(20);
/// How often a folder that sends no events is looked at.
const POLL: Duration = Duration::from_millis(300);
/// How often one is looked at that should send events: some systems lose them without a word.
const DOUBT: Duration = Duration::from_secs(3);

/// A watch on a world. Dropped, it ends.
pub struct Watch {
    changes: Receiver<Change>,
    hints: Sender<Hint>,
    thread: Option<JoinHandle<()>>,
}

/// What the watching thread reacts to.
enum Hint {
    Look,
    End,
}

impl Watch {
    /// Watches a world, whose folder is made if it is not there, or files. What is there already is not reported.
    /// `wake` is called when there is something new in [`Watch::changes`]. With `poll`, or where the system has no
    /// watches left, folders are looked at several times a second.
    ///
    /// # Errors
    /// If the folder can be neither found nor made, or the system gives no thread.
    pub fn start(scope: Scope, poll: bool, wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        Self::start_in_doubt(scope, poll, DOUBT, wake)
    }

    fn start_in_doubt(
        scope: Scope,
        poll: bool,
        doubt: Duration,
        wake: impl Fn() + Send + 'static,
    ) -> io::Result<Self> {
        if let Some(world) = &scope.world {
            fs::create_dir_all(world.root())?;
        }
        let (sender, changes) = channel();
        let (hints, hinted) = channel();
        let events = if poll { None } else { events(hints.clone()) };
        let mut observer = Observer { scope, events, watched: BTreeSet::new(), seen: Snapshot::default() };
        observer.look();
        let thread = thread::Builder::new()
            .name("world watch".into())
            .spawn(move || observer.run(&hinted, doubt, &sender, &wake))?;
        Ok(Self { changes, hints, thread: Some(thread) })
    }

    /// What changed since the last call. Never waits. The same change may be told more often than it happened, never
    /// less often than once after it.
    pub fn changes(&self) -> TryIter<'_, Change> {
        self.changes.try_iter()
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = self.hints.send(Hint::End);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Sends a hint whenever the system reports a change.
fn events(hints: Sender<Hint>) -> Option<Debouncer<RecommendedWatcher, NoCache>> {
    let heard = move |result: DebounceEventResult| {
        // An error, an overflowing queue for instance, means lost events. Reading is no change.
        let changed = result.map_or(true, |events| {
            events.iter().any(|event| event.need_rescan() || !matches!(event.kind, EventKind::Access(_)))
        });
        if changed {
            let _ = hints.send(Hint::Look);
        }
    };
    new_debouncer_opt(SETTLE, None, heard, NoCache, Config::default()).ok()
}

/// Takes one snapshot after the other, and watches the folders that have come.
struct Observer {
    scope: Scope,
    /// `None` when looking often has to do.
    events: Option<Debouncer<RecommendedWatcher, NoCache>>,
    watched: BTreeSet<PathBuf>,
    seen: Snapshot,
}

impl Observer {
    fn run(mut self, hints: &Receiver<Hint>, doubt: Duration, sender: &Sender<Change>, wake: &dyn Fn()) {
        loop {
            match hints.recv_timeout(if self.events.is_some() { doubt } else { POLL }) {
                Ok(Hint::Look) | Err(RecvTimeoutError::Timeout) => {}
                Ok(Hint::End) | Err(RecvTimeoutError::Disconnected) => return,
            }
            let changes = self.look();
            for &change in &changes {
                // Nothing listens only when the watch is being dropped.
                let _ = sender.send(change);
            }
            if !changes.is_empty() {
                wake();
            }
        }
    }

    /// What changed since the last look.
    fn look(&mut self) -> BTreeSet<Change> {
        let mut now = Snapshot::take(&self.scope, &self.seen);
        // What came into a new folder before it was watched is found by looking once more.
        while self.watch(&now.folders) {
            now = Snapshot::take(&self.scope, &self.seen);
        }
        let changes = now.changes_since(&self.seen);
        self.seen = now;
        changes
    }

    /// Watches exactly these folders; true if there are new ones among them.
    fn watch(&mut self, folders: &BTreeSet<PathBuf>) -> bool {
        let Some(events) = &mut self.events else { return false };
        for gone in self.watched.difference(folders) {
            // It mostly ended by itself when the folder went.
            let _ = events.unwatch(gone);
        }
        let new: Vec<_> = folders.difference(&self.watched).collect();
        for folder in &new {
            if events.watch(folder, RecursiveMode::NonRecursive).is_err() && folder.is_dir() {
                // The system has no more to give.
                self.events = None;
                return false;
            }
        }
        let has_new = !new.is_empty();
        self.watched.clone_from(folders);
        has_new
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atomic_write::replace;
    use crate::folder::World;
    use crate::names;

    fn scope(root: PathBuf) -> Scope {
        Scope { scenes: true, ..Scope::of(World::new(root)) }
    }

    /// Waits until all of `expected` were told; what else is told is returned.
    fn told(watch: &Watch, expected: &[Change]) -> BTreeSet<Change> {
        let (mut missing, mut others) = (BTreeSet::from_iter(expected.iter().copied()), BTreeSet::new());
        while !missing.is_empty() {
            let change = watch.changes.recv_timeout(Duration::from_secs(20));
            let change = change.unwrap_or_else(|_| panic!("{missing:?} is not told"));
            if !missing.remove(&change) && !expected.contains(&change) {
                others.insert(change);
            }
        }
        others
    }

    fn tells_everything(poll: bool) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (root, shaders) = (folder.path().join("world"), folder.path().join("shaders"));
        fs::create_dir(&shaders).expect("a folder");
        let scope = Scope { shaders: Some(shaders.clone()), ..scope(root.clone()) };
        // Without the looks that lost events call for: here none are lost.
        let watch = Watch::start_in_doubt(scope, poll, Duration::MAX, || {}).expect("watched");
        let put = |name: String, text: &str| replace(&root.join(name), text).expect("saved");

        // Folders come with their first files.
        let scene = |generation, index| Change::Scene { generation, index };
        put(names::population(0), "one");
        put(names::scene(0, 2), "a scene");
        put(names::CURRENT.into(), "now");
        let others = told(&watch, &[Change::Population(0), scene(0, 2), Change::Current]);
        assert!(others.is_empty(), "{others:?}");
        // Every atomic save is told, not only the first, and in folders that came later, too.
        for text in ["two", "six"] {
            put(names::population(0), text);
            told(&watch, &[Change::Population(0)]);
            put(names::scene(0, 2), text);
            told(&watch, &[scene(0, 2)]);
        }
        put(names::scene(7, 1), "a scene");
        put(names::SPACE.into(), "space");
        fs::write(shaders.join("sky.wgsl"), "fn sky() {}").expect("written");
        told(&watch, &[scene(7, 1), Change::Space, Change::Shaders]);
        fs::remove_dir_all(root.join("baked/g0000")).expect("removed");
        told(&watch, &[scene(0, 2)]);
        put(names::scene(0, 2), "back again");
        told(&watch, &[scene(0, 2)]);
    }

    #[test]
    fn events_tell_everything() {
        tells_everything(false);
    }

    #[test]
    fn looking_often_tells_everything() {
        tells_everything(true);
    }

    #[test]
    fn what_lies_there_already_is_not_told() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let root = folder.path().to_owned();
        replace(&root.join(names::population(3)), "old").expect("saved");
        let watch = Watch::start(scope(root.clone()), false, || {}).expect("watched");
        replace(&root.join(names::SPACE), "new").expect("saved");
        assert!(told(&watch, &[Change::Space]).is_empty());
    }
}
