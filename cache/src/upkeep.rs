//! What is in the cache, and whether all of it is whole.

use std::collections::BTreeMap;

use crate::action::is_record;
use crate::history::is_history;
use crate::lock::is_lock;
use crate::store::is_staged;
use crate::{ActionRecord, BlobRef, Cache, Error, Fault, Notice, Result};

/// The folders that are the cache's own.
const FOLDERS: [&str; 5] = ["actions", "blobs", "history", "locks", "staged"];

/// What the actions of one stage take and save.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageStats {
    pub actions: usize,
    /// Bytes of their outputs; a blob that two actions produced counts twice.
    pub bytes: u64,
    /// Milliseconds that it took to build them.
    pub cost_ms: f64,
}

/// Files and bytes of blobs and of records, and what each stage has of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stats {
    pub blobs: usize,
    pub blob_bytes: u64,
    pub actions: usize,
    pub action_bytes: u64,
    pub stages: BTreeMap<String, StageStats>,
}

/// What was read and what was wrong.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct VerifyReport {
    pub blobs: usize,
    pub bytes: u64,
    pub actions: usize,
    /// What was damaged or missing; all of it is out of the way now and will be rebuilt.
    pub faults: Vec<Notice>,
    /// Files that no cache wrote, relative to the cache folder; they were left alone.
    pub foreign: Vec<String>,
}

impl Cache {
    /// Counts what is in the cache. Reads all records, no blob.
    ///
    /// # Errors
    /// If the folder cannot be listed or read.
    pub fn stats(&self) -> Result<Stats> {
        let mut stats = Stats::default();
        let blobs = self.store.list("blobs")?;
        for blob in blobs
            .iter()
            .filter(|entry| entry.is_file)
            .filter_map(|entry| BlobRef::from_path(&entry.name, entry.bytes))
        {
            stats.blobs += 1;
            stats.blob_bytes += blob.len;
        }
        for entry in self.store.list("actions")?.into_iter().filter(|entry| is_record(&entry.name)) {
            let Some((record, _)) = self.get_sealed::<ActionRecord>(&entry.name)? else { continue };
            stats.actions += 1;
            stats.action_bytes += entry.bytes;
            let stage = stats.stages.entry(record.fields.stage).or_default();
            stage.actions += 1;
            stage.bytes += record.bytes;
            stage.cost_ms += record.cost_ms;
        }
        Ok(stats)
    }

    /// Reads and checks every blob, record and history; removes damaged ones, and records whose blobs are missing.
    ///
    /// # Errors
    /// If a folder cannot be listed or a damaged file not be removed. A file that cannot be read is a fault like others.
    pub fn verify(&self) -> Result<VerifyReport> {
        // The notices of a cache opened for this are the faults found by this.
        let cache = Cache::open(&self.store.root)?;
        let mut report = VerifyReport::default();
        for entry in cache.store.list("blobs")?.iter().filter(|entry| entry.is_file) {
            let Some(blob) = BlobRef::from_path(&entry.name, entry.bytes) else { continue };
            report.blobs += 1;
            report.bytes += blob.len;
            cache.checked(&entry.name, cache.get_blob(&blob));
        }
        // Nothing is published meanwhile, or a record could be removed that another process has just mended.
        let _nothing_is_published = cache.locks.removing()?;
        for entry in cache.store.list("actions")?.iter().filter(|entry| is_record(&entry.name)) {
            let Some(record) = cache.checked(&entry.name, cache.get_sealed(&entry.name)) else { continue };
            report.actions += 1;
            let (record, _): (ActionRecord, _) = record;
            // Whole they are, or they would be gone by now.
            let lost = cache.lost_outputs(&record, |blob| Ok(cache.has_file(blob)))?;
            cache.tell_lost(&entry.name, &lost);
            if !lost.is_empty() {
                cache.store.remove(&entry.name)?;
            }
        }
        for entry in cache.store.list("history")?.iter().filter(|entry| is_history(&entry.name)) {
            cache.checked(&entry.name, cache.check_seal(&entry.name));
        }
        report.faults = cache.take_notices();
        for folder in FOLDERS {
            let entries = cache.store.list(folder)?.into_iter();
            report
                .foreign
                .extend(entries.filter(|entry| !entry.is_file || !is_ours(&entry.name)).map(|e| e.name));
        }
        Ok(report)
    }

    /// What was read, if it could be; if not, that is noted.
    fn checked<T>(&self, name: &str, read: Result<Option<T>>) -> Option<T> {
        read.unwrap_or_else(|error| {
            let why = match error {
                Error::Storage { error, .. } => error.to_string(),
                other => other.to_string(),
            };
            self.notices().add(self.store.path_of(name), Fault::Unreadable(why));
            None
        })
    }
}

/// Whether only this cache gives files such a name.
fn is_ours(name: &str) -> bool {
    let kinds = [is_record, is_history, is_lock, is_staged];
    BlobRef::from_path(name, 0).is_some() || kinds.iter().any(|is_of_kind| is_of_kind(name))
}
