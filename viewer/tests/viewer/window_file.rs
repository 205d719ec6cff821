//! A file of anyone's in a real window: alone, turned by the mouse, read again when it is saved, and kept when a save goes
//! wrong.

use std::fs;

use serde_json::{Value, json};

use crate::display::{Display, keys};
use crate::files::File;
use crate::program::Viewer;

/// Of the window, in pixels; the screen is as large.
const SIZE: [u16; 2] = [640, 480];
/// The middle of the picture.
const MIDDLE: [usize; 4] = [280, 220, 360, 300];
const IN_PICTURE: [i16; 2] = [500, 300];

/// A square of one colour that takes no light, with a coarser level of detail.
fn square(color: [f32; 3]) -> Vec<u8> {
    let mut file = File::square();
    let [r, g, b] = color;
    file.add(
        "materials",
        json!({
            "doubleSided": true, "extensions": { "KHR_materials_unlit": {} },
            "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0] },
        }),
    );
    file.primitive()["material"] = json!(0);
    let mesh = file.json["meshes"][0].clone();
    file.add("meshes", mesh);
    file.json["nodes"] = json!([{ "mesh": 0, "extensions": { "MSFT_lod": { "ids": [1] } } }, { "mesh": 1 }]);
    file.glb()
}

fn number(viewer: &Viewer, key: &str) -> f64 {
    viewer.get("pose", key).as_f64().expect("a pose")
}

/// How often the file was put on the screen.
fn shown(viewer: &Viewer) -> usize {
    viewer.lines.iter().filter(|line| line["what"] == "landscape" && line["name"] == "red square.glb").count()
}

fn labels(viewer: &Viewer) -> Vec<String> {
    let widgets = viewer.get("widgets", "widgets").as_array().cloned().unwrap_or_default();
    widgets.iter().filter_map(|widget| widget["label"].as_str()).map(str::to_owned).collect()
}

#[test]
#[ignore = "needs Xvfb and a Vulkan driver: `cargo xtask test` runs it"]
fn anyones_file_is_alone_turns_and_follows_its_saves() {
    let (display, folder) = (Display::start(SIZE), tempfile::tempdir().expect("a temporary folder"));
    let path = folder.path().join("red square.glb");
    fs::write(&path, square([1.0, 0.0, 0.0])).expect("written");
    let arguments = ["red square.glb", "--settings", "settings.ron", "--size", "640x480"];
    let mut viewer = Viewer::start(&display, folder.path(), &arguments);
    viewer.until("the file", |viewer| shown(viewer) == 1);
    viewer.until("rest", Viewer::rests);
    let reddish = |display: &Display| {
        let picture = display.picture();
        let [x0, y0, x1, y1] = MIDDLE;
        let rows = (y0..y1).flat_map(|y| &picture.pixels[y * picture.size[0] + x0..y * picture.size[0] + x1]);
        let red = rows.filter(|[r, g, b]| *r > 200 && *g < 60 && *b < 60).count();
        red as f64 / ((y1 - y0) * (x1 - x0)) as f64
    };
    assert!(reddish(&display) > 0.9, "it fills the middle, in its own colour");
    display.picture().save("file-1-start.png");

    // Nothing to vote on, nothing to breed, nobody else.
    viewer.until("widgets", |viewer| !labels(viewer).is_empty());
    let told = labels(&viewer);
    assert!(told.iter().any(|label| label == "About this file"), "{told:?}");
    for word in ["best in", "generation", "Undo", "Compare", "Genes"] {
        assert!(!told.iter().any(|label| label.contains(word)), "{word}: {told:?}");
    }

    // It turns, also to be seen from below, and comes nearer.
    let (yaw, away) = (number(&viewer, "yaw_rad"), number(&viewer, "distance_m"));
    assert_eq!(*viewer.get("pose", "mode"), "Orbit");
    display.point(IN_PICTURE);
    viewer.frames(2);
    display.button(1, true);
    viewer.frames(2);
    display.nudge([80, -160]);
    // What is grabbed follows the pointer: the eye goes to the left and down.
    viewer.until("a drag turns it", |viewer| number(viewer, "yaw_rad") < yaw - 0.02);
    viewer.until("a drag looks up at it", |viewer| number(viewer, "pitch_rad") > 0.05);
    display.button(1, false);
    display.button(4, true);
    display.button(4, false);
    viewer.until("the wheel comes nearer", |viewer| number(viewer, "distance_m") < 0.95 * away);

    // Levels of detail by the keys of trees; facts in the panel that otherwise has genes.
    display.tap(keys::F5);
    viewer.until("another LOD mode", |viewer| viewer.get("wish", "wish") == "NextTreeLod");
    display.tap(keys::G);
    viewer.until("what is known of it", |viewer| {
        labels(viewer).iter().any(|label| label == "Close what is known of the file")
    });
    viewer.frames(2);
    display.picture().save("file-2-about.png");
    display.tap(keys::G);

    // Saved anew it is read anew, where one is; half saved it stays, and says why.
    let stood = number(&viewer, "yaw_rad");
    fs::write(&path, square([0.0, 0.0, 1.0])).expect("written");
    viewer.until("the new file", |viewer| shown(viewer) == 2);
    viewer.until("rest", Viewer::rests);
    assert!(reddish(&display) < 0.01, "it is blue now");
    assert_eq!(number(&viewer, "yaw_rad"), stood);
    fs::write(&path, &square([0.0, 1.0, 0.0])[..300]).expect("written");
    viewer.until("a mistake is told", |viewer| viewer.get("errors", "count") == 1);
    let report = viewer.get("errors", "errors")[0]["report"].to_string();
    assert!(report.contains("red square.glb"), "{report}");
    fs::write(&path, square([1.0, 0.0, 0.0])).expect("written");
    viewer.until("the mistake is mended", |viewer| viewer.get("errors", "count") == 0 && shown(viewer) == 3);
    viewer.until("rest", Viewer::rests);
    assert!(reddish(&display) > 0.9, "and red again");

    // One can fly and walk there, too.
    for mode in ["Walk", "Fly"] {
        display.tap(keys::F);
        viewer.until(mode, |viewer| *viewer.get("pose", "mode") == mode);
    }
    let z = number(&viewer, "z_m");
    display.key(keys::W, true);
    viewer.until("it flies", |viewer| (number(viewer, "z_m") - z).abs() > 0.2);
    display.key(keys::W, false);
    assert_eq!(*viewer.get("errors", "errors"), Value::Array(Vec::new()));
    assert_eq!(viewer.quit(&display).code(), Some(0));
}
