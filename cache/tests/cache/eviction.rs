//! Eviction: the least recently used goes first, roots and young things never, and the cap holds in a crowd.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, SystemTime};

use genescape_cache::{BlobRef, Cache, Digest, GcOptions, How};
use proptest::prelude::*;

use crate::{build, is_right, key, put};

const LEN: usize = 1000;

fn at_once(max_bytes: u64) -> GcOptions {
    GcOptions { max_bytes, grace: Duration::ZERO }
}

/// Makes a file look as if last written that many minutes ago.
fn age(path: &Path, minutes: u64) {
    let then = SystemTime::now() - Duration::from_secs(60 * minutes);
    File::options().append(true).open(path).expect("exists").set_modified(then).expect("set");
}

fn record(root: &Path, n: u32) -> std::path::PathBuf {
    root.join("actions").join(key(n).digest().to_string())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..Default::default() })]

    #[test]
    fn roots_stay_whole_and_the_cap_holds_for_the_rest(
        actions in 1_u32..12,
        roots in prop::collection::btree_set(0_u32..12, 0..6),
        cap in 0_u64..30_000,
    ) {
        let world = tempfile::tempdir().expect("a temporary folder");
        let cache = Cache::open(world.path()).expect("opens");
        let builds = AtomicUsize::new(0);
        let mut keep = BTreeSet::<Digest>::new();
        for n in 0..actions {
            let outcome = build(&cache, n, LEN, &builds).expect("builds");
            if roots.contains(&n) {
                keep.extend(outcome.record.outputs.iter().map(|(_, blob)| blob.digest));
            }
        }
        let report = cache.gc(at_once(cap), &keep).expect("collects");
        let stats = cache.stats().expect("counts");
        prop_assert_eq!(report.bytes_left, stats.blob_bytes + stats.action_bytes);
        let of_roots = roots.iter().filter(|&&n| n < actions).count();
        prop_assert_eq!(report.bytes_of_roots, (of_roots * 2 * LEN) as u64);
        prop_assert!(report.bytes_left <= cap || stats.actions == of_roots, "{:?}", report);
        builds.store(0, Ordering::SeqCst);
        for n in 0..actions {
            let outcome = build(&cache, n, LEN, &builds).expect("builds");
            prop_assert!(is_right(&outcome, n, LEN));
            prop_assert!(outcome.how == How::Reused || !roots.contains(&n));
        }
        prop_assert!(cache.take_notices().is_empty(), "eviction is no damage");
    }
}

#[test]
fn the_least_recently_used_goes_first() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let builds = AtomicUsize::new(0);
    for n in 0..4 {
        build(&cache, n, LEN, &builds).expect("builds");
        age(&record(world.path(), n), 100 - u64::from(n));
    }
    assert!(cache.lookup(&key(0)).expect("read").is_some(), "used again: now the youngest");
    cache.gc(at_once(2 * 2500), &BTreeSet::new()).expect("collects");
    let left: Vec<u32> = (0..4).filter(|&n| record(world.path(), n).exists()).collect();
    assert_eq!(left, [0, 3]);
}

#[test]
fn a_root_whose_record_is_lost_stays() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let root = put(&cache, b"in use", "bin").expect("stored");
    let other = put(&cache, b"not in use", "bin").expect("stored");
    fs::remove_dir_all(world.path().join("actions")).expect("removed");
    cache.gc(at_once(0), &BTreeSet::from([root.digest])).expect("collects");
    let exists = |blob: &BlobRef| world.path().join(blob.path()).exists();
    assert_eq!((exists(&root), exists(&other)), (true, false));
}

#[test]
fn the_young_and_the_just_used_stay() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let builds = AtomicUsize::new(0);
    for n in 0..3 {
        let outcome = build(&cache, n, LEN, &builds).expect("builds");
        if n > 0 {
            age(&record(world.path(), n), 60);
            outcome.record.outputs.iter().for_each(|(_, blob)| age(&world.path().join(blob.path()), 60));
        }
    }
    cache.lookup(&key(1)).expect("read").expect("a hit");
    let report = cache.gc(GcOptions::to(0), &BTreeSet::new()).expect("collects");
    assert_eq!((report.actions_removed, report.blobs_removed), (1, 2));
    assert!(
        record(world.path(), 0).exists()
            && record(world.path(), 1).exists()
            && !record(world.path(), 2).exists()
    );
    assert!(cache.lookup(&key(1)).expect("read").is_some(), "its old blobs are kept by its record");
}

#[test]
fn what_killed_writers_left_is_swept_when_old() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let blob = put(&cache, b"unnamed", "bin").expect("stored");
    let blob = world.path().join(blob.path());
    fs::remove_dir_all(world.path().join("actions")).expect("removed");
    let staged = ["bin#1", "bin#Ab3xYz"].map(|extension| blob.with_extension(extension));
    staged.iter().for_each(|path| fs::write(path, "half").expect("written"));
    assert_eq!(cache.stats().expect("counts").blobs, 1, "what is half-written is no blob");
    assert_eq!(cache.gc(GcOptions::to(0), &BTreeSet::new()).expect("collects").abandoned_removed, 0);
    assert!(staged.iter().all(|path| path.exists()) && blob.exists(), "their writer may be alive");
    staged.iter().chain([&blob]).for_each(|path| age(path, 60));
    let report = cache.gc(GcOptions::to(u64::MAX), &BTreeSet::new()).expect("collects");
    assert_eq!((report.abandoned_removed, report.blobs_removed), (2, 1));
    assert!(!staged.iter().any(|path| path.exists()) && !blob.exists());
}

#[test]
fn the_cap_holds_while_others_put() {
    const CAP: u64 = 20_000;
    let world = tempfile::tempdir().expect("a temporary folder");
    let (done, builds) = (AtomicBool::new(false), AtomicUsize::new(0));
    let root = Cache::open(world.path()).expect("opens");
    let kept = build(&root, 1_000_000, LEN, &builds).expect("builds");
    let keep: BTreeSet<Digest> = kept.record.outputs.iter().map(|(_, blob)| blob.digest).collect();
    std::thread::scope(|scope| {
        let putters: Vec<_> = (0..3)
            .map(|putter| {
                let (path, builds) = (world.path(), &builds);
                scope.spawn(move || {
                    let cache = Cache::open(path).expect("opens");
                    for n in 0..40 {
                        let n = (n * 7 + putter) % 40;
                        assert!(is_right(&build(&cache, n, LEN, builds).expect("builds"), n, LEN));
                    }
                    let notices = cache.take_notices();
                    assert!(notices.is_empty(), "no record is ever without its blobs: {notices:?}");
                })
            })
            .collect();
        let collector = scope.spawn(|| {
            let cache = Cache::open(world.path()).expect("opens");
            while !done.load(Ordering::SeqCst) {
                let left = cache.gc(at_once(CAP), &keep).expect("collects").bytes_left;
                assert!(left <= CAP, "{left}");
            }
        });
        let ends: Vec<_> = putters.into_iter().map(|putter| putter.join()).collect();
        done.store(true, Ordering::SeqCst);
        collector.join().expect("no panic");
        assert!(ends.iter().all(Result::is_ok));
    });
    root.gc(at_once(CAP), &keep).expect("collects");
    let stats = root.stats().expect("counts");
    assert!(stats.blob_bytes + stats.action_bytes <= CAP);
    assert!(root.lookup(&key(1_000_000)).expect("read").is_some(), "the root is whole");
    assert_eq!(root.verify().expect("verifies").faults, []);
}
