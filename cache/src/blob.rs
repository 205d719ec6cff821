//! Bytes ↔ immutable files that are named by the digest of their bytes.

use serde::{Deserialize, Serialize};

use crate::{Bytes, Cache, Digest, Error, Fault, Output, Result};

/// Where some bytes are: `blobs/ab/ab12….EXT`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct BlobRef {
    pub digest: Digest,
    /// File extension without a dot, so that other programs know the file's kind.
    pub ext: String,
    /// Number of bytes.
    pub len: u64,
}

impl BlobRef {
    /// The blob that holds `bytes`, whether it exists or not.
    ///
    /// # Errors
    /// If `ext` is not one to eight lower-case letters and digits.
    pub fn of(bytes: &[u8], ext: &str) -> Result<Self> {
        Self::named(Digest::of(bytes), ext, bytes.len())
    }

    fn named(digest: Digest, ext: &str, len: usize) -> Result<Self> {
        if !is_plain(ext) {
            return Err(Error::Extension(ext.to_owned()));
        }
        Ok(Self { digest, ext: ext.to_owned(), len: len as u64 })
    }

    /// The file's path relative to the cache folder, separated by `/`.
    pub fn path(&self) -> String {
        let hex = self.digest.to_string();
        format!("blobs/{}/{hex}.{}", &hex[..2], self.ext)
    }

    /// The URI of the blob in a file that lies `folders` folders below the cache folder: 2 for
    /// `g0003/scene-0/scene.gltf`. It needs no escapes.
    pub fn uri(&self, folders: usize) -> String {
        "../".repeat(folders) + &self.path()
    }

    /// The blob of `len` bytes that a path names, if it is a blob's path.
    pub(crate) fn from_path(path: &str, len: u64) -> Option<Self> {
        let (folder, file) = path.strip_prefix("blobs/")?.split_once('/')?;
        let (hex, ext) = file.split_once('.')?;
        let digest = hex.parse().ok()?;
        let named = folder.len() == 2 && hex.starts_with(folder) && is_plain(ext);
        named.then(|| Self { digest, ext: ext.to_owned(), len })
    }
}

fn is_plain(ext: &str) -> bool {
    (1..=8).contains(&ext.len()) && ext.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit())
}

impl Cache {
    /// The bytes of a blob, verified; `None` if it is missing or damaged (then it is removed: build it again).
    ///
    /// # Errors
    /// If the file exists and cannot be read.
    pub fn get_blob(&self, blob: &BlobRef) -> Result<Option<Bytes>> {
        let path = blob.path();
        let Some((bytes, _)) = self.store.get(&path)? else { return Ok(None) };
        if Digest::of(&bytes) == blob.digest {
            return Ok(Some(bytes));
        }
        // In a folder that cannot be written to it stays, and is not served all the same.
        if let Ok(_nothing_is_published) = self.locks.removing() {
            match self.store.get(&path)? {
                Some((bytes, _)) if Digest::of(&bytes) != blob.digest => {
                    let _ = self.store.remove(&path);
                }
                // Another process has removed or mended it.
                _ => return Ok(None),
            }
        }
        self.notices.add(self.store.path_of(&path), Fault::DamagedBlob);
        Ok(None)
    }

    /// Whether a blob's file exists and has the right length; says nothing of what is in it.
    pub(crate) fn has_blob(&self, blob: &BlobRef) -> bool {
        self.store.metadata(&blob.path()).is_some_and(|meta| meta.is_file() && meta.len() == blob.len)
    }

    /// Stores bytes under their digest, while the caller keeps `gc` waiting. What stood there is replaced: it may be
    /// damaged.
    pub(crate) fn put_blob(&self, Output { ext, bytes, digest, .. }: &Output) -> Result<BlobRef> {
        let blob = BlobRef::named(digest.unwrap_or_else(|| Digest::of(bytes)), ext, bytes.len())?;
        self.publish_file(&blob.path(), bytes)?;
        Ok(blob)
    }

    /// Writes a file; if a folder stands in its way, moves that aside first.
    pub(crate) fn publish_file(&self, name: &str, bytes: &[u8]) -> Result<()> {
        self.store.put(name, bytes).or_else(|error| {
            if !self.store.metadata(name).is_some_and(|meta| meta.is_dir()) {
                return Err(error);
            }
            if let Some(aside) = self.store.move_aside(name)? {
                self.notices.add(aside, Fault::MovedAside);
            }
            self.store.put(name, bytes)
        })?;
        self.notices.mended(&self.store.path_of(name));
        Ok(())
    }
}
