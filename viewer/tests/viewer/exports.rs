//! Landscapes leave the window as files: by the card, by a drag to another program, by the clipboard.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::desktop::Program;
use crate::display::{Display, keys};
use crate::program::Viewer;

/// Beside the viewer's window there is room for another.
const SCREEN: [u16; 2] = [1000, 600];
/// In the first picture, where nothing can be pressed.
const IN_PICTURE: [i16; 2] = [200, 180];
/// The window of a program that takes no files, and of one that does.
const REFUSES: [i16; 4] = [830, 20, 150, 150];
const ACCEPTS: [i16; 4] = [830, 300, 150, 150];

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Waits until it was told, after the first `from` lines of the log, in words that contain `text`.
fn told(viewer: &mut Viewer, from: usize, text: &str) -> String {
    let find = |viewer: &Viewer| {
        let mut lines = viewer.lines[from..].iter().filter(|line| line["what"] == "told");
        lines.find_map(|line| line["text"].as_str().filter(|told| told.contains(text)).map(str::to_owned))
    };
    viewer.until(&format!("it tells “{text}”"), |viewer| find(viewer).is_some());
    find(viewer).expect("it was just there")
}

/// Clicks on something until the viewer has understood: where frames take long, a press is no click.
fn click(display: &Display, viewer: &mut Viewer, label: &str, wish: &str) {
    for _ in 0..10 {
        let from = viewer.lines.len();
        viewer.click(display, label);
        viewer.frames(3);
        let wishes = |line: &Value| line["wish"].as_str().is_some_and(|asked| asked.starts_with(wish));
        if viewer.lines[from..].iter().any(wishes) {
            return;
        }
    }
    panic!("“{label}” asks for no {wish}");
}

#[test]
#[ignore = "needs Xvfb and a Vulkan driver: `cargo xtask test` runs it"]
fn landscapes_are_exported_dragged_out_and_copied() {
    let display = Display::start(SCREEN);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let arguments =
        ["--world", "world", "--settings", "settings.ron", "--heightfield", "65", "--size", "800x600"];
    let mut viewer = Viewer::start(&display, folder.path(), &arguments);
    viewer.until("the first landscapes", |viewer| viewer.shows(0));
    let exports = folder.path().join("exports");
    let glb = one_file(&display, &mut viewer, &exports);
    a_file_changed_by_hand_stays(&display, &mut viewer, &glb);
    a_folder_for_blender(&display, &mut viewer, &exports);
    pasted_elsewhere(&display, &mut viewer);
    dragged_over_a_program_that_takes_nothing(&display, &mut viewer);
    dragged_to_another_program(&display, &mut viewer, &exports);
    assert_eq!(viewer.quit(&display).code(), Some(0));
    let settings = fs::read_to_string(folder.path().join("settings.ron")).expect("settings");
    assert!(settings.contains("audience: Blender") && settings.contains("form: Folder"), "{settings}");
}

/// By key and card: what `bake export 1 FILE.glb` writes.
fn one_file(display: &Display, viewer: &mut Viewer, exports: &Path) -> PathBuf {
    let from = viewer.lines.len();
    display.tap(keys::E);
    click(display, viewer, "Export", "Export(");
    let told = told(viewer, from, "Landscape 1 is exported");
    let [name] = &names(exports)[..] else { panic!("one file: {:?}", names(exports)) };
    assert!(name.starts_with("g0000-1-") && name.ends_with(".glb") && told.contains(name.as_str()), "{told}");
    viewer.frames(2);
    display.picture().save("14-exported.png");
    let path = exports.join(name);
    let bytes = fs::read(&path).expect("the file");
    assert!(bytes.starts_with(b"glTF") && bytes.len() > 1_000_000, "{} bytes", bytes.len());
    path
}

fn a_file_changed_by_hand_stays(display: &Display, viewer: &mut Viewer, glb: &Path) {
    let good = fs::read(glb).expect("the file");
    fs::write(glb, "mine").expect("written");
    let from = viewer.lines.len();
    click(display, viewer, "Export", "Export(");
    let told = told(viewer, from, "Landscape 1 is not exported");
    assert!(told.contains("is there already") && told.contains("move it, or export elsewhere"), "{told}");
    assert_eq!(fs::read(glb).expect("the file"), b"mine");
    fs::write(glb, good).expect("written");
}

fn a_folder_for_blender(display: &Display, viewer: &mut Viewer, exports: &Path) {
    click(display, viewer, "Export for: Blender", "ExportChoice");
    click(display, viewer, "Export as: Folder", "ExportChoice");
    click(display, viewer, "Landscape to export: 3", "Choose");
    viewer.until("landscape 3 is chosen", |viewer| *viewer.get("screen", "chosen") == json!(2));
    let from = viewer.lines.len();
    click(display, viewer, "Export", "Export(");
    told(viewer, from, "Landscape 3 is exported");
    let folder = names(exports).into_iter().find(|name| name.starts_with("g0000-3-")).expect("a folder");
    let files = names(&exports.join(folder));
    for ending in ["-blender.py", "-sky.exr", "-sky.jpg", ".glb", "trees"] {
        assert!(files.iter().any(|name| name.ends_with(ending)), "{ending}: {files:?}");
    }
}

fn pasted_elsewhere(display: &Display, viewer: &mut Viewer) {
    let from = viewer.lines.len();
    click(display, viewer, "Copy", "CopyExported");
    told(viewer, from, "Copied");
    let pasted = Program::open(display, REFUSES, false).pasted();
    let [folder] = &pasted[..] else { panic!("{pasted:?}") };
    assert!(folder.is_dir() && folder.join("trees").is_dir(), "{folder:?}");
    display.tap(keys::E);
    viewer.until("the card is gone", |viewer| {
        viewer.get("screen", "panels").as_str().is_some_and(|panels| panels.contains("export: false"))
    });
}

/// Holds the handle of the first picture over a program's window.
fn drag_over(display: &Display, viewer: &mut Viewer, [x, y, width, height]: [i16; 4]) {
    display.point(IN_PICTURE);
    let handle = viewer.place_of("Export: 1");
    display.point(handle);
    viewer.frames(2);
    display.button(1, true);
    viewer.frames(2);
    for step in 1..=10 {
        let part = |from: i16, to: i16| from + (to - from) / 10 * step;
        display.point([part(handle[0], x + width / 2), part(handle[1], y + height / 2)]);
        viewer.frames(1);
    }
}

fn dragged_over_a_program_that_takes_nothing(display: &Display, viewer: &mut Viewer) {
    let mut program = Program::open(display, REFUSES, false);
    let from = viewer.lines.len();
    drag_over(display, viewer, REFUSES);
    program.hears("position");
    display.button(1, false);
    program.hears("leave");
    assert!(!program.heard.contains(&"drop"));
    told(viewer, from, "Landscape 1 is exported");
}

fn dragged_to_another_program(display: &Display, viewer: &mut Viewer, exports: &Path) {
    let mut program = Program::open(display, ACCEPTS, true);
    drag_over(display, viewer, ACCEPTS);
    program.hears("position");
    display.button(1, false);
    let dropped = program.dropped();
    assert_eq!(program.heard, ["enter", "position", "drop"]);
    let [folder] = &dropped[..] else { panic!("{dropped:?}") };
    assert!(folder.starts_with(exports.canonicalize().expect("there")), "{folder:?}");
    let name = folder.file_name().and_then(|name| name.to_str()).expect("a name");
    assert!(name.starts_with("g0000-1-") && folder.join("trees").is_dir(), "{folder:?}");
}
