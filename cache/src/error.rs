//! What can go wrong, with the path it happened to and what to do about it.

use std::error::Error as StdError;
use std::io;
use std::path::{Path, PathBuf};

/// The result of a cache operation.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Why the cache could not do its work. Damaged and missing files are no errors but misses.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The folder or a file in it could not be used.
    #[error("cannot {verb} {}: {source}{}", path.display(), advice(source.as_ref()))]
    Storage {
        /// "read", "write", …
        verb: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: Box<dyn StdError + Send + Sync>,
    },
    /// Parameters that have no canonical bytes.
    #[error("the parameters of stage `{stage}` cannot be hashed: {source}")]
    Parameters {
        /// Name of the stage.
        stage: String,
        /// What postcard said.
        source: postcard::Error,
    },
    /// A file extension that is not a few lower-case letters and digits.
    #[error("`{0}` is no file extension for a blob: use one to eight lower-case letters and digits")]
    Extension(String),
    /// A stage that gave two outputs one name.
    #[error("stage `{stage}` has two outputs named `{output}`")]
    TwiceNamed {
        /// Name of the stage.
        stage: String,
        /// Name of the outputs.
        output: String,
    },
}

impl Error {
    /// An error at `path`; `verb` completes "cannot … PATH".
    pub(crate) fn at(
        verb: &'static str,
        path: &Path,
        source: impl Into<Box<dyn StdError + Send + Sync>>,
    ) -> Self {
        Self::Storage { verb, path: path.to_path_buf(), source: source.into() }
    }

    /// The system's error beneath this one, if there is one.
    pub fn io_kind(&self) -> Option<io::ErrorKind> {
        match self {
            Self::Storage { source, .. } => io_kind(source.as_ref()),
            _ => None,
        }
    }
}

/// The kind of the `io::Error` at the bottom of a chain of errors.
pub(crate) fn io_kind(error: &(dyn StdError + 'static)) -> Option<io::ErrorKind> {
    let mut link = Some(error);
    while let Some(error) = link {
        if let Some(io) = error.downcast_ref::<io::Error>() {
            return Some(io.kind());
        }
        link = error.source();
    }
    None
}

fn advice(error: &(dyn StdError + 'static)) -> &'static str {
    use io::ErrorKind as Kind;
    match io_kind(error) {
        Some(Kind::StorageFull | Kind::QuotaExceeded | Kind::FileTooLarge) => {
            ". There is no room: free some space there or clear the cache; what was finished is kept"
        }
        Some(Kind::PermissionDenied | Kind::ReadOnlyFilesystem) => {
            ". Nothing can be written there: change its permissions or choose another folder"
        }
        Some(Kind::NotADirectory | Kind::AlreadyExists) => {
            ". A file stands where a folder must be: move it away or choose another folder"
        }
        Some(Kind::IsADirectory | Kind::DirectoryNotEmpty) => {
            ". A folder stands where a file must be: move it away"
        }
        _ => "",
    }
}
