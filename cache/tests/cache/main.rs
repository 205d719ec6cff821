//! The cache's promises, kept under damage, crowds, killed builders and full disks.

mod damage;
mod eviction;
mod faults;
mod history;
mod keys;
mod processes;

use std::sync::atomic::{AtomicUsize, Ordering};

use genescape_cache::{ActionKey, BlobRef, Bytes, Cache, Digest, Error, KeyFields, Outcome, Output};

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

/// Builds the action `n`, or reuses it with verified bytes; counts builds.
fn build(cache: &Cache, n: u32, len: usize, builds: &AtomicUsize) -> Result<Outcome, Error> {
    build_by(cache, n, || {
        builds.fetch_add(1, Ordering::SeqCst);
        Ok(outputs(n, len))
    })
}

/// The same by a builder of one's own: what turns out damaged is built again, as the bake's runner does it.
fn build_by(cache: &Cache, n: u32, build: impl Fn() -> Result<Vec<Output>, Error>) -> Result<Outcome, Error> {
    loop {
        let mut outcome = cache.get_or_build(&key(n), &build)?;
        if outcome.bytes.is_none() {
            let blobs = outcome.record.outputs.iter();
            outcome.bytes = blobs.map(|(_, blob)| cache.get_blob(blob)).collect::<Result<_, _>>()?;
        }
        if outcome.bytes.is_some() {
            return Ok(outcome);
        }
    }
}

/// Whether an outcome has exactly the bytes that action `n` produces.
fn is_right(outcome: &Outcome, n: u32, len: usize) -> bool {
    let right: Vec<Bytes> = outputs(n, len).into_iter().map(|output| output.bytes).collect();
    outcome.bytes.as_ref() == Some(&right)
}

/// Stores bytes as the only output of an action.
fn put(cache: &Cache, bytes: &[u8], ext: &str) -> Result<BlobRef, Error> {
    let output = || Ok::<_, Error>(vec![Output::new("bytes", ext, bytes.to_vec())]);
    Ok(cache.get_or_build(&key_with_input("put", "bytes", bytes), output)?.record.outputs[0].1.clone())
}
