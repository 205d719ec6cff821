//! Bytes ↔ immutable files that are named by the digest of their bytes.

use std::path::Path;
use std::time::{Duration, SystemTime};

use serde::{Deserialize, Serialize};

use crate::{Bytes, Cache, Digest, Error, Fault, Output, Result};

/// The first of January 2000, in seconds since 1970.
const YEAR_2000_S: u64 = 946_684_800;

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

    /// The modification time of the blob's file. It is no date but a mark: these bytes were verified, and nobody has
    /// written to the file since, which would set the time. Made of the digest, so that a file which was put in
    /// another's place doesn't carry its mark; in even seconds, which every file system can hold.
    fn mark(&self) -> SystemTime {
        let [a, b, c, ..] = *self.digest.as_bytes();
        let own_s = 2 * u64::from(u32::from_le_bytes([a, b, c, 0]));
        SystemTime::UNIX_EPOCH + Duration::from_secs(YEAR_2000_S + own_s)
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
        let found = self.read_blob(blob)?;
        if found.is_some() || self.store.file(&path).is_none() {
            return Ok(found);
        }
        // In a folder that cannot be written to it stays, and is not served all the same.
        if let Ok(_nothing_is_published) = self.locks.removing() {
            // Another process may have mended or removed it in the meantime.
            let found = self.read_blob(blob)?;
            if found.is_some() || self.store.file(&path).is_none() {
                return Ok(found);
            }
            let _ = self.store.remove(&path);
        }
        self.notices().add(self.store.path_of(&path), Fault::DamagedBlob);
        Ok(None)
    }

    /// The bytes of a blob if they are right, which is then marked.
    fn read_blob(&self, blob: &BlobRef) -> Result<Option<Bytes>> {
        let found = self.store.get(&blob.path())?.filter(|(bytes, _)| Digest::of(bytes) == blob.digest);
        let unmarked = found.as_ref().is_some_and(|(_, modified)| *modified != blob.mark());
        if unmarked {
            self.store.set_modified(&blob.path(), blob.mark());
        }
        Ok(found.map(|(bytes, _)| bytes))
    }

    /// Whether a blob's file exists and has the right length; says nothing of what is in it.
    pub(crate) fn has_file(&self, blob: &BlobRef) -> bool {
        self.store.file(&blob.path()).is_some_and(|meta| meta.len() == blob.len)
    }

    /// Whether a blob is there and whole. Its bytes are read only if somebody wrote to the file since they were last
    /// verified; what was written while the old time was kept, [`Cache::verify`] finds.
    pub(crate) fn has_blob(&self, blob: &BlobRef) -> Result<bool> {
        let file = self.store.file(&blob.path()).filter(|meta| meta.len() == blob.len);
        Ok(match file.map(|meta| meta.modified()) {
            None => false,
            Some(Ok(modified)) if modified == blob.mark() => true,
            Some(_) => self.get_blob(blob)?.is_some(),
        })
    }

    /// Whether some blob has these bytes: a copy of a blob, such as [`Cache::put_copy`] makes, is intact if that is so.
    ///
    /// # Errors
    /// If the blob cannot be read, or `ext` is none.
    pub fn has_copied(&self, bytes: &[u8], ext: &str) -> Result<bool> {
        self.has_blob(&BlobRef::of(bytes, ext)?)
    }

    /// Stores bytes under their digest, while the caller keeps removal waiting. What stood there is replaced: it may be
    /// damaged.
    pub(crate) fn put_blob(&self, Output { ext, bytes, digest, .. }: &Output) -> Result<BlobRef> {
        let blob = BlobRef::named(digest.unwrap_or_else(|| Digest::of(bytes)), ext, bytes.len())?;
        self.publish_file(&blob.path(), bytes, Some(blob.mark()))?;
        Ok(blob)
    }

    /// Writes a file of the caller's, which other programs read beside the blobs, unless it says that already. What
    /// stands in its way is moved aside.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn put_file(&self, name: &str, bytes: &[u8]) -> Result<()> {
        match self.store.get(name)? {
            Some((there, _)) if *there == bytes => Ok(()),
            _ => self.publish_file(name, bytes, None),
        }
    }

    /// The same with a blob's bytes; `false` if the blob is missing or damaged.
    ///
    /// # Errors
    /// If the blob cannot be read or the file not be written.
    pub fn put_copy(&self, name: &str, blob: &BlobRef) -> Result<bool> {
        if self.store.get(name)?.is_some_and(|(there, _)| Digest::of(&there) == blob.digest) {
            return Ok(true);
        }
        let Some(bytes) = self.get_blob(blob)? else { return Ok(false) };
        self.publish_file(name, &bytes, None)?;
        Ok(true)
    }

    pub(crate) fn publish_file(&self, name: &str, bytes: &[u8], modified: Option<SystemTime>) -> Result<()> {
        self.store.put(name, bytes, modified)?;
        self.notices().mended(&self.store.path_of(name));
        Ok(())
    }
}

/// The bytes of the file at `path` as they were read, if they are what its name promises: a digest does, as blobs have it.
/// People's own files have other names.
///
/// # Errors
/// [`Error::Damaged`].
pub fn verified(path: &Path, bytes: Vec<u8>) -> Result<Vec<u8>> {
    let stem = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
    match stem.parse::<Digest>() {
        Ok(promised) if promised != Digest::of(&bytes) => Err(Error::Damaged(path.to_owned())),
        _ => Ok(bytes),
    }
}
