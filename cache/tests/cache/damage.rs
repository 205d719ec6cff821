//! Damage of any kind is noticed, told once, and mended; nothing damaged is served.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use genescape_cache::{BlobRef, Cache, Digest, Fault, How, Notice};
use proptest::prelude::*;

use crate::{build, is_right, key, put};

const LEN: usize = 500;

/// Ways to spoil a file.
#[derive(Clone, Debug)]
enum Harm {
    Flip(usize, u8),
    CutTo(usize),
    Append,
    Delete,
    EmptyFolder,
    FullFolder,
}

fn harm() -> impl Strategy<Value = Harm> {
    prop_oneof![
        4 => (any::<usize>(), 0_u8..8).prop_map(|(at, bit)| Harm::Flip(at, bit)),
        2 => (0..LEN).prop_map(Harm::CutTo),
        1 => Just(Harm::Append),
        1 => Just(Harm::Delete),
        1 => Just(Harm::EmptyFolder),
        1 => Just(Harm::FullFolder),
    ]
}

fn inflict(harm: &Harm, path: &Path) {
    let mut bytes = fs::read(path).expect("the file is there");
    fs::remove_file(path).expect("it can be removed");
    match *harm {
        Harm::Flip(at, bit) => {
            let at = at % bytes.len();
            bytes[at] ^= 1 << bit;
            fs::write(path, bytes).expect("written");
        }
        Harm::CutTo(len) => fs::write(path, &bytes[..len.min(bytes.len() - 1)]).expect("written"),
        Harm::Append => fs::write(path, [bytes, vec![0]].concat()).expect("written"),
        Harm::Delete => {}
        Harm::EmptyFolder => fs::create_dir(path).expect("made"),
        Harm::FullFolder => {
            fs::create_dir(path).expect("made");
            fs::write(path.join("diary.txt"), "someone's").expect("written");
        }
    }
}

/// Files of the cache but for locks.
fn files(root: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for folder in fs::read_dir(root).expect("a folder").flatten().filter(|e| e.file_name() != "locks") {
        let mut folders = vec![folder.path()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).expect("a folder").flatten() {
                if entry.path().is_dir() { folders.push(entry.path()) } else { found.push(entry.path()) }
            }
        }
    }
    found.sort();
    found
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..Default::default() })]

    #[test]
    fn whatever_is_damaged_is_never_served_and_is_rebuilt(harm in harm(), which in 0_usize..3) {
        let world = tempfile::tempdir().expect("a temporary folder");
        let cache = Cache::open(world.path()).expect("opens");
        let builds = AtomicUsize::new(0);
        build(&cache, 7, LEN, &builds).expect("builds");
        let victim = files(world.path())[which].clone();
        let before = fs::read(&victim).expect("reads");
        inflict(&harm, &victim);

        let again = build(&cache, 7, LEN, &builds).expect("rebuilds");
        prop_assert!(is_right(&again, 7, LEN));
        prop_assert_eq!((again.how, builds.load(Ordering::SeqCst)), (How::Built, 2));
        let is_record = victim.starts_with(world.path().join("actions"));
        prop_assert!(is_record || fs::read(&victim).expect("mended") == before);

        let notices = cache.take_notices();
        // A record that is simply gone is a miss like any other.
        let silent = is_record && matches!(harm, Harm::Delete | Harm::EmptyFolder);
        let told = if matches!(harm, Harm::FullFolder) && !is_record { 2 } else { usize::from(!silent) };
        prop_assert_eq!(notices.len(), told, "{:?}", notices);

        let third = build(&cache, 7, LEN, &builds).expect("reuses");
        prop_assert!(is_right(&third, 7, LEN) && third.how == How::Reused);
        prop_assert!(cache.take_notices().is_empty());
        if matches!(harm, Harm::FullFolder) {
            let diary = files(world.path()).into_iter().find(|path| path.ends_with("diary.txt"));
            prop_assert_eq!(fs::read_to_string(diary.expect("kept")).expect("whole"), "someone's");
        }
    }
}

#[test]
fn every_flipped_byte_of_a_blob_is_a_miss() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let bytes: Vec<u8> = (0..=255).collect();
    for at in [0, 1, 31, 127, 254, 255] {
        let blob = put(&cache, &bytes, "bin").expect("stored");
        let path = world.path().join(blob.path());
        assert_eq!(cache.get_blob(&blob).expect("read").as_deref(), Some(&bytes));
        inflict(&Harm::Flip(at, 0), &path);
        assert_eq!(put(&cache, &bytes, "bin").expect("reused"), blob, "length alone does not tell");
        assert_eq!(cache.get_blob(&blob).expect("read"), None);
        assert!(!path.exists(), "removed");
        assert_eq!(cache.take_notices(), [Notice { path, fault: Fault::DamagedBlob }]);
        assert_eq!(cache.get_blob(&blob).expect("read"), None);
        assert!(cache.take_notices().is_empty(), "told once");
    }
}

#[test]
fn a_forgotten_action_is_built_again_and_its_stage_named() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let (cache, builds) = (Cache::open(world.path()).expect("opens"), AtomicUsize::new(0));
    for round in 1..=2 {
        build(&cache, 3, LEN, &builds).expect("builds");
        cache.forget(&key(3)).expect("forgotten");
        let notices: Vec<String> = cache.take_notices().iter().map(Notice::to_string).collect();
        assert!(
            matches!(&notices[..], [text] if text.contains("stage test cannot be decoded")),
            "{notices:?}"
        );
        assert_eq!(cache.lookup(&key(3)).expect("read"), None);
        let again = build(&cache, 3, LEN, &builds).expect("rebuilds");
        assert_eq!((again.how, builds.load(Ordering::SeqCst)), (How::Built, 1 + round), "by this call");
    }
    cache.forget(&key(4)).expect("what is not there needs no forgetting");
}

#[test]
fn a_record_under_another_key_is_not_believed() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    build(&cache, 1, LEN, &AtomicUsize::new(0)).expect("builds");
    let actions = world.path().join("actions");
    let record = |n| actions.join(key(n).digest().to_string());
    fs::copy(record(1), record(2)).expect("copied");
    assert_eq!(cache.lookup(&key(2)).expect("read"), None);
}

#[test]
fn verify_finds_all_damage_and_clears_it_away() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let builds = AtomicUsize::new(0);
    let made: Vec<_> = (0..6).map(|n| build(&cache, n, LEN, &builds).expect("builds")).collect();
    assert_eq!(cache.verify().expect("verifies").faults, []);

    let mesh = |n: usize| world.path().join(made[n].record.outputs[0].1.path());
    inflict(&Harm::Flip(9, 3), &mesh(0));
    inflict(&Harm::Delete, &mesh(1));
    inflict(&Harm::Flip(40, 1), &world.path().join("actions").join(key(2).digest().to_string()));
    fs::write(world.path().join("blobs/README"), "not ours").expect("written");

    let report = cache.verify().expect("verifies");
    assert_eq!((report.blobs, report.faults.len()), (11, 3), "{report:?}");
    assert_eq!(report.foreign, ["blobs/README"]);
    assert_eq!(cache.verify().expect("verifies").faults, [], "cleared away");
    builds.store(0, Ordering::SeqCst);
    for n in 0..6 {
        assert!(is_right(&build(&cache, n, LEN, &builds).expect("builds"), n, LEN));
    }
    assert_eq!(builds.load(Ordering::SeqCst), 3, "what was whole was reused");
    assert!(world.path().join("blobs/README").exists());
}

#[test]
fn a_blob_lies_where_its_uri_says() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let blob = put(&cache, b"bytes", "png").expect("stored");
    let scene = world.path().join("g0000/scene-0");
    fs::create_dir_all(&scene).expect("made");
    assert_eq!(fs::read(scene.join(blob.uri(2))).expect("found"), b"bytes");
    assert_eq!(blob.digest, Digest::of(b"bytes"));
    for ext in ["", "PNG", "a/b", "..", "tar.gz", "abcdefghi"] {
        assert!(BlobRef::of(b"", ext).is_err(), "{ext}");
    }
}
