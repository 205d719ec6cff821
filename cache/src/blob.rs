//! Bytes ↔ immutable files that are named by the digest of their bytes.

use bytes::Bytes;
use serde::{Deserialize, Serialize};

use crate::{Cache, Digest, Error, Notice, Result};

/// Where some bytes are: `blobs/ab/ab12….EXT`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct BlobRef {
    /// Of the bytes.
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
        let plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit();
        if ext.is_empty() || ext.len() > 8 || !ext.bytes().all(plain) {
            return Err(Error::Extension(ext.to_owned()));
        }
        Ok(Self { digest: Digest::of(bytes), ext: ext.to_owned(), len: bytes.len() as u64 })
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

    /// The digest and extension that a path names, if it is a blob's path.
    pub(crate) fn parse_path(path: &str) -> Option<(Digest, &str)> {
        let (folder, file) = path.strip_prefix("blobs/")?.split_once('/')?;
        let (hex, ext) = file.split_once('.')?;
        let digest = hex.parse().ok()?;
        (hex.starts_with(folder) && folder.len() == 2 && !ext.contains(['.', '/'])).then_some((digest, ext))
    }
}

impl Cache {
    /// Stores bytes under their digest. Anything that stood there is replaced: it may be damaged.
    ///
    /// # Errors
    /// If the extension is not plain or the folder cannot be written to.
    pub fn put_blob(&self, bytes: impl Into<Bytes>, ext: &str) -> Result<BlobRef> {
        let _gc_waits = self.locks.publishing()?;
        self.write_blob(bytes.into(), ext)
    }

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
        self.discard_damaged(&path, blob.digest)?;
        Ok(None)
    }

    /// Whether a blob's file exists and has the right length. One system call; says nothing of what is in it.
    pub fn has_blob(&self, blob: &BlobRef) -> bool {
        self.store.metadata(&blob.path()).is_some_and(|meta| meta.is_file() && meta.len() == blob.len)
    }

    /// As `put_blob`, while the caller keeps `gc` waiting.
    pub(crate) fn write_blob(&self, bytes: Bytes, ext: &str) -> Result<BlobRef> {
        let blob = BlobRef::of(&bytes, ext)?;
        self.write_over(&blob.path(), |path| self.store.put(path, bytes.clone()))?;
        Ok(blob)
    }

    /// Runs `write`; if a folder stands in its way, moves that aside and runs it again.
    pub(crate) fn write_over<T>(&self, path: &str, write: impl Fn(&str) -> Result<T>) -> Result<T> {
        let written = write(path).or_else(|error| {
            if !self.store.metadata(path).is_some_and(|meta| meta.is_dir()) {
                return Err(error);
            }
            if let Some(aside) = self.store.move_aside(path)? {
                self.notices.add(Notice::MovedAside(aside));
            }
            write(path)
        })?;
        self.notices.mended(&self.store.path_of(path));
        Ok(written)
    }

    /// Removes a blob that is still damaged when nobody else writes; tells so if this call did it.
    pub(crate) fn discard_damaged(&self, path: &str, digest: Digest) -> Result<()> {
        let notice = Notice::DamagedBlob(self.store.path_of(path));
        // In a folder that cannot be written to, it stays: it is not served all the same.
        let Ok(_nobody_writes) = self.locks.removing() else {
            self.notices.add(notice);
            return Ok(());
        };
        let Some((bytes, _)) = self.store.get(path)? else { return Ok(()) };
        if Digest::of(&bytes) != digest {
            let _ = self.store.remove(path);
            self.notices.add(notice);
        }
        Ok(())
    }
}
