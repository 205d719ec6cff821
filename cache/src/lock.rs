//! Who builds what, and who may remove: locks between threads and processes.
//!
//! All are locks on files (`std::fs::File::lock`, one handle a holder, so threads exclude each other too). The system
//! releases them when a process ends, however it ends. There is a fixed number of lock files, which stay: to remove a
//! lock file safely takes a second lock.

use std::cell::Cell;
use std::fs::{File, TryLockError};
use std::io;
use std::marker::PhantomData;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::{Digest, Error, Result};

/// Files that builders lock. Two keys rarely share one; if they do, one waits without need.
const SLOTS: u16 = 1024;

thread_local! {
    /// How many turns this thread holds.
    static TURNS: Cell<usize> = const { Cell::new(0) };
}

#[derive(Debug)]
pub(crate) struct Locks {
    folder: PathBuf,
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
    pub fn new(folder: PathBuf) -> Self {
        Self { folder, patience: Duration::from_secs(60) }
    }

    /// Waits for the turn to build `key`.
    ///
    /// Single flight saves work; it isn't needed for correct results. So no thread waits at any price: one that
    /// builds already (a thread pool gave it this task while it waited for parts of the other) does not wait, since
    /// the other builder may be waiting for it, and none waits longer than `patience`.
    pub fn turn(&self, key: Digest) -> Result<Turn> {
        let [a, b, ..] = *key.as_bytes();
        let slot = u16::from_le_bytes([a, b]) % SLOTS;
        let path = self.folder.join(format!("{slot:03x}"));
        let file = self.open(&path)?;
        let patience = if TURNS.get() > 0 { Duration::ZERO } else { self.patience };
        let held = wait(&file, patience).map_err(|source| Error::at("lock", &path, source))?;
        TURNS.set(TURNS.get() + 1);
        Ok(Turn { _file: held.then_some(file), _not_send: PhantomData })
    }

    /// Held while files are published or marked as used: keeps `gc` from removing them at that moment.
    pub fn publishing(&self) -> Result<File> {
        self.lock_gc(File::lock_shared)
    }

    /// Held while files are removed: nothing is published.
    pub fn removing(&self) -> Result<File> {
        self.lock_gc(File::lock)
    }

    fn lock_gc(&self, lock: impl Fn(&File) -> io::Result<()>) -> Result<File> {
        let path = self.folder.join("gc");
        let file = self.open(&path)?;
        unless_unsupported(lock(&file)).map_err(|source| Error::at("lock", &path, source))?;
        Ok(file)
    }

    fn open(&self, path: &Path) -> Result<File> {
        let open = || File::options().create(true).truncate(false).write(true).open(path);
        let file = open().or_else(|error| match error.kind() {
            io::ErrorKind::NotFound => std::fs::create_dir_all(&self.folder).and_then(|()| open()),
            _ => Err(error),
        });
        file.map_err(|source| Error::at("write", path, source))
    }
}

/// Polls, since a blocking lock cannot be given up. True if the lock is held now.
fn wait(file: &File, patience: Duration) -> io::Result<bool> {
    let start = Instant::now();
    let mut pause = Duration::from_micros(200);
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(true),
            Err(TryLockError::WouldBlock) if start.elapsed() >= patience => return Ok(false),
            Err(TryLockError::WouldBlock) => std::thread::sleep(pause),
            Err(TryLockError::Error(error)) => return unless_unsupported(Err(error)).map(|()| false),
        }
        pause = (pause * 2).min(Duration::from_millis(5));
    }
}

/// Some network folders have no locks; there, builders may do the same work twice, and that is all.
fn unless_unsupported(result: io::Result<()>) -> io::Result<()> {
    result.or_else(|error| if error.kind() == io::ErrorKind::Unsupported { Ok(()) } else { Err(error) })
}
