//! Waits until something that a person edits in the world folder has changed.
//!
//! Folders are watched, never files: an editor's atomic save replaces the file, and a watch on it would end there.
//! What changed is not trusted either, for an event can be lost: any event means "look at everything again".

use std::path::Path;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use anyhow::{Context, Result};
use notify_debouncer_full::notify::{Config, EventKind, PollWatcher, RecommendedWatcher, RecursiveMode};
use notify_debouncer_full::{DebounceEventResult, Debouncer, NoCache, new_debouncer_opt};

/// An editor's save is several events; they are gathered for this long, and never longer.
const SETTLE: Duration = Duration::from_millis(60);
/// How often a folder that sends no events (a network share) is looked at.
const POLL: Duration = Duration::from_millis(500);
/// How often a waiting thread looks up to see whether it should stop.
const LOOK_UP: Duration = Duration::from_millis(100);

/// The watch; ends when dropped.
pub struct Watch {
    signal: Arc<Signal>,
    _watcher: Keep,
}

/// Whichever kind of watcher runs: kept alive, never looked at.
#[expect(dead_code, reason = "holds the watcher's thread alive")]
enum Keep {
    Events(Debouncer<RecommendedWatcher, NoCache>),
    Polling(Debouncer<PollWatcher, NoCache>),
}

impl Watch {
    /// Watches the folders `dirs` (not what lies deeper). With `poll`, looks at them every half second instead of
    /// waiting for the system's events, for file systems that send none.
    pub fn new(dirs: &[&Path], poll: bool) -> Result<Self> {
        let signal = Arc::new(Signal::default());
        let heard = Arc::clone(&signal);
        let on_events = move |result: DebounceEventResult| {
            // Errors (an overflowing queue, say) mean lost events, so they count as a change, too.
            let changed = match result {
                Ok(events) => {
                    events.iter().any(|e| e.need_rescan() || !matches!(e.kind, EventKind::Access(_)))
                }
                Err(_) => true,
            };
            if changed {
                *heard.lock() += 1;
                heard.changed.notify_all();
            }
        };
        let no_watch = |dir: &Path| format!("cannot watch {}; try --poll", dir.display());
        let config = Config::default().with_poll_interval(POLL).with_compare_contents(true);
        let watcher = if poll {
            let mut debouncer = new_debouncer_opt(SETTLE, None, on_events, NoCache, config)?;
            for dir in dirs {
                debouncer.watch(dir, RecursiveMode::NonRecursive).with_context(|| no_watch(dir))?;
            }
            Keep::Polling(debouncer)
        } else {
            let mut debouncer = new_debouncer_opt(SETTLE, None, on_events, NoCache, config)?;
            for dir in dirs {
                debouncer.watch(dir, RecursiveMode::NonRecursive).with_context(|| no_watch(dir))?;
            }
            Keep::Events(debouncer)
        };
        Ok(Self { signal, _watcher: watcher })
    }

    /// How many times something changed since the watch began.
    pub fn count(&self) -> u64 {
        *self.signal.lock()
    }

    /// Blocks until [`Watch::count`] is not `seen`, or `stopped` says so; false then.
    pub fn wait_beyond(&self, seen: u64, stopped: &dyn Fn() -> bool) -> bool {
        let mut count = self.signal.lock();
        while *count == seen {
            if stopped() {
                return false;
            }
            let waited = self.signal.changed.wait_timeout(count, LOOK_UP);
            count = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        true
    }
}

/// A number that can be waited for.
#[derive(Default)]
struct Signal {
    count: Mutex<u64>,
    changed: Condvar,
}

impl Signal {
    fn lock(&self) -> MutexGuard<'_, u64> {
        self.count.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sees_an_atomic_save(poll: bool) {
        let dir = tempfile::tempdir().expect("a temporary folder");
        let file = dir.path().join("g0000.ron");
        std::fs::write(&file, "old").expect("written");
        let watch = Watch::new(&[dir.path()], poll).expect("watched");
        for text in ["new", "newer still"] {
            let draft = dir.path().join("draft~");
            std::fs::write(&draft, text).expect("written");
            let seen = watch.count();
            std::fs::rename(&draft, &file).expect("renamed");
            assert!(watch.wait_beyond(seen, &|| false), "every save is seen, not only the first");
        }
    }

    #[test]
    fn events_survive_an_editors_atomic_save() {
        sees_an_atomic_save(false);
    }

    #[test]
    fn polling_survives_an_editors_atomic_save() {
        sees_an_atomic_save(true);
    }
}
