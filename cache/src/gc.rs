//! Removing what was least recently used, until the cache is as small as asked.
//!
//! The unit of use is the action: a record's modification time says when it was last looked up. A blob goes with the
//! last record that names it. Nothing goes while anybody holds a lease.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;

use crate::action::{is_record, record_path};
use crate::store::{Entry, is_staged};
use crate::{ActionRecord, BlobRef, Cache, Digest, Result};

/// The right to evict: until it is dropped, nobody gets a [`Lease`](crate::Lease). So whoever holds it can find out what
/// is in use, and it stays true.
#[derive(Debug)]
pub struct Gc<'a> {
    cache: &'a Cache,
    _nobody_has_a_lease: File,
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
    /// Of those, bytes of blobs that are in use.
    pub bytes_in_use: u64,
}

impl Cache {
    /// Waits until nobody holds a lease. Meanwhile `keep_waiting` is asked again and again; `None` if it says no.
    ///
    /// # Errors
    /// If the lock's file cannot be used.
    pub fn begin_gc(&self, keep_waiting: impl FnMut() -> bool) -> Result<Option<Gc<'_>>> {
        let lock = self.locks.evicting(keep_waiting)?;
        Ok(lock.map(|lock| Gc { cache: self, _nobody_has_a_lease: lock }))
    }
}

impl Gc<'_> {
    /// Removes blobs that no record names, then the least recently used actions, until blobs and records take no more
    /// than `max_bytes`. Blobs in `roots` stay, and so does what they were made from: all that the actions which gave
    /// them read and gave. If that alone is larger, more is left than asked (`bytes_left` says how much).
    ///
    /// # Errors
    /// If the folder cannot be listed or a file cannot be removed.
    pub fn evict(&self, max_bytes: u64, roots: &BTreeSet<Digest>) -> Result<GcReport> {
        let _nothing_is_published = self.cache.locks.removing()?;
        let mut sweep = Sweep::begin(self.cache, roots)?;
        // First those whose records are gone, or were never written because their builder was killed.
        let blobs: Vec<String> = sweep.blobs.keys().cloned().collect();
        blobs.iter().try_for_each(|name| sweep.remove_blob_if_free(name))?;
        sweep.oldest_actions(max_bytes)?;
        sweep.abandoned_files()?;
        Ok(sweep.report)
    }

    /// Removes actions whose results nobody wants, with the blobs that no other action gave. Those that are gone
    /// already are no error.
    ///
    /// # Errors
    /// If the folder cannot be listed or a file cannot be removed.
    pub fn discard(&self, actions: &BTreeSet<Digest>) -> Result<GcReport> {
        let _nothing_is_published = self.cache.locks.removing()?;
        let mut sweep = Sweep::begin(self.cache, &BTreeSet::new())?;
        let names: BTreeSet<String> = actions.iter().map(|action| record_path(*action)).collect();
        let records = std::mem::take(&mut sweep.records).into_iter();
        records
            .filter(|record| names.contains(&record.entry.name))
            .try_for_each(|record| sweep.remove_action(&record))?;
        Ok(sweep.report)
    }
}

struct Blob {
    bytes: u64,
    digest: Digest,
    /// How many records name it.
    named: usize,
}

struct Record {
    entry: Entry,
    record: ActionRecord,
    in_use: bool,
}

struct Sweep<'a> {
    cache: &'a Cache,
    in_use: BTreeSet<Digest>,
    blobs: BTreeMap<String, Blob>,
    /// The least recently used first.
    records: Vec<Record>,
    report: GcReport,
}

impl<'a> Sweep<'a> {
    fn begin(cache: &'a Cache, roots: &BTreeSet<Digest>) -> Result<Self> {
        let mut records = Vec::new();
        for entry in cache.store.list("actions")?.into_iter().filter(|entry| is_record(&entry.name)) {
            let Some((record, _)) = cache.get_sealed::<ActionRecord>(&entry.name)? else { continue };
            records.push(Record { entry, record, in_use: false });
        }
        records.sort_by(|Record { entry: a, .. }, Record { entry: b, .. }| {
            (a.modified, &a.name).cmp(&(b.modified, &b.name))
        });
        let in_use = mark(roots, &mut records);
        let mut report = GcReport::default();
        let mut blobs = BTreeMap::new();
        for Entry { name, bytes, is_file, .. } in cache.store.list("blobs")? {
            let blob = BlobRef::from_path(&name, bytes).filter(|_| is_file);
            let Some(BlobRef { digest, .. }) = blob else { continue };
            report.bytes_before += bytes;
            report.bytes_in_use += if in_use.contains(&digest) { bytes } else { 0 };
            blobs.insert(name, Blob { bytes, digest, named: 0 });
        }
        for Record { entry, record, .. } in &records {
            report.bytes_before += entry.bytes;
            for (_, blob) in &record.outputs {
                blobs.entry(blob.path()).and_modify(|blob| blob.named += 1);
            }
        }
        report.bytes_left = report.bytes_before;
        Ok(Self { cache, in_use, blobs, records, report })
    }

    fn oldest_actions(&mut self, max_bytes: u64) -> Result<()> {
        for record in std::mem::take(&mut self.records) {
            if self.report.bytes_left <= max_bytes {
                break;
            }
            if !record.in_use {
                self.remove_action(&record)?;
            }
        }
        Ok(())
    }

    fn remove_action(&mut self, Record { entry, record, .. }: &Record) -> Result<()> {
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
        Ok(())
    }

    fn remove_blob_if_free(&mut self, name: &str) -> Result<()> {
        let Some(blob) = self.blobs.get(name) else { return Ok(()) };
        if blob.named > 0 || self.in_use.contains(&blob.digest) {
            return Ok(());
        }
        self.cache.store.remove(name)?;
        self.report.blobs_removed += 1;
        self.report.bytes_left -= blob.bytes;
        self.blobs.remove(name);
        Ok(())
    }

    /// Nobody who has a lease is writing, so what is staged will never be published.
    fn abandoned_files(&mut self) -> Result<()> {
        for entry in self.cache.store.list("staged")?.iter().filter(|entry| is_staged(&entry.name)) {
            self.cache.store.remove(&entry.name)?;
            self.report.abandoned_removed += 1;
        }
        Ok(())
    }
}

/// Marks the records that gave a root or something that such a record read, and so on. The digests of all that is in use.
fn mark(roots: &BTreeSet<Digest>, records: &mut [Record]) -> BTreeSet<Digest> {
    let mut givers = BTreeMap::<Digest, Vec<usize>>::new();
    for (index, Record { record, .. }) in records.iter().enumerate() {
        record.outputs.iter().for_each(|(_, blob)| givers.entry(blob.digest).or_default().push(index));
    }
    let (mut in_use, mut due) = (roots.clone(), roots.iter().copied().collect::<Vec<_>>());
    while let Some(digest) = due.pop() {
        for giver in givers.remove(&digest).unwrap_or_default() {
            let Record { record, in_use: marked, .. } = &mut records[giver];
            *marked = true;
            let outputs = record.outputs.iter().map(|(_, blob)| blob.digest);
            let inputs = record.fields.inputs.iter().map(|(_, digest)| *digest);
            due.extend(outputs.chain(inputs).filter(|digest| in_use.insert(*digest)));
        }
    }
    in_use
}
