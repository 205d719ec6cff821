//! What was measured, as files in one folder: each measurement is written as soon as it is there, and read instead of made
//! when the laboratory goes on.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use genescape_cache::Digest;
use genescape_world::atomic_write;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::measure::Machine;

/// Beside the measurements: what they depend on.
const CONFIGURATION: &str = "laboratory.json";
/// Where the tables are.
const SERIES: &str = "series";

/// All that measurements depend on. Two folders with the same can be put together; with others, compared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Configuration {
    /// "viewer lab --quick", as it was called.
    pub command: String,
    /// Version and digest of the program.
    pub program: String,
    /// Of the checkout that the program lies in, if it lies in one.
    pub commit: Option<String>,
    pub size_px: [u32; 2],
    /// Places of the camera across the land.
    pub steps: u32,
    /// Frames across the land where popping is measured.
    pub frames: u32,
    /// Scenes whose preprocessing is measured.
    pub scenes: u32,
    pub machine: Machine,
}

impl Configuration {
    /// For people: names and values.
    pub fn facts(&self) -> Vec<(String, String)> {
        let Self { command, program, commit, size_px: [width, height], steps, frames, scenes, machine } =
            self;
        let facts = [
            ("Machine", machine.told()),
            ("Driver", machine.driver.clone()),
            ("Program", format!("genescape-viewer {program}")),
            ("Commit", commit.clone().unwrap_or_else(|| "not known".into())),
            ("Command", command.clone()),
            (
                "Pictures",
                format!(
                    "{width} × {height}; {steps} places there and back, {frames} frames for popping, {scenes} bred scenes"
                ),
            ),
        ];
        facts.map(|(name, value)| (name.to_owned(), value)).into()
    }

    /// Whether measurements of both belong together; programs run under any load.
    fn suits(&self, other: &Self) -> bool {
        let key = |one: &Self| {
            let machine = Machine { load_average: None, ..one.machine.clone() };
            Self { command: String::new(), machine, ..one.clone() }
        };
        key(self) == key(other)
    }
}

/// The folder.
#[derive(Debug)]
pub struct Store {
    root: PathBuf,
}

impl Store {
    /// Opens the folder `root` to measure, or to go on with the same `configuration`.
    ///
    /// # Errors
    /// A folder that holds measurements of another program, machine or size; one that cannot be written to.
    pub fn open(root: &Path, configuration: &Configuration) -> Result<Self> {
        let store = Self { root: root.to_owned() };
        match Self::read(root) {
            Ok((_, found)) => ensure!(
                found.suits(configuration),
                "{} holds measurements of another program, machine, or size ({}, {}); name another folder, and \
                 compare both by `viewer lab compare`",
                root.display(),
                found.command,
                found.machine.device
            ),
            Err(_) if !root.join(CONFIGURATION).exists() => {
                let is_free = fs::read_dir(root).map_or(true, |mut entries| entries.next().is_none());
                ensure!(
                    is_free,
                    "{} is neither empty nor a laboratory's folder; name another one",
                    root.display()
                );
                write(root, CONFIGURATION, serde_json::to_string_pretty(configuration)?)?;
            }
            Err(error) => return Err(error),
        }
        Ok(store)
    }

    /// Opens a folder that was measured into.
    ///
    /// # Errors
    /// A folder without, or with a damaged, configuration.
    pub fn read(root: &Path) -> Result<(Self, Configuration)> {
        let path = root.join(CONFIGURATION);
        let text = fs::read_to_string(&path).with_context(|| {
            format!("{} is no laboratory's folder: {} cannot be read", root.display(), path.display())
        })?;
        let configuration = serde_json::from_str(&text)
            .with_context(|| format!("{} is damaged; remove the folder to measure anew", path.display()))?;
        Ok((Self { root: root.to_owned() }, configuration))
    }

    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Whether a table is there.
    pub fn has(&self, name: &str) -> bool {
        self.table(name).exists()
    }

    /// The rows of a table; none if it was not measured.
    ///
    /// # Errors
    /// A table that is damaged.
    pub fn rows<R: DeserializeOwned>(&self, name: &str) -> Result<Vec<R>> {
        let path = self.table(name);
        let mut reader = match csv::Reader::from_path(&path) {
            Ok(reader) => reader,
            Err(error) => match error.into_kind() {
                csv::ErrorKind::Io(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
                kind => bail!("{} cannot be read: {kind:?}", path.display()),
            },
        };
        let rows = reader.deserialize().collect::<Result<Vec<R>, _>>();
        rows.with_context(|| format!("{} is damaged; remove it to measure it anew", path.display()))
    }

    /// Writes a table.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn keep<R: Serialize>(&self, name: &str, rows: &[R]) -> Result<()> {
        write(&self.root, &format!("{SERIES}/{name}.csv"), to_csv(rows)?)
    }

    fn table(&self, name: &str) -> PathBuf {
        self.root.join(SERIES).join(format!("{name}.csv"))
    }
}

/// Writes a file into a folder.
///
/// # Errors
/// A folder that cannot be written to.
pub fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> Result<()> {
    let path = folder.join(name);
    atomic_write::replace(&path, bytes).with_context(|| format!("cannot write {}", path.display()))
}

/// Rows as CSV (RFC 4180) with a line of names.
///
/// # Errors
/// Rows that are no flat records.
pub fn to_csv<R: Serialize>(rows: &[R]) -> Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    rows.iter().try_for_each(|row| writer.serialize(row))?;
    Ok(String::from_utf8(writer.into_inner().context("memory can be written to")?)?)
}

/// Version and digest of this program.
///
/// # Errors
/// A program that cannot read itself.
pub fn this_program() -> Result<String> {
    let path = std::env::current_exe().context("the system does not say where this program is")?;
    let bytes = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let digest = Digest::of(&bytes).to_string();
    Ok(format!("{} {}", env!("CARGO_PKG_VERSION"), &digest[..12]))
}

/// The commit of the checkout that this program was built in, as its folder says.
pub fn commit() -> Option<String> {
    let path = std::env::current_exe().ok()?;
    let git = path.ancestors().map(|folder| folder.join(".git")).find(|git| git.exists())?;
    let git = match fs::read_to_string(&git) {
        // Of a further work tree.
        Ok(text) => PathBuf::from(text.strip_prefix("gitdir:")?.trim()),
        Err(_) => git,
    };
    let head = fs::read_to_string(git.join("HEAD")).ok()?;
    let Some(branch) = head.trim().strip_prefix("ref: ") else { return Some(head.trim().to_owned()) };
    let shared = fs::read_to_string(git.join("commondir")).map_or(git.clone(), |to| git.join(to.trim()));
    let named = fs::read_to_string(shared.join(branch)).ok().map(|id| id.trim().to_owned());
    named.or_else(|| {
        let packed = fs::read_to_string(shared.join("packed-refs")).ok()?;
        packed.lines().find_map(|line| Some(line.strip_suffix(branch)?.trim().to_owned()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Row {
        scheme: String,
        frame: u32,
        l2: Option<f64>,
    }

    fn configuration(steps: u32) -> Configuration {
        Configuration {
            command: format!("viewer lab --steps {steps}"),
            program: "1".into(),
            commit: None,
            size_px: [4, 3],
            steps,
            frames: 2,
            scenes: 1,
            machine: Machine::default(),
        }
    }

    #[test]
    fn what_was_measured_is_read_again_and_never_mixed() {
        let folder = tempfile::tempdir().expect("a folder");
        let root = folder.path().join("out");
        let store = Store::open(&root, &configuration(5)).expect("new");
        assert!(!store.has("walk") && store.rows::<Row>("walk").expect("none").is_empty());
        let rows = [
            Row { scheme: "a, \"b\"".into(), frame: 1, l2: Some(0.25) },
            Row { scheme: "c".into(), frame: 2, l2: None },
        ];
        store.keep("walk", &rows).expect("written");

        let again = Store::open(&root, &configuration(5)).expect("the same");
        assert_eq!(again.rows::<Row>("walk").expect("whole"), rows);
        let busy = Machine { load_average: Some(3.0), ..Machine::default() };
        Store::open(&root, &Configuration { machine: busy, ..configuration(5) }).expect("only busier");

        let other = Store::open(&root, &configuration(6)).expect_err("another").to_string();
        assert!(other.contains("--steps 5") && other.contains("name another folder"), "{other}");
        assert_eq!(again.rows::<Row>("walk").expect("still there"), rows);

        atomic_write::replace(&root.join("series/walk.csv"), "scheme,frame,l2\na,x,1\n").expect("written");
        let told = format!("{:#}", again.rows::<Row>("walk").expect_err("no number"));
        assert!(told.contains("walk.csv") && told.contains("remove it"), "{told}");
    }

    #[test]
    fn a_folder_of_somebody_else_is_left_alone() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("letter.txt");
        atomic_write::replace(&file, "dear").expect("written");
        let told = Store::open(folder.path(), &configuration(5)).expect_err("not ours").to_string();
        assert!(told.contains("neither empty"), "{told}");
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1);
    }
}
