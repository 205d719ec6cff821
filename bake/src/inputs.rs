//! What a person can change in a world folder, as it is at one moment: two such moments compared say what was saved
//! in between, however few or many events told of it.

use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use anyhow::{Context, Result};
use genescape_cache::Digest;
use genescape_schema::{Lineage, names};

/// The space and the population files.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// The digest of `space.ron`; `None` if there is none.
    pub space: Option<Digest>,
    /// The population files.
    pub populations: BTreeMap<PathBuf, Save>,
}

/// What is known of a file that was saved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Save {
    /// When, by the file system's clock. Saving a file as it was counts, too: it asks for its bake.
    pub saved: Option<SystemTime>,
    /// Of its bytes: two saves may fall within one tick of that clock.
    pub digest: Digest,
    /// Who descends from whom, if the file says so legibly.
    pub lineage: Option<Lineage>,
}

impl Inputs {
    /// What is there now in the world folder `root`, or of its populations the file `only`. What `before` knows
    /// already is not parsed again.
    ///
    /// # Errors
    /// A folder or file that cannot be read. A file that vanishes meanwhile is none.
    pub fn read(root: &Path, only: Option<&Path>, before: &Self) -> Result<Self> {
        let space = read(&root.join(names::SPACE))?.map(|(bytes, _)| Digest::of(&bytes));
        let mut populations = BTreeMap::new();
        for path in only.map_or_else(|| population_files(root), |path| Ok(vec![path.to_owned()]))? {
            if let Some((bytes, saved)) = read(&path)? {
                let digest = Digest::of(&bytes);
                let known = before.populations.get(&path).filter(|known| known.digest == digest);
                let lineage = known.map_or_else(|| lineage(&bytes), |known| known.lineage);
                populations.insert(path, Save { saved, digest, lineage });
            }
        }
        Ok(Self { space, populations })
    }

    /// The population files that are new or were saved since `before`.
    pub fn saved_since<'a>(&'a self, before: &'a Self) -> impl Iterator<Item = &'a PathBuf> {
        let changed = |(path, save): &(&PathBuf, &Save)| before.populations.get(*path) != Some(*save);
        self.populations.iter().filter(changed).map(|(path, _)| path)
    }

    /// Who descends from whom.
    pub fn lineages(&self) -> Vec<Lineage> {
        self.populations.values().filter_map(|save| save.lineage).collect()
    }

    /// Orders population files by when they were saved, the same moment by name; a file that is gone comes first.
    pub fn age<'a>(&self, path: &'a Path) -> (Option<SystemTime>, &'a Path) {
        (self.populations.get(path).and_then(|save| save.saved), path)
    }
}

fn lineage(bytes: &[u8]) -> Option<Lineage> {
    Lineage::read("", std::str::from_utf8(bytes).ok()?).ok()
}

fn population_files(root: &Path) -> Result<Vec<PathBuf>> {
    let folder = root.join(names::POPULATIONS);
    let mut files = Vec::new();
    for entry in fs::read_dir(&folder).with_context(|| format!("cannot read {}", folder.display()))? {
        let name = entry?.file_name();
        if name.to_str().and_then(names::generation).is_some() {
            files.push(folder.join(name));
        }
    }
    Ok(files)
}

fn read(path: &Path) -> Result<Option<(Vec<u8>, Option<SystemTime>)>> {
    // The time first: a save in between is then found by the next look.
    let saved = fs::metadata(path).and_then(|data| data.modified()).ok();
    match fs::read(path) {
        Ok(bytes) => Ok(Some((bytes, saved))),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error).with_context(|| format!("cannot read {}", path.display())),
    }
}
