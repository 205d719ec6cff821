//! Waits until something that a person edits in the world folder has changed.
//!
//! Folders are watched, never files: an editor's atomic save replaces the file, and a watch on it would end there.
//! What changed is not trusted either, for an event can be lost: any event means "look at everything again", which
//! costs a bake where nothing changed, a few milliseconds.

use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use anyhow::{Context, Result};
use notify_debouncer_full::notify::{Config, EventKind, PollWatcher, RecommendedWatcher, RecursiveMode};
use notify_debouncer_full::{DebounceEventResult, Debouncer, NoCache, new_debouncer_opt};

/// An editor's save is several events; they are gathered for this long, and never longer.
const SETTLE: Duration = Duration::from_millis(60);
/// How often a folder that sends no events (a network share) is looked at.
const POLL: Duration = Duration::from_millis(500);

/// The watch; ends when dropped.
pub struct Watch {
    changes: Receiver<()>,
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
        let (sender, changes) = channel();
        let on_events = move |result: DebounceEventResult| {
            // Errors (an overflowing queue, say) mean lost events, so they count as a change, too.
            let changed = match result {
                Ok(events) => events.iter().any(|e| e.need_rescan() || !matches!(e.kind, EventKind::Access(_))),
                Err(_) => true,
            };
            if changed {
                // The receiver is gone only when the watch is being dropped.
                let _ = sender.send(());
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
        Ok(Self { changes, _watcher: watcher })
    }

    /// Blocks until something changed, or `stopped` says so; false then.
    pub fn wait(&self, stopped: &dyn Fn() -> bool) -> bool {
        loop {
            match self.changes.recv_timeout(Duration::from_millis(100)) {
                Ok(()) => {
                    while self.changes.try_recv().is_ok() {}
                    return true;
                }
                Err(RecvTimeoutError::Timeout) if stopped() => return false,
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return false,
            }
        }
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
            std::fs::rename(&draft, &file).expect("renamed");
            assert!(watch.wait(&|| false), "every save is seen, not only the first");
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
