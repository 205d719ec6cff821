//! Removing what was least recently used, until the cache is as small as asked.
//!
//! The unit of use is the action: a record's modification time says when it was last looked up. A blob goes with the
//! last record that names it. Removal excludes publication (see `lock`), so that no record is ever published whose
//! blobs were removed a moment before.

use std::collections::{BTreeMap, BTreeSet};
use std::time::{Duration, SystemTime};

use crate::action::record_path;
use crate::store::Entry;
use crate::{ActionRecord, BlobRef, Cache, Digest, Result};

/// What to remove.
#[derive(Clone, Copy, Debug)]
pub struct GcOptions {
    /// Bytes that blobs and records may take together.
    pub max_bytes: u64,
    /// What was written or used more recently than this stays, whatever the size: a bake that runs now may count
    /// on it. By default ten minutes.
    pub grace: Duration,
}

impl GcOptions {
    /// Down to `max_bytes`, with the default grace.
    pub fn to(max_bytes: u64) -> Self {
        Self { max_bytes, grace: Duration::from_secs(600) }
    }
}

/// What was removed, what is left and why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GcReport {
    pub actions_removed: usize,
    pub blobs_removed: usize,
    /// Files that killed writers left behind.
    pub abandoned_removed: usize,
    /// Bytes that blobs and records took before.
    pub bytes_before: u64,
    /// Bytes that they take now.
    pub bytes_left: u64,
    /// Of those, bytes of blobs that are roots.
    pub bytes_of_roots: u64,
}

impl Cache {
    /// Removes blobs that no record names, then the least recently used actions, until `options.max_bytes` hold.
    /// Never removes a blob whose digest is in `roots`, nor the record that names it, nor anything younger than
    /// the grace: if those alone are larger, more is left than asked (`bytes_left` says how much).
    ///
    /// # Errors
    /// If the folder cannot be listed or a file cannot be removed.
    pub fn gc(&self, options: GcOptions, roots: &BTreeSet<Digest>) -> Result<GcReport> {
        let _nothing_is_published = self.locks.removing()?;
        let mut sweep = Sweep::begin(self, options, roots)?;
        // First those whose records are gone, or were never written because their builder was killed.
        let blobs: Vec<String> = sweep.blobs.keys().cloned().collect();
        blobs.iter().try_for_each(|name| sweep.remove_blob_if_free(name))?;
        sweep.oldest_actions()?;
        sweep.abandoned_files()?;
        Ok(sweep.report)
    }

    /// The digests of all blobs that the last run of a scope produced: the roots that keep it whole.
    ///
    /// # Errors
    /// If its history or a record exists and cannot be read.
    pub fn roots_of(&self, scope: &str) -> Result<BTreeSet<Digest>> {
        let mut roots = BTreeSet::new();
        for key in self.history(scope)?.keys() {
            if let Some((record, _)) = self.get_sealed::<ActionRecord>(&record_path(key))? {
                roots.extend(record.outputs.iter().map(|(_, blob)| blob.digest));
            }
        }
        Ok(roots)
    }
}

struct Blob {
    entry: Entry,
    digest: Digest,
    /// How many records name it.
    named: usize,
}

struct Sweep<'a> {
    cache: &'a Cache,
    options: GcOptions,
    roots: &'a BTreeSet<Digest>,
    now: SystemTime,
    blobs: BTreeMap<String, Blob>,
    records: Vec<(Entry, ActionRecord)>,
    report: GcReport,
}

impl<'a> Sweep<'a> {
    fn begin(cache: &'a Cache, options: GcOptions, roots: &'a BTreeSet<Digest>) -> Result<Self> {
        let mut report = GcReport::default();
        let mut blobs = BTreeMap::new();
        for entry in cache.store.list("blobs")? {
            let Some(BlobRef { digest, .. }) = BlobRef::from_path(&entry.name, entry.bytes) else { continue };
            report.bytes_before += entry.bytes;
            report.bytes_of_roots += if roots.contains(&digest) { entry.bytes } else { 0 };
            blobs.insert(entry.name.clone(), Blob { entry, digest, named: 0 });
        }
        let mut records = Vec::new();
        for entry in cache.store.list("actions")? {
            let Some((record, _)) = cache.get_sealed::<ActionRecord>(&entry.name)? else { continue };
            report.bytes_before += entry.bytes;
            for (_, blob) in &record.outputs {
                blobs.entry(blob.path()).and_modify(|blob| blob.named += 1);
            }
            records.push((entry, record));
        }
        report.bytes_left = report.bytes_before;
        records.sort_by(|(a, _), (b, _)| (a.modified, &a.name).cmp(&(b.modified, &b.name)));
        Ok(Self { cache, options, roots, now: SystemTime::now(), blobs, records, report })
    }

    fn oldest_actions(&mut self) -> Result<()> {
        for (entry, record) in std::mem::take(&mut self.records) {
            if self.report.bytes_left <= self.options.max_bytes {
                break;
            }
            let is_root = record.outputs.iter().any(|(_, blob)| self.roots.contains(&blob.digest));
            if is_root || self.is_young(&entry) {
                continue;
            }
            // The record first: if this process is killed now, its blobs are merely unnamed.
            self.cache.store.remove(&entry.name)?;
            self.report.actions_removed += 1;
            self.report.bytes_left -= entry.bytes;
            for (_, blob) in &record.outputs {
                let path = blob.path();
                if let Some(blob) = self.blobs.get_mut(&path) {
                    blob.named -= 1;
                    self.remove_blob_if_free(&path)?;
                }
            }
        }
        Ok(())
    }

    fn remove_blob_if_free(&mut self, name: &str) -> Result<()> {
        let Some(blob) = self.blobs.get(name) else { return Ok(()) };
        if blob.named > 0 || self.roots.contains(&blob.digest) || self.is_young(&blob.entry) {
            return Ok(());
        }
        self.cache.store.remove(name)?;
        self.report.blobs_removed += 1;
        self.report.bytes_left -= blob.entry.bytes;
        self.blobs.remove(name);
        Ok(())
    }

    fn abandoned_files(&mut self) -> Result<()> {
        for folder in ["blobs", "actions", "history"] {
            let mut abandoned = self.cache.store.staged(folder)?;
            abandoned.retain(|entry| !self.is_young(entry));
            abandoned.iter().try_for_each(|entry| self.cache.store.remove(&entry.name))?;
            self.report.abandoned_removed += abandoned.len();
        }
        Ok(())
    }

    /// A time in the far future (the clock was set back since) is not young, or it would be so for ever.
    fn is_young(&self, entry: &Entry) -> bool {
        match self.now.duration_since(entry.modified) {
            Ok(age) => age < self.options.grace,
            Err(ahead) => ahead.duration() < self.options.grace,
        }
    }
}
