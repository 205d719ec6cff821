//! A person's session in a real window: the program as it is, under an X server without a screen, with synthetic keys and
//! mouse. What it does is known from its log, its files and its pixels; pictures of it go to target/window-test/.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use clap::Parser;
use genescape_schema::{Parent, Space, Votes};
use genescape_viewer::settings::SettingsFile;
use genescape_world::World;
use serde_json::json;

use crate::display::{Display, Picture, keys};
use crate::program::Viewer;

/// Of the window, in pixels; the screen is as large.
const SIZE: [u16; 2] = [640, 480];
/// Where the four pictures are when they stand two by two: clear of the bar above, names and buttons.
const PICTURES: [[usize; 4]; 4] =
    [[10, 80, 310, 200], [330, 80, 630, 200], [10, 300, 310, 410], [330, 300, 630, 410]];
/// In the first picture, where nothing can be pressed.
const IN_PICTURE: [i16; 2] = [160, 140];

/// A folder of our own with a world in it, and a display.
struct Stage {
    folder: tempfile::TempDir,
    files: World,
    display: Display,
}

impl Stage {
    fn set() -> Self {
        let display = Display::start(SIZE);
        let folder = tempfile::tempdir().expect("a temporary folder");
        let files = World::new(folder.path().join("world"));
        Self { folder, files, display }
    }

    fn viewer(&self, more: &[&str]) -> Viewer {
        // What is baked ahead would take the processor from what is looked at here.
        let usual = ["--world", "world", "--settings", "settings.ron", "--heightfield", "65", "--ahead", "0"];
        Viewer::start(&self.display, self.folder.path(), &[&usual, more].concat())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// What is on the screen, kept for people; each of the four pictures must be one of something, as soon as a busy machine
    /// has drawn it.
    fn look(&self, name: &str) -> Picture {
        let start = Instant::now();
        loop {
            let picture = self.display.picture();
            let brightness = PICTURES.map(|place| picture.brightness(place));
            let is_flat = |(mean, deviation): (f64, f64)| !(8.0..245.0).contains(&mean) || deviation <= 2.0;
            let flat = brightness.into_iter().position(is_flat);
            if flat.is_none() || start.elapsed() > Duration::from_secs(20) {
                picture.save(name);
                assert_eq!(flat, None, "{name}: a view is black, white or flat: {brightness:?}");
                return picture;
            }
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    fn population(&self, generation: u32) -> genescape_schema::Population {
        self.files.population(&Space::builtin(), generation).expect("a valid file").population
    }
}

#[test]
#[ignore = "needs Xvfb and a Vulkan driver: `cargo xtask test` runs it"]
fn a_whole_round_in_a_window() {
    let stage = Stage::set();
    let mut viewer = stage.viewer(&["--size", "640x480", "--pictures", "pictures"]);
    the_first_landscapes_grow(&stage, &mut viewer);
    nothing_is_drawn_when_nothing_changes(&mut viewer);
    drawing_takes_no_more_memory(&stage, &mut viewer);
    a_person_walks_and_looks_around(&stage, &mut viewer);
    a_person_votes_and_breeds(&stage, &mut viewer);
    a_person_goes_back(&stage, &mut viewer);
    files_change_by_another_hand(&stage, &mut viewer);
    a_gene_changes_in_the_panel(&stage, &mut viewer);
    a_picture_is_saved(&stage, &mut viewer);
    the_window_changes_its_size(&stage, &mut viewer);
    it_ends_and_remembers(&stage, viewer);
}

/// An empty folder becomes a world; pictures come one by one while it is baked.
fn the_first_landscapes_grow(stage: &Stage, viewer: &mut Viewer) {
    viewer.until("the first landscapes", |viewer| viewer.shows(0));
    let part = |line: &&serde_json::Value| {
        line["what"] == "bake"
            && line["done"].as_u64().is_some_and(|done| Some(done) < line["total"].as_u64())
    };
    assert!(viewer.lines.iter().filter(part).count() > 10, "no progress was seen");
    let first = viewer.lines.iter().position(|line| line["what"] == "landscape" && !line["name"].is_null());
    let end = viewer.lines.iter().rposition(|line| line["what"] == "bake");
    assert!(first < end, "landscapes do not come one by one");
    let mut names: Vec<_> = viewer.landscapes.iter().map(|one| one["name"].to_string()).collect();
    names.dedup();
    assert_eq!(names.len(), 4, "{names:?}");
    viewer.frames(2);
    stage.look("1-start.png");
}

fn nothing_is_drawn_when_nothing_changes(viewer: &mut Viewer) {
    viewer.until("rest", Viewer::rests);
    viewer.until("the finest pictures", Viewer::is_still);
    let is_refining = |line: &&serde_json::Value| line["what"] == "rest" && line["refining"] == true;
    assert!(viewer.lines.iter().any(|line| is_refining(&line)), "no picture became finer");
    let (frames, seconds) = (viewer.frame(), viewer.processor_s());
    std::thread::sleep(Duration::from_secs(3));
    viewer.read();
    assert!(viewer.frame() <= frames + 1, "{} frames at rest", viewer.frame() - frames);
    let taken_s = viewer.processor_s() - seconds;
    assert!(taken_s < 0.05 * 3.0, "an idle window took {taken_s:.2} s of 3 s");
}

/// On Mesa's software driver it was 9 MiB a frame once. With GENESCAPE_LONG for 2,000 frames.
fn drawing_takes_no_more_memory(stage: &Stage, viewer: &mut Viewer) {
    let walk_back_and_forth = |viewer: &mut Viewer| {
        for key in [keys::W, keys::S] {
            stage.display.key(key, true);
            viewer.frames(25);
            stage.display.key(key, false);
        }
        viewer.memory_mib()
    };
    walk_back_and_forth(viewer);
    let before_mib = walk_back_and_forth(viewer);
    let rounds = if std::env::var_os("GENESCAPE_LONG").is_some() { 38 } else { 1 };
    let after_mib = (0..rounds).map(|_| walk_back_and_forth(viewer)).last().expect("a round");
    genescape_bake::say!("{} frames: {before_mib:.0} MiB, then {after_mib:.0} MiB", 50 * rounds);
    assert!(after_mib < 1.05 * before_mib, "{before_mib:.0} MiB became {after_mib:.0} MiB");
}

/// Where the camera is, and where it looks.
fn place(viewer: &Viewer) -> [f64; 4] {
    ["x_m", "z_m", "yaw_rad", "pitch_rad"].map(|key| viewer.get("pose", key).as_f64().expect("a pose"))
}

fn a_person_walks_and_looks_around(stage: &Stage, viewer: &mut Viewer) {
    let display = &stage.display;
    let before = display.picture();
    let start = place(viewer);
    // The first with each of the others, then all again; the keys that follow are still heard.
    for shown in ["right: 1", "right: 2", "right: 3", "Grid"] {
        display.tap(keys::TAB);
        viewer.until("Tab compares", |viewer| {
            viewer
                .get("screen", "arrangement")
                .as_str()
                .is_some_and(|arrangement| arrangement.contains(shown))
        });
    }
    display.key(keys::W, true);
    viewer.until("the walker moves", |viewer| {
        let now = place(viewer);
        libm::hypot(now[0] - start[0], now[1] - start[1]) > 2.0
    });
    display.key(keys::W, false);
    viewer.frames(1);
    assert_eq!(place(viewer)[2..], start[2..], "walking does not turn the walker");

    // Dragging a picture.
    let turned = |viewer: &Viewer, from: f64| (place(viewer)[2] - from).abs() > 0.02;
    display.point(IN_PICTURE);
    viewer.frames(2);
    display.button(1, true);
    // One frame may be under way; a press and a move that the next one sees together are no drag.
    viewer.frames(2);
    display.nudge([60, 0]);
    viewer.until("a drag turns", |viewer| turned(viewer, start[2]));
    display.button(1, false);
    // The pointer steers after a right click, until Escape.
    viewer.press(display, IN_PICTURE, 3);
    viewer.until("the pointer is the camera's", |viewer| viewer.get("screen", "captured") == true);
    let from = place(viewer);
    display.nudge([-120, 0]);
    viewer.until("the mouse turns", |viewer| turned(viewer, from[2]));
    display.tap(keys::ESCAPE);
    viewer.until("the pointer is free", |viewer| viewer.get("screen", "captured") == false);

    viewer.frames(2);
    let after = stage.look("2-walked.png");
    for place in PICTURES {
        assert!(after.difference(&before, place) > 0.02, "all four walk");
    }
}

/// By key, by click, and with a step back in between.
fn a_person_votes_and_breeds(stage: &Stage, viewer: &mut Viewer) {
    let display = &stage.display;
    let cast = |viewer: &Viewer| ["tree", "terrain", "sky"].map(|name| viewer.get("ballots", name).clone());
    display.tap(keys::U);
    viewer.until("a vote by key", |viewer| cast(viewer) == [json!(0), json!(null), json!(null)]);
    viewer.click(display, "Terrain: best in 2");
    viewer.until("a vote by click", |viewer| cast(viewer) == [json!(0), json!(1), json!(null)]);
    display.tap(keys::DOT);
    viewer.until("another by key", |viewer| cast(viewer) == [json!(0), json!(1), json!(2)]);
    display.tap_with_ctrl(keys::Z);
    viewer.until("it is taken back", |viewer| cast(viewer) == [json!(0), json!(1), json!(null)]);
    display.tap_with_ctrl(keys::Y);
    viewer.until("it is made again", |viewer| cast(viewer) == [json!(0), json!(1), json!(2)]);
    viewer.click(display, "Sky: none of the four");
    viewer.until("none pleases", |viewer| cast(viewer) == [json!(0), json!(1), json!("none")]);
    viewer.frames(1);
    stage.look("3-votes.png");

    let (from, before) = (viewer.lines.len(), place(viewer));
    display.tap(keys::N);
    viewer.until("the next generation", |viewer| viewer.shows(1));
    viewer.frames(5);
    let mut poses: Vec<_> = viewer.lines[from..].iter().filter(|line| line["what"] == "pose").collect();
    poses.dedup_by_key(|pose| [pose["x_m"].clone(), pose["z_m"].clone()]);
    assert!((1..=2).contains(&poses.len()), "one goes to the start once, or once more: {poses:?}");
    assert_ne!(place(viewer), before);
    let votes = Votes { tree: Some(0), terrain: Some(1), sky: None };
    let (parents, children) = (stage.population(0), stage.population(1));
    assert_eq!(parents.votes, Some(votes));
    assert_eq!(children.parent, Some(Parent { generation: 0, votes, variety: None }));
    assert_eq!(cast(viewer), [json!(null), json!(null), json!(null)]);
    viewer.frames(2);
    stage.look("4-children.png");
}

fn a_person_goes_back(stage: &Stage, viewer: &mut Viewer) {
    let display = &stage.display;
    display.tap(keys::PAGE_UP);
    viewer.until("the parents", |viewer| viewer.shows(0));
    display.tap(keys::PAGE_DOWN);
    viewer.until("the children again", |viewer| viewer.shows(1));
    display.tap_with_ctrl(keys::Z);
    viewer.until("the breeding is taken back", |viewer| viewer.shows(0));
    assert_eq!(stage.population(0).votes, None);
    display.tap_with_ctrl(keys::Y);
    viewer.until("it is made again", |viewer| viewer.shows(1));
    assert!(stage.population(0).votes.is_some());
    display.tap_with_ctrl(keys::Z);
    viewer.until("it is taken back once more", |viewer| viewer.shows(0));
    assert_eq!(stage.population(0).votes, None);
    assert_eq!(*viewer.get("ballots", "tree"), 0, "the ballots are as they were before");
    assert_eq!(stage.files.generations().expect("a folder"), [0, 1], "nothing is thrown away");
}

/// An editor changes the population's file while a bake is on; first makes a mistake, then mends it.
fn files_change_by_another_hand(stage: &Stage, viewer: &mut Viewer) {
    let path = stage.files.population_path(0);
    let good = fs::read_to_string(&path).expect("a file");
    let other = good.replacen(" height_m: ", " height_m: 25, // ", 1);
    assert_ne!(other, good);
    let from = viewer.lines.len();
    fs::write(&path, &other).expect("written");
    // In mid-flight: as soon as the bake of that change has begun.
    viewer.until("the change is baked", |viewer| !viewer.get("bake", "generation").is_null());
    fs::write(&path, other.replacen("tree_seed: ", "tree_seed: seven, // ", 1)).expect("written");
    viewer.until("a mistake is told", |viewer| viewer.get("errors", "count") == 1);
    let report = viewer.get("errors", "errors")[0]["report"].to_string();
    assert!(report.contains("g0000.ron") && report.contains("tree_seed"), "{report}");
    viewer.frames(2);
    stage.look("5-mistake.png");
    fs::write(&path, &other).expect("written");
    viewer.until("the mistake is mended", |viewer| viewer.get("errors", "count") == 0);
    viewer.until("the change shows", |viewer| {
        let new = viewer.lines[from..].iter().any(|line| line["what"] == "landscape" && line["view"] == 0);
        new && viewer.shows(0)
    });
}

fn a_gene_changes_in_the_panel(stage: &Stage, viewer: &mut Viewer) {
    let display = &stage.display;
    let before = stage.population(0);
    display.tap(keys::G);
    let field = viewer.place_of("Value of height_m");
    let from = viewer.lines.len();
    viewer.press(display, field, 1);
    // From the next frame on, it takes what is typed.
    viewer.frames(2);
    display.tap_with_ctrl(keys::A);
    "17".chars().for_each(|digit| display.tap(keys::digit(digit)));
    viewer.frames(2);
    stage.display.picture().save("6-genes.png");
    display.tap(keys::ENTER);
    viewer.until("the gene's landscape", |viewer| {
        let new = viewer.lines[from..].iter().any(|line| line["what"] == "landscape" && line["view"] == 0);
        new && viewer.shows(0)
    });
    let after = stage.population(0);
    let height = |population: &genescape_schema::Population| {
        population.individuals[0].genome.value(&Space::builtin(), "height_m").expect("a gene")
    };
    assert!((height(&after) - 17.0).abs() < 0.3 && (height(&before) - 25.0).abs() < 0.3);
    assert_eq!(after.individuals[1..], before.individuals[1..]);
    assert!(viewer.get("screen", "arrangement") == "Grid", "digits that are typed are no commands");
    display.tap(keys::G);
    viewer.until("the panel is gone", |viewer| {
        viewer.get("screen", "panels").as_str().is_some_and(|panels| panels.contains("genome: false"))
    });
}

fn a_picture_is_saved(stage: &Stage, viewer: &mut Viewer) {
    stage.display.tap(keys::F12);
    let path = stage.path("pictures/genescape-0001.png");
    // It is there at once, but written when its last bytes can be read.
    let read = || image::open(&path).ok().map(image::DynamicImage::into_rgba8);
    viewer.until("a picture is saved", |_| read().is_some());
    let image = read().expect("it was just there");
    let (width_px, height_px) = image.dimensions();
    assert!(width_px > 600 && height_px > 350, "{width_px} × {height_px}");
    let distinct: std::collections::BTreeSet<_> = image.as_raw().chunks_exact(4).collect();
    assert!(distinct.len() > 1000, "{} colours", distinct.len());
}

fn the_window_changes_its_size(stage: &Stage, viewer: &mut Viewer) {
    for size in [[300, 200], [640, 90], [60, 480]] {
        stage.display.resize(viewer.window, size);
        viewer.until("the window is small", |viewer| *viewer.get("screen", "size_px") == json!(size));
        viewer.frames(3);
        stage.display.picture().save(&format!("7-window-{}x{}.png", size[0], size[1]));
    }
    stage.display.resize(viewer.window, SIZE.map(u32::from));
    viewer.until("the window is large", |viewer| *viewer.get("screen", "size_px") == json!(SIZE));
    viewer.frames(3);
    stage.look("8-large-again.png");
}

/// What was chosen is there again after a second start, and the window and the walker are as they were.
fn it_ends_and_remembers(stage: &Stage, mut viewer: Viewer) {
    stage.display.tap(keys::F5);
    viewer.until("another LOD mode", |viewer| viewer.get("wish", "wish") == "NextTreeLod");
    stage.display.resize(viewer.window, [600, 440]);
    viewer.until("another size", |viewer| *viewer.get("screen", "size_px") == json!([600, 440]));
    let left = place(&viewer);
    assert_eq!(viewer.quit(&stage.display).code(), Some(0));
    let (kept, problems) = SettingsFile::open(Some(stage.path("settings.ron")));
    assert_eq!(problems, [""; 0]);
    assert_eq!(kept.settings.options.tree_lod, genescape_viewer::lod_mode::TreeLodMode::Simple);

    let mut viewer = stage.viewer(&["--no-bake"]);
    viewer.until("the second start shows all", |viewer| viewer.shows(0));
    assert_eq!(*viewer.get("screen", "size_px"), json!([600, 440]));
    assert_eq!(*viewer.get("ballots", "tree"), 0);
    assert_eq!(*viewer.get("ballots", "sky"), "none");
    viewer.frames(2);
    let found = place(&viewer);
    assert!(left.iter().zip(found).all(|(left, found)| (left - found).abs() < 0.01), "{left:?} {found:?}");
    stage.display.picture().save("9-second-start.png");
    // The last step of the first run.
    let edited = fs::read_to_string(stage.files.population_path(0)).expect("a file");
    stage.display.tap_with_ctrl(keys::Z);
    viewer.until("the gene is taken back", |viewer| {
        fs::read_to_string(stage.files.population_path(0)).is_ok_and(|text| text != edited)
            && viewer.get("ballots", "tree") == 0
    });
    stage.display.tap_with_ctrl(keys::Y);
    viewer.until("the gene is changed again", |_| {
        fs::read_to_string(stage.files.population_path(0)).is_ok_and(|text| text == edited)
    });
    assert_eq!(viewer.quit(&stage.display).code(), Some(0));
}

/// With [`BAKES`] set, this is the baker that is killed.
#[test]
#[ignore = "needs Xvfb and a Vulkan driver: `cargo xtask test` runs it"]
fn a_baker_that_is_killed_leaves_the_viewer_going_and_another_bakes_the_rest() {
    if let Some(world) = std::env::var_os(BAKES) {
        return act_as_a_baker(world.to_str().expect("a temporary folder's name"));
    }
    let stage = Stage::set();
    // A viewer that bakes nothing makes no world either.
    fs::create_dir_all(stage.files.population_path(0).parent().expect("a folder")).expect("made");
    let mut viewer = stage.viewer(&["--no-bake", "--size", "640x480"]);
    viewer.until("an empty world is told", |viewer| viewer.get("screen", "situation") == "stuck");
    let baker = baker(stage.files.root());
    let baked = |files: &World| (0..4).filter(|scene| files.scene_path(0, *scene).is_file()).count();
    let start = Instant::now();
    while baked(&stage.files) == 0 {
        assert!(start.elapsed() < Duration::from_secs(180), "nothing is baked");
        std::thread::sleep(Duration::from_millis(2));
    }
    drop(baker);
    let before = baked(&stage.files);
    assert!(before < 4, "it had done everything already");
    let shown = |viewer: &Viewer| viewer.landscapes.iter().filter(|one| one["generation"] == 0).count();
    viewer.until("what was done is shown", |viewer| shown(viewer) == before);
    viewer.frames(5);
    assert_eq!(*viewer.get("errors", "count"), 0);
    stage.display.picture().save("10-baker-killed.png");

    let second = self::baker(stage.files.root());
    viewer.until("another baker's landscapes", |viewer| viewer.shows(0));
    viewer.frames(2);
    stage.look("11-second-baker.png");
    drop(second);
    viewer.frames(3);
    assert_eq!(viewer.quit(&stage.display).code(), Some(0));
}

/// A scene without its world fills the window; another program's glTF is refused in the window.
#[test]
#[ignore = "needs Xvfb and a Vulkan driver: `cargo xtask test` runs it"]
fn a_scene_alone_and_a_file_that_is_none_of_ours() {
    let stage = Stage::set();
    let baker = baker(stage.files.root());
    let scene = stage.files.scene_path(0, 2);
    let start = Instant::now();
    while !scene.is_file() {
        assert!(start.elapsed() < Duration::from_secs(180), "nothing is baked");
        std::thread::sleep(Duration::from_millis(10));
    }
    drop(baker);
    let open = |path: &Path| {
        let arguments = ["--size", "640x480", "--settings", "alone.ron", path.to_str().expect("UTF-8")];
        Viewer::start(&stage.display, stage.folder.path(), &arguments)
    };
    let mut viewer = open(&scene);
    viewer.until("the scene", |viewer| viewer.landscapes[0]["generation"] == 0);
    for key in [keys::U, keys::TAB, keys::digit('3')] {
        stage.display.tap(key);
    }
    viewer.frames(3);
    assert_eq!(*viewer.get("screen", "arrangement"), "One(0)");
    assert!(viewer.get("ballots", "tree").is_null());
    stage.display.picture().save("12-one-scene.png");
    assert_eq!(viewer.quit(&stage.display).code(), Some(0));

    let foreign = stage.path("triangle.gltf");
    fs::write(&foreign, r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}]}"#)
        .expect("written");
    let mut viewer = open(&foreign);
    viewer.until("it is told", |viewer| viewer.get("screen", "situation") == "stuck");
    assert!(viewer.get("errors", "errors")[0]["report"].to_string().contains("triangle.gltf"));
    viewer.frames(2);
    stage.display.picture().save("13-no-landscape.png");
    assert_eq!(viewer.quit(&stage.display).code(), Some(0));
}

/// Names the world to a process of this program that is to be a baker.
const BAKES: &str = "GENESCAPE_TEST_BAKES";
/// The test that such a process runs.
const BAKER: &str = "window::a_baker_that_is_killed_leaves_the_viewer_going_and_another_bakes_the_rest";

/// A baker's process; it ends with this value, by SIGKILL: it has no time to tidy up.
struct Baker(Child);

impl Drop for Baker {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// `bake --watch` in a process of its own: this very program, for the viewer's tests have no other at hand.
fn baker(world: &Path) -> Baker {
    let process = Command::new(std::env::current_exe().expect("this program"))
        .args(["--exact", BAKER, "--include-ignored", "--nocapture"])
        .env(BAKES, world)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("this program once more");
    Baker(process)
}

/// What the process of [`baker`] does.
fn act_as_a_baker(world: &str) {
    let command = ["bake", "--watch", "--world", world, "--size", "65", "--threads", "1"];
    genescape_bake::commands::run(genescape_bake::cli::Cli::parse_from(command));
}
