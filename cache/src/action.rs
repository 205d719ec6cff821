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

/// Whether that is the name of a record.
pub(crate) fn is_record(name: &str) -> bool {
    name.strip_prefix("actions/").is_some_and(|key| key.parse::<Digest>().is_ok())
}

impl Cache {
    /// The record of an action if all its blobs are there and whole; bytes are read only of files that somebody wrote to
    /// since they were last verified. Marks it as used. While it counts on it, the caller holds a [`Lease`](crate::Lease).
    ///
    /// # Errors
    /// If a file exists and cannot be read.
    pub fn lookup(&self, key: &ActionKey) -> Result<Option<ActionRecord>> {
        let path = record_path(key.digest());
        let Some((record, modified)) = self.get_sealed::<ActionRecord>(&path)? else { return Ok(None) };
        if modified.elapsed().unwrap_or(TOUCH_AFTER) >= TOUCH_AFTER {
            self.store.set_modified(&path, SystemTime::now());
        }
        let lost = self.lost_outputs(&record, |blob| self.has_blob(blob))?;
        self.tell_lost(&path, &lost);
        Ok(lost.is_empty().then_some(record))
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
        self.notices().add(self.store.path_of(&path), Fault::Undecodable { stage });
        Ok(())
    }

    /// Stores outputs, then the record that names them; nothing is removed meanwhile.
    fn publish(&self, key: &ActionKey, outputs: &[Output], cost: Duration) -> Result<ActionRecord> {
        let mut record = ActionRecord {
            fields: key.fields().clone(),
            outputs: Vec::with_capacity(outputs.len()),
            cost_ms: cost.as_secs_f64() * 1e3,
            bytes: outputs.iter().map(|output| output.bytes.len() as u64).sum(),
            created_unix_s: SystemTime::UNIX_EPOCH.elapsed().map_or(0, |age| age.as_secs()),
        };
        let _nothing_is_removed = self.locks.publishing()?;
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

    /// Whether all blobs of a record are still there and whole, as [`Cache::lookup`] says it.
    ///
    /// # Errors
    /// If a file exists and cannot be read.
    pub fn is_whole(&self, record: &ActionRecord) -> Result<bool> {
        Ok(self.lost_outputs(record, |blob| self.has_blob(blob))?.is_empty())
    }

    /// The blobs of a record that are not there, as far as `is_there` tells.
    pub(crate) fn lost_outputs<'a>(
        &self,
        record: &'a ActionRecord,
        is_there: impl Fn(&BlobRef) -> Result<bool>,
    ) -> Result<Vec<&'a BlobRef>> {
        let mut lost = Vec::new();
        for (_, blob) in &record.outputs {
            if !is_there(blob)? {
                lost.push(blob);
            }
        }
        Ok(lost)
    }

    /// Notes which blobs of the record at `path` are lost. Eviction is no loss: it removes the record before its blobs.
    pub(crate) fn tell_lost(&self, path: &str, lost: &[&BlobRef]) {
        if !lost.is_empty() && self.store.file(path).is_some() {
            let paths = lost.iter().map(|blob| self.store.path_of(&blob.path()));
            paths.for_each(|path| self.notices().add(path, Fault::MissingBlob));
        }
    }
}
