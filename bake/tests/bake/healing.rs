//! Damage that a plain `bake` mends by itself, whatever stands where its files must be, and that no reader serves.

use std::fs;
use std::path::{Path, PathBuf};

use crate::faults::flip_a_bit;
use crate::world::{World, damage};

#[test]
fn a_bake_with_nothing_to_do_mends_blobs_that_were_written_to() {
    let world = World::starters();
    let before = world.files();
    assert!(world.bake(&[]).ok().built().is_empty());
    let victims: Vec<_> = world.blobs().into_iter().step_by(9).collect();
    victims.iter().for_each(|blob| damage(blob, flip_a_bit));
    let again = world.bake(&[]).ok();
    assert_eq!(again.of("notice").count(), victims.len(), "each is told");
    assert!(world.files() == before);
    assert!(world.bake(&[]).ok().built().is_empty());
}

#[test]
fn nothing_damaged_is_exported() {
    let world = World::starters();
    let out = world.file("alps.glb");
    let export = |scene: &str| world.run(&["export", scene, out.to_str().expect("text")]);
    assert!(export("1").status.success());
    let right = fs::read(&out).expect("written");
    let text = fs::read_to_string(world.scene(0)).expect("there");
    let uri = text.split("\"uri\":\"").find_map(|rest| rest.split_once(".png\"")).expect("a picture").0;
    let blob = world.scene(0).with_file_name(format!("{uri}.png"));
    for victim in [blob, world.scene(0)] {
        damage(&victim, flip_a_bit);
        fs::remove_file(&out).expect("removed");
        let output = export("1");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains("damaged") || said.contains("not as it was baked"), "{said}");
        assert!(!out.exists());
        world.bake(&[]).ok();
        assert!(export("1").status.success());
        assert!(fs::read(&out).expect("written") == right);
    }
}

#[test]
fn a_scene_whose_own_blob_is_damaged_too_is_mended_in_one_bake() {
    let world = World::starters();
    let before = world.files();
    let json = world.blobs().into_iter().filter(|blob| blob.extension().is_some_and(|ext| ext == "json"));
    for blob in json {
        // Under its old time, so that only reading tells.
        let modified = fs::metadata(&blob).and_then(|meta| meta.modified()).expect("a time");
        damage(&blob, flip_a_bit);
        let file = fs::File::options().append(true).open(&blob).expect("there");
        file.set_modified(modified).expect("set");
    }
    (0..4).for_each(|scene| fs::remove_file(world.scene(scene)).expect("removed"));
    world.bake(&[]).ok();
    assert!(world.files() == before);
}

#[test]
fn what_is_cleared_away_in_the_midst_of_a_bake_is_made_again() {
    let world = World::new();
    let (mut child, mut lines) = world.spawn(&[]);
    assert!(lines.any(|line| line.contains("\"finished\"")), "a stage");
    fs::rename(world.file("baked/blobs"), world.file("cleared away")).expect("moved");
    let lines: Vec<String> = lines.collect();
    assert!(child.wait().expect("ended").success(), "{lines:?}");
    assert!(world.files() == World::starters().files());
}

fn remove(path: &Path) {
    fs::remove_file(path).or_else(|_| fs::remove_dir_all(path)).expect("removed");
}

/// What is none of ours at all of these places, then one bake.
fn heals(what: &str, places: &[&str], obstruct: impl Fn(&Path)) {
    let world = World::starters();
    let before = world.files();
    let paths: Vec<PathBuf> = places.iter().map(|place| world.file(&format!("baked/{place}"))).collect();
    for path in &paths {
        remove(path);
        obstruct(path);
    }
    let baked = world.bake(&[]).ok();
    assert!(world.file("baked/current.ron").is_file() && world.files() == before, "{what}");
    let told: Vec<&str> = baked.of("notice").filter_map(|notice| notice["message"].as_str()).collect();
    for path in &paths {
        let aside = format!("{}.aside-1", path.display());
        assert!(fs::symlink_metadata(&aside).is_ok(), "{what}: {aside} is kept");
        assert!(told.iter().any(|text| text.starts_with(&aside)), "{what}: {aside} is told: {told:?}");
    }
    assert!(world.run(&["cache", "verify"]).status.success());
}

#[test]
fn whatever_stands_in_the_way_is_moved_aside() {
    let action = fs::read_dir(World::starters().file("baked/actions")).expect("a folder").next();
    let action = action.expect("one").expect("an entry").file_name();
    let action = format!("actions/{}", action.to_string_lossy());
    let files = [
        "g0000/scene-0/scene.gltf",
        "current.ron",
        "history/g0000-scene-0.keys",
        "locks/leases",
        action.as_str(),
    ];
    let folders = ["g0000", "blobs", "actions", "locks", "history", "staged"];
    heals("a folder", &files, |path| fs::create_dir_all(path.join("drawer")).expect("made"));
    heals("a file", &folders, |path| fs::write(path, "a person's").expect("written"));
    #[cfg(unix)]
    heals("a link to itself", &files, |path| std::os::unix::fs::symlink(path, path).expect("linked"));
    #[cfg(unix)]
    heals("a pipe", &files, |path| {
        assert!(std::process::Command::new("mkfifo").arg(path).status().expect("runs").success());
    });
}
