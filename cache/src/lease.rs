//! The promise that nothing is evicted, for those who count on what they looked up.

use std::fs::File;
use std::io::{self, ErrorKind};

use crate::{Cache, Error, Result};

/// As long as anybody holds one, nothing is evicted: what was looked up stays. The system takes it back when the
/// process ends, however it ends.
#[must_use = "what was looked up stays only as long as this is held"]
#[derive(Debug)]
pub struct Lease {
    _file: Option<File>,
}

impl Cache {
    /// A lease, for one who counts on what this cache holds over many calls. Waits while something is being evicted; so
    /// whoever evicts must not ask for one meanwhile.
    ///
    /// # Errors
    /// If the lock's file cannot be used; in a folder that may not be written to there is nothing to evict.
    pub fn lease(&self) -> Result<Lease> {
        match self.locks.leasing() {
            Ok(file) => Ok(Lease { _file: Some(file) }),
            Err(Error::Storage { error, .. }) if is_forbidden(&error) => Ok(Lease { _file: None }),
            Err(error) => Err(error),
        }
    }
}

fn is_forbidden(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem)
}
