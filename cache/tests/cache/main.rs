//! The cache's promises, kept under damage, crowds, killed builders and full disks.

mod damage;
mod eviction;
mod faults;
mod history;
mod keys;
mod processes;

use std::sync::atomic::{AtomicUsize, Ordering};

use genescape_cache::{
    ActionKey, ActionRecord, BlobRef, Bytes, Cache, Digest, Error, How, KeyFields, Outcome, Output,
};

/// The key of an action of that stage without parameters and inputs but one.
fn key_with_input(stage: &str, name: &str, input: &[u8]) -> ActionKey {
    let inputs = vec![(name.to_owned(), Digest::of(input))];
    ActionKey::new(KeyFields { stage: stage.to_owned(), inputs, ..KeyFields::default() })
}

/// A key whose only parameter is `n`.
fn key(n: u32) -> ActionKey {
    let parameters = n.to_le_bytes().to_vec();
    ActionKey::new(KeyFields { stage: "test".to_owned(), version: 1, parameters, ..KeyFields::default() })
}

/// Two outputs for `n`, of `len` bytes each.
fn outputs(n: u32, len: usize) -> Vec<Output> {
    let bytes = |salt: u32| -> Vec<u8> {
        let mut reader = blake3::Hasher::new().update(&(n ^ salt).to_le_bytes()).finalize_xof();
        let mut bytes = vec![0; len];
        reader.fill(&mut bytes);
        bytes
    };
    vec![Output::new("mesh", "glb", bytes(0)), Output::new("picture", "png", bytes(1 << 31))]
}

/// An outcome with the bytes of its outputs, verified.
#[derive(Debug)]
struct Found {
    how: How,
    record: ActionRecord,
    bytes: Vec<Bytes>,
}

/// Builds the action `n`, or reuses it; counts builds.
fn build(cache: &Cache, n: u32, len: usize, builds: &AtomicUsize) -> Result<Found, Error> {
    build_by(cache, n, || {
        builds.fetch_add(1, Ordering::SeqCst);
        Ok(outputs(n, len))
    })
}

/// The same by a builder of one's own: what turns out damaged is built again, as the bake's runner does it.
fn build_by(cache: &Cache, n: u32, build: impl Fn() -> Result<Vec<Output>, Error>) -> Result<Found, Error> {
    loop {
        let Outcome { how, record } = cache.get_or_build(&key(n), &build)?;
        let blobs = record.outputs.iter().map(|(_, blob)| cache.get_blob(blob));
        if let Some(bytes) = blobs.collect::<Result<_, _>>()? {
            return Ok(Found { how, record, bytes });
        }
    }
}

/// Whether the bytes are exactly those that action `n` produces.
fn is_right(found: &Found, n: u32, len: usize) -> bool {
    found.bytes == outputs(n, len).into_iter().map(|output| output.bytes).collect::<Vec<_>>()
}

/// Stores bytes as the only output of an action.
fn put(cache: &Cache, bytes: &[u8], ext: &str) -> Result<BlobRef, Error> {
    let output = || Ok::<_, Error>(vec![Output::new("bytes", ext, bytes.to_vec())]);
    Ok(cache.get_or_build(&key_with_input("put", "bytes", bytes), output)?.record.outputs[0].1.clone())
}
