//! What can go wrong with a world's files, told so that a person can mend it.

use std::io;
use std::path::PathBuf;

use genescape_schema::Report;
use genescape_schema::edit::EditError;

use crate::names::POPULATIONS;

// Causes are part of each message, and so they are no `source`: a chain of errors would tell them twice.
#[derive(Debug, thiserror::Error)]
pub enum WorldError {
    #[error("{} is no world folder: it has no {POPULATIONS}/; `bake` makes one", .0.display())]
    NoWorld(PathBuf),
    #[error("{} holds no population; `bake random --seed 1` makes one", .0.display())]
    NoPopulation(PathBuf),
    #[error("cannot make the world folder {}: {error}; choose another with --world DIR", path.display())]
    Make { path: PathBuf, error: io::Error },
    /// A folder that would have to be made, and the world that was probably meant.
    #[error(
        "there is no world {}; did you mean {}? To begin a world of that name, make its folder first: mkdir {}",
        path.display(), near.display(), path.display()
    )]
    NearName { path: PathBuf, near: PathBuf },
    #[error("cannot read {}: {error}", path.display())]
    Read { path: PathBuf, error: io::Error },
    #[error("cannot write {}: {error}", path.display())]
    Write { path: PathBuf, error: io::Error },
    #[error("cannot remove the drafts that a killed program left in {}: {error}", path.display())]
    Sweep { path: PathBuf, error: io::Error },
    /// What a file says is wrong: everything at once, with lines.
    #[error(transparent)]
    Faulty(#[from] Report),
    /// A change that cannot be made in this file.
    #[error("{}: {error}", path.display())]
    Edit { path: PathBuf, error: EditError },
    /// The file no longer says what the change was made from.
    #[error("{} was changed elsewhere in the meantime; nothing was written over it", .0.display())]
    Changed(PathBuf),
    #[error("generation {0} is the last that can be numbered")]
    LastGeneration(u32),
    #[error("there is no file {}", .0.display())]
    NoFile(PathBuf),
    #[error("{} is neither a folder nor a .glb or .gltf file", .0.display())]
    NoScene(PathBuf),
    #[error("{} is neither a world nor a baked folder: it has no {POPULATIONS}/ and no scene.gltf", .0.display())]
    NoSource(PathBuf),
}

impl WorldError {
    /// Whether the person has to correct something: what was asked for, or what a file says.
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Make { .. } | Self::Write { .. } | Self::Changed(_) => false,
            Self::Read { error, .. } => {
                use io::ErrorKind::{FileTooLarge, InvalidInput, NotFound};
                [NotFound, InvalidInput, FileTooLarge].contains(&error.kind())
            }
            _ => true,
        }
    }
}
