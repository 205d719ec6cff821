//! What can go wrong, with the path it happened to and what to do about it.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

pub type Result<T, E = Error> = std::result::Result<T, E>;

// Causes are part of each message, and so they are no `source`: a chain of errors would tell them twice.
/// Why the cache could not do its work. Damaged and missing files are no errors but misses.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The folder or a file in it could not be used; `verb` completes "cannot … PATH".
    #[error("cannot {verb} {}: {error}{}", path.display(), advice(error.kind()))]
    Storage { verb: &'static str, path: PathBuf, error: io::Error },
    #[error("{} is damaged: its bytes are not those that its name promises", .0.display())]
    Damaged(PathBuf),
    #[error("`{0}` is no file extension for a blob: use one to eight lower-case letters and digits")]
    Extension(String),
    #[error("stage `{stage}` has two outputs named `{output}`")]
    TwiceNamed { stage: String, output: String },
}

impl Error {
    pub(crate) fn at(verb: &'static str, path: &Path, error: io::Error) -> Self {
        Self::Storage { verb, path: path.to_path_buf(), error }
    }
}

fn advice(kind: ErrorKind) -> &'static str {
    match kind {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            ". There is no room: free some space there or clear the cache; what was finished is kept"
        }
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            ". Nothing can be written there: change its permissions or choose another folder"
        }
        ErrorKind::NotADirectory | ErrorKind::AlreadyExists => {
            ". A file stands where a folder must be: move it away or choose another folder"
        }
        ErrorKind::IsADirectory | ErrorKind::DirectoryNotEmpty => {
            ". A folder stands where a file must be: move it away"
        }
        _ => "",
    }
}
