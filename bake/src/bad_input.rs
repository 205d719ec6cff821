//! What a person typed or saved and must correct, in words.

use std::path::Path;

/// Input that the person must correct, as against a failure of the program: exit code 2.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct BadInput(pub String);

impl BadInput {
    /// For a file that the person has named.
    pub fn unread(path: &Path, error: &std::io::Error) -> Self {
        Self(format!("cannot read {}: {error}", path.display()))
    }
}
