//! Bytes by digest, results by action key: a disposable store of what was computed before, in one folder, shared by
//! any number of threads and processes. It knows nothing of what it stores.
//!
//! The words are those of Bazel's remote execution API:
//!
//! - A **blob** is a file named by the [`Digest`] (BLAKE3) of its bytes, so it never changes; a [`BlobRef`] says where.
//! - An **action** is one run of a pure function on known inputs. Its [`ActionKey`] is the digest of everything that
//!   the result may depend on: stage name, stage version, parameters, digests of the inputs.
//! - An [`ActionRecord`] says which blobs the action with that key produced, and what they cost.
//! - A **hit** is a record whose blobs all exist; all else is a **miss**, after which the action is run again.
//!
//! ```text
//! baked/blobs/ab/ab12….png     immutable, verified whenever it is read
//! baked/actions/ab34…          one sealed record for each action key
//! baked/history/SCOPE.keys     the keys of a scope's last run, from which `explain` says what changed
//! baked/locks/                 empty files: who builds what, who counts on what is there, who cleans up
//! baked/staged/                files being written
//! ```
//!
//! All of it is one local folder. A store that machines share comes later, behind a feature, in the place of `store.rs`.
//!
//! What it promises:
//!
//! - *Nothing damaged is served.* A blob is hashed when read, and when somebody wrote to its file since it was last
//!   hashed: the file's modification time tells, which is a mark made of the digest as long as nobody did. (Bytes that
//!   were changed under the old time and length are found when read, or by [`Cache::verify`].) Records and histories
//!   carry a seal. What fails is removed, rebuilt, and reported once ([`Cache::take_notices`]).
//! - *Nothing half-written is seen.* All files are published by rename. None is synced to disk: a power cut may
//!   damage them, which is the case above.
//! - *Work is done once.* Threads and processes that want the same action wait for the one that builds it
//!   ([`Cache::get_or_build`]); if that one dies, another takes over.
//! - *Nothing in use goes.* [`Gc::evict`] removes the least recently used, never what the caller names as a root or what
//!   that was made from, and only while nobody holds a [`Lease`].
//! - *What is none of ours stays.* It is left alone, or moved aside if it stands where a file of ours must be; links are
//!   not followed.

mod action;
mod blob;
mod digest;
mod error;
mod gc;
mod history;
mod key;
mod lease;
mod lock;
mod notice;
mod sealed;
mod store;
mod upkeep;

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

pub use action::{ActionRecord, How, Outcome, Output};
pub use blob::{BlobRef, verified};
pub use digest::{Digest, ParseDigestError};
pub use error::{Error, Result};
pub use gc::{Gc, GcReport};
pub use history::{Change, Explanation, History};
pub use key::{ActionKey, KeyFields};
pub use lease::Lease;
pub use notice::{Fault, Notice};
pub use upkeep::{StageStats, Stats, VerifyReport};

/// A buffer that is cheap to clone and comes from a `Vec` without a copy.
pub type Bytes = Arc<Vec<u8>>;

/// A cache folder. Cheap to open; one may be shared by all threads, and any number may be open on one folder.
#[derive(Debug)]
pub struct Cache {
    store: store::Store,
    locks: lock::Locks,
}

impl Cache {
    /// Opens the cache in `root` (`world/baked`), which is made if it does not exist. A folder that cannot be
    /// written to can be opened and read; the error comes with the first thing to be stored.
    ///
    /// # Errors
    /// If `root` is neither a folder nor can be made one.
    pub fn open(root: impl AsRef<Path>) -> Result<Self> {
        let store = store::Store::open(root.as_ref())?;
        let locks = lock::Locks::new(store.clone());
        Ok(Self { store, locks })
    }

    /// The same cache, but a thread that waits for another's build does it itself after `patience` (default: a
    /// minute): no suspended process and no cycle of waiting threads can hold up a bake for longer.
    #[must_use]
    pub fn with_patience(mut self, patience: Duration) -> Self {
        self.locks.patience = patience;
        self
    }

    /// What was found missing or damaged since the last call: for the caller to print. Each is reported once.
    pub fn take_notices(&self) -> Vec<Notice> {
        self.notices().take()
    }

    fn notices(&self) -> &notice::Notices {
        &self.store.notices
    }
}
