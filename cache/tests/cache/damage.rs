//! Damage of any kind is noticed, told once, and mended; nothing damaged is served.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use genescape_cache::{BlobRef, Cache, Digest, Error, Fault, How, Notice, verified};
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
    /// To a file that somebody else may change, though its bytes are right now.
    Link,
    DanglingLink,
    LinkToItself,
}

fn harm() -> impl Strategy<Value = Harm> {
    prop_oneof![
        4 => (any::<usize>(), 0_u8..8).prop_map(|(at, bit)| Harm::Flip(at, bit)),
        2 => (0..LEN).prop_map(Harm::CutTo),
        1 => Just(Harm::Append),
        1 => Just(Harm::Delete),
        1 => Just(Harm::EmptyFolder),
        1 => Just(Harm::FullFolder),
        1 => Just(Harm::Link),
        1 => Just(Harm::DanglingLink),
        1 => Just(Harm::LinkToItself),
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
        Harm::Link => {
            let mine = path.with_file_name("mine");
            fs::write(&mine, bytes).expect("written");
            link(&mine, path);
        }
        Harm::DanglingLink => link(&path.with_file_name("nothing"), path),
        Harm::LinkToItself => link(path, path),
    }
}

#[cfg(unix)]
fn link(target: &Path, link: &Path) {
    std::os::unix::fs::symlink(target, link).expect("linked");
}

#[cfg(windows)]
fn link(target: &Path, link: &Path) {
    std::os::windows::fs::symlink_file(target, link).expect("linked");
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
        let is_miss = matches!(harm, Harm::Delete | Harm::EmptyFolder);
        let is_aside = matches!(harm, Harm::FullFolder | Harm::Link | Harm::DanglingLink | Harm::LinkToItself);
        let told = usize::from(is_aside) + usize::from(!is_record || !is_miss && !is_aside);
        prop_assert_eq!(notices.len(), told, "{:?}", notices);
        prop_assert!(!victim.with_file_name("nothing").exists(), "nothing is written through a link");
        prop_assert!(fs::symlink_metadata(&victim).is_ok_and(|meta| meta.is_file()));

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

/// As a failing disk or a careless program does it: in place.
fn flip_in_place(path: &Path) {
    let mut bytes = fs::read(path).expect("readable");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 4;
    fs::write(path, bytes).expect("written");
}

#[test]
fn a_lookup_notices_what_was_written_to() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let (cache, builds) = (Cache::open(world.path()).expect("opens"), AtomicUsize::new(0));
    let made = build(&cache, 1, LEN, &builds).expect("builds");
    let [mesh, picture] = [0, 1].map(|n: usize| world.path().join(made.record.outputs[n].1.path()));

    // Right bytes under another time, as a copied folder has them, are read once.
    let modified = |path: &Path| fs::metadata(path).and_then(|meta| meta.modified()).expect("a time");
    let mark = modified(&mesh);
    assert!(mark != modified(&picture), "each has its own");
    fs::write(&mesh, fs::read(&mesh).expect("readable")).expect("written");
    assert!(modified(&mesh) != mark);
    assert!(cache.lookup(&key(1)).expect("read").is_some() && modified(&mesh) == mark);

    flip_in_place(&picture);
    assert_eq!(cache.lookup(&key(1)).expect("read"), None);
    assert_eq!(cache.take_notices(), [Notice { path: picture.clone(), fault: Fault::DamagedBlob }]);
    assert!(is_right(&build(&cache, 1, LEN, &builds).expect("rebuilds"), 1, LEN));

    // What keeps length and time, only reading finds.
    let mark = modified(&picture);
    flip_in_place(&picture);
    fs::File::options().append(true).open(&picture).and_then(|file| file.set_modified(mark)).expect("set");
    assert!(cache.lookup(&key(1)).expect("read").is_some());
    assert_eq!(cache.verify().expect("verifies").faults.len(), 1);
    assert_eq!(cache.lookup(&key(1)).expect("read"), None);
}

#[test]
fn what_is_none_of_ours_is_left_alone() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    build(&cache, 1, LEN, &AtomicUsize::new(0)).expect("builds");
    let record = format!("actions/{}", key(1).digest());
    let theirs = [
        format!("{record}.aside-1/diary.txt"),
        "actions/notes.txt".to_owned(),
        "blobs/ab/picture.png#1".to_owned(),
        "history/notes.txt".to_owned(),
        "locks/fff".to_owned(),
        "staged/notes".to_owned(),
    ];
    for name in &theirs {
        let path = world.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        fs::write(&path, "a person's").expect("written");
    }
    for _ in 0..2 {
        let report = cache.verify().expect("verifies");
        assert_eq!((report.faults, report.foreign), (vec![], theirs.to_vec()));
        assert_eq!(cache.stats().expect("counts").actions, 1);
        let gc = cache.begin_gc(|| true).expect("locked").expect("nobody has a lease");
        gc.evict(0, &BTreeSet::new()).expect("collects");
        build(&cache, 1, LEN, &AtomicUsize::new(0)).expect("builds");
    }
    for name in &theirs {
        assert_eq!(fs::read_to_string(world.path().join(name)).expect("there"), "a person's", "{name}");
    }
    assert!(cache.take_notices().is_empty());
}

/// A world from somebody else: nothing outside it is made, changed or waited for.
#[cfg(unix)]
#[test]
fn links_lead_nowhere_and_pipes_are_not_waited_for() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (world, outside) = (folder.path().join("world"), folder.path().join("outside"));
    let cache = Cache::open(&world).expect("opens");
    let made = build(&cache, 1, LEN, &AtomicUsize::new(0)).expect("builds");
    fs::create_dir(&outside).expect("made");
    let record = world.join("actions").join(key(1).digest().to_string());
    let blobs = made.record.outputs.iter().map(|(_, blob)| world.join(blob.path()));
    let folders: Vec<PathBuf> = blobs.map(|blob| blob.parent().expect("a folder").to_owned()).collect();

    fs::remove_file(world.join("locks/gc")).expect("removed");
    link(&outside.join("gc"), &world.join("locks/gc"));
    fs::rename(&record, outside.join("record")).expect("moved");
    link(&outside.join("record"), &record);
    let long_ago = std::time::SystemTime::UNIX_EPOCH;
    let file = fs::File::options().append(true).open(outside.join("record")).expect("there");
    file.set_modified(long_ago).expect("set");
    for folder in &folders {
        fs::remove_dir_all(folder).expect("removed");
        link(&outside, folder);
    }
    let again = build(&cache, 1, LEN, &AtomicUsize::new(0)).expect("builds");
    assert!(again.how == How::Built && is_right(&again, 1, LEN));
    let names: Vec<_> = fs::read_dir(&outside).expect("a folder").flatten().map(|e| e.file_name()).collect();
    assert_eq!(names, ["record"], "nothing was written there");
    assert_eq!(file.metadata().and_then(|meta| meta.modified()).expect("a time"), long_ago);

    for name in [record, world.join("locks/leases"), world.join(made.record.outputs[0].1.path())] {
        let _ = fs::remove_file(&name);
        assert!(std::process::Command::new("mkfifo").arg(&name).status().expect("runs").success());
    }
    let _lease = cache.lease().expect("a lease");
    assert!(is_right(&build(&cache, 1, LEN, &AtomicUsize::new(0)).expect("builds"), 1, LEN));
    assert_eq!(cache.verify().expect("verifies").faults, []);
}

#[test]
fn a_file_beside_the_blobs_is_put_in_place_whatever_stands_there() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let blob = put(&cache, b"a scene", "json").expect("stored");
    let (name, path) = ("g0000/scene-0/scene.gltf", world.path().join("g0000/scene-0/scene.gltf"));
    for harm in ["nothing", "a file for a folder", "a folder", "other bytes"] {
        let _ = fs::remove_file(&path);
        match harm {
            "a file for a folder" => {
                fs::remove_dir_all(world.path().join("g0000")).expect("removed");
                fs::write(world.path().join("g0000"), "a person's").expect("written");
            }
            "a folder" => fs::create_dir_all(path.join("drawer")).expect("made"),
            "other bytes" => fs::write(&path, "a skene").expect("written"),
            _ => {}
        }
        assert!(cache.put_copy(name, &blob).expect("written"), "{harm}");
        assert_eq!(fs::read(&path).expect("there"), b"a scene", "{harm}");
    }
    assert_eq!(fs::read_to_string(world.path().join("g0000.aside-1")).expect("kept"), "a person's");
    assert!(world.path().join("g0000/scene-0/scene.gltf.aside-1/drawer").exists());
    assert_eq!(cache.take_notices().len(), 2);

    flip_in_place(&world.path().join(blob.path()));
    assert!(cache.put_copy(name, &blob).expect("it says that already"));
    fs::remove_file(&path).expect("removed");
    assert!(!cache.put_copy(name, &blob).expect("read") && !path.exists(), "nothing damaged is put anywhere");
}

#[test]
fn a_digest_as_a_name_is_a_promise() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let blob = put(&cache, b"some bytes", "bin").expect("stored");
    let path = world.path().join(blob.path());
    assert_eq!(verified(&path, b"some bytes".to_vec()).expect("right"), b"some bytes");
    assert!(
        matches!(verified(&path, b"some bites".to_vec()), Err(Error::Damaged(damaged)) if damaged == path)
    );
    assert!(verified(Path::new("my own.bin"), b"some bites".to_vec()).is_ok());

    let is_copy = |bytes: &[u8]| cache.has_copied(bytes, "bin").expect("read");
    assert!(is_copy(b"some bytes") && !is_copy(b"some bites"));
    flip_in_place(&path);
    assert!(!is_copy(b"some bytes"), "nothing vouches for it any more");
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
