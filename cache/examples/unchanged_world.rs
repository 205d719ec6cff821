//! Prints what an unchanged world costs: `cargo run --release -p genescape-cache --example unchanged_world`

use std::time::Instant;

use genescape_cache::{ActionKey, Cache, Error, How, KeyFields, Output};

fn key(n: u32) -> ActionKey {
    let parameters = n.to_le_bytes().to_vec();
    ActionKey::new(KeyFields { stage: "test".to_owned(), version: 1, parameters, ..KeyFields::default() })
}

fn outputs(n: u32) -> Vec<Output> {
    let bytes = |salt: u32| [n, salt].map(u32::to_le_bytes).as_flattened().repeat(50_000 / 8);
    vec![Output::new("mesh", "glb", bytes(0)), Output::new("picture", "png", bytes(1))]
}

fn main() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let start = Instant::now();
    for n in 0..120 {
        cache.get_or_build::<Error>(&key(n), || Ok(outputs(n))).expect("builds");
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
