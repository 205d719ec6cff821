//! Results → the files that other programs open: glTF 2.0 (Khronos, 2021) with our extensions beside the core.
//!
//! Metres, right-handed, y up. Everything here is a pure function to bytes; where bytes are stored, and by what name
//! they are found again, is the caller's affair: a scene gets the URIs of its blobs as arguments.

mod document;
pub mod exr;
mod foreground;
mod glb;
mod impostor;
mod level_scenes;
mod levels;
mod materials;
pub mod png;
mod prune;
mod scene;
mod scene_import;
mod scene_parts;
mod scene_trees;
mod single;
#[cfg(test)]
mod synthetic;
mod tangents;
mod terrain;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_impostor;
mod tree;
mod vertices;

use thiserror::Error;

pub(crate) use document::for_each_object;
pub use foreground::{GRASS_MATERIAL, foreground_glb};
pub(crate) use glb::split_glb;
pub use levels::levelled_glb;
pub use materials::{KHR_MATERIALS_DIFFUSE_TRANSMISSION, MaterialSet, Picture};
pub use scene::{directional_light, scene_gltf};
pub use scene_parts::{Blob, GlbBlob, SceneParts};
pub use single::single_glb;
pub use terrain::terrain_glb;
pub use tree::{TreePictures, tree_glb};

/// What `asset.generator` says.
pub const GENERATOR: &str = concat!("Genescape ", env!("CARGO_PKG_VERSION"));

/// Why a file could not be made.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ExportError {
    /// glTF knows no mesh without triangles.
    #[error("{0} has no triangles")]
    Empty(String),
    /// NaN or infinity, which glTF forbids.
    #[error("{0} has an attribute that is not a finite number")]
    NotFinite(String),
    /// Indices or attribute lists that do not fit each other.
    #[error("{0} is inconsistent: {1}")]
    Inconsistent(String, &'static str),
    /// A transform that cannot be split into glTF nodes.
    #[error("the transform of {0} is mirrored or flattened (determinant {1})")]
    Transform(String, f64),
    /// An instance of a template that is not there.
    #[error("{0} is of template {1}, but there are only {2}")]
    Template(String, u32, usize),
    /// A file given as input is not what it should be.
    #[error("{0} is not a glTF file that can be used here: {1}")]
    NotGltf(String, String),
    /// A file that a scene names could not be had.
    #[error("{0} could not be read: {1}")]
    Missing(String, String),
}
