//! Action key → record of what it produced → blobs; built at most once at a time.

use std::time::{Duration, Instant, SystemTime};

use bytes::Bytes;
use serde::{Deserialize, Serialize};

use crate::store::Sealed;
use crate::{ActionKey, BlobRef, Cache, Error, KeyFields, Notice, Result};

/// A record younger than this is not marked as used again: the mark costs a system call, eviction is no finer.
pub(crate) const TOUCH_AFTER: Duration = Duration::from_secs(120);

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
    /// When, in seconds since 1970.
    pub created_unix_s: u64,
}

impl ActionRecord {
    /// The output of that name.
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
    /// The bytes.
    pub bytes: Bytes,
}

impl Output {
    /// An output of that name and file extension.
    pub fn new(name: impl Into<String>, ext: impl Into<String>, bytes: impl Into<Bytes>) -> Self {
        Self { name: name.into(), ext: ext.into(), bytes: bytes.into() }
    }
}

/// Where a result came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum How {
    /// It was there.
    Reused,
    /// It was built by this call.
    Built,
}

/// What an action gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Where the results are.
    pub record: ActionRecord,
    /// Whether this call built them.
    pub how: How,
    /// The bytes of the outputs in the record's order, if they are in memory: always after
    /// [`Cache::get_or_build_bytes`], and after [`Cache::get_or_build`] if it built them.
    pub bytes: Option<Vec<Bytes>>,
}

impl Outcome {
    /// The bytes of an output, if they are in memory.
    pub fn bytes_of(&self, name: &str) -> Option<&Bytes> {
        let at = self.record.outputs.iter().position(|(n, _)| n == name)?;
        self.bytes.as_ref()?.get(at)
    }
}

pub(crate) fn record_path(key: crate::Digest) -> String {
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
        let (record, modified) = match self.store.get_sealed::<ActionRecord>(&path)? {
            Sealed::Absent => return Ok(None),
            Sealed::Broken => {
                self.discard_record(&path);
                return Ok(None);
            }
            Sealed::Whole(record, modified) => (record, modified),
        };
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
    /// again, or use [`Cache::get_or_build_bytes`] in the first place.
    ///
    /// # Errors
    /// What `build` fails with; or, converted to its type, that the results could not be stored.
    pub fn get_or_build<E: From<Error>>(
        &self,
        key: &ActionKey,
        build: impl FnOnce() -> Result<Vec<Output>, E>,
    ) -> Result<Outcome, E> {
        let reused = |record| Outcome { record, how: How::Reused, bytes: None };
        if let Some(record) = self.lookup(key)? {
            return Ok(reused(record));
        }
        let _turn = self.locks.turn(key.digest())?;
        // Another may have built it in the meantime.
        if let Some(record) = self.lookup(key)? {
            return Ok(reused(record));
        }
        self.build_now(key, build)
    }

    /// As [`Cache::get_or_build`], with the verified bytes of all outputs; what turns out damaged is built again.
    ///
    /// # Errors
    /// As there.
    pub fn get_or_build_bytes<E: From<Error>>(
        &self,
        key: &ActionKey,
        build: impl Fn() -> Result<Vec<Output>, E>,
    ) -> Result<Outcome, E> {
        for _ in 0..2 {
            let mut outcome = self.get_or_build(key, &build)?;
            if outcome.bytes.is_none() {
                let blobs = outcome.record.outputs.iter();
                outcome.bytes = blobs.map(|(_, blob)| self.get_blob(blob)).collect::<Result<_>>()?;
            }
            if outcome.bytes.is_some() {
                return Ok(outcome);
            }
        }
        // It went twice between being found and being read: don't look again.
        self.build_now(key, build)
    }

    fn build_now<E: From<Error>>(
        &self,
        key: &ActionKey,
        build: impl FnOnce() -> Result<Vec<Output>, E>,
    ) -> Result<Outcome, E> {
        let start = Instant::now();
        let outputs = build()?;
        let record = self.publish(key, &outputs, start.elapsed())?;
        let bytes = outputs.into_iter().map(|output| output.bytes).collect();
        Ok(Outcome { record, how: How::Built, bytes: Some(bytes) })
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
        for Output { name, ext, bytes } in outputs {
            if record.output(name).is_some() {
                return Err(Error::TwiceNamed { stage: key.stage().to_owned(), output: name.clone() });
            }
            record.outputs.push((name.clone(), self.write_blob(bytes.clone(), ext)?));
        }
        self.write_over(&record_path(key.digest()), |path| self.store.put_sealed(path, &record))?;
        Ok(record)
    }

    fn has_outputs(&self, path: &str, record: &ActionRecord) -> bool {
        let blobs = record.outputs.iter().map(|(_, blob)| blob);
        let gone: Vec<&BlobRef> = blobs.filter(|blob| !self.has_blob(blob)).collect();
        // `gc` removes the record before its blobs: if the record is there still, they were lost.
        if !gone.is_empty() && self.store.metadata(path).is_some() {
            gone.iter().for_each(|blob| self.notices.add(Notice::MissingBlob(self.path_of_blob(blob))));
        }
        gone.is_empty()
    }

    /// Forgets what an action produced, so that it is built again: its blobs are whole, but not what its stage writes.
    pub fn forget(&self, key: &ActionKey) {
        self.discard_record(&record_path(key.digest()));
    }

    pub(crate) fn discard_record(&self, path: &str) {
        // If it cannot be removed, it still fails its seal the next time.
        let _ = self.store.remove(path);
        self.notices.add(Notice::DamagedRecord(self.store.path_of(path)));
    }
}
