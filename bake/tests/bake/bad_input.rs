//! Files that a person got wrong: told clearly, all at once, and nothing of theirs touched.

use std::fs;
use std::process::Command;

use crate::world::{Baked, World};

/// Bakes after `change` and gives what was said; the file must be untouched and the exit code 2.
fn refused(change: impl FnOnce(String) -> String) -> String {
    let world = World::new();
    fs::create_dir_all(world.file("population")).expect("a folder");
    let starter = include_str!("../../../configs/starter.ron");
    let text = change(starter.to_owned());
    fs::write(world.population(0), &text).expect("written");
    let baked = world.bake(&[]);
    assert_eq!(baked.code, Some(2), "{}", baked.stderr);
    assert_eq!(fs::read_to_string(world.population(0)).expect("still there"), text);
    assert!(!world.file("baked/current.ron").exists());
    baked.stderr
}

#[test]
fn unknown_out_of_range_and_wrong_type_are_told_together() {
    let said = refused(|text| {
        let text = text.replacen("height_m:", "hight_m:", 1);
        let text = text.replacen("relief_m: ", "relief_m: 90000.0, // ", 1);
        text.replacen("cloud_cover: ", "cloud_cover: \"much\", // ", 1)
    });
    for part in ["hight_m", "height_m", "relief_m", "90000", "cloud_cover", "g0000.ron:"] {
        assert!(said.contains(part), "{part} is missing in\n{said}");
    }
}

#[test]
fn truncated_ron() {
    let said = refused(|text| text[..text.len() / 2].to_owned());
    assert!(said.contains("g0000.ron:"), "{said}");
}

#[test]
fn empty_files_and_empty_populations() {
    refused(|_| String::new());
    let said = refused(|_| "Population(generation: 0, seed: 1, votes: None, individuals: [])".to_owned());
    assert!(said.contains('4'), "{said}");
}

#[test]
fn no_votes() {
    let world = World::starters();
    let baked = world.bake(&["next"]);
    assert_eq!(baked.code, Some(2));
    assert!(baked.stderr.contains("vote"), "{}", baked.stderr);
    assert!(!world.population(1).exists());
}

#[test]
fn sizes_that_are_none() {
    for size in ["0", "64", "512", "4097", "-1", "big"] {
        let world = World::new();
        let output = world.command(&["--size", size]).output().expect("bake runs");
        assert_eq!(output.status.code(), Some(2), "{size}");
    }
}

fn lod(name: &str, bytes: &[u8]) -> (Option<i32>, String, bool) {
    let folder = tempfile::tempdir().expect("a folder");
    let (input, out) = (folder.path().join(name), folder.path().join("out.glb"));
    fs::write(&input, bytes).expect("written");
    let output = Command::new(env!("CARGO_BIN_EXE_bake")).arg("lod").arg(&input).arg(&out).output();
    let output = output.expect("bake runs");
    let said = [output.stdout, output.stderr].concat();
    (output.status.code(), String::from_utf8_lossy(&said).into_owned(), out.exists())
}

#[test]
fn meshes_beyond_repair_are_refused() {
    let no_positions = br#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{}}]}]}"#;
    for (name, bytes) in [
        ("a.gltf", &no_positions[..]),
        ("b.glb", b"glTF\x02\0\0\0"),
        ("c.obj", b"# nothing\n"),
        ("d.obj", b"v nan nan nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("e.ply", b"ply\n"),
        ("f.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
    ] {
        let (code, said, written) = lod(name, bytes);
        assert_eq!(code, Some(2), "{name}: {said}");
        assert!(said.contains(name), "{name}: {said}");
        assert!(!written && !said.contains("panicked"), "{name}: {said}");
    }
}

#[test]
fn meshes_that_can_be_repaired_are_and_it_is_said() {
    // A fan of three triangles on one edge, a degenerate triangle, a vertex that is no number.
    let obj = b"v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 1\nv -1 0 0\nv nan 0 0\n\
        f 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 1 2\nf 1 2 6\n";
    let (code, said, written) = lod("fan.obj", obj);
    assert_eq!(code, Some(0), "{said}");
    assert!(written && said.contains("repair"), "{said}");
}

#[test]
fn a_missing_population_is_named() {
    let world = World::new();
    let mut command = world.command(&["nowhere.ron", "--json"]);
    let baked = Baked::from(command.output().expect("bake runs"));
    assert_eq!(baked.code, Some(1));
    assert!(baked.stderr.contains("nowhere.ron"), "{}", baked.stderr);
}
