//! What may go wrong around a bake: damage, interruption, a full or forbidden disk, two at once.

mod common;

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use common::{Baked, World};

fn blobs(world: &World) -> Vec<PathBuf> {
    let files = world.files().into_keys().filter(|name| name.starts_with("baked/blobs"));
    files.map(|name| world.file(&name)).collect()
}

#[test]
fn a_missing_or_shortened_blob_is_made_again() {
    let world = World::new();
    world.bake(&[]).ok();
    let before = world.files();
    for (n, blob) in blobs(&world).iter().enumerate() {
        match n % 3 {
            0 => fs::remove_file(blob).expect("removed"),
            1 => fs::write(blob, b"short").expect("shortened"),
            _ => {}
        }
    }
    let again = world.bake(&[]).ok();
    assert!(!again.built().is_empty());
    assert!(world.files() == before, "everything is as it was");
}

#[test]
fn a_damaged_blob_is_found_by_verify_and_made_again() {
    let world = World::new();
    world.bake(&[]).ok();
    let before = world.files();
    // Same length, one bit different: only reading it tells.
    for blob in blobs(&world).iter().step_by(7) {
        let mut bytes = fs::read(blob).expect("readable");
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        fs::write(blob, bytes).expect("damaged");
    }
    let verify = world.run(&["cache", "verify"]);
    let said = String::from_utf8_lossy(&verify.stdout).into_owned();
    assert!(said.contains("damaged"), "{said}");
    world.bake(&[]).ok();
    assert!(world.files() == before);
    assert!(world.run(&["cache", "verify"]).status.success());
}

#[test]
fn a_damaged_blob_that_a_stage_reads_is_never_used() {
    let world = World::new();
    world.bake(&[]).ok();
    let good = world.files();
    for blob in blobs(&world) {
        let mut bytes = fs::read(&blob).expect("readable");
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        fs::write(&blob, bytes).expect("damaged");
    }
    // The light map reads the landform, placement and trees again, all of them damaged.
    world.edit(0, |text| text.replacen("sun_azimuth_deg: ", "sun_azimuth_deg: 0.0, // ", 1));
    let baked = world.bake(&[]).ok();
    assert!(baked.of("notice").count() > 0, "damage is told");
    let fresh = World::new();
    fresh.bake(&[]).ok();
    fs::copy(world.population(0), fresh.population(0)).expect("copied");
    fresh.bake(&[]).ok();
    let scene = "baked/g0000/scene-0/scene.gltf";
    assert!(world.files()[scene] == fresh.files()[scene]);
    assert!(world.files()[scene] != good[scene]);
}

#[test]
fn a_killed_bake_leaves_a_usable_folder() {
    for kill_after_ms in [50, 300, 900] {
        let world = World::new();
        let mut child = world
            .command(&["--size", "65", "--json"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("bake runs");
        std::thread::sleep(Duration::from_millis(kill_after_ms));
        child.kill().expect("killed");
        child.wait().expect("ended");
        world.bake(&[]).ok();
        assert!(world.run(&["cache", "verify"]).status.success());
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_what_was_finished() {
    let world = World::new();
    let child =
        world.command(&["--size", "257", "--json"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut child = child.expect("bake runs");
    // Only once the first stage has begun is there anything to interrupt.
    let mut lines = std::io::BufRead::lines(std::io::BufReader::new(child.stdout.take().expect("piped")));
    lines
        .by_ref()
        .find(|line| line.as_ref().is_ok_and(|l| l.contains("finished")))
        .expect("a stage")
        .expect("read");
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill runs");
    assert!(kill.success());
    for _ in lines {}
    assert_eq!(child.wait().expect("ended").code(), Some(130));
    assert!(!world.file("baked/current.ron").exists(), "half a generation is not announced");
    let mut again = world.command(&["--size", "257", "--json"]);
    let baked = Baked::from(again.output().expect("bake runs")).ok();
    assert!(baked.of("finished").any(|event| event["reused"] == true), "what was finished is reused");
}

#[test]
fn two_bakes_of_one_world_share_the_work() {
    let world = World::new();
    let spawn = || {
        world
            .command(&["--size", "65", "--json"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("runs")
    };
    let start = Instant::now();
    let children = [spawn(), spawn()];
    let [a, b] = children.map(|child| Baked::from(child.wait_with_output().expect("ended")).ok());
    assert!(start.elapsed() < Duration::from_secs(300), "they did not wait for each other forever");
    let mut built = [a.built(), b.built()].concat();
    built.sort();
    let all = built.len();
    built.dedup();
    assert_eq!(all, built.len(), "nothing was built twice");
    assert_eq!(built.len(), 65);
}

#[test]
fn a_world_that_cannot_be_written_is_a_clear_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    fs::write(&file, "mine").expect("written");
    let output = Command::new(env!("CARGO_BIN_EXE_bake")).arg("--world").arg(file.join("world")).output();
    let output = output.expect("bake runs");
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("cannot make the world folder") && said.contains("--world"), "{said}");
    assert_eq!(fs::read(&file).expect("still there"), b"mine");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_a_clear_error_and_loses_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let disk = folder.path().join("disk");
    fs::create_dir(&disk).expect("made");
    let mount = Command::new("mount").args(["-t", "tmpfs", "-o", "size=1m", "tmpfs"]).arg(&disk).output();
    if !mount.is_ok_and(|output| output.status.success()) {
        eprintln!("SKIPPED: no right to mount a small disk here");
        return;
    }
    let world = disk.join("world");
    let output =
        Command::new(env!("CARGO_BIN_EXE_bake")).args(["--size", "65", "--world"]).arg(&world).output();
    let output = output.expect("bake runs");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let population = fs::read_to_string(world.join("population/g0000.ron"));
    let _ = Command::new("umount").arg(&disk).status();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.to_lowercase().contains("space") || said.contains("full"), "{said}");
    assert!(population.expect("still there").contains("individuals"));
}
