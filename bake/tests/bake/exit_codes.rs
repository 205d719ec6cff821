//! The exit codes that the documentation promises, each met.

use std::collections::BTreeSet;
use std::process::Command;

use crate::world::World;

#[test]
fn every_documented_exit_code_is_given_for_its_reason() {
    let world = World::new();
    let code = |words: &[&str]| world.run(words).status.code();
    let not_a_folder = format!("{}/man1", env!("CARGO_BIN_EXE_bake"));
    let met = [code(&["params"]), code(&["man", &not_a_folder]), code(&["nxt"]), interrupted(&world)];
    assert_eq!(met, [Some(0), Some(1), Some(2), Some(130)]);
    assert_eq!(documented(), met.into_iter().flatten().collect());
}

#[test]
fn what_the_person_can_mend_is_bad_input() {
    let world = World::new();
    let scene = world.file("gone/scene.gltf").display().to_string();
    let cases: [(&[&str], &str); 6] = [
        (&["lod", "missing.obj", "a.glb"], "cannot read missing.obj"),
        (&["export", &scene, "a.glb"], "cannot read"),
        (&["export", env!("CARGO_BIN_EXE_bake"), "a.glb"], "no scene.gltf"),
        (&["frobnicate"], "neither a population file nor a command"),
        (&["nowhere.ron"], "nowhere.ron"),
        (&["--size", "-5"], "whole number"),
    ];
    for (words, why) in cases {
        let output = world.run(words);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && said.contains(why), "{words:?}: {said}");
    }
}

/// As under a quota: the system ends a program that does not expect it.
#[cfg(unix)]
#[test]
fn a_limit_on_the_size_of_files_is_told_in_words() {
    let world = World::new();
    let mut limited = Command::new("sh");
    limited.args(["-c", "ulimit -f 500; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_bake"), "--size", "65"]);
    let output = limited.arg("--world").arg(world.path()).output().expect("runs");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && said.contains("There is no room"), "{said}");
}

fn interrupted(world: &World) -> Option<i32> {
    let (mut child, mut events) = world.spawn(&[]);
    events.find(|line| line.contains("\"planned\"")).expect("it begins");
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill runs");
    assert!(kill.success());
    child.wait().expect("ended").code()
}

fn documented() -> BTreeSet<i32> {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/command-line.md");
    let page = std::fs::read_to_string(page).expect("a page");
    let (_, section) = page.split_once("## Exit codes\n").expect("a section");
    let section = section.split("\n## ").next().unwrap_or(section);
    let rows = section.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next());
    rows.map(|code| code.parse().expect("a number")).collect()
}
