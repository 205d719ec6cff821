//! Eviction: the least recently used goes first, what is in use or held never, and the cap holds in a crowd.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, SystemTime};

use genescape_cache::{ActionKey, BlobRef, Cache, Digest, Error, GcReport, How, KeyFields, Output};
use proptest::prelude::*;

use crate::{build, is_right, key, put};

const LEN: usize = 1000;

fn gc(cache: &Cache, max_bytes: u64, roots: &BTreeSet<Digest>) -> GcReport {
    let gc = cache.begin_gc(|| true).expect("locked").expect("it waits");
    gc.evict(max_bytes, roots).expect("collects")
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
        let report = gc(&cache, cap, &keep);
        let stats = cache.stats().expect("counts");
        prop_assert_eq!(report.bytes_left, stats.blob_bytes + stats.action_bytes);
        let of_roots = roots.iter().filter(|&&n| n < actions).count();
        prop_assert_eq!(report.bytes_in_use, (of_roots * 2 * LEN) as u64);
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
    gc(&cache, 2 * 2500, &BTreeSet::new());
    let left: Vec<u32> = (0..4).filter(|&n| record(world.path(), n).exists()).collect();
    assert_eq!(left, [0, 3]);
}

#[test]
fn what_is_discarded_goes_with_what_it_alone_gave() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let same = |n: u32| {
        let outputs = || {
            Ok::<_, Error>(
                ["same".to_owned(), n.to_string()]
                    .map(|text| Output::new(text.clone(), "bin", text.into_bytes()))
                    .to_vec(),
            )
        };
        cache.get_or_build(&key(n), outputs).expect("builds").record
    };
    let [kept, gone] = [same(0), same(1)];
    let unnamed = put(&cache, b"named by nobody", "bin").expect("stored");
    let gc = cache.begin_gc(|| true).expect("locked").expect("it waits");
    let report = gc.discard(&BTreeSet::from([key(1).digest(), key(2).digest()])).expect("discards");
    assert_eq!((report.actions_removed, report.blobs_removed), (1, 1));
    let exists = |blob: &BlobRef| world.path().join(blob.path()).exists();
    assert!(kept.outputs.iter().all(|(_, blob)| exists(blob)) && exists(&unnamed));
    assert!(!exists(&gone.outputs[1].1));
}

#[test]
fn a_root_whose_record_is_lost_stays() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let root = put(&cache, b"in use", "bin").expect("stored");
    let other = put(&cache, b"not in use", "bin").expect("stored");
    fs::remove_dir_all(world.path().join("actions")).expect("removed");
    gc(&cache, 0, &BTreeSet::from([root.digest]));
    let exists = |blob: &BlobRef| world.path().join(blob.path()).exists();
    assert_eq!((exists(&root), exists(&other)), (true, false));
}

/// An action that reads these blobs and gives one more.
fn derive(cache: &Cache, stage: &str, inputs: &[&BlobRef]) -> BlobRef {
    let inputs = inputs.iter().map(|blob| ("input".to_owned(), blob.digest)).collect();
    let key = ActionKey::new(KeyFields { stage: stage.to_owned(), inputs, ..KeyFields::default() });
    let outputs = || Ok::<_, Error>(vec![Output::new("output", "bin", stage.as_bytes().to_vec())]);
    cache.get_or_build(&key, outputs).expect("builds").record.outputs[0].1.clone()
}

#[test]
fn what_a_root_was_made_from_stays() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let made = |stage: &str, inputs: &[&BlobRef]| derive(&cache, stage, inputs);
    let (land, tree) = (made("land", &[]), made("tree", &[]));
    let trees = made("trees", &[&land, &tree]);
    let scene = made("scene", &[&trees]);
    let (other, sibling) = (made("other", &[]), made("sibling", &[&trees]));
    gc(&cache, 0, &BTreeSet::from([scene.digest]));
    let stays =
        [&land, &tree, &trees, &scene, &other, &sibling].map(|blob| world.path().join(blob.path()).exists());
    assert_eq!(stays, [true, true, true, true, false, false]);
    assert_eq!(
        cache.stats().expect("counts").actions,
        4,
        "and so do the records: nothing is to be done again"
    );
}

#[test]
fn an_action_that_lost_one_output_keeps_the_others() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let outputs = build(&cache, 1, LEN, &AtomicUsize::new(0)).expect("builds").record.outputs;
    let [mesh, picture] = [0, 1].map(|n: usize| world.path().join(outputs[n].1.path()));
    fs::remove_file(&mesh).expect("removed");
    assert_eq!(cache.verify().expect("verifies").faults.len(), 1);
    let roots = outputs.iter().map(|(_, blob)| blob.digest).collect();
    gc(&cache, 0, &roots);
    assert!(picture.exists(), "it is in use");
}

/// However long the run takes and whatever the clock says: a bake may be suspended for a week.
#[test]
fn nothing_goes_while_a_lease_is_held() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let leases = [cache.lease().expect("a lease"), cache.lease().expect("one more")];
    let made = build(&cache, 1, LEN, &AtomicUsize::new(0)).expect("builds");
    age(&record(world.path(), 1), 60 * 24 * 7);
    let other = Cache::open(world.path()).expect("opens");
    for lease in leases {
        let mut asked = 0;
        let patient = || {
            asked += 1;
            asked < 3
        };
        assert!(other.begin_gc(patient).expect("locked").is_none(), "it waits, until it is told not to");
        assert_eq!(asked, 3);
        drop(lease);
    }
    let gc = other.begin_gc(|| false).expect("locked").expect("nobody holds a lease");
    assert_eq!(gc.evict(0, &BTreeSet::new()).expect("collects").actions_removed, 1);
    assert!(!world.path().join(made.record.outputs[0].1.path()).exists());
    std::thread::scope(|scope| {
        let lessee = scope.spawn(|| drop(cache.lease()));
        std::thread::sleep(Duration::from_millis(30));
        assert!(!lessee.is_finished(), "who comes while things go waits");
        drop(gc);
    });
}

#[test]
fn what_killed_writers_left_is_swept() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let blob = put(&cache, b"unnamed", "bin").expect("stored");
    fs::remove_dir_all(world.path().join("actions")).expect("removed");
    let half = world.path().join("staged/file-Ab3xYz");
    fs::write(&half, "half").expect("written");
    assert_eq!(cache.stats().expect("counts").blobs, 1, "what is half-written is no blob");
    let report = gc(&cache, u64::MAX, &BTreeSet::new());
    assert_eq!((report.abandoned_removed, report.blobs_removed), (1, 1));
    assert!(!half.exists() && !world.path().join(blob.path()).exists());
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
                        // With a breath between, for the other.
                        std::thread::sleep(Duration::from_micros(300));
                        let n = (n * 7 + putter) % 40;
                        let _lease = cache.lease().expect("a lease");
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
                let gc = cache.begin_gc(|| !done.load(Ordering::SeqCst)).expect("locked");
                let report = gc.map(|gc| gc.evict(CAP, &keep).expect("collects"));
                assert!(report.is_none_or(|report| report.bytes_left <= CAP), "{report:?}");
            }
        });
        let ends: Vec<_> = putters.into_iter().map(|putter| putter.join()).collect();
        done.store(true, Ordering::SeqCst);
        collector.join().expect("no panic");
        assert!(ends.iter().all(Result::is_ok));
    });
    gc(&root, CAP, &keep);
    let stats = root.stats().expect("counts");
    assert!(stats.blob_bytes + stats.action_bytes <= CAP);
    assert!(root.lookup(&key(1_000_000)).expect("read").is_some(), "the root is whole");
    assert_eq!(root.verify().expect("verifies").faults, []);
}
