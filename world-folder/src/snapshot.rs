//! The state of a world folder at one moment: two snapshots compared say what was saved in between, however few or many
//! events reported it.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use genescape_schema::{INDIVIDUALS, Lineage};

use crate::folder::{MAX_TEXT_BYTES, World, list};
use crate::{names, regular_file};

/// What changed between two snapshots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Change {
    /// `space.ron` came, went or was saved.
    Space,
    /// A population file came, went or was saved.
    Population(u32),
    /// A `scene.gltf` came, went or was replaced; `index` is 0 … 3.
    Scene { generation: u32, index: usize },
    /// `current.ron` came, went or was replaced.
    Current,
    /// A `.wgsl` file of the folder of shaders came, went or was saved.
    Shaders,
    /// The file of that number in [`Scope::files`] came, went or was saved.
    File(usize),
}

/// What to look at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scope {
    /// Its `space.ron`, and what else is asked for.
    pub world: Option<World>,
    /// This population file alone, wherever it lies, instead of all of the world's.
    pub population: Option<PathBuf>,
    /// What was baked: scenes and `current.ron`.
    pub scenes: bool,
    /// A folder with WGSL files, for those who write shaders.
    pub shaders: Option<PathBuf>,
    /// Any other files.
    pub files: Vec<PathBuf>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    space: Option<Stamp>,
    populations: BTreeMap<PathBuf, (Stamp, Option<Lineage>)>,
    current: Option<Stamp>,
    scenes: BTreeMap<(u32, usize), Stamp>,
    shaders: BTreeMap<PathBuf, Stamp>,
    files: BTreeMap<usize, Stamp>,
    /// Folders that files of interest may come into.
    pub(crate) folders: BTreeSet<PathBuf>,
}

/// Identifies one saved state of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stamp {
    /// By the file system's clock. Saving a file as it was counts, too: it asks for its bake.
    saved: Option<SystemTime>,
    /// Of a small file the digest: two saves may fall within one tick of that clock. Of a scene, which is always
    /// replaced by another file, its length and number.
    digest: Option<blake3::Hash>,
    length: u64,
    inode: u64,
}

impl Stamp {
    /// What the system knows of a file; `None` if it is not there. Links are followed.
    pub fn of(path: &Path) -> Option<Self> {
        let data = fs::metadata(path).ok().filter(|data| data.is_file())?;
        #[cfg(unix)]
        let inode = std::os::unix::fs::MetadataExt::ino(&data);
        #[cfg(not(unix))]
        let inode = 0;
        Some(Self { saved: data.modified().ok(), digest: None, length: data.len(), inode })
    }
}

impl Scope {
    /// The space and all populations of a world.
    pub fn of(world: World) -> Self {
        Self { world: Some(world), population: None, scenes: false, shaders: None, files: Vec::new() }
    }

    /// Files of no world.
    pub fn of_files(files: Vec<PathBuf>) -> Self {
        Self { world: None, population: None, scenes: false, shaders: None, files }
    }
}

impl Snapshot {
    /// What is there now. What cannot be read is not there; what `before` knows already is not parsed again.
    pub fn take(scope: &Scope, before: &Self) -> Self {
        let Scope { world, population, scenes, shaders, files } = scope;
        let mut now = Self::default();
        if let Some(world) = world {
            now.add_world(world, population.as_deref(), *scenes, before);
        }
        for (number, path) in files.iter().enumerate() {
            now.add_folder_of(path);
            now.files.extend(Stamp::of(path).map(|stamp| (number, stamp)));
        }
        if let Some(folder) = shaders {
            let is_shader = |name: &str| name.ends_with(".wgsl").then(|| folder.join(name));
            for path in list(folder, is_shader).unwrap_or_default() {
                now.shaders.extend(read(&path).map(|(stamp, _)| (path, stamp)));
            }
            now.add_folder(folder.clone());
        }
        now
    }

    fn add_world(&mut self, world: &World, population: Option<&Path>, scenes: bool, before: &Self) {
        let root = world.root();
        self.space = read(&root.join(names::SPACE)).map(|(stamp, _)| stamp);
        self.add_folder(root.to_owned());
        let populations = self.add_folder(root.join(names::POPULATIONS));
        match population {
            Some(path) => {
                self.add_folder_of(path);
                self.add_population(path.to_owned(), before);
            }
            None => {
                for generation in list(&populations, names::generation).unwrap_or_default() {
                    self.add_population(world.population_path(generation), before);
                }
            }
        }
        if scenes {
            self.current = Stamp::of(&root.join(names::CURRENT));
            self.add_scenes(world);
        }
    }

    fn add_folder_of(&mut self, path: &Path) {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        self.add_folder(folder.unwrap_or(Path::new(".")).to_owned());
    }

    /// Notes a folder that files may come into, if it is there.
    fn add_folder(&mut self, folder: PathBuf) -> PathBuf {
        if folder.is_dir() {
            self.folders.insert(folder.clone());
        }
        folder
    }

    fn add_population(&mut self, path: PathBuf, before: &Self) {
        let Some((stamp, bytes)) = read(&path) else { return };
        let lineage = match before.populations.get(&path) {
            Some((known, lineage)) if known.digest == stamp.digest => *lineage,
            // Half saved, or with a mistake: it is still that child, so that it is not bred again.
            known => lineage(&path, &bytes)
                .or_else(|| known.and_then(|(_, known)| known.map(|known| Lineage { votes: None, ..known }))),
        };
        self.populations.insert(path, (stamp, lineage));
    }

    fn add_scenes(&mut self, world: &World) {
        let baked = self.add_folder(world.baked());
        for generation in list(&baked, names::baked_generation).unwrap_or_default() {
            for index in 0..INDIVIDUALS {
                let path = world.scene_path(generation, index);
                self.scenes.extend(Stamp::of(&path).map(|stamp| ((generation, index), stamp)));
                // Its own folder and that of the generation.
                for folder in path.ancestors().skip(1).take(2) {
                    self.add_folder(folder.to_owned());
                }
            }
        }
    }

    /// What is different from an earlier moment.
    pub fn changes_since(&self, before: &Self) -> BTreeSet<Change> {
        let mut changes = BTreeSet::new();
        changes.extend((self.space != before.space).then_some(Change::Space));
        changes.extend((self.current != before.current).then_some(Change::Current));
        changes.extend((self.shaders != before.shaders).then_some(Change::Shaders));
        changes.extend(differing(&self.files, &before.files).map(|&number| Change::File(number)));
        let saved = differing(&self.populations, &before.populations);
        changes.extend(saved.filter_map(|path| names::generation_of(path)).map(Change::Population));
        let replaced = differing(&self.scenes, &before.scenes);
        changes.extend(replaced.map(|&(generation, index)| Change::Scene { generation, index }));
        changes
    }

    /// The population files.
    pub fn populations(&self) -> impl Iterator<Item = &PathBuf> {
        self.populations.keys()
    }

    /// The population files that are new or were saved since `before`.
    pub fn saved_since(&self, before: &Self) -> impl Iterator<Item = &PathBuf> {
        self.populations().filter(|path| self.populations.get(*path) != before.populations.get(*path))
    }

    /// A population file of `before` is gone.
    pub fn has_lost_since(&self, before: &Self) -> bool {
        before.populations().any(|path| !self.populations.contains_key(path))
    }

    /// The lineage of each file; of an illegible one the last that it stated, but without votes.
    pub fn lineages(&self) -> impl Iterator<Item = (&PathBuf, Lineage)> {
        self.populations.iter().filter_map(|(path, (_, lineage))| Some((path, (*lineage)?)))
    }

    /// Orders population files by when they were saved, the same moment by name; a file that is gone comes first.
    pub fn age<'a>(&self, path: &'a Path) -> (Option<SystemTime>, &'a Path) {
        (self.populations.get(path).and_then(|(stamp, _)| stamp.saved), path)
    }
}

/// Keys whose values differ, or that only one of the two has.
fn differing<'a, K: Ord, V: PartialEq>(
    a: &'a BTreeMap<K, V>,
    b: &'a BTreeMap<K, V>,
) -> impl Iterator<Item = &'a K> {
    let changed = a.iter().filter(|(key, value)| b.get(key) != Some(value)).map(|(key, _)| key);
    changed.chain(b.keys().filter(|key| !a.contains_key(key)))
}

/// What a file states; of the generation its name decides, as when it is baked.
fn lineage(path: &Path, bytes: &[u8]) -> Option<Lineage> {
    let stated = Lineage::read("", std::str::from_utf8(bytes).ok()?).ok()?;
    Some(Lineage { generation: names::generation_of(path).unwrap_or(stated.generation), ..stated })
}

/// The stamp of a small file, and its bytes; none while it cannot be read.
fn read(path: &Path) -> Option<(Stamp, Vec<u8>)> {
    // The time first: a save in between is then found by the next look.
    let saved = Stamp::of(path)?.saved;
    match regular_file::read(path, MAX_TEXT_BYTES) {
        Ok(bytes) => {
            let digest = Some(blake3::hash(&bytes));
            Some((Stamp { saved, digest, ..Stamp::default() }, bytes))
        }
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        Err(_) => Some((Stamp { saved, ..Stamp::default() }, Vec::new())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atomic_write::replace;
    use proptest::prelude::*;
    use std::time::Duration;

    /// A world with generations 0 and 3, and files that mean nothing.
    fn world() -> (tempfile::TempDir, Scope) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let scope = Scope { scenes: true, ..Scope::of(World::new(folder.path())) };
        for generation in [0, 3] {
            replace(&path(&scope, generation), format!("(generation: {generation})")).expect("written");
        }
        (folder, scope)
    }

    fn path(scope: &Scope, generation: u32) -> PathBuf {
        scope.world.as_ref().expect("a world").population_path(generation)
    }

    fn look(scope: &Scope, before: &Snapshot) -> Snapshot {
        Snapshot::take(scope, before)
    }

    fn generations(snapshot: &Snapshot) -> Vec<u32> {
        snapshot.lineages().map(|(_, lineage)| lineage.generation).collect()
    }

    #[test]
    fn every_save_is_seen_even_within_one_tick_or_without_a_change() {
        let (_folder, scope) = world();
        let before = look(&scope, &Snapshot::default());
        assert_eq!(generations(&before), [0, 3]);
        assert_eq!(look(&scope, &before), before);
        let file =
            |generation| fs::File::options().append(true).open(path(&scope, generation)).expect("there");
        let time = fs::metadata(path(&scope, 3)).and_then(|data| data.modified()).expect("a time");

        fs::write(path(&scope, 3), "(generation: 8)").expect("written");
        file(3).set_modified(time).expect("set");
        let now = look(&scope, &before);
        assert_eq!(now.saved_since(&before).collect::<Vec<_>>(), [&path(&scope, 3)], "the same time");
        assert_eq!(now.changes_since(&before), [Change::Population(3)].into());

        file(0).set_modified(time + Duration::from_secs(9)).expect("set");
        let later = look(&scope, &now);
        assert_eq!(later.saved_since(&now).collect::<Vec<_>>(), [&path(&scope, 0)], "the same text");
        assert!(later.age(&path(&scope, 0)) > later.age(&path(&scope, 3)), "saved later");
    }

    #[test]
    fn a_child_remains_its_parents_child_while_it_is_illegible() {
        let (_folder, scope) = world();
        let child = "(generation: 3, parent: (generation: 0, votes: (sky: 1)), votes: (sky: 2))";
        fs::write(path(&scope, 3), child).expect("written");
        let lineage = |snapshot: &Snapshot| snapshot.lineages().nth(1).expect("two").1;
        let mut before = look(&scope, &Snapshot::default());
        let legible = lineage(&before);
        assert!(legible.parent.is_some() && legible.votes.is_some());
        for illegible in ["", &child[..30], "(generation: -1)"] {
            fs::write(path(&scope, 3), illegible).expect("written");
            before = look(&scope, &before);
            assert_eq!(lineage(&before), Lineage { votes: None, ..legible }, "{illegible}");
        }
        fs::write(path(&scope, 3), child.replace("sky: 1", "sky: 0")).expect("written");
        let now = look(&scope, &before);
        assert_ne!(lineage(&now).parent, legible.parent, "legible again: what it says");
    }

    #[test]
    fn one_file_alone_may_matter() {
        let (folder, all) = world();
        let only = folder.path().join("elsewhere/mine.ron");
        replace(&only, "(generation: 7)").expect("written");
        let scope = Scope { population: Some(only.clone()), ..all };
        let now = look(&scope, &Snapshot::default());
        assert_eq!(now.populations().collect::<Vec<_>>(), [&only]);
        assert!(now.folders.contains(&folder.path().join("elsewhere")));
        fs::remove_file(&only).expect("removed");
        let gone = look(&scope, &now);
        assert!(gone.populations().next().is_none() && gone != now && gone.has_lost_since(&now));
        assert!(!now.has_lost_since(&gone));
    }

    #[test]
    fn files_of_no_world_may_matter() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let [model, picture] = ["model.gltf", "sub/bark.png"].map(|name| folder.path().join(name));
        fs::create_dir(folder.path().join("sub")).expect("made");
        fs::write(&model, "one").expect("written");
        let scope = Scope::of_files(vec![model.clone(), picture.clone()]);
        let before = look(&scope, &Snapshot::default());
        assert!(before.folders.contains(&folder.path().join("sub")));
        fs::write(&picture, "came").expect("written");
        fs::write(folder.path().join("other.gltf"), "none of ours").expect("written");
        let now = look(&scope, &before);
        assert_eq!(now.changes_since(&before), [Change::File(1)].into());
        fs::write(&model, "saved").expect("written");
        assert_eq!(look(&scope, &now).changes_since(&now), [Change::File(0)].into());
    }

    #[test]
    fn files_of_the_world_count_and_no_others() {
        let (folder, mut scope) = world();
        let shaders = tempfile::tempdir().expect("a temporary folder");
        scope.shaders = Some(shaders.path().to_owned());
        let before = look(&scope, &Snapshot::default());
        for other in [
            "g0012.ron",
            "population/g12.ron",
            "population/g0003.ron~",
            "population/.draft-x",
            "population/old/g0012.ron",
            "baked/g0012/scene-4/scene.gltf",
            "baked/g0012/scene-03/scene.gltf",
            "baked/g0012/scene-3/scene.gltf~",
            "baked/g12/scene-3/scene.gltf",
            "baked/blobs/ab/abcd.glb",
        ] {
            replace(&folder.path().join(other), "something").expect("written");
        }
        for other in ["notes.txt", "old/sky.wgsl"] {
            replace(&shaders.path().join(other), "something").expect("written");
        }
        let now = look(&scope, &before);
        assert_eq!(now.changes_since(&before), BTreeSet::new());
        for ours in [names::SPACE, names::CURRENT, &names::scene(12345, 3), &names::population(12)] {
            replace(&folder.path().join(ours), "something").expect("written");
        }
        replace(&shaders.path().join("sky.wgsl"), "fn sky() {}").expect("written");
        let scene = Change::Scene { generation: 12345, index: 3 };
        let changes = [Change::Space, Change::Population(12), scene, Change::Current, Change::Shaders];
        assert_eq!(look(&scope, &now).changes_since(&now), changes.into());
    }

    proptest! {
        #[test]
        fn exactly_what_differs_has_changed(
            before in prop::collection::btree_map((0..3u32, 0..2usize), 0..3u64, 0..6),
            after in prop::collection::btree_map((0..3u32, 0..2usize), 0..3u64, 0..6),
        ) {
            let snapshot = |files: &BTreeMap<(u32, usize), u64>| {
                let stamp = |length: u64| Stamp { length, ..Stamp::default() };
                let scenes = files.iter().map(|(&scene, &length)| (scene, stamp(length))).collect();
                Snapshot { scenes, ..Snapshot::default() }
            };
            let all = (0..3).flat_map(|generation| (0..2).map(move |index| (generation, index)));
            let changed = all.filter(|scene| before.get(scene) != after.get(scene));
            let changed = changed.map(|(generation, index)| Change::Scene { generation, index }).collect();
            prop_assert_eq!(snapshot(&after).changes_since(&snapshot(&before)), changed);
        }
    }
}
