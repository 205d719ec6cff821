//! Names → bytes in a folder, through `object_store`, the one storage trait behind blobs, records and histories.
//!
//! It writes a file `NAME#1` beside the target and renames it, so a file is whole or absent; a writer that was killed
//! leaves its `NAME#1`, which nobody reads and `gc` sweeps. Outside an async runtime its local folder does its work
//! inline: `block_on` then polls a future once and never parks.

use std::fs::{self, File, FileTimes, Metadata};
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use bytes::Bytes;
use futures_executor::block_on;
use futures_util::TryStreamExt;
use object_store::local::LocalFileSystem;
use object_store::path::Path as Name;
use object_store::{ObjectStore, ObjectStoreExt, PutPayload};
use serde::{Serialize, de::DeserializeOwned};

use crate::error::io_kind;
use crate::{Error, Result};

/// The domain of the seal on records and histories.
const SEAL: &str = "genescape 2026 cache: seal 1";

#[derive(Debug)]
pub(crate) struct Store {
    objects: Box<dyn ObjectStore>,
    root: PathBuf,
}

/// A file in the store.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    /// Relative to the root, parts separated by `/`.
    pub name: String,
    pub bytes: u64,
    pub modified: SystemTime,
}

impl Store {
    pub fn open(root: &Path) -> Result<Self> {
        fs::create_dir_all(root).map_err(|source| Error::at("make the folder", root, source))?;
        let objects =
            LocalFileSystem::new_with_prefix(root).map_err(|source| Error::at("open", root, source))?;
        Ok(Self { objects: Box::new(objects), root: root.to_path_buf() })
    }

    pub fn root(&self) -> &Path {
        &self.root
    }

    pub fn path_of(&self, name: &str) -> PathBuf {
        self.root.join(name)
    }

    /// The file's bytes and when it was last changed; `None` if there is no such file.
    pub fn get(&self, name: &str) -> Result<Option<(Bytes, SystemTime)>> {
        let failed = |source| Error::at("read", &self.path_of(name), source);
        let found = match block_on(self.objects.get(&Name::from(name))) {
            Ok(found) => found,
            Err(object_store::Error::NotFound { .. }) => return Ok(None),
            // A file where a folder should be hides what should lie in the folder.
            Err(error) if io_kind(&error) == Some(io::ErrorKind::NotADirectory) => return Ok(None),
            Err(error) => return Err(failed(error)),
        };
        let modified = found.meta.last_modified.into();
        match block_on(found.bytes()) {
            Ok(bytes) => Ok(Some((bytes, modified))),
            // Replaced by a shorter file between opening and reading: impossible by rename, so it was cut short.
            Err(_) if self.metadata(name).is_none() => Ok(None),
            Err(error) => Err(failed(error)),
        }
    }

    /// Publishes `bytes` under `name`, replacing what was there.
    pub fn put(&self, name: &str, bytes: Bytes) -> Result<()> {
        let payload = PutPayload::from(bytes);
        block_on(self.objects.put(&Name::from(name), payload))
            .map(|_| ())
            .map_err(|source| Error::at("write", &self.path_of(name), source))
    }

    /// Removes a file; true if it was there.
    pub fn remove(&self, name: &str) -> Result<bool> {
        match block_on(self.objects.delete(&Name::from(name))) {
            Ok(()) => Ok(true),
            Err(object_store::Error::NotFound { .. }) => Ok(false),
            Err(source) => Err(Error::at("remove", &self.path_of(name), source)),
        }
    }

    /// All files under a folder, by name.
    pub fn list(&self, folder: &str) -> Result<Vec<Entry>> {
        let listed = block_on(self.objects.list(Some(&Name::from(folder))).try_collect::<Vec<_>>())
            .map_err(|source| Error::at("list", &self.path_of(folder), source))?;
        let mut entries: Vec<Entry> = listed
            .into_iter()
            .map(|meta| Entry {
                name: meta.location.to_string(),
                bytes: meta.size,
                modified: meta.last_modified.into(),
            })
            .collect();
        entries.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(entries)
    }

    /// What stands at `name`, if anything does.
    ///
    /// Straight from the file system: `ObjectStore::head` opens and closes the file and builds a URL and an etag on
    /// the way, and this is what an unchanged bake does for every blob.
    pub fn metadata(&self, name: &str) -> Option<Metadata> {
        fs::metadata(self.path_of(name)).ok()
    }

    /// Marks a file as used now. The trait has no such operation; a folder that cannot be written to needs none.
    pub fn touch(&self, name: &str) {
        let now = FileTimes::new().set_modified(SystemTime::now());
        let _ = File::options().append(true).open(self.path_of(name)).and_then(|file| file.set_times(now));
    }

    /// Moves something that is not a file out of the way of the file `name`; where to, if there was such a thing.
    pub fn move_aside(&self, name: &str) -> Result<Option<PathBuf>> {
        let path = self.path_of(name);
        if !fs::symlink_metadata(&path).is_ok_and(|meta| meta.is_dir()) || fs::remove_dir(&path).is_ok() {
            return Ok(None);
        }
        for n in 1.. {
            let aside = self.path_of(&format!("{name}.aside-{n}"));
            if fs::symlink_metadata(&aside).is_err() {
                fs::rename(&path, &aside).map_err(|source| Error::at("move aside", &path, source))?;
                return Ok(Some(aside));
            }
        }
        Ok(None)
    }

    /// Publishes a value as postcard behind a seal: a hash over its name and bytes.
    pub fn put_sealed<T: Serialize>(&self, name: &str, value: &T) -> Result<u64> {
        let failed = |source| Error::at("write", &self.path_of(name), source);
        let mut bytes = vec![0; 32];
        bytes = postcard::to_extend(value, bytes).map_err(failed)?;
        let seal = seal(name, &bytes[32..]);
        bytes[..32].copy_from_slice(&seal);
        let len = bytes.len() as u64;
        self.put(name, bytes.into())?;
        Ok(len)
    }

    /// A sealed value and when it was last changed; `Err(Broken)` inside if it fails its seal.
    pub fn get_sealed<T: DeserializeOwned>(&self, name: &str) -> Result<Sealed<T>> {
        let Some((bytes, modified)) = self.get(name)? else { return Ok(Sealed::Absent) };
        let value = bytes
            .split_at_checked(32)
            .filter(|(found, payload)| *found == seal(name, payload))
            .and_then(|(_, payload)| postcard::from_bytes(payload).ok());
        Ok(match value {
            Some(value) => Sealed::Whole(value, modified),
            None => Sealed::Broken,
        })
    }

    /// Files `NAME#n` under a folder that were last written before `before`: left by writers that were killed.
    pub fn abandoned(&self, folder: &str, before: SystemTime) -> Vec<PathBuf> {
        let mut found = Vec::new();
        let mut folders = vec![self.path_of(folder)];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
                let Ok(meta) = entry.metadata() else { continue };
                let name = entry.file_name();
                let suffix = name.to_str().and_then(|name| name.rsplit_once('#')).map(|(_, suffix)| suffix);
                let staged = suffix.is_some_and(|s| !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit()));
                if meta.is_dir() {
                    folders.push(entry.path());
                } else if staged && meta.modified().is_ok_and(|modified| modified < before) {
                    found.push(entry.path());
                }
            }
        }
        found.sort();
        found
    }
}

/// What was found under a name.
pub(crate) enum Sealed<T> {
    /// Nothing.
    Absent,
    /// Something that fails its seal.
    Broken,
    /// The value and when it was last changed.
    Whole(T, SystemTime),
}

fn seal(name: &str, payload: &[u8]) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new_derive_key(SEAL);
    hasher.update(&(name.len() as u64).to_le_bytes());
    hasher.update(name.as_bytes());
    hasher.update(payload);
    *hasher.finalize().as_bytes()
}
