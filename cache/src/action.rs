//! Action key → record of what it produced → blobs; built at most once at a time.

use std::time::{Duration, Instant, SystemTime};

use serde::{Deserialize, Serialize};

use crate::{ActionKey, BlobRef, Bytes, Cache, Digest, Error, Fault, KeyFields, Result};

/// A record younger than this is not marked as used again: the mark costs a system call, eviction is no finer.
const TOUCH_AFTER: Duration = Duration::from_secs(120);

/// What an action produced.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActionRecord {
    /// What the key was made of, stage name included.
    pub fields: KeyFields,
    /// The results by name.
    pub outputs: Vec<(String, BlobRef)>,
    /// Milliseconds that it took to build them.
    pub cost_ms: f64,
    /// Bytes of all outputs.
    pub bytes: u64,
    pub created_unix_s: u64,
}

impl ActionRecord {
    pub fn output(&self, name: &str) -> Option<&BlobRef> {
        self.outputs.iter().find(|(n, _)| n == name).map(|(_, blob)| blob)
    }
}

/// One result of an action, to be stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    /// Its name within the action.
    pub name: String,
    /// File extension.
    pub ext: String,
    pub bytes: Bytes,
    /// Of `bytes`, if it is known already: hashing takes time.
    pub digest: Option<Digest>,
}

impl Output {
    pub fn new(name: impl Into<String>, ext: impl Into<String>, bytes: impl Into<Bytes>) -> Self {
        Self { name: name.into(), ext: ext.into(), bytes: bytes.into(), digest: None }
    }
}

/// Where a result came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum How {
    Reused,
    Built,
}

/// What an action gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    pub record: ActionRecord,
    pub how: How,
}

pub(crate) fn record_path(key: Digest) -> String {
    format!("actions/{key}")
}

impl Cache {
    /// The record of an action if all its blobs exist with the right length; their bytes are not read. Marks it as
    /// used.
    ///
    /// # Errors
    /// If the record exists and cannot be read.
    pub fn lookup(&self, key: &ActionKey) -> Result<Option<ActionRecord>> {
        let path = record_path(key.digest());
        let Some((record, modified)) = self.get_sealed::<ActionRecord>(&path)? else { return Ok(None) };
        let old = modified.elapsed().unwrap_or(TOUCH_AFTER) >= TOUCH_AFTER;
        // An old record may be about to go. While `gc` waits, mark it, then look whether all is there.
        let gc_waits = if old { self.locks.publishing().ok() } else { None };
        if gc_waits.is_some() {
            if self.store.metadata(&path).is_none() {
                return Ok(None);
            }
            self.store.touch(&path);
        }
        Ok(self.has_outputs(&path, &record).then_some(record))
    }

    /// The results of an action: from the cache, or by running `build` and storing what it gives. Of all threads
    /// and processes that ask for one key at a time, one builds and the others wait for it.
    ///
    /// A reused blob's bytes are verified when they are read. If [`Cache::get_blob`] then gives `None`, call this
    /// again; if they cannot be decoded, call [`Cache::forget`] first.
    ///
    /// # Errors
    /// What `build` fails with; or, converted to its type, that the results could not be stored.
    pub fn get_or_build<E: From<Error>>(
        &self,
        key: &ActionKey,
        build: impl FnOnce() -> Result<Vec<Output>, E>,
    ) -> Result<Outcome, E> {
        let reused = |record| Outcome { record, how: How::Reused };
        if let Some(record) = self.lookup(key)? {
            return Ok(reused(record));
        }
        let _turn = self.locks.turn(key.digest())?;
        // Another may have built it in the meantime.
        if let Some(record) = self.lookup(key)? {
            return Ok(reused(record));
        }
        let start = Instant::now();
        let outputs = build()?;
        let record = self.publish(key, &outputs, start.elapsed())?;
        Ok(Outcome { record, how: How::Built })
    }

    /// Removes the record of an action whose results are whole but cannot be decoded, with a notice that names its
    /// stage: the next [`Cache::get_or_build`] builds it again.
    ///
    /// # Errors
    /// If the record exists and cannot be removed.
    pub fn forget(&self, key: &ActionKey) -> Result<()> {
        let path = record_path(key.digest());
        self.store.remove(&path)?;
        let stage = key.fields().stage.clone();
        self.notices.add(self.store.path_of(&path), Fault::Undecodable { stage });
        Ok(())
    }

    /// Stores outputs, then the record that names them; `gc` waits.
    fn publish(&self, key: &ActionKey, outputs: &[Output], cost: Duration) -> Result<ActionRecord> {
        let mut record = ActionRecord {
            fields: key.fields().clone(),
            outputs: Vec::with_capacity(outputs.len()),
            cost_ms: cost.as_secs_f64() * 1e3,
            bytes: outputs.iter().map(|output| output.bytes.len() as u64).sum(),
            created_unix_s: SystemTime::UNIX_EPOCH.elapsed().map_or(0, |age| age.as_secs()),
        };
        let _gc_waits = self.locks.publishing()?;
        for output in outputs {
            let name = &output.name;
            if record.output(name).is_some() {
                return Err(Error::TwiceNamed { stage: record.fields.stage, output: name.clone() });
            }
            record.outputs.push((name.clone(), self.put_blob(output)?));
        }
        self.put_sealed(&record_path(key.digest()), &record)?;
        Ok(record)
    }

    /// Whether the blobs that the record at `path` names exist with the right length.
    pub(crate) fn has_outputs(&self, path: &str, record: &ActionRecord) -> bool {
        let blobs = record.outputs.iter().map(|(_, blob)| blob);
        let gone: Vec<&BlobRef> = blobs.filter(|blob| !self.has_blob(blob)).collect();
        // `gc` removes the record before its blobs: if the record is there still, they were lost.
        if !gone.is_empty() && self.store.metadata(path).is_some() {
            let paths = gone.iter().map(|blob| self.store.path_of(&blob.path()));
            paths.for_each(|path| self.notices.add(path, Fault::MissingBlob));
        }
        gone.is_empty()
    }
}
