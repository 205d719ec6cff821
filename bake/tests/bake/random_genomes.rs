//! Two hundred random genomes: every one must bake.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use genescape_schema::{Population, Space};

use crate::library::run;

const POPULATIONS: u64 = 50;

/// Each on one thread, as many at a time as there are cores: stages are too short to share their inner loops well.
#[test]
fn two_hundred_random_genomes_bake() {
    let (next, failed) = (AtomicU64::new(0), Mutex::new(Vec::new()));
    let work = || {
        while let seed @ 0..POPULATIONS = next.fetch_add(1, Ordering::SeqCst) {
            // Every population in a folder of its own: together they take 5 GB.
            let folder = tempfile::tempdir().expect("a temporary folder");
            let population = Population::random(&Space::builtin(), seed, 0);
            if let Err(error) = run(&population, folder.path(), 1) {
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
