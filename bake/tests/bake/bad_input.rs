//! Files that a person got wrong: told clearly, all at once, and nothing of theirs touched.

use std::fs;
use std::process::Command;

use crate::world::World;

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
    for words in [["nowhere.ron", "--json"], ["nowhere.ron", "--watch"]] {
        let output = world.run(&words);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains("nowhere.ron"), "{said}");
    }
    assert!(!world.path().exists(), "no world is made for it");
}

#[test]
fn what_needs_a_world_makes_none() {
    let world = World::new();
    for folder_is_there in [false, true] {
        if folder_is_there {
            fs::create_dir(world.path()).expect("made");
        }
        for words in [&["next"][..], &["next", "--from", "0"], &["export", "1", "a.glb"], &["explain"]] {
            let output = world.run(words);
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(
                output.status.code() == Some(2) && said.contains("is no world folder"),
                "{words:?}: {said}"
            );
            let left = fs::read_dir(world.path()).map_or(0, Iterator::count);
            assert!(world.path().exists() == folder_is_there && left == 0, "{words:?} leaves something");
        }
    }
}

#[test]
fn a_typing_error_makes_no_world() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::create_dir_all(folder.path().join("alps/population")).expect("made");
    for words in [&[][..], &["random", "--seed", "1"], &["--watch"]] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_bake"));
        let output = command.args(words).args(["--world", "alpz"]).current_dir(folder.path()).output();
        let output = output.expect("bake runs");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains("did you mean alps?"), "{words:?}: {said}");
        assert!(!folder.path().join("alpz").exists());
    }
}

#[test]
fn text_of_another_encoding_says_what_to_do() {
    let world = World::new();
    fs::create_dir_all(world.file("population")).expect("a folder");
    let starter = include_str!("../../../configs/starter.ron");
    let utf16: Vec<u8> = starter.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let latin = starter.replacen("name: \"", "name: \"\u{0}", 1).replace('\0', "?").into_bytes();
    let latin: Vec<u8> = latin.iter().map(|&byte| if byte == b'?' { 0xe4 } else { byte }).collect();
    for (bytes, hint) in [([&[0xff, 0xfe][..], &utf16].concat(), "UTF-16"), (latin, "UTF-8")] {
        fs::write(world.population(0), bytes).expect("written");
        let baked = world.bake(&[]);
        assert_eq!(baked.code, Some(2), "{}", baked.stderr);
        assert!(baked.stderr.contains("g0000.ron:") && baked.stderr.contains(hint), "{}", baked.stderr);
    }
}

#[test]
fn names_that_are_no_names_are_refused_before_anything_is_baked() {
    for name in ["x".repeat(70_000), "\\u{1b}[31m".into(), "\u{1b}]0;title\u{7}".into()] {
        let at = |text: &str| text.find("name: \"").expect("a name") + 7;
        let said = refused(|text| format!("{}{name}{}", &text[..at(&text)], &text[at(&text)..]));
        assert!(said.contains("name: ") && said.len() < 1000 && !said.contains('\u{1b}'), "{said:?}");
    }
}

#[test]
fn a_space_that_landscapes_cannot_be_made_from_is_told_before_anything_is_written() {
    let world = World::starters();
    let space = fs::read_to_string(world.file("space.ron")).expect("there");
    let line = space.lines().find(|line| line.contains("\"base_splits\"")).expect("a gene");
    let changed = space.replacen(line, &line.replace("scale: integer", "scale: linear"), 1);
    fs::write(world.file("space.ron"), changed).expect("written");
    for words in [&["random", "--seed", "3"][..], &["params"], &[]] {
        let output = world.run(words);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{words:?}: {said}");
        assert!(said.contains("space.ron:") && said.contains("base_splits"), "{words:?}: {said}");
    }
    assert!(!world.population(1).exists(), "no file is made that cannot be baked");
}

#[test]
fn numbers_of_threads_are_bounded() {
    let world = World::new();
    for threads in ["0", "1000000", "-1"] {
        assert_eq!(world.run(&["--threads", threads]).status.code(), Some(2), "{threads}");
    }
    assert!(!world.path().exists());
}

#[test]
fn json_is_refused_where_there_are_no_events() {
    let world = World::starters();
    for words in [&["params"][..], &["cache", "stats"], &["man"]] {
        let output = world.run(&[words, &["--json"]].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains("--json"), "{words:?}: {said}");
    }
}
