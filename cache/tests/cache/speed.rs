//! What an unchanged world costs: printed, never asserted.
//! `cargo test --release -p genescape-cache -- --ignored --nocapture unchanged`

use std::sync::atomic::AtomicUsize;
use std::time::Instant;

use genescape_cache::{Cache, How};

use crate::{build, key};

#[test]
#[ignore = "a measurement"]
fn unchanged_world() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let start = Instant::now();
    for n in 0..120 {
        build(&cache, n, 50_000, &AtomicUsize::new(0)).expect("builds");
    }
    eprintln!("120 actions of 2 blobs of 50 kB, fresh: {:.2?}", start.elapsed());
    for _ in 0..5 {
        let start = Instant::now();
        let cache = Cache::open(world.path()).expect("opens");
        for scope in 0..4 {
            let mut history = cache.history(&format!("g0000/scene-{scope}")).expect("read");
            for n in 0..30 {
                let key = key(scope * 30 + n);
                cache.lookup(&key).expect("read").expect("a hit");
                history.note(&format!("item/{n}"), &key, How::Reused);
            }
            cache.save_history(&history).expect("saved");
        }
        eprintln!("unchanged, 120 lookups and 4 histories: {:.2?}", start.elapsed());
    }
    let start = Instant::now();
    let report = cache.verify().expect("verifies");
    eprintln!("verify {} blobs, {} bytes: {:.2?}", report.blobs, report.bytes, start.elapsed());
}
