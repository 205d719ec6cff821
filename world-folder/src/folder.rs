//! A world folder's files, read and checked. Every file may be missing, broken or just being changed by another
//! program. A person's files are only ever created, or replaced by a text made from what they say now.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use genescape_schema::{Current, Favourites, INDIVIDUALS, Lineage, Parent, Population, Space, decode};

use crate::near_name::near_world;
use crate::{WorldError, atomic_write, names, regular_file};

/// What a file of a world may hold that people write, in bytes; ours have some 12,000.
pub const MAX_TEXT_BYTES: u64 = 4 << 20;

/// What a thumbnail may hold, in bytes; ours have some 8,000.
const MAX_THUMBNAIL_BYTES: u64 = 1 << 20;

/// The landscapes that new worlds begin with.
pub const STARTER_RON: &str = include_str!("../../configs/starter.ron");

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct World {
    root: PathBuf,
}

/// A population file as found.
#[derive(Debug)]
pub struct PopulationFile {
    pub path: PathBuf,
    pub population: Population,
    /// For people: rounded values and genes filled in, each with file and line.
    pub notices: Vec<String>,
    /// BLAKE3 of its bytes.
    pub digest: blake3::Hash,
}

impl World {
    /// The world in `root`, whether or not there is one yet.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self { root: root.into() }
    }

    /// The world in `root`, which must exist.
    ///
    /// # Errors
    /// [`WorldError::NoWorld`].
    pub fn open(root: &Path) -> Result<Self, WorldError> {
        match root.join(names::POPULATIONS).is_dir() {
            true => Ok(Self::new(root)),
            false => Err(WorldError::NoWorld(root.to_owned())),
        }
    }

    /// The world in `root`, which is made, still without landscapes, if there is none.
    ///
    /// # Errors
    /// A folder that cannot be made or written to; [`WorldError::NearName`].
    pub fn open_or_create(root: &Path) -> Result<Self, WorldError> {
        if let Some(near) = near_world(root) {
            return Err(WorldError::NearName { path: root.to_owned(), near });
        }
        let made = fs::create_dir_all(root.join(names::POPULATIONS));
        made.map_err(|error| WorldError::Make { path: root.to_owned(), error })?;
        create_unless_there(&root.join(names::SPACE), Space::BUILTIN)?;
        Ok(Self::new(root))
    }

    /// Gives a world without a population the starter landscapes; `true` if it did.
    ///
    /// # Errors
    /// A folder that cannot be read or written to.
    pub fn begin(&self) -> Result<bool, WorldError> {
        Ok(self.generations()?.is_empty() && create_unless_there(&self.population_path(0), STARTER_RON)?)
    }

    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The folder of what can be made again.
    pub fn baked(&self) -> PathBuf {
        self.root.join(names::BAKED)
    }

    /// A generation's population file; it need not exist.
    pub fn population_path(&self, generation: u32) -> PathBuf {
        self.root.join(names::population(generation))
    }

    /// A generation's scene file; it need not exist.
    pub fn scene_path(&self, generation: u32, scene: usize) -> PathBuf {
        self.root.join(names::scene(generation, scene))
    }

    /// The world's parameter space, with the built-in declarations of genes that `space.ron` lacks, and a notice of
    /// each of these. While there is no such file, the built-in space.
    ///
    /// # Errors
    /// A file that cannot be read or is wrong.
    pub fn space(&self) -> Result<(Space, Vec<String>), WorldError> {
        let path = self.root.join(names::SPACE);
        match read_if_there(&path)? {
            Some(text) => Ok(Space::load(&path.display().to_string(), &text)?),
            None => Ok((Space::builtin(), Vec::new())),
        }
    }

    /// All generations that have a population file, rising; none in a folder that is not there.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn generations(&self) -> Result<Vec<u32>, WorldError> {
        let mut generations = list(&self.root.join(names::POPULATIONS), names::generation)?;
        generations.sort_unstable();
        Ok(generations)
    }

    /// The file of the newest population.
    ///
    /// # Errors
    /// A world without one.
    pub fn newest_population(&self) -> Result<PathBuf, WorldError> {
        let newest = self.generations()?.last().map(|&generation| self.population_path(generation));
        newest.ok_or_else(|| WorldError::NoPopulation(self.root.clone()))
    }

    /// The number of the next population to be made, whatever it is made of.
    ///
    /// # Errors
    /// A folder that cannot be read, or the end of numbers.
    pub fn next_generation(&self) -> Result<u32, WorldError> {
        let Some(&newest) = self.generations()?.last() else { return Ok(0) };
        newest.checked_add(1).ok_or(WorldError::LastGeneration(newest))
    }

    /// A generation's population file as text.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn population_text(&self, generation: u32) -> Result<String, WorldError> {
        read(&self.population_path(generation))
    }

    /// A generation's population.
    ///
    /// # Errors
    /// As [`World::read_population`].
    pub fn population(&self, space: &Space, generation: u32) -> Result<PopulationFile, WorldError> {
        Self::read_population(space, &self.population_path(generation))
    }

    /// The population in a file, which may lie elsewhere. Its generation is the one in the file's name, if that is a
    /// name of ours: a copy of a file is a generation of its own, whose scenes take nobody's place.
    ///
    /// # Errors
    /// A file that cannot be read or is wrong.
    pub fn read_population(space: &Space, path: &Path) -> Result<PopulationFile, WorldError> {
        let text = read(path)?;
        let loaded = Population::load(space, &path.display().to_string(), &text)?;
        let (mut population, mut notices) = (loaded.population, loaded.notices);
        if let Some(named) = names::generation_of(path).filter(|&named| named != population.generation) {
            let (path, said) = (path.display(), population.generation);
            notices
                .push(format!("{path}: by its name it is generation {named}, and so it is used, not {said}"));
            population.generation = named;
        }
        Ok(PopulationFile {
            path: path.to_owned(),
            population,
            notices,
            digest: blake3::hash(text.as_bytes()),
        })
    }

    /// Writes a population as a new file and says where.
    ///
    /// # Errors
    /// A generation that has a file already, or a folder that cannot be written to.
    pub fn create_population(&self, space: &Space, population: &Population) -> Result<PathBuf, WorldError> {
        let path = self.population_path(population.generation);
        match atomic_write::create(&path, population.to_ron(space)) {
            Ok(()) => Ok(path),
            Err(error) => Err(WorldError::Write { path, error }),
        }
    }

    /// Writes what `make` makes of the next free number as a new population file and says where. Who else does the same
    /// at the same time gets another number.
    ///
    /// # Errors
    /// Those of `make`; the end of numbers, or a folder that cannot be written to.
    pub fn create_next_population<E: From<WorldError>>(
        &self,
        space: &Space,
        make: impl Fn(u32) -> Result<Population, E>,
    ) -> Result<PathBuf, E> {
        let mut generation = self.next_generation()?;
        loop {
            match self.create_population(space, &make(generation)?) {
                Err(WorldError::Write { error, .. }) if error.kind() == ErrorKind::AlreadyExists => {
                    generation = generation.checked_add(1).ok_or(WorldError::LastGeneration(generation))?;
                }
                result => return Ok(result?),
            }
        }
    }

    /// Writes another text into a population file, which must still say `expected`.
    ///
    /// # Errors
    /// [`WorldError::Changed`] if it says something else; a file that cannot be read or written.
    pub fn replace_population(&self, generation: u32, expected: &str, text: &str) -> Result<(), WorldError> {
        let path = self.population_path(generation);
        if read(&path)? != expected {
            return Err(WorldError::Changed(path));
        }
        atomic_write::replace(&path, text).map_err(|error| WorldError::Write { path, error })
    }

    /// Asks for a generation's scenes by saving its population file as it is: they may be stale, or evicted.
    ///
    /// # Errors
    /// A file that is missing or not the person's.
    pub fn ask_for_bake(&self, generation: u32) -> Result<(), WorldError> {
        let path = self.population_path(generation);
        let touch = || fs::File::options().append(true).open(&path)?.set_modified(SystemTime::now());
        touch().map_err(|error| WorldError::Write { path: path.clone(), error })
    }

    /// What a generation was bred from, if from any, as far as its file is legible.
    pub fn parent_of(&self, generation: u32) -> Option<Parent> {
        let text = self.population_text(generation).ok()?;
        Lineage::read("", &text).ok()?.parent
    }

    /// The generation that was bred from that one by those votes, as far as the files are legible.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn child_of(&self, parent: &Parent) -> Result<Option<u32>, WorldError> {
        let is_child =
            |generation: &u32| self.parent_of(*generation).is_some_and(|of| parent.is_answered_by(&of));
        Ok(self.generations()?.into_iter().find(is_child))
    }

    /// Which scenes were baked last; `None` before the first bake is done.
    ///
    /// # Errors
    /// A file that cannot be read or is wrong.
    pub fn current(&self) -> Result<Option<Current>, WorldError> {
        let path = self.root.join(names::CURRENT);
        let Some(text) = read_if_there(&path)? else { return Ok(None) };
        Ok(Some(Current::load(&path.display().to_string(), &text)?))
    }

    /// The landscapes that a person has marked; none while there is no such file.
    ///
    /// # Errors
    /// A file that cannot be read or is wrong.
    pub fn favourites(&self) -> Result<Favourites, WorldError> {
        let path = self.root.join(names::FAVOURITES);
        let Some(text) = read_if_there(&path)? else { return Ok(Favourites::default()) };
        Ok(Favourites::load(&path.display().to_string(), &text)?)
    }

    /// Marks a landscape, or takes its mark away; returns all that are marked now.
    ///
    /// # Errors
    /// A file that cannot be read or is wrong, and then is left as it is; one that cannot be written.
    pub fn mark(&self, generation: u32, landscape: usize, is_marked: bool) -> Result<Favourites, WorldError> {
        let mut favourites = self.favourites()?;
        let changed = match is_marked {
            true => favourites.0.insert((generation, landscape)),
            false => favourites.0.remove(&(generation, landscape)),
        };
        if changed {
            let path = self.root.join(names::FAVOURITES);
            let written = atomic_write::replace(&path, favourites.to_ron());
            written.map_err(|error| WorldError::Write { path, error })?;
        }
        Ok(favourites)
    }

    /// What `current.ron` is to say when all scenes of a population are ready.
    pub fn current_after(file: &PopulationFile) -> Current {
        let generation = file.population.generation;
        let scenes = std::array::from_fn(|scene| names::scene(generation, scene));
        Current { generation, population: file.digest.to_string(), scenes }
    }

    /// The thumbnail of a landscape, a JPEG file, if somebody has looked at it.
    pub fn thumbnail(&self, generation: u32, scene: usize) -> Option<Vec<u8>> {
        const BEGINNING: [u8; 3] = [0xff, 0xd8, 0xff];
        let bytes =
            regular_file::read(&self.root.join(names::thumbnail(generation, scene)), MAX_THUMBNAIL_BYTES);
        bytes.ok().filter(|bytes| bytes.starts_with(&BEGINNING))
    }

    /// Keeps a JPEG file as the thumbnail of a landscape.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn keep_thumbnail(&self, generation: u32, scene: usize, jpeg: &[u8]) -> Result<(), WorldError> {
        let path = self.root.join(names::thumbnail(generation, scene));
        atomic_write::replace(&path, jpeg).map_err(|error| WorldError::Write { path, error })
    }

    /// Removes what programs that were killed while they wrote left among the person's files; how many files.
    ///
    /// # Errors
    /// A folder that cannot be read, or a file that cannot be removed.
    pub fn sweep_drafts(&self) -> Result<usize, WorldError> {
        let folders = [self.root.clone(), self.root.join(names::POPULATIONS)];
        let swept = folders
            .into_iter()
            .map(|path| atomic_write::sweep(&path).map_err(|error| WorldError::Sweep { path, error }));
        swept.sum()
    }

    /// The scenes of all generations that are still in the folder: generation, number and file.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn scenes(&self) -> Result<Vec<(u32, usize, PathBuf)>, WorldError> {
        let mut generations = list(&self.baked(), names::baked_generation)?;
        generations.sort_unstable();
        let scenes = generations.into_iter().flat_map(|generation| {
            (0..INDIVIDUALS).map(move |scene| (generation, scene, self.scene_path(generation, scene)))
        });
        Ok(scenes.filter(|(.., path)| path.is_file()).collect())
    }
}

/// What `meaning` makes of the names in a folder; nothing of a folder that is not there.
pub(crate) fn list<T>(path: &Path, meaning: impl Fn(&str) -> Option<T>) -> Result<Vec<T>, WorldError> {
    let failed = |error| WorldError::Read { path: path.to_owned(), error };
    let entries = match fs::read_dir(path) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(failed(error)),
    };
    let mut found = Vec::new();
    for entry in entries {
        found.extend(entry.map_err(failed)?.file_name().to_str().and_then(&meaning));
    }
    Ok(found)
}

pub(crate) fn read(path: &Path) -> Result<String, WorldError> {
    let bytes = regular_file::read(path, MAX_TEXT_BYTES);
    let bytes = bytes.map_err(|error| WorldError::Read { path: path.to_owned(), error })?;
    Ok(decode(&path.display().to_string(), bytes)?)
}

fn read_if_there(path: &Path) -> Result<Option<String>, WorldError> {
    match read(path) {
        Ok(text) => Ok(Some(text)),
        Err(WorldError::Read { error, .. }) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

/// `true` if it was this process that created it: another one may do the same.
fn create_unless_there(path: &Path, text: &str) -> Result<bool, WorldError> {
    if path.exists() {
        return Ok(false);
    }
    match atomic_write::create(path, text) {
        Ok(()) => Ok(true),
        Err(_) if path.is_file() => Ok(false),
        Err(error) => Err(WorldError::Write { path: path.to_owned(), error }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use genescape_schema::Votes;

    fn world() -> (tempfile::TempDir, World) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let world = World::new(folder.path());
        (folder, world)
    }

    fn put(world: &World, generation: u32, parent: Option<Parent>) {
        let space = Space::builtin();
        let population = Population { parent, ..Population::random(&space, 7, generation) };
        world.create_population(&space, &population).expect("saved");
    }

    #[test]
    fn an_empty_folder_is_a_world_without_generations() {
        let (_folder, world) = world();
        assert!(world.generations().expect("none").is_empty() && world.scenes().expect("none").is_empty());
        assert_eq!(world.current().expect("none"), None);
        assert_eq!(world.space().expect("the built-in one"), (Space::builtin(), Vec::new()));
        let error = world.population(&Space::builtin(), 3).expect_err("no such file");
        assert!(error.to_string().contains("g0003.ron"), "{error}");
        assert!(matches!(World::open(world.root()), Err(WorldError::NoWorld(_))));
    }

    #[test]
    fn marks_are_kept_and_a_wrong_file_of_them_is_left_alone() {
        let (_folder, world) = world();
        assert_eq!(world.favourites().expect("none"), Favourites::default());
        world.mark(3, 1, true).expect("marked");
        world.mark(0, 2, true).expect("marked");
        assert_eq!(world.mark(3, 1, false).expect("unmarked").0, [(0, 2)].into());
        assert_eq!(world.favourites().expect("one").0, [(0, 2)].into());
        let path = world.root().join(names::FAVOURITES);
        atomic_write::replace(&path, "Favourites(mine").expect("edited");
        world.mark(1, 1, true).expect_err("it would be lost");
        assert_eq!(fs::read_to_string(&path).expect("there"), "Favourites(mine");
    }

    #[test]
    fn a_world_begins_once() {
        let (folder, _) = world();
        let world = World::open_or_create(&folder.path().join("new")).expect("made");
        assert!(world.begin().expect("begun") && !world.begin().expect("has begun"));
        let space = "Space(version: 2)";
        atomic_write::replace(&world.root().join(names::SPACE), space).expect("edited");
        World::open_or_create(world.root()).expect("there");
        assert_eq!(fs::read_to_string(world.root().join(names::SPACE)).expect("there"), space);
        assert_eq!(world.newest_population().expect("the starter"), world.population_path(0));
    }

    #[test]
    fn faults_are_told_with_their_lines() {
        let (_folder, world) = world();
        let put = |path: PathBuf, text: &str| atomic_write::replace(&path, text).expect("saved");
        put(world.population_path(0), "Population(\n  generation: -1,\n)");
        let error = world.population(&Space::builtin(), 0).expect_err("faulty");
        assert!(matches!(error, WorldError::Faulty(_)) && error.to_string().contains("g0000.ron:2:15"));
        put(world.root().join(names::SPACE), "Space(");
        assert!(matches!(world.space(), Err(WorldError::Faulty(_))));
        put(world.root().join(names::CURRENT), "Current(");
        assert!(matches!(world.current(), Err(WorldError::Faulty(_))));
    }

    #[test]
    fn a_copy_of_a_population_is_the_generation_that_its_name_says() {
        let (_folder, world) = world();
        put(&world, 0, None);
        for (copy, generation, notices) in [("population/g0004.ron", 4, 1), ("population/mine.ron", 0, 0)] {
            let copy = world.root().join(copy);
            fs::copy(world.population_path(0), &copy).expect("copied");
            let file = World::read_population(&Space::builtin(), &copy).expect("valid");
            assert_eq!((file.population.generation, file.notices.len()), (generation, notices));
        }
        let snapshot = crate::Snapshot::take(&crate::Scope::of(world), &crate::Snapshot::default());
        let known: Vec<u32> = snapshot.lineages().map(|(_, lineage)| lineage.generation).collect();
        assert_eq!(known, [0, 4]);
    }

    #[test]
    fn who_makes_a_population_at_the_same_time_gets_another_number() {
        let (_folder, world) = world();
        put(&world, 0, None);
        let space = Space::builtin();
        let random = |number| Ok::<_, WorldError>(Population::random(&space, 7, number));
        let make = || world.create_next_population(&space, random);
        let mut made: Vec<PathBuf> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..6).map(|_| scope.spawn(make)).collect();
            threads.into_iter().map(|thread| thread.join().expect("no panic").expect("made")).collect()
        });
        made.sort();
        assert_eq!(made, (1..=6).map(|number| world.population_path(number)).collect::<Vec<_>>());
    }

    #[cfg(unix)]
    #[test]
    fn files_that_no_person_writes_are_refused_and_not_waited_for() {
        let (_folder, world) = world();
        put(&world, 0, None);
        let path = world.population_path(0);
        let told = || world.population(&Space::builtin(), 0).expect_err("refused").to_string();
        fs::File::options()
            .append(true)
            .open(&path)
            .and_then(|file| file.set_len(MAX_TEXT_BYTES + 1))
            .expect("set");
        assert!(told().contains("larger than 4 MiB"), "{}", told());
        fs::write(&path, b"\xff\xfe(\0").expect("written");
        assert!(told().contains("UTF-16"), "{}", told());
        fs::remove_file(&path).expect("removed");
        assert!(std::process::Command::new("mkfifo").arg(&path).status().expect("mkfifo runs").success());
        assert!(told().contains("no regular file"), "{}", told());
        crate::Snapshot::take(&crate::Scope::of(world), &crate::Snapshot::default());
    }

    #[test]
    fn a_population_is_never_overwritten_unseen() {
        let (_folder, world) = world();
        put(&world, 0, None);
        let text = world.population_text(0).expect("there");
        let space = Space::builtin();
        assert!(world.create_population(&space, &Population::random(&space, 8, 0)).is_err());
        assert!(matches!(world.replace_population(0, "another", "new"), Err(WorldError::Changed(_))));
        assert_eq!(world.population_text(0).expect("there"), text);
        world.replace_population(0, &text, "new").expect("it says what was expected");
        assert_eq!(world.population_text(0).expect("there"), "new");
    }

    #[test]
    fn a_child_is_found_by_its_parents_and_their_votes() {
        let (_folder, world) = world();
        let votes = Votes { tree: Some(1), ..Votes::default() };
        let parent = Parent { generation: 2, votes, variety: None };
        for (generation, parent) in [(10, None), (2, None), (4, Some(parent))] {
            put(&world, generation, parent);
        }
        assert_eq!(world.generations().expect("three"), [2, 4, 10]);
        assert_eq!(world.next_generation().expect("a number"), 11);
        assert_eq!(world.child_of(&parent).expect("readable"), Some(4));
        let other = Parent { votes: Votes::default(), ..parent };
        assert_eq!(world.child_of(&other).expect("readable"), None);
        put(&world, u32::MAX, None);
        assert!(matches!(world.next_generation(), Err(WorldError::LastGeneration(u32::MAX))));
    }

    #[test]
    fn asking_for_a_bake_saves_the_file_as_it_is() {
        let (_folder, world) = world();
        put(&world, 0, None);
        let path = world.population_path(0);
        let state = || (fs::read(&path).expect("there"), fs::metadata(&path).and_then(|m| m.modified()).ok());
        let before = state();
        world.ask_for_bake(0).expect("there");
        let after = state();
        assert!(before.0 == after.0 && before.1 != after.1);
        assert!(world.ask_for_bake(1).is_err(), "no file is made");
        assert_eq!(world.generations().expect("one"), [0]);
    }

    #[test]
    fn what_is_current_is_told_with_the_digest_of_its_file() {
        let (_folder, world) = world();
        put(&world, 3, None);
        let file = world.population(&Space::builtin(), 3).expect("valid");
        let text = World::current_after(&file).to_ron();
        atomic_write::replace(&world.root().join(names::CURRENT), text).expect("written");
        let current = world.current().expect("valid").expect("there");
        assert_eq!((current.generation, &current.scenes[1]), (3, &names::scene(3, 1)));
        let bytes = fs::read(world.population_path(3)).expect("there");
        assert_eq!(current.population, blake3::hash(&bytes).to_hex().to_string());
    }
}
