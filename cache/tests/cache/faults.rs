//! Folders that cannot be written to and disks that are full: a clear error, and nothing lost.
//! Permission bits don't stop a superuser, so these tests use obstacles that stop everyone.

use std::fs;
use std::io::ErrorKind;
use std::sync::atomic::AtomicUsize;

use genescape_cache::{Cache, Error, Fault, How, Notice};

use crate::{build, is_right, key, outputs, put};

#[test]
fn a_folder_below_a_file_cannot_be_opened() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let file = world.path().join("file");
    fs::write(&file, "").expect("written");
    for root in [file.clone(), file.join("below")] {
        let message = Cache::open(&root).expect_err("no folder").to_string();
        assert!(message.contains(&root.display().to_string()), "{message}");
        assert!(message.contains("choose another folder"), "{message}");
    }
}

#[test]
fn a_file_in_place_of_a_folder_is_moved_aside() {
    for blocked in ["blobs", "actions", "locks", "staged"] {
        let world = tempfile::tempdir().expect("a temporary folder");
        fs::write(world.path().join(blocked), "someone's").expect("written");
        let cache = Cache::open(world.path()).expect("opens");
        let built = build(&cache, 1, 10, &AtomicUsize::new(0)).expect("builds");
        assert!(is_right(&built, 1, 10));
        let aside = world.path().join(format!("{blocked}.aside-1"));
        assert_eq!(fs::read_to_string(&aside).expect("kept"), "someone's");
        assert_eq!(cache.take_notices(), [Notice { path: aside, fault: Fault::MovedAside }], "{blocked}");
    }
}

#[test]
fn a_failed_build_stores_nothing_and_may_be_tried_again() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let failed = cache.get_or_build(&key(1), || Err(Error::Extension("made up".into())));
    assert!(matches!(failed, Err(Error::Extension(_))));
    let panicked = std::thread::scope(|scope| {
        let build = || {
            let bug = || std::panic::resume_unwind(Box::new("a bug in a stage"));
            cache.get_or_build::<Error>(&key(1), bug)
        };
        scope.spawn(build).join()
    });
    assert!(panicked.is_err());
    let built = build(&cache, 1, 10, &AtomicUsize::new(0)).expect("builds");
    assert!(built.how == How::Built && is_right(&built, 1, 10));
}

#[test]
fn two_outputs_of_one_name_are_refused() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let twice = || Ok([outputs(1, 10), outputs(2, 10)].concat());
    assert!(matches!(cache.get_or_build(&key(1), twice), Err(Error::TwiceNamed { .. })));
    assert_eq!(cache.lookup(&key(1)).expect("read"), None);
}

#[test]
fn a_full_disk_is_told_as_such() {
    let full = std::io::Error::from(ErrorKind::StorageFull);
    let error = Error::Storage { verb: "write", path: "baked/blobs/ab".into(), error: full };
    let message = error.to_string();
    assert!(message.contains("baked/blobs/ab") && message.contains("free some space"), "{message}");
    assert!(std::error::Error::source(&error).is_none(), "a chain would say the system's words twice");
}

#[cfg(unix)]
#[test]
fn published_files_are_as_readable_as_any() {
    use std::os::unix::fs::PermissionsExt;
    let world = tempfile::tempdir().expect("a temporary folder");
    let blob = put(&Cache::open(world.path()).expect("opens"), b"bytes", "bin").expect("stored");
    fs::write(world.path().join("plain"), "").expect("written");
    let mode = |name: &str| fs::metadata(world.path().join(name)).expect("exists").permissions().mode();
    assert_eq!(mode(&blob.path()), mode("plain"));
}

/// A real one: in a child, which is this test again, whose files may not grow beyond a few kilobytes.
#[cfg(unix)]
#[test]
fn a_write_that_ends_midway_leaves_no_trace() {
    if let Ok(folder) = std::env::var("GENESCAPE_TEST_FOLDER") {
        return write_without_room(&folder);
    }
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    build(&cache, 1, 100, &AtomicUsize::new(0)).expect("builds");
    let mut child = std::process::Command::new("sh");
    child.args(["-c", "trap '' XFSZ; ulimit -f 8; exec \"$0\" --exact \"$1\""]);
    child.arg(std::env::current_exe().expect("this program"));
    child.arg("faults::a_write_that_ends_midway_leaves_no_trace").env("GENESCAPE_TEST_FOLDER", world.path());
    let output = child.output().expect("runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    let report = cache.verify().expect("verifies");
    assert_eq!((report.faults.len(), report.foreign.len()), (0, 0), "{report:?}");
    assert!(cache.lookup(&key(1)).expect("read").is_some(), "what was finished is kept");
    assert_eq!(cache.lookup(&key(2)).expect("read"), None);
    assert!(is_right(&build(&cache, 2, 100_000, &AtomicUsize::new(0)).expect("room now"), 2, 100_000));
}

#[cfg(unix)]
fn write_without_room(folder: &str) {
    let cache = Cache::open(folder).expect("opens");
    let error = build(&cache, 2, 100_000, &AtomicUsize::new(0)).expect_err("no room");
    let message = error.to_string();
    assert!(message.contains(folder) && message.contains("There is no room"), "{message}");
    assert!(cache.take_notices().is_empty());
}
