//! A world folder as the viewer knows it: its files, read and checked by the schema, and the changes that a person
//! makes to them from within the window. Every file may be missing, broken or just being changed by somebody else;
//! that is an error to tell, never a reason to end.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use genescape_schema::edit::EditError;
use genescape_schema::{Current, Lineage, Loaded, Parent, Population, Report, Space, names};

use crate::save::save;

/// Why a file could not be read or changed.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// It is not there, or the system keeps it from us.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// Which file or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// What it says is wrong.
    #[error("{report}")]
    Faulty {
        /// Which file.
        path: PathBuf,
        /// Everything that is wrong with it, with lines.
        report: Report,
    },
    /// The change cannot be made in this file.
    #[error("{}: {source}", path.display())]
    Edit {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: EditError,
    },
    /// Somebody else changed it in the meantime.
    #[error("{} was changed elsewhere in the meantime; nothing was written over it", path.display())]
    Changed {
        /// Which file.
        path: PathBuf,
    },
    /// It could not be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

impl FileError {
    /// The file that the error is about.
    pub fn path(&self) -> &Path {
        match self {
            Self::Read { path, .. }
            | Self::Faulty { path, .. }
            | Self::Edit { path, .. }
            | Self::Changed { path }
            | Self::Write { path, .. } => path,
        }
    }
}

/// A world folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorldFiles {
    root: PathBuf,
}

impl WorldFiles {
    /// The world in `root`, whether or not there is one yet.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self { root: root.into() }
    }

    /// The folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// A generation's population file.
    pub fn population_path(&self, generation: u32) -> PathBuf {
        self.root.join(names::population(generation))
    }

    /// A generation's scene file; it need not exist.
    pub fn scene_path(&self, generation: u32, scene: usize) -> PathBuf {
        self.root.join(names::scene(generation, scene))
    }

    /// The world's parameter space; the built-in one while there is no `space.ron`.
    ///
    /// # Errors
    /// A file that cannot be read or is wrong.
    pub fn space(&self) -> Result<Space, FileError> {
        let path = self.root.join(names::SPACE);
        match read(&path) {
            Ok(text) => {
                let name = path.display().to_string();
                Space::parse(&name, &text).map_err(|report| FileError::Faulty { path, report })
            }
            Err(error) if is_absent(&error) => Ok(Space::builtin()),
            Err(error) => Err(error),
        }
    }

    /// All generations that have a population file, rising; none in a folder that is not there.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn generations(&self) -> Result<Vec<u32>, FileError> {
        let path = self.root.join(names::POPULATIONS);
        let failed = |source| FileError::Read { path: path.clone(), source };
        let entries = match fs::read_dir(&path) {
            Ok(entries) => entries,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            Err(error) => return Err(failed(error)),
        };
        let mut generations = Vec::new();
        for entry in entries {
            let name = entry.map_err(failed)?.file_name();
            generations.extend(name.to_str().and_then(names::generation));
        }
        generations.sort_unstable();
        Ok(generations)
    }

    /// A population file's text.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn population_text(&self, generation: u32) -> Result<String, FileError> {
        read(&self.population_path(generation))
    }

    /// A population as its file says.
    ///
    /// # Errors
    /// A file that cannot be read or is wrong.
    pub fn population(&self, space: &Space, generation: u32) -> Result<Loaded, FileError> {
        let path = self.population_path(generation);
        let text = read(&path)?;
        Population::load(space, &path.display().to_string(), &text)
            .map_err(|report| FileError::Faulty { path, report })
    }

    /// Which scenes were baked last; `None` before the first bake is done.
    ///
    /// # Errors
    /// A file that cannot be read or is wrong.
    pub fn current(&self) -> Result<Option<Current>, FileError> {
        let path = self.root.join(names::CURRENT);
        match read(&path) {
            Ok(text) => {
                let current = Current::load(&path.display().to_string(), &text);
                current.map(Some).map_err(|report| FileError::Faulty { path, report })
            }
            Err(error) if is_absent(&error) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Who descends from whom, as far as the files say so legibly. In the order of generations.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn lineages(&self) -> Result<Vec<Lineage>, FileError> {
        let texts = self.generations()?.into_iter().filter_map(|g| self.population_text(g).ok());
        Ok(texts.filter_map(|text| Lineage::read("", &text).ok()).collect())
    }

    /// The generation that was bred from that one by those votes: it exists already if they were cast before.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn child_of(&self, parent: &Parent) -> Result<Option<u32>, FileError> {
        let lineages = self.lineages()?;
        Ok(lineages.iter().find(|child| child.parent.as_ref() == Some(parent)).map(|child| child.generation))
    }

    /// Asks whoever bakes for a generation's scenes, by saving its population file as it is. Who goes back to an old
    /// generation should ask: its scenes may be stale, or have made room for others.
    ///
    /// # Errors
    /// A file that is missing or not the person's.
    pub fn ask_for_bake(&self, generation: u32) -> Result<(), FileError> {
        let path = self.population_path(generation);
        let touch = || fs::File::options().append(true).open(&path)?.set_modified(SystemTime::now());
        touch().map_err(|source| FileError::Write { path: path.clone(), source })
    }

    /// Writes another text into a population file, which must still say `expected`.
    ///
    /// # Errors
    /// [`FileError::Changed`] if it says something else; a file that cannot be read or written.
    pub fn replace_population(&self, generation: u32, expected: &str, text: &str) -> Result<(), FileError> {
        let path = self.population_path(generation);
        if read(&path)? != expected {
            return Err(FileError::Changed { path });
        }
        save(&path, text).map_err(|source| FileError::Write { path, source })
    }
}

fn read(path: &Path) -> Result<String, FileError> {
    fs::read_to_string(path).map_err(|source| FileError::Read { path: path.to_owned(), source })
}

fn is_absent(error: &FileError) -> bool {
    matches!(error, FileError::Read { source, .. } if source.kind() == io::ErrorKind::NotFound)
}

#[cfg(test)]
mod tests {
    use super::*;
    use genescape_schema::Votes;

    fn world() -> (tempfile::TempDir, WorldFiles) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let files = WorldFiles::new(folder.path());
        (folder, files)
    }

    fn put(files: &WorldFiles, generation: u32, parent: Option<Parent>) {
        let space = Space::builtin();
        let population = Population { parent, ..Population::random(&space, 7, generation) };
        save(&files.population_path(generation), &population.to_ron(&space)).expect("saved");
    }

    #[test]
    fn an_empty_folder_is_a_world_without_generations() {
        let (_folder, files) = world();
        assert!(files.generations().expect("none").is_empty());
        assert_eq!(files.current().expect("none"), None);
        assert_eq!(files.space().expect("the built-in one"), Space::builtin());
        let error = files.population(&Space::builtin(), 3).expect_err("no such file");
        assert!(error.to_string().contains("g0003.ron"), "{error}");
    }

    #[test]
    fn faults_are_told_with_their_lines() {
        let (_folder, files) = world();
        save(&files.population_path(0), "Population(\n  generation: -1,\n)").expect("saved");
        let error = files.population(&Space::builtin(), 0).expect_err("faulty");
        assert!(matches!(error, FileError::Faulty { .. }) && error.to_string().contains("g0000.ron:2:15"));
        save(&files.root().join(names::SPACE), "Space(").expect("saved");
        assert!(matches!(files.space(), Err(FileError::Faulty { .. })));
        save(&files.root().join(names::CURRENT), "Current(").expect("saved");
        assert!(matches!(files.current(), Err(FileError::Faulty { .. })));
    }

    #[test]
    fn a_child_is_found_by_its_parents_and_their_votes() {
        let (_folder, files) = world();
        let votes = Votes { tree: Some(1), ..Votes::default() };
        let parent = Parent { generation: 2, votes };
        for (generation, parent) in [(10, None), (2, None), (4, Some(parent))] {
            put(&files, generation, parent);
        }
        assert_eq!(files.generations().expect("three"), [2, 4, 10]);
        assert_eq!(files.child_of(&parent).expect("readable"), Some(4));
        let other = Parent { votes: Votes::default(), ..parent };
        assert_eq!(files.child_of(&other).expect("readable"), None);
    }

    #[test]
    fn asking_for_a_bake_saves_the_file_as_it_is() {
        let (_folder, files) = world();
        put(&files, 0, None);
        let path = files.population_path(0);
        let state = || (fs::read(&path).expect("there"), fs::metadata(&path).and_then(|m| m.modified()).ok());
        let before = state();
        files.ask_for_bake(0).expect("there");
        let after = state();
        assert!(before.0 == after.0 && before.1 != after.1);
        assert!(files.ask_for_bake(1).is_err(), "no file is made");
        assert_eq!(files.generations().expect("one"), [0]);
    }
}
