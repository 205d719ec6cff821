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
    /// Who descends from whom: what the file says; while it is illegible, what it last said, but without votes.
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
                let lineage = match before.populations.get(&path) {
                    Some(known) if known.digest == digest => known.lineage,
                    // Half saved, or with a mistake: still the child that it was, lest it be bred again.
                    known => lineage(&bytes).or(known
                        .and_then(|known| known.lineage)
                        .map(|known| Lineage { votes: None, ..known })),
                };
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

    /// A population file of `before` is gone.
    pub fn lacks_some_of(&self, before: &Self) -> bool {
        before.populations.keys().any(|path| !self.populations.contains_key(path))
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn world() -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("a temporary folder");
        fs::create_dir(folder.path().join(names::POPULATIONS)).expect("a folder");
        for generation in [0, 3] {
            fs::write(path(&folder, generation), format!("(generation: {generation})")).expect("written");
        }
        fs::write(folder.path().join(names::POPULATIONS).join("g0003.ron~"), "an editor's").expect("written");
        folder
    }

    fn path(folder: &tempfile::TempDir, generation: u32) -> PathBuf {
        folder.path().join(names::population(generation))
    }

    fn look(folder: &tempfile::TempDir, before: &Inputs) -> Inputs {
        Inputs::read(folder.path(), None, before).expect("readable")
    }

    fn saved(folder: &tempfile::TempDir, before: &Inputs) -> Vec<PathBuf> {
        look(folder, before).saved_since(before).cloned().collect()
    }

    #[test]
    fn every_save_is_seen_even_within_one_tick_or_without_a_change() {
        let folder = world();
        let before = look(&folder, &Inputs::default());
        assert_eq!(before.lineages().iter().map(|l| l.generation).collect::<Vec<_>>(), [0, 3]);
        assert!(saved(&folder, &before).is_empty());
        let file =
            |generation| fs::File::options().append(true).open(path(&folder, generation)).expect("there");
        let time = fs::metadata(path(&folder, 3)).and_then(|data| data.modified()).expect("a time");

        fs::write(path(&folder, 3), "(generation: 8)").expect("written");
        file(3).set_modified(time).expect("set");
        assert_eq!(saved(&folder, &before), [path(&folder, 3)], "another text, the same time");

        let before = look(&folder, &before);
        file(0).set_modified(time + Duration::from_secs(9)).expect("set");
        let now = look(&folder, &before);
        assert_eq!(now.saved_since(&before).collect::<Vec<_>>(), [&path(&folder, 0)], "the same text");
        assert!(now.age(&path(&folder, 0)) > now.age(&path(&folder, 3)), "saved later");
    }

    #[test]
    fn a_child_remains_its_parents_child_while_it_is_illegible() {
        let folder = world();
        let child = "(generation: 3, parent: (generation: 0, votes: (sky: 1)), votes: (sky: 2))";
        fs::write(path(&folder, 3), child).expect("written");
        let mut before = look(&folder, &Inputs::default());
        let legible = before.lineages()[1];
        assert!(legible.parent.is_some() && legible.votes.is_some());
        for illegible in ["", &child[..30], "(generation: -1)"] {
            fs::write(path(&folder, 3), illegible).expect("written");
            before = look(&folder, &before);
            assert_eq!(before.lineages()[1], Lineage { votes: None, ..legible }, "{illegible}");
        }
        fs::write(path(&folder, 3), child.replace("sky: 1", "sky: 0")).expect("written");
        assert_ne!(
            look(&folder, &before).lineages()[1].parent,
            legible.parent,
            "legible again: what it says"
        );
    }

    #[test]
    fn one_file_alone_may_matter() {
        let folder = world();
        let only = path(&folder, 0);
        let inputs = Inputs::read(folder.path(), Some(&only), &Inputs::default()).expect("readable");
        assert_eq!(inputs.populations.keys().collect::<Vec<_>>(), [&only]);
        fs::remove_file(&only).expect("removed");
        let gone = Inputs::read(folder.path(), Some(&only), &inputs).expect("readable");
        assert!(gone.populations.is_empty() && gone != inputs && gone.lacks_some_of(&inputs));
        assert!(!inputs.lacks_some_of(&gone));
    }
}
