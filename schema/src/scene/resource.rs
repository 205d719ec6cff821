//! Bytes that an extension points to.

use serde::{Deserialize, Serialize};

/// A file beside the glTF file or a part of one of its buffers, as glTF's own images are given: exactly one of `uri`
/// and `buffer_view` is there.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Resource {
    /// A relative URI.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uri: Option<String>,
    /// An index into `bufferViews`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub buffer_view: Option<usize>,
    /// What the bytes are: `image/png`, `image/x-exr` or `application/octet-stream`.
    pub mime_type: String,
}

impl Resource {
    /// A file by its relative URI.
    pub fn file(uri: impl Into<String>, mime_type: &str) -> Self {
        Self { uri: Some(uri.into()), buffer_view: None, mime_type: mime_type.into() }
    }

    /// A part of a buffer.
    pub fn view(buffer_view: usize, mime_type: &str) -> Self {
        Self { uri: None, buffer_view: Some(buffer_view), mime_type: mime_type.into() }
    }
}
