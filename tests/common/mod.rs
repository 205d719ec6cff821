//! What the tests of whole bakes share: a world in a temporary folder, and the `bake` program run on it.
#![allow(dead_code, reason = "each test file uses some of it")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A world of its own, gone with the test.
pub struct World {
    folder: tempfile::TempDir,
}

impl World {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a temporary folder") }
    }

    pub fn path(&self) -> PathBuf {
        self.folder.path().join("world")
    }

    pub fn file(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    /// `bake WORDS --world …`, small so that tests are quick.
    pub fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_bake"));
        command.args(words).arg("--world").arg(self.path());
        command
    }

    /// Bakes at the smallest size.
    pub fn bake(&self, words: &[&str]) -> Baked {
        let mut command = self.command(words);
        Baked::from(command.args(["--size", "65", "--json"]).output().expect("bake runs"))
    }

    pub fn run(&self, words: &[&str]) -> Output {
        self.command(words).output().expect("bake runs")
    }

    pub fn population(&self, generation: u32) -> PathBuf {
        self.file(&format!("population/g{generation:04}.ron"))
    }

    /// Changes text of a population file.
    pub fn edit(&self, generation: u32, change: impl FnOnce(String) -> String) {
        let path = self.population(generation);
        let text = fs::read_to_string(&path).expect("a population");
        fs::write(path, change(text)).expect("written");
    }

    /// Every file under `baked/` that other programs read, by relative path.
    pub fn files(&self) -> BTreeMap<String, Vec<u8>> {
        let mut files = BTreeMap::new();
        for folder in ["baked/blobs", "baked/g0000"] {
            collect(&self.path(), &self.file(folder), &mut files);
        }
        files
    }
}

fn collect(root: &Path, folder: &Path, into: &mut BTreeMap<String, Vec<u8>>) {
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            collect(root, &path, into);
        } else {
            let name = path.strip_prefix(root).expect("inside").to_string_lossy().into_owned();
            into.insert(name, fs::read(path).expect("readable"));
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
