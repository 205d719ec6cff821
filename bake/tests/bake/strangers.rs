//! Models from strangers: nothing outside their folder is read, nothing of the person's is written over, nothing panics
//! or runs for hours.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::world::World;

/// A folder with `secret.txt` in it and a stranger's folder `model/`.
struct Folder(tempfile::TempDir);

impl Folder {
    fn with(files: &[(&str, &str)]) -> Self {
        let folder = Self(tempfile::tempdir().expect("a temporary folder"));
        for (name, text) in files.iter().chain(&[("secret.txt", SECRET)]) {
            let path = folder.file(name);
            fs::create_dir_all(path.parent().expect("a folder")).expect("made");
            fs::write(path, text).expect("written");
        }
        folder
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn bake(&self, words: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_bake"));
        command.args(words).current_dir(self.0.path()).output().expect("bake runs")
    }
}

const SECRET: &str = "what nobody else may know";
const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
/// A triangle of three points in 36 bytes, as a data URI.
const POINTS: &str = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";

/// A glTF file of one triangle with these images and this buffer.
fn gltf(images: &str, buffer: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}],
        "textures":[{{"source":0}}],"images":{images},
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36,"uri":"{buffer}"}}]}}"#
    )
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&[&output.stdout[..], &output.stderr].concat()).into_owned()
}

fn holds_secret(bytes: &[u8]) -> bool {
    bytes.windows(SECRET.len()).any(|window| window == SECRET.as_bytes())
}

/// What `bake lod` says of a model; the secret is neither said nor in what it writes.
fn lod(files: &[(&str, &str)], model: &str) -> (Option<i32>, String) {
    let folder = Folder::with(files);
    let output = folder.bake(&["lod", model, "out.glb"]);
    let told = said(&output);
    assert!(!told.contains(SECRET) && !told.contains("panicked"), "{told}");
    let made = fs::read(folder.file("out.glb"));
    assert!(!made.is_ok_and(|bytes| holds_secret(&bytes)), "it was written into the output");
    (output.status.code(), told)
}

#[test]
fn a_model_reads_nothing_outside_its_folder() {
    let obj = |mtl: &str| format!("mtllib {mtl}\n{TRIANGLE}");
    for (mtl, map) in [
        ("m.mtl", "../secret.txt"),
        ("m.mtl", "sub/../../secret.txt"),
        ("m.mtl", "/etc/hostname"),
        ("m.mtl", "/dev/zero"),
        ("../secret.txt", "x.png"),
        ("/etc/passwd", "x.png"),
    ] {
        let files = [("model/m.mtl", &*format!("newmtl a\nmap_Kd {map}\n")), ("model/a.obj", &obj(mtl))];
        let (code, told) = lod(&files, "model/a.obj");
        assert_eq!(code, Some(0), "{told}");
        assert!(told.contains("can't be read and was left out"), "{mtl} {map}: {told}");
    }
    for uri in ["../secret.txt", "..%2fsecret.txt", "%2e%2e/secret.txt", "/dev/zero", "/etc/hostname"] {
        let image = gltf(&format!(r#"[{{"uri":"{uri}","mimeType":"image/png"}}]"#), POINTS);
        let (code, told) = lod(&[("model/a.gltf", &image)], "model/a.gltf");
        assert!(code == Some(0) && told.contains("left out"), "{uri}: {told}");
        let (code, told) = lod(&[("model/a.gltf", &gltf(r#"[{"uri":"x.png"}]"#, uri))], "model/a.gltf");
        assert!(code == Some(2) && told.contains("outside the folder"), "{uri}: {told}");
    }
}

#[cfg(unix)]
#[test]
fn a_link_or_a_pipe_in_the_folder_is_not_followed_or_waited_for() {
    let folder =
        Folder::with(&[("model/a.gltf", &gltf(r#"[{"uri":"link.png"},{"uri":"pipe.png"}]"#, POINTS))]);
    std::os::unix::fs::symlink("../secret.txt", folder.file("model/link.png")).expect("linked");
    assert!(Command::new("mkfifo").arg(folder.file("model/pipe.png")).status().expect("mkfifo").success());
    let output = folder.bake(&["lod", "model/a.gltf", "out.glb"]);
    assert_eq!(said(&output).matches("left out").count(), 2, "{}", said(&output));
    assert!(!holds_secret(&fs::read(folder.file("out.glb")).expect("written")));
}

#[test]
fn files_that_other_programs_write_do_not_panic() {
    let mtl = [("model/a.mtl", "newmtl a\nKd 1\n"), ("model/a.obj", &*format!("mtllib a.mtl\n{TRIANGLE}"))];
    assert_eq!(lod(&mtl, "model/a.obj").0, Some(0));
    for images in [
        r#"[{"name":"x"}]"#,
        r#"[{"bufferView":0}]"#,
        r#"[{"bufferView":null,"uri":null}]"#,
        r#"[{"bufferView":0,"uri":"x.png"}]"#,
        r#"[{"bufferView":99}]"#,
    ] {
        let (code, told) = lod(&[("model/a.gltf", &gltf(images, POINTS))], "model/a.gltf");
        assert!(matches!(code, Some(0 | 2)), "{images}: {told}");
    }
}

#[test]
fn what_a_model_is_called_steers_no_terminal_and_fills_no_screen() {
    let name = "\\u001b[31m".to_owned() + &"x".repeat(5000);
    let images: Vec<String> =
        (0..5000).map(|n| format!(r#"{{"uri":"{n}{name}","name":"{n}{name}"}}"#)).collect();
    let (_, told) =
        lod(&[("model/a.gltf", &gltf(&format!("[{}]", images.join(",")), POINTS))], "model/a.gltf");
    assert!(!told.contains('\u{1b}') && told.contains("more repairs"), "{}", &told[..500]);
    assert!(told.len() < 30_000, "{} bytes are printed", told.len());
}

#[test]
fn a_model_is_not_written_over() {
    let folder = Folder::with(&[("a.obj", TRIANGLE), ("b.gltf", &gltf(r#"[{"uri":"x.png"}]"#, "data.glb"))]);
    folder.bake(&["lod", "a.obj", "a.glb"]);
    let points = [0f32, 0., 0., 1., 0., 0., 0., 1., 0.].map(f32::to_le_bytes);
    fs::write(folder.file("data.glb"), points.as_flattened()).expect("written");
    for (words, why) in [
        (["a.obj", "a.obj"], "must end in .glb"),
        (["a.obj", "b"], "must end in .glb"),
        (["a.glb", "./a.glb"], "is what is being read"),
        (["b.gltf", "data.glb"], "is what is being read"),
    ] {
        let before = words.map(|name| fs::read(folder.file(name)).ok());
        let output = folder.bake(&[&["lod"], &words[..]].concat());
        assert!(
            output.status.code() == Some(2) && said(&output).contains(why),
            "{words:?}: {}",
            said(&output)
        );
        assert_eq!(words.map(|name| fs::read(folder.file(name)).ok()), before);
    }
}

#[test]
fn no_file_of_a_world_is_written_over() {
    let world = World::starters();
    let model = world.file("a.obj");
    fs::write(&model, TRIANGLE).expect("written");
    let before = world.files();
    let blob = world.blobs().into_iter().find(|blob| blob.extension().is_some_and(|end| end == "glb"));
    for out in [
        world.population(0),
        world.file("space.ron"),
        world.file("population/a.glb"),
        blob.expect("a tree"),
        world.scene(0),
    ] {
        let (text, there) = (out.to_str().expect("text"), fs::read(&out).ok());
        for words in [["export", "1", text], ["lod", model.to_str().expect("text"), text]] {
            let output = world.run(&words);
            assert_eq!(output.status.code(), Some(2), "{words:?}: {}", said(&output));
        }
        assert_eq!(fs::read(&out).ok(), there, "{}", out.display());
    }
    assert!(world.files() == before);
}

/// Processor time that a command may take which does next to nothing: even a debug build needs a hundredth.
#[cfg(target_os = "linux")]
#[test]
fn no_model_of_this_size_takes_minutes() {
    let around_one_edge: String = (0..4000).map(|n| format!("v {n} 1 {}\n", n % 7)).collect();
    let faces: String = (0..4000).map(|n| format!("f 1 2 {}\n", n + 3)).collect();
    let book = format!("v 0 0 0\nv 0 0 1\n{around_one_edge}{faces}");
    let polygon = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf {}\n", "1 2 3 ".repeat(20_000));
    for (name, text) in [("book.obj", book), ("polygon.obj", polygon)] {
        let folder = Folder::with(&[(name, &text)]);
        let script =
            format!("ulimit -t 20; exec {:?} lod {name} out.glb", Path::new(env!("CARGO_BIN_EXE_bake")));
        let output = Command::new("sh").args(["-c", &script]).current_dir(folder.0.path()).output();
        let output = output.expect("sh runs");
        assert_eq!(output.status.code(), Some(0), "{name}: {}", said(&output));
    }
}
