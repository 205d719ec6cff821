//! The folder a person works in: what is theirs (space, populations) and what was baked.
//!
//! A person's files are only ever created, by temporary file, sync and rename, never overwritten.

use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};
use genescape_cache::Digest;
use genescape_schema::{Current, Loaded, Population, Space, names};

use crate::breed::BreedError;

/// The landscapes that new worlds begin with.
pub const STARTER_RON: &str = include_str!("../../configs/starter.ron");

/// An open world folder.
#[derive(Debug)]
pub struct World {
    root: PathBuf,
    space: Space,
}

/// A population file as found.
#[derive(Debug)]
pub struct PopulationFile {
    /// Where it is.
    pub path: PathBuf,
    /// What it says, with the values that were rounded.
    pub loaded: Loaded,
    /// Digest of its bytes.
    pub digest: Digest,
}

impl World {
    /// Opens the world in `root`, which is made if there is none.
    pub fn open_or_create(root: &Path) -> Result<Self> {
        let populations = root.join(names::POPULATIONS);
        fs::create_dir_all(&populations).with_context(|| {
            format!("cannot make the world folder {}; choose another with --world DIR", root.display())
        })?;
        let space_path = root.join(names::SPACE);
        if !space_path.exists() {
            create_unless_there(&space_path, Space::BUILTIN)?;
        }
        Self::open(root)
    }

    /// Gives a world without a population the starter landscapes; `true` if it did.
    pub fn begin(&self) -> Result<bool> {
        if self.newest_generation()?.is_some() {
            return Ok(false);
        }
        create_unless_there(&self.root.join(names::population(0)), STARTER_RON)
    }

    /// Opens the world in `root`, which must exist.
    pub fn open(root: &Path) -> Result<Self> {
        if !root.join(names::POPULATIONS).is_dir() {
            bail!(
                "{} is no world folder: it has no {}/; `bake` makes one",
                root.display(),
                names::POPULATIONS
            );
        }
        let mut world = Self { root: root.to_owned(), space: Space::builtin() };
        world.reload_space()?;
        Ok(world)
    }

    /// Reads `space.ron` again.
    pub fn reload_space(&mut self) -> Result<()> {
        let path = self.root.join(names::SPACE);
        match fs::read_to_string(&path) {
            Ok(text) => self.space = Space::parse(&path.display().to_string(), &text)?,
            Err(error) if error.kind() == ErrorKind::NotFound => self.space = Space::builtin(),
            Err(error) => return Err(error).with_context(|| format!("cannot read {}", path.display())),
        }
        Ok(())
    }

    /// The folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// This world's parameter space.
    pub fn space(&self) -> &Space {
        &self.space
    }

    /// The highest generation that has a population file.
    pub fn newest_generation(&self) -> Result<Option<u32>> {
        let folder = self.root.join(names::POPULATIONS);
        let mut newest = None;
        for entry in fs::read_dir(&folder).with_context(|| format!("cannot read {}", folder.display()))? {
            let name = entry?.file_name();
            newest = newest.max(name.to_str().and_then(names::generation));
        }
        Ok(newest)
    }

    /// The file of the newest population.
    pub fn newest_population(&self) -> Result<PathBuf> {
        let generation = self.newest_generation()?.ok_or_else(|| {
            anyhow!("{} holds no population; `bake random --seed 1` makes one", self.root.display())
        })?;
        Ok(self.root.join(names::population(generation)))
    }

    /// The number of the next population to be made, whatever it is made of.
    pub fn next_generation(&self) -> Result<u32> {
        let Some(newest) = self.newest_generation()? else { return Ok(0) };
        Ok(newest.checked_add(1).ok_or(BreedError::LastGeneration { generation: newest })?)
    }

    /// Reads and checks a population file.
    pub fn load_population(&self, path: &Path) -> Result<PopulationFile> {
        let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
        let digest = Digest::of(&bytes);
        let text = String::from_utf8(bytes)
            .map_err(|error| anyhow!("{}: not text: {}", path.display(), error.utf8_error()))?;
        let loaded = Population::load(&self.space, &path.display().to_string(), &text)?;
        Ok(PopulationFile { path: path.to_owned(), loaded, digest })
    }

    /// Writes a population as a new file and says where. Fails rather than overwrite one.
    pub fn save_population(&self, population: &Population) -> Result<PathBuf> {
        let path = self.root.join(names::population(population.generation));
        create(&path, &population.to_ron(&self.space))?;
        Ok(path)
    }

    /// Puts a scene's file in its place unless the very same is there. The file is always whole: it is renamed.
    pub fn publish_scene(
        &self,
        generation: u32,
        scene: usize,
        digest: Digest,
        json: &dyn Fn() -> Result<Vec<u8>>,
    ) -> Result<()> {
        let path = self.scene_path(generation, scene);
        if fs::read(&path).is_ok_and(|there| Digest::of(&there) == digest) {
            return Ok(());
        }
        replace(&path, &json()?)
    }

    /// Where a scene's file is.
    pub fn scene_path(&self, generation: u32, scene: usize) -> PathBuf {
        self.root.join(names::scene(generation, scene))
    }

    /// Says in `current.ron` that all scenes of a population are ready.
    pub fn publish_current(&self, population: &PopulationFile) -> Result<()> {
        let generation = population.loaded.population.generation;
        let current = Current {
            generation,
            population: population.digest.to_string(),
            scenes: std::array::from_fn(|scene| names::scene(generation, scene)),
        };
        let (path, text) = (self.root.join(names::CURRENT), current.to_ron());
        if fs::read_to_string(&path).is_ok_and(|there| there == text) {
            return Ok(());
        }
        replace(&path, text.as_bytes())
    }

    /// What `current.ron` says.
    pub fn current(&self) -> Result<Current> {
        let path = self.root.join(names::CURRENT);
        let text = fs::read_to_string(&path)
            .with_context(|| format!("cannot read {}: nothing has been baked here yet", path.display()))?;
        Ok(Current::load(&path.display().to_string(), &text)?)
    }

    /// The scene files of all generations that are still in the folder.
    pub fn scene_files(&self) -> Result<Vec<PathBuf>> {
        let baked = self.root.join(names::BAKED);
        let mut files = Vec::new();
        for generation in read_dir_sorted(&baked)? {
            if generation.file_name().is_some_and(|n| n.to_string_lossy().starts_with('g')) {
                files.extend(read_dir_sorted(&generation)?.into_iter().map(|s| s.join("scene.gltf")));
            }
        }
        files.retain(|file| file.is_file());
        Ok(files)
    }
}

/// Whether all files that a scene names exist.
pub fn is_whole(scene: &Path) -> Result<bool> {
    let text = fs::read_to_string(scene).with_context(|| format!("cannot read {}", scene.display()))?;
    let Ok(json) = serde_json::from_str::<serde_json::Value>(&text) else { return Ok(false) };
    let folder = scene.parent().unwrap_or(Path::new("."));
    Ok(uris(&json).iter().all(|uri| folder.join(uri).is_file()))
}

/// Every "uri" in a JSON document.
fn uris(json: &serde_json::Value) -> Vec<&str> {
    match json {
        serde_json::Value::Object(fields) => fields
            .iter()
            .flat_map(|(name, value)| match value {
                serde_json::Value::String(uri) if name == "uri" => vec![uri.as_str()],
                other => uris(other),
            })
            .collect(),
        serde_json::Value::Array(items) => items.iter().flat_map(uris).collect(),
        _ => Vec::new(),
    }
}

fn read_dir_sorted(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            return Ok(Vec::new());
        }
        Err(error) => return Err(error).with_context(|| format!("cannot read {}", folder.display())),
    };
    let mut paths = entries.map(|e| Ok(e?.path())).collect::<std::io::Result<Vec<_>>>()?;
    paths.sort();
    Ok(paths)
}

/// Writes a file that must not exist yet, so that a crash or a full disk leaves either all of it or nothing.
pub fn create(path: &Path, text: &str) -> Result<()> {
    let file = draft(path, text.as_bytes(), true)?;
    file.persist_noclobber(path)
        .map_err(|error| error.error)
        .with_context(|| format!("cannot create {}", path.display()))?;
    Ok(())
}

/// The same, but another process may be the one that creates it; `true` if it was this one.
fn create_unless_there(path: &Path, text: &str) -> Result<bool> {
    match create(path, text) {
        Ok(()) => Ok(true),
        Err(_) if path.is_file() => Ok(false),
        Err(error) => Err(error),
    }
}

/// Writes a file that the person asked for (an export), replacing an older one, synced.
pub fn write_synced(path: &Path, bytes: &[u8]) -> Result<()> {
    let file = draft(path, bytes, true)?;
    file.persist(path)
        .map_err(|error| error.error)
        .with_context(|| format!("cannot write {}", path.display()))?;
    Ok(())
}

/// Replaces a file that can be made again.
fn replace(path: &Path, bytes: &[u8]) -> Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    }
    let file = draft(path, bytes, false)?;
    file.persist(path)
        .map_err(|error| error.error)
        .with_context(|| format!("cannot write {}", path.display()))?;
    Ok(())
}

fn draft(path: &Path, bytes: &[u8], sync: bool) -> Result<tempfile::NamedTempFile> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let write = || -> std::io::Result<tempfile::NamedTempFile> {
        let mut builder = tempfile::Builder::new();
        // A temporary file is private by default; what is renamed into place is for everyone to read.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644));
        let mut file = builder.prefix(".draft-").tempfile_in(folder)?;
        file.write_all(bytes)?;
        if sync {
            file.as_file().sync_all()?;
        }
        Ok(file)
    };
    write().with_context(|| format!("cannot write {}", path.display()))
}
