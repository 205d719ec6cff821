//! Random genomes, of the flat space and of kinds: every one must bake.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use genescape_bake::random;
use genescape_schema::{Kinds, Population, Space};

use crate::library::run;

/// Every other one of kinds. Two hundred landscapes where `GENESCAPE_LONG` is set.
fn populations() -> u64 {
    if std::env::var_os("GENESCAPE_LONG").is_some() { 50 } else { 15 }
}

fn population(seed: u64) -> Population {
    let space = Space::builtin();
    if seed.is_multiple_of(2) {
        return Population::random(&space, seed, 0);
    }
    let (kinds, _) = Kinds::shipped(&space);
    random::population(&space, &kinds, &[], seed, 0).expect("kinds of all categories").population
}

/// Each on one thread, as many at a time as there are cores: stages are too short to share their inner loops well.
#[test]
fn random_genomes_bake() {
    let (count, next, failed) = (populations(), AtomicU64::new(0), Mutex::new(Vec::new()));
    let work = || {
        loop {
            let seed = next.fetch_add(1, Ordering::SeqCst);
            if seed >= count {
                break;
            }
            // Every population in a folder of its own: together they take 5 GB.
            let folder = tempfile::tempdir().expect("a temporary folder");
            if let Err(error) = run(&population(seed), folder.path(), 1) {
                failed.lock().expect("no panic").push(format!("seed {seed}: {error:#}"));
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    let failed = failed.into_inner().expect("no panic");
    assert!(failed.is_empty(), "{failed:#?}");
}
