//! What is in the cache, and whether all of it is whole.

use std::collections::BTreeMap;

use crate::store::Sealed;
use crate::{ActionRecord, BlobRef, Cache, Notice, Result};

/// What the actions of one stage take and save.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageStats {
    /// Records.
    pub actions: usize,
    /// Bytes of their outputs; a blob that two actions produced counts twice.
    pub bytes: u64,
    /// Milliseconds that it took to build them.
    pub cost_ms: f64,
}

/// What is in the cache.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stats {
    /// Blobs.
    pub blobs: usize,
    /// Bytes of all blobs.
    pub blob_bytes: u64,
    /// Records.
    pub actions: usize,
    /// Bytes of all records.
    pub action_bytes: u64,
    /// By name of the stage.
    pub stages: BTreeMap<String, StageStats>,
}

/// What was read and what was wrong.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct VerifyReport {
    /// Blobs read.
    pub blobs: usize,
    /// Bytes read.
    pub bytes: u64,
    /// Records read.
    pub actions: usize,
    /// What was damaged or missing; all of it is out of the way now and will be rebuilt.
    pub faults: Vec<Notice>,
    /// Files that are none of ours, relative to the cache folder; they were left alone.
    pub foreign: Vec<String>,
}

impl Cache {
    /// Counts what is in the cache. Reads all records, no blob.
    ///
    /// # Errors
    /// If the folder cannot be listed or read.
    pub fn stats(&self) -> Result<Stats> {
        let mut stats = Stats::default();
        for entry in self.store.list("blobs")? {
            if BlobRef::parse_path(&entry.name).is_some() {
                stats.blobs += 1;
                stats.blob_bytes += entry.bytes;
            }
        }
        for entry in self.store.list("actions")? {
            let Sealed::Whole(record, _) = self.store.get_sealed::<ActionRecord>(&entry.name)? else {
                continue;
            };
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
        let mut report = VerifyReport::default();
        self.verify_blobs(&mut report)?;
        self.verify_records(&mut report)?;
        Ok(report)
    }

    fn verify_blobs(&self, report: &mut VerifyReport) -> Result<()> {
        for entry in self.store.list("blobs")? {
            let Some((digest, ext)) = BlobRef::parse_path(&entry.name) else {
                report.foreign.push(entry.name);
                continue;
            };
            report.blobs += 1;
            report.bytes += entry.bytes;
            if self.get_blob(&BlobRef { digest, ext: ext.to_owned(), len: entry.bytes })?.is_none() {
                report.faults.push(Notice::DamagedBlob(self.store.path_of(&entry.name)));
            }
        }
        Ok(())
    }

    fn verify_records(&self, report: &mut VerifyReport) -> Result<()> {
        // Nobody publishes meanwhile, or a record could be removed that another process has just mended.
        let _nobody_publishes = self.locks.removing()?;
        for entry in self.store.list("actions")? {
            match self.store.get_sealed::<ActionRecord>(&entry.name)? {
                Sealed::Absent => {}
                Sealed::Broken => {
                    self.discard_record(&entry.name);
                    report.faults.push(Notice::DamagedRecord(self.store.path_of(&entry.name)));
                }
                Sealed::Whole(record, _) => {
                    report.actions += 1;
                    if !self.all_there(&record, report) {
                        self.store.remove(&entry.name)?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Whether a record's blobs exist; reports those that don't and weren't reported as damaged.
    fn all_there(&self, record: &ActionRecord, report: &mut VerifyReport) -> bool {
        let gone: Vec<&BlobRef> =
            record.outputs.iter().map(|(_, blob)| blob).filter(|blob| !self.has_blob(blob)).collect();
        for path in gone.iter().map(|blob| self.path_of_blob(blob)) {
            let told = [Notice::DamagedBlob(path.clone()), Notice::MissingBlob(path.clone())];
            if !told.iter().any(|notice| report.faults.contains(notice)) {
                report.faults.push(Notice::MissingBlob(path));
            }
        }
        gone.is_empty()
    }
}
