//! Who builds what, who counts on what is there, and who may remove: locks between threads and processes.
//!
//! All are locks on files (`std::fs::File::lock`, one handle a holder, so threads exclude each other too). The system
//! releases them when a process ends, however it ends. There is a fixed number of lock files, which stay: to remove a
//! lock file safely takes a second lock.

use std::cell::Cell;
use std::fs::{File, TryLockError};
use std::io;
use std::marker::PhantomData;
use std::time::{Duration, Instant};

use crate::store::Store;
use crate::{Digest, Error, Result};

/// Files that builders lock. Two keys rarely share one; if they do, one waits without need.
const SLOTS: u16 = 1024;
/// Shared by those who publish; exclusive to one who removes.
const REMOVAL: &str = "locks/gc";
/// Shared by all who hold a lease; exclusive to one who evicts.
const LEASES: &str = "locks/leases";

thread_local! {
    /// How many turns this thread holds.
    static TURNS: Cell<usize> = const { Cell::new(0) };
}

#[derive(Debug)]
pub(crate) struct Locks {
    store: Store,
    /// How long to wait for another builder.
    pub patience: Duration,
}

/// The right to build, until dropped; by the thread that got it.
#[derive(Debug)]
pub(crate) struct Turn {
    _file: Option<File>,
    _not_send: PhantomData<*const ()>,
}

impl Drop for Turn {
    fn drop(&mut self) {
        TURNS.set(TURNS.get() - 1);
    }
}

impl Locks {
    pub fn new(store: Store) -> Self {
        Self { store, patience: Duration::from_secs(60) }
    }

    /// Waits for the turn to build `key`.
    ///
    /// Single flight saves work; it isn't needed for correct results. So no thread waits at any price: one that
    /// builds already (a thread pool gave it this task while it waited for parts of the other) does not wait, since
    /// the other builder may be waiting for it, and none waits longer than `patience`.
    pub fn turn(&self, key: Digest) -> Result<Turn> {
        let [a, b, ..] = *key.as_bytes();
        let name = format!("locks/{:03x}", u16::from_le_bytes([a, b]) % SLOTS);
        let file = self.open(&name)?;
        let patience = if TURNS.get() > 0 { Duration::ZERO } else { self.patience };
        let start = Instant::now();
        let held = self.wait(&name, &file, || start.elapsed() < patience)?;
        TURNS.set(TURNS.get() + 1);
        Ok(Turn { _file: held.then_some(file), _not_send: PhantomData })
    }

    /// Held while files are published: nothing is removed.
    pub fn publishing(&self) -> Result<File> {
        self.lock(REMOVAL, File::lock_shared)
    }

    /// Held while files are removed: nothing is published.
    pub fn removing(&self) -> Result<File> {
        self.lock(REMOVAL, File::lock)
    }

    /// Held by whoever counts on what is there: nothing is evicted.
    pub fn leasing(&self) -> Result<File> {
        self.lock(LEASES, File::lock_shared)
    }

    /// Held while things are evicted: nobody has a lease. `None` if `keep_waiting` said no before that was so.
    pub fn evicting(&self, keep_waiting: impl FnMut() -> bool) -> Result<Option<File>> {
        let file = self.open(LEASES)?;
        Ok(self.wait(LEASES, &file, keep_waiting)?.then_some(file))
    }

    fn lock(&self, name: &str, lock: impl Fn(&File) -> io::Result<()>) -> Result<File> {
        let file = self.open(name)?;
        match lock(&file) {
            Err(error) if !is_unsupported(&error) => Err(Error::at("lock", &self.store.path_of(name), error)),
            _ => Ok(file),
        }
    }

    /// Polls, since a blocking lock cannot be given up. True if the lock is held now.
    fn wait(&self, name: &str, file: &File, mut keep_waiting: impl FnMut() -> bool) -> Result<bool> {
        let mut pause = Duration::from_micros(200);
        loop {
            match file.try_lock() {
                Ok(()) => return Ok(true),
                Err(TryLockError::WouldBlock) if keep_waiting() => std::thread::sleep(pause),
                Err(TryLockError::WouldBlock) => return Ok(false),
                Err(TryLockError::Error(error)) if is_unsupported(&error) => return Ok(true),
                Err(TryLockError::Error(error)) => {
                    return Err(Error::at("lock", &self.store.path_of(name), error));
                }
            }
            pause = (pause * 2).min(Duration::from_millis(5));
        }
    }

    /// Opens a lock's file, which is made if need be; what else stands there, a link for instance, is moved aside.
    fn open(&self, name: &str) -> Result<File> {
        let path = self.store.path_of(name);
        self.store.make_way(name)?;
        let open = || File::options().create(true).truncate(false).write(true).open(&path);
        let file = open().or_else(|error| match error.kind() {
            io::ErrorKind::NotFound => {
                std::fs::create_dir_all(path.parent().unwrap_or(&path)).and_then(|()| open())
            }
            _ => Err(error),
        });
        file.map_err(|error| Error::at("write", &path, error))
    }
}

/// Some network folders have no locks; there, builders may do the same work twice and what is evicted in the midst of a
/// run is built again, and that is all.
fn is_unsupported(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::Unsupported
}

/// Whether that is the name of a lock's file.
pub(crate) fn is_lock(name: &str) -> bool {
    let slot = name.strip_prefix("locks/").filter(|slot| slot.len() == 3);
    let slot = slot.and_then(|slot| u16::from_str_radix(slot, 16).ok());
    [REMOVAL, LEASES].contains(&name) || slot.is_some_and(|slot| slot < SLOTS)
}
