//! What has been read from blobs and is still in use, by the blob's name.

use std::any::Any;
use std::collections::HashMap;
use std::io::ErrorKind;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use genescape_world::NamedFiles;

use super::{LoadError, Result};

/// Values by name. None is kept alive by it.
#[derive(Debug, Default)]
pub struct Store(Mutex<HashMap<String, Weak<dyn Any + Send + Sync>>>);

impl Store {
    fn values(&self) -> MutexGuard<'_, HashMap<String, Weak<dyn Any + Send + Sync>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The value of that name, made if none is in use.
    pub(super) fn get<T: Any + Send + Sync>(
        &self,
        name: &str,
        make: impl FnOnce() -> Result<T>,
    ) -> Result<Arc<T>> {
        let known = self.values().get(name).and_then(Weak::upgrade);
        if let Some(Ok(known)) = known.map(Arc::downcast) {
            return Ok(known);
        }
        let made = Arc::new(make()?);
        let mut values = self.values();
        values.retain(|_, value| value.strong_count() > 0);
        let weak: Weak<T> = Arc::downgrade(&made);
        values.insert(name.to_owned(), weak);
        Ok(made)
    }

    /// The bytes at `path`, which a scene names `uri`; verified against their name if that is a digest (a person's own
    /// files have other names).
    pub(super) fn bytes(&self, files: &NamedFiles, uri: &str, path: &Path) -> Result<Arc<Vec<u8>>> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        self.get(&format!("bytes of {name}"), || {
            files.read_uri(uri).map_err(|reason| match reason.kind() {
                ErrorKind::InvalidData => LoadError::Damaged { path: path.to_owned() },
                _ => LoadError::Unreadable { path: path.to_owned(), reason },
            })
        })
    }
}
