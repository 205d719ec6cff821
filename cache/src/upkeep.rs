//! What is in the cache, and whether all of it is whole.

use std::collections::BTreeMap;

use crate::{ActionRecord, BlobRef, Cache, Notice, Result};

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
        for blob in blobs.iter().filter_map(|entry| BlobRef::from_path(&entry.name, entry.bytes)) {
            stats.blobs += 1;
            stats.blob_bytes += blob.len;
        }
        for entry in self.store.list("actions")? {
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

    /// Reads and checks every blob and record; removes damaged ones, and records whose blobs are missing.
    ///
    /// # Errors
    /// If the folder cannot be listed or a file cannot be read.
    pub fn verify(&self) -> Result<VerifyReport> {
        // The notices of a cache opened for this are the faults found by this.
        let cache = Cache::open(&self.store.root)?;
        let mut report = VerifyReport::default();
        for entry in cache.store.list("blobs")? {
            let Some(blob) = BlobRef::from_path(&entry.name, entry.bytes) else {
                report.foreign.push(entry.name);
                continue;
            };
            report.blobs += 1;
            report.bytes += blob.len;
            cache.get_blob(&blob)?;
        }
        // Nothing is published meanwhile, or a record could be removed that another process has just mended.
        let _nothing_is_published = cache.locks.removing()?;
        for entry in cache.store.list("actions")? {
            let Some((record, _)) = cache.get_sealed::<ActionRecord>(&entry.name)? else { continue };
            report.actions += 1;
            if !cache.has_outputs(&entry.name, &record) {
                cache.store.remove(&entry.name)?;
            }
        }
        report.faults = cache.take_notices();
        Ok(report)
    }
}
