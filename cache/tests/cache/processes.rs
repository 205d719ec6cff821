//! Single flight between threads and between processes, and builders that die.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::Barrier;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use genescape_cache::{Cache, How};

use crate::{build, build_by, is_right, outputs};

/// Waits until `ready`, or fails after a generous while.
fn until(what: &str, mut ready: impl FnMut() -> bool) {
    let start = Instant::now();
    while !ready() {
        assert!(start.elapsed() < Duration::from_secs(30), "{what}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// This test program again, with a test that begins with [`is_child`], to build action 5 in this time, leaving a file
/// `started-PID` first.
fn child(test: &str, folder: &Path, pause_ms: u64) -> Child {
    Command::new(std::env::current_exe().expect("this program"))
        .args(["--exact", test, "--nocapture"])
        .env("GENESCAPE_TEST_FOLDER", folder)
        .env("GENESCAPE_TEST_PAUSE_MS", pause_ms.to_string())
        .stdout(Stdio::piped())
        .spawn()
        .expect("starts")
}

fn started(folder: &Path) -> usize {
    let names = std::fs::read_dir(folder).expect("a folder").flatten();
    names.filter(|entry| entry.file_name().to_string_lossy().starts_with("started-")).count()
}

/// Whether this process is a [`child`]; then it has done its work.
fn is_child() -> bool {
    let Ok(folder) = std::env::var("GENESCAPE_TEST_FOLDER") else { return false };
    let folder = Path::new(&folder);
    let pause_ms = std::env::var("GENESCAPE_TEST_PAUSE_MS").expect("set with the folder");
    let pause = Duration::from_millis(pause_ms.parse().expect("a number"));
    let cache = Cache::open(folder.join("baked")).expect("opens");
    let slowly = || {
        std::fs::write(folder.join(format!("started-{}", std::process::id())), "").expect("written");
        std::thread::sleep(pause);
        Ok(outputs(5, 3000))
    };
    let outcome = build_by(&cache, 5, slowly).expect("builds");
    assert!(is_right(&outcome, 5, 3000));
    true
}

#[test]
fn of_several_processes_one_builds() {
    if is_child() {
        return;
    }
    let world = tempfile::tempdir().expect("a temporary folder");
    let children: Vec<Child> =
        (0..3).map(|_| child("processes::of_several_processes_one_builds", world.path(), 300)).collect();
    for child in children {
        let output = child.wait_with_output().expect("ends");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    }
    assert_eq!(started(world.path()), 1);
}

#[test]
fn a_killed_builder_is_replaced() {
    if is_child() {
        return;
    }
    let world = tempfile::tempdir().expect("a temporary folder");
    let mut victim = child("processes::a_killed_builder_is_replaced", world.path(), 60_000);
    until("the first child builds", || started(world.path()) == 1);
    let cache = Cache::open(world.path().join("baked")).expect("opens");
    std::thread::scope(|scope| {
        let waiter = scope.spawn(|| build(&cache, 5, 3000, &AtomicUsize::new(0)).expect("builds"));
        std::thread::sleep(Duration::from_millis(30));
        assert!(!waiter.is_finished(), "it waits for the child");
        victim.kill().expect("killed");
        victim.wait().expect("ends");
        let outcome = waiter.join().expect("no panic");
        assert!(outcome.how == How::Built && is_right(&outcome, 5, 3000));
    });
}

#[test]
fn a_killed_process_has_no_lease() {
    if let Ok(folder) = std::env::var("GENESCAPE_TEST_FOLDER") {
        let folder = Path::new(&folder);
        let _lease = Cache::open(folder.join("baked")).expect("opens").lease().expect("a lease");
        std::fs::write(folder.join("started-now"), "").expect("written");
        return std::thread::sleep(Duration::from_secs(60));
    }
    let world = tempfile::tempdir().expect("a temporary folder");
    let mut victim = child("processes::a_killed_process_has_no_lease", world.path(), 0);
    until("the child has a lease", || started(world.path()) == 1);
    let cache = Cache::open(world.path().join("baked")).expect("opens");
    assert!(cache.begin_gc(|| false).expect("locked").is_none());
    victim.kill().expect("killed");
    victim.wait().expect("ends");
    assert!(cache.begin_gc(|| false).expect("locked").is_some());
}

#[test]
fn of_several_threads_one_builds() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let (builds, reused, gate) = (AtomicUsize::new(0), AtomicUsize::new(0), Barrier::new(8));
    std::thread::scope(|scope| {
        for thread in 0..8 {
            let (builds, reused, gate, path) = (&builds, &reused, &gate, world.path());
            scope.spawn(move || {
                // A cache of its own, as another process would have.
                let cache = Cache::open(path).expect("opens");
                gate.wait();
                for n in 0..20 {
                    let outcome = build(&cache, (n + thread) % 20, 200, builds).expect("builds");
                    assert!(is_right(&outcome, (n + thread) % 20, 200));
                    reused.fetch_add(usize::from(outcome.how == How::Reused), Ordering::SeqCst);
                }
            });
        }
    });
    assert_eq!((builds.into_inner(), reused.into_inner()), (20, 8 * 20 - 20));
}

#[test]
fn patience_ends_a_wait() {
    if is_child() {
        return;
    }
    let world = tempfile::tempdir().expect("a temporary folder");
    let mut sleeper = child("processes::patience_ends_a_wait", world.path(), 60_000);
    until("the child builds", || started(world.path()) == 1);
    let cache =
        Cache::open(world.path().join("baked")).expect("opens").with_patience(Duration::from_millis(20));
    let outcome = build(&cache, 5, 3000, &AtomicUsize::new(0)).expect("builds");
    assert_eq!(outcome.how, How::Built);
    sleeper.kill().expect("killed");
    sleeper.wait().expect("ends");
}

/// A thread pool may give a builder that waits for its parts another task: even one for the same key.
#[test]
fn a_builder_that_asks_for_its_own_key_does_not_wait_for_itself() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let builds = AtomicUsize::new(0);
    let outer = || {
        let inner = build(&cache, 9, 64, &builds)?;
        assert_eq!(inner.how, How::Built);
        Ok(outputs(9, 64))
    };
    let outer = build_by(&cache, 9, outer).expect("builds");
    assert!(is_right(&outer, 9, 64));
}
