//! What a person asks for by mistake: told in words, with exit code 2, and nothing is made or written over.

use std::fs;
use std::process::Command;

#[test]
fn mistakes_are_told_and_leave_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name);
    fs::create_dir_all(at("alps/population")).expect("made");
    fs::write(at("alps/space.ron"), "mine").expect("written");
    fs::write(at("mine.jpg"), "mine").expect("written");
    for (words, why) in [
        (&["--no-bake", "--world", "nowhere"][..], "nowhere is no world folder"),
        (&["--world", "alpz"], "did you mean alps?"),
        (&["alpz"], "did you mean alps?"),
        (&["alps", "--screenshot", "mine.jpg"], "must end in .png"),
        (&["alps", "--screenshot", "alps/space.ron"], "must end in .png"),
        (&["alps", "--screenshot", "alps/population/a.png"], "write elsewhere"),
        (&["alps", "--fov", "nan"], "a number from 1 to 170 degrees"),
        (&["alps", "--threads", "1000000"], "1 to 1024"),
        (&["alps", "--shaders", "shadres"], "there is no such folder"),
        (&["bench", "--shaders", "shadres"], "there is no such folder"),
        (&["nowhere.gltf"], "there is no file nowhere.gltf"),
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_viewer"));
        let output = command.args(words).current_dir(folder.path()).output().expect("the viewer is built");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains(why), "{words:?}: {said}");
    }
    for (file, text) in [("mine.jpg", "mine"), ("alps/space.ron", "mine")] {
        assert_eq!(fs::read_to_string(at(file)).expect("there"), text);
    }
    let left = fs::read_dir(folder.path()).expect("ours").count();
    assert!(left == 2 && !at("alps/population/a.png").exists(), "{left} things lie there");
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn where_no_window_is_opened_nothing_is_said_of_a_desktop() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("empty.gltf"), r#"{"asset": {"version": "2.0"}}"#).expect("written");
    let mut command = Command::new(env!("CARGO_BIN_EXE_viewer"));
    for name in ["XDG_RUNTIME_DIR", "DISPLAY", "WAYLAND_DISPLAY"] {
        command.env_remove(name);
    }
    let words = ["empty.gltf", "--screenshot", "a.png", "--size", "64x64"];
    let output = command.args(words).current_dir(folder.path()).output().expect("the viewer is built");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("empty.gltf") && !said.contains("XDG_RUNTIME_DIR"), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
}
