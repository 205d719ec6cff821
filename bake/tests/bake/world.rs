//! A world in a temporary folder, and the `bake` program run on it.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::LazyLock;
use std::time::{Duration, SystemTime};

/// Temporary folders, on the disk that holds the baked starters.
const TEMPORARY: &str = env!("CARGO_TARGET_TMPDIR");

/// A world of its own, gone with the test.
pub struct World {
    folder: tempfile::TempDir,
}

/// A world that was baked once for all tests of this process, for them to copy.
struct Starters {
    world: PathBuf,
    baked: Baked,
    /// Keeps another process from the folder.
    _lock: File,
}

static STARTERS: LazyLock<Starters> = LazyLock::new(|| {
    let folder = Path::new(TEMPORARY).join("starters");
    let lock = File::create(folder.with_extension("lock")).expect("cargo's folder can be written to");
    lock.lock().expect("locked");
    let _ = fs::remove_dir_all(&folder);
    let world = folder.join("world");
    // More threads than this machine has cores: nothing may depend on it.
    let baked = bake(&world, &["--threads", "8"]).ok();
    Starters { world, baked, _lock: lock }
});

impl World {
    /// A world that doesn't exist yet.
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir_in(TEMPORARY).expect("a temporary folder") }
    }

    /// The starters, baked at the smallest size.
    pub fn starters() -> Self {
        let world = Self::new();
        copy(&STARTERS.world, &world.path(), false);
        world
    }

    /// How the bake of [`World::starters`] went.
    pub fn first_bake() -> &'static Baked {
        &STARTERS.baked
    }

    pub fn path(&self) -> PathBuf {
        self.folder.path().join("world")
    }

    pub fn file(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    /// `bake WORDS --world …`
    pub fn command(&self, words: &[&str]) -> Command {
        command(&self.path(), words)
    }

    /// Bakes at the smallest size.
    pub fn bake(&self, words: &[&str]) -> Baked {
        bake(&self.path(), words)
    }

    /// A bake at the smallest size, whose events are read as they come.
    pub fn spawn(&self, words: &[&str]) -> (Child, impl Iterator<Item = String> + use<>) {
        let mut command = self.command(words);
        command.args(["--size", "65", "--json"]);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("bake runs");
        let lines = BufReader::new(child.stdout.take().expect("piped")).lines();
        (child, lines.map(|line| line.expect("text")))
    }

    pub fn run(&self, words: &[&str]) -> Output {
        self.command(words).output().expect("bake runs")
    }

    pub fn population(&self, generation: u32) -> PathBuf {
        self.file(&format!("population/g{generation:04}.ron"))
    }

    pub fn scene(&self, scene: usize) -> PathBuf {
        self.file(&format!("baked/g0000/scene-{scene}/scene.gltf"))
    }

    /// Changes text of a population file.
    pub fn edit(&self, generation: u32, change: impl FnOnce(String) -> String) {
        let path = self.population(generation);
        let text = fs::read_to_string(&path).expect("a population");
        fs::write(path, change(text)).expect("written");
    }

    /// Digests of all files under `baked/` that other programs read, by relative path; not of what was moved aside.
    pub fn files(&self) -> BTreeMap<String, blake3::Hash> {
        let mut files = BTreeMap::new();
        for folder in ["baked/blobs", "baked/g0000"] {
            collect(&self.path(), &self.file(folder), &mut files);
        }
        files
    }

    /// The files that a current scene names and that are missing or damaged; none before the first bake is done.
    pub fn holes(&self) -> Vec<PathBuf> {
        let scenes =
            (0..4).map(|scene| self.scene(scene)).filter(|_| self.file("baked/current.ron").exists());
        let named = scenes.flat_map(|scene| {
            let text = fs::read_to_string(&scene).unwrap_or_else(|_| panic!("{} is there", scene.display()));
            let uris = text.split("\"uri\":\"").skip(1).filter_map(|rest| rest.split('"').next());
            let files: Vec<PathBuf> = uris.map(|uri| scene.with_file_name(uri)).collect();
            assert!(files.len() > 20, "it names its blobs");
            files
        });
        let is_whole = |file: &PathBuf| {
            let promised = file.file_stem().expect("a name").to_string_lossy().into_owned();
            fs::read(file).is_ok_and(|bytes| blake3::hash(&bytes).to_hex().to_string() == promised)
        };
        named.filter(|file| !is_whole(file)).collect()
    }

    /// Every file of the cache looks as if nobody had used it for an hour, as after a jump of the clock. Blobs, whose
    /// files are shared and whose times are no dates, are left out.
    pub fn age(&self) {
        let old = SystemTime::now() - Duration::from_secs(3600);
        for folder in ["baked/actions", "baked/history", "baked/g0000"] {
            let mut files = BTreeMap::new();
            collect(&self.path(), &self.file(folder), &mut files);
            for name in files.keys() {
                let file = File::options().append(true).open(self.file(name));
                // It may have gone since.
                let _ = file.and_then(|file| file.set_modified(old));
            }
        }
    }

    pub fn blobs(&self) -> Vec<PathBuf> {
        let files = self.files().into_keys().filter(|name| name.starts_with("baked/blobs"));
        files.map(|name| self.file(&name)).collect()
    }
}

/// Puts other bytes in a blob's place. Not into its file, which [`World::starters`] shares.
pub fn damage(blob: &Path, change: impl FnOnce(Vec<u8>) -> Vec<u8>) {
    let bytes = change(fs::read(blob).expect("readable"));
    fs::remove_file(blob).expect("removed");
    fs::write(blob, bytes).expect("written");
}

fn command(world: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_bake"));
    command.args(words).arg("--world").arg(world);
    command
}

fn bake(world: &Path, words: &[&str]) -> Baked {
    Baked::from(command(world, words).args(["--size", "65", "--json"]).output().expect("bake runs"))
}

/// Copies a folder; blobs, which nobody changes, by hard links.
fn copy(from: &Path, to: &Path, by_link: bool) {
    fs::create_dir_all(to).expect("made");
    for entry in fs::read_dir(from).expect("a folder") {
        let (from, to) = (entry.expect("an entry").path(), to);
        let to = to.join(from.file_name().expect("a name"));
        if from.is_dir() {
            copy(&from, &to, by_link || from.ends_with("blobs"));
        } else if by_link {
            fs::hard_link(&from, &to).expect("linked");
        } else {
            fs::copy(&from, &to).expect("copied");
        }
    }
}

fn collect(root: &Path, folder: &Path, into: &mut BTreeMap<String, blake3::Hash>) {
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.expect("an entry").path();
        if path.to_string_lossy().contains(".aside-") {
            continue;
        }
        if path.is_dir() {
            collect(root, &path, into);
        } else {
            let name = path.strip_prefix(root).expect("inside").to_string_lossy().into_owned();
            into.insert(name, blake3::hash(&fs::read(path).expect("readable")));
        }
    }
}

/// What a bake said.
pub struct Baked {
    pub code: Option<i32>,
    pub stderr: String,
    pub events: Vec<serde_json::Value>,
}

impl From<Output> for Baked {
    fn from(output: Output) -> Self {
        let text = String::from_utf8(output.stdout).expect("text");
        let events = text.lines().map(|line| serde_json::from_str(line).expect("a JSON line")).collect();
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        Self { code: output.status.code(), stderr, events }
    }
}

impl Baked {
    /// Fails the test with all that was said unless the bake succeeded.
    pub fn ok(self) -> Self {
        assert_eq!(self.code, Some(0), "bake failed: {}", self.stderr);
        self
    }

    /// Events of a kind.
    pub fn of<'a>(&'a self, kind: &'a str) -> impl Iterator<Item = &'a serde_json::Value> {
        self.events.iter().filter(move |event| event["event"] == kind)
    }

    /// How many stages the plan has.
    pub fn planned(&self) -> usize {
        let planned = self.of("planned").next().expect("a plan");
        planned["stages"].as_u64().expect("a number") as usize
    }

    /// Stages that were computed, with the first scene each is used by, sorted.
    pub fn built(&self) -> Vec<(String, u64)> {
        let finished = self.of("finished").filter(|event| event["reused"] == false);
        let mut built: Vec<_> = finished
            .map(|event| {
                let scene = event["scenes"][0].as_u64().expect("a scene");
                (event["stage"].as_str().expect("a stage").to_owned(), scene)
            })
            .collect();
        built.sort();
        built
    }
}
