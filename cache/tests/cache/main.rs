//! The cache's promises, kept under damage, crowds, killed builders and full disks.

mod damage;
mod eviction;
mod faults;
mod history;
mod keys;
mod processes;

use std::sync::atomic::{AtomicUsize, Ordering};

use genescape_cache::{ActionKey, Cache, Error, Outcome, Output};

/// A key whose only parameter is `n`.
fn key(n: u32) -> ActionKey {
    ActionKey::builder("test", 1).parameters(&n).expect("a number has canonical bytes").build()
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

/// Builds the action `n`, or reuses it, and counts builds.
fn build(cache: &Cache, n: u32, len: usize, builds: &AtomicUsize) -> Result<Outcome, Error> {
    cache.get_or_build_bytes(&key(n), || {
        builds.fetch_add(1, Ordering::SeqCst);
        Ok(outputs(n, len))
    })
}

/// Whether an outcome has exactly the bytes that action `n` produces.
fn is_right(outcome: &Outcome, n: u32, len: usize) -> bool {
    outputs(n, len).iter().all(|output| outcome.bytes_of(&output.name) == Some(&output.bytes))
}
