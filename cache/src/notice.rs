//! What was found wrong with the cache and put right: for people to know, not for programs to act upon.

use std::collections::BTreeSet;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// One thing found wrong.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Notice {
    /// A blob's bytes are not those that its name promises; it was removed.
    DamagedBlob(PathBuf),
    /// A record or history that fails its seal; it was removed.
    DamagedRecord(PathBuf),
    /// A record promises a blob that is not there.
    MissingBlob(PathBuf),
    /// Something else stood where a file must be; it was moved, not removed.
    MovedAside(PathBuf),
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DamagedBlob(path) => write!(f, "{}: damaged, removed; will be rebuilt", path.display()),
            Self::DamagedRecord(path) => write!(f, "{}: damaged record, removed", path.display()),
            Self::MissingBlob(path) => write!(f, "{}: missing or cut short; will be rebuilt", path.display()),
            Self::MovedAside(path) => {
                write!(f, "{}: stood where a cached file belongs, moved aside", path.display())
            }
        }
    }
}

impl Notice {
    fn path(&self) -> &PathBuf {
        match self {
            Self::DamagedBlob(p) | Self::DamagedRecord(p) | Self::MissingBlob(p) | Self::MovedAside(p) => p,
        }
    }
}

/// Notices nobody has taken yet, and the files told about that nobody has rebuilt yet.
#[derive(Debug, Default)]
pub(crate) struct Notices(Mutex<(BTreeSet<Notice>, BTreeSet<PathBuf>)>);

impl Notices {
    /// Tells, unless that file was told about already: a damaged blob, once removed, is missing as well.
    pub fn add(&self, notice: Notice) {
        let (pending, told) = &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if told.insert(notice.path().clone()) {
            pending.insert(notice);
        }
    }

    /// The file is whole again; should it be damaged once more, that is news.
    pub fn mended(&self, path: &Path) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).1.remove(path);
    }

    pub fn take(&self) -> Vec<Notice> {
        let (pending, _) = &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner);
        std::mem::take(pending).into_iter().collect()
    }
}
