//! What may go wrong around a bake: damage, interruption, a full or forbidden disk, two at once.

use std::collections::BTreeSet;
use std::fs;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::world::{Baked, World, damage};

#[test]
fn a_missing_or_shortened_blob_is_made_again() {
    let world = World::starters();
    let before = world.files();
    for (n, blob) in world.blobs().iter().enumerate() {
        match n % 3 {
            0 => fs::remove_file(blob).expect("removed"),
            1 => damage(blob, |_| b"short".to_vec()),
            _ => {}
        }
    }
    let again = world.bake(&[]).ok();
    assert!(!again.built().is_empty());
    assert!(world.files() == before, "everything is as it was");
}

/// Same length, one bit different: only reading it tells.
pub fn flip_a_bit(mut bytes: Vec<u8>) -> Vec<u8> {
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    bytes
}

#[test]
fn a_damaged_blob_is_found_by_verify_and_made_again() {
    let world = World::starters();
    let before = world.files();
    world.blobs().iter().step_by(7).for_each(|blob| damage(blob, flip_a_bit));
    let verify = world.run(&["cache", "verify"]);
    let said = String::from_utf8_lossy(&verify.stdout).into_owned();
    assert!(said.contains("damaged"), "{said}");
    world.bake(&[]).ok();
    assert!(world.files() == before);
    assert!(world.run(&["cache", "verify"]).status.success());
}

#[test]
fn a_damaged_blob_that_a_stage_reads_is_never_used() {
    let world = World::starters();
    let good = world.files();
    world.blobs().iter().for_each(|blob| damage(blob, flip_a_bit));
    // The light map reads the landform, placement and trees again, all of them damaged.
    world.edit(0, |text| text.replacen("sun_azimuth_deg: ", "sun_azimuth_deg: 0.0, // ", 1));
    let baked = world.bake(&[]).ok();
    assert!(baked.of("notice").count() > 0, "damage is told");
    let fresh = World::starters();
    fs::copy(world.population(0), fresh.population(0)).expect("copied");
    fresh.bake(&[]).ok();
    let scene = "baked/g0000/scene-0/scene.gltf";
    assert!(world.files()[scene] == fresh.files()[scene]);
    assert!(world.files()[scene] != good[scene]);
}

#[test]
fn a_killed_bake_leaves_a_usable_folder() {
    let world = World::new();
    // One bake after the other gets a little further.
    for finished in [0, 1, 4, 20] {
        let (mut child, lines) = world.spawn(&[]);
        let is_computed = |line: &String| line.contains("\"finished\"") && line.contains("\"reused\":false");
        match finished {
            0 => assert!({ lines }.any(|line| line.contains("\"started\"")), "it begins"),
            _ => assert_eq!(lines.filter(is_computed).take(finished).count(), finished, "it gets that far"),
        }
        child.kill().expect("killed");
        child.wait().expect("ended");
        assert!(world.run(&["cache", "verify"]).status.success());
    }
    assert!(!world.file("baked/current.ron").exists(), "it was killed too late");
    world.bake(&[]).ok();
    assert!(world.run(&["cache", "verify"]).status.success());
    assert!(world.files() == World::starters().files());
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_what_was_finished() {
    let world = World::new();
    let (mut child, mut lines) = world.spawn(&[]);
    // Only once the first stage has begun is there anything to interrupt.
    assert!(lines.any(|line| line.contains("\"finished\"")), "a stage");
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill runs");
    assert!(kill.success());
    lines.for_each(drop);
    assert_eq!(child.wait().expect("ended").code(), Some(130));
    assert!(!world.file("baked/current.ron").exists(), "half a generation is not announced");
    let baked = world.bake(&[]).ok();
    assert!(baked.of("finished").any(|event| event["reused"] == true), "what was finished is reused");
}

#[test]
fn several_that_breed_at_the_same_time_get_a_number_each() {
    let world = World::starters();
    let votes = "votes: Some((tree: Some(0), terrain: Some(1), sky: Some(2)))";
    world.edit(0, |text| text.replace("votes: None", votes));
    let breed = || world.spawn(&["next", "--from", "0"]);
    let processes: Vec<_> = (0..5).map(|_| breed()).collect();
    for (mut process, lines) in processes {
        let lines: Vec<String> = lines.collect();
        assert!(process.wait().expect("our child").success(), "{lines:?}");
    }
    let text = |generation| fs::read_to_string(world.population(generation)).expect("a child");
    let genes = |text: String| text.split_once("individuals").expect("genes").1.to_owned();
    let children: BTreeSet<String> = (1..=5).map(text).map(genes).collect();
    assert_eq!(children.len(), 5, "no two are the same");
    assert!(!world.population(6).exists());
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
    built.dedup();
    assert_eq!(a.built().len() + b.built().len(), built.len(), "nothing was built twice");
    assert_eq!(built.len(), a.planned());
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

/// On a disk of 1 MB, mounted in a name space of its own, or else by a superuser.
#[cfg(target_os = "linux")]
#[test]
#[ignore = "needs the right to mount a disk: `cargo xtask test` runs it"]
fn a_full_disk_is_a_clear_error_and_loses_nothing() {
    const SCRIPT: &str = r#"
        mount -t tmpfs -o size=1m tmpfs "$1" || exit 99
        "$2" --size 65 --world "$1/world"; code=$?
        cat "$1/world/population/g0000.ron"
        umount "$1"; exit $code"#;
    let bake = |launcher: &[&str]| {
        let folder = tempfile::tempdir().expect("a folder");
        let mut command = Command::new(launcher[0]);
        command.args(&launcher[1..]).args(["-c", SCRIPT, "sh"]).arg(folder.path());
        command
            .arg(env!("CARGO_BIN_EXE_bake"))
            .output()
            .ok()
            .filter(|output| output.status.code() != Some(99))
    };
    let output = bake(&["unshare", "--user", "--map-root-user", "--mount", "sh"]).or_else(|| bake(&["sh"]));
    let output = output.expect("a small disk can be mounted, by `unshare` or by root");
    let [said, population] =
        [output.stderr, output.stdout].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.to_lowercase().contains("space") || said.contains("full"), "{said}");
    assert!(population.contains("individuals"), "{population}");
}
