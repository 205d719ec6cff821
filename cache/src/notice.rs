//! What was found wrong with the cache and put right: for people to know, not for programs to act upon.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// One thing found wrong and put right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    pub path: PathBuf,
    pub fault: Fault,
}

/// What was wrong with a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A blob's bytes are not those that its name promises; it was removed.
    DamagedBlob,
    /// The system cannot read a file, for this reason; nothing was done about it.
    Unreadable(String),
    /// A record or history fails its seal; it was removed.
    DamagedRecord,
    /// A record promises a blob that is not there.
    MissingBlob,
    /// A stage's result is whole, but its reader cannot make sense of it; its record was removed.
    Undecodable { stage: String },
    /// What is none of ours stood where a file or folder of ours must be; it was moved to this path, not removed.
    MovedAside,
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.path.display())?;
        match &self.fault {
            Fault::DamagedBlob => f.write_str("damaged, removed; will be rebuilt"),
            Fault::Unreadable(why) => write!(f, "cannot be read: {why}"),
            Fault::DamagedRecord => f.write_str("damaged record, removed"),
            Fault::MissingBlob => f.write_str("missing or cut short; will be rebuilt"),
            Fault::Undecodable { stage } => {
                write!(f, "the cached result of stage {stage} cannot be decoded; it will be rebuilt")
            }
            Fault::MovedAside => f.write_str("stood where a cached file belongs, moved aside"),
        }
    }
}

/// Notices by path until they are taken, and the paths of those taken until their files are rebuilt.
#[derive(Debug, Default)]
pub(crate) struct Notices(Mutex<(BTreeMap<PathBuf, Fault>, BTreeSet<PathBuf>)>);

impl Notices {
    /// Adds a notice unless there was one of that file: a damaged blob, once removed, is missing as well.
    pub fn add(&self, path: PathBuf, fault: Fault) {
        let (pending, told) = &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if told.insert(path.clone()) {
            pending.insert(path, fault);
        }
    }

    /// The file is whole again; should it be damaged once more, that is news.
    pub fn mended(&self, path: &Path) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).1.remove(path);
    }

    pub fn take(&self) -> Vec<Notice> {
        let (pending, _) = &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner);
        std::mem::take(pending).into_iter().map(|(path, fault)| Notice { path, fault }).collect()
    }
}
