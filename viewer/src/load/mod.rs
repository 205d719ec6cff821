//! `scene.gltf` and the blobs that it names → [`Scene`]; any other glTF file → [`Asset`]. What was read for one landscape is
//! kept while any landscape uses it, so that a reload reads only blobs with new names.

mod accessor;
mod asset;
mod bounds;
mod document;
mod ground;
mod images;
mod octahedral;
mod store;
mod trees;

use std::path::{Path, PathBuf};

use genescape_cache::verified;
use genescape_schema::scene::{GSC_SKY, Resource, START_NODE, SkyExtension, StartView};
use genescape_world::{MAX_MODEL_BYTES, regular_file};
use glam::Vec3;
use thiserror::Error;

pub use store::Store;

use crate::scene::{Asset, Ground, HdrImage, Scene, Sky};
use document::Document;

/// Why a landscape cannot be shown. Reasons are in the text, and so no sources: whoever prints the chain would tell
/// them twice.
#[derive(Debug, Error)]
pub enum LoadError {
    #[error("cannot read {path}: {reason}; `bake` makes it again")]
    Unreadable { path: PathBuf, reason: std::io::Error },
    #[error(
        "{path} is damaged: its bytes are not those that its name promises; \
         `bake cache verify`, then `bake` make it again"
    )]
    Damaged { path: PathBuf },
    #[error("{path} is no glTF file: {reason}")]
    NoGltf { path: PathBuf, reason: Box<gltf::Error> },
    /// The scene is glTF, but none of ours.
    #[error("{path} is no landscape of Genescape: {what}")]
    Foreign { path: PathBuf, what: String },
    /// A file of anyone's.
    #[error("{path} cannot be shown: {what}")]
    Asset { path: PathBuf, what: String },
    #[error("cannot read {path}: {reason}")]
    FileUnreadable { path: PathBuf, reason: std::io::Error },
}

type Result<T, E = LoadError> = std::result::Result<T, E>;

impl LoadError {
    /// Whether the file itself is not what it should be.
    pub fn is_bad_input(&self) -> bool {
        matches!(self, Self::NoGltf { .. } | Self::Foreign { .. } | Self::Asset { .. })
    }

    fn foreign(path: &Path, what: impl Into<String>) -> Self {
        Self::Foreign { path: path.to_owned(), what: what.into() }
    }
}

/// What a file holds.
#[derive(Clone, Debug)]
pub enum Content {
    Landscape(Box<Scene>),
    /// Anyone's, and the other files that it is made of.
    Asset(Box<Asset>, Vec<PathBuf>),
}

/// Reads a glTF file: a landscape if it says that it is one.
pub fn load(path: &Path, store: &Store) -> Result<Content> {
    let bytes = regular_file::read(path, MAX_MODEL_BYTES)
        .map_err(|reason| LoadError::FileUnreadable { path: path.to_owned(), reason })?;
    let bytes = verified(path, bytes).map_err(|_| LoadError::Damaged { path: path.to_owned() })?;
    if asset::is_landscape(&bytes) {
        return landscape(path, &bytes, store).map(|scene| Content::Landscape(Box::new(scene)));
    }
    asset::read(path, &bytes).map(|(asset, files)| Content::Asset(Box::new(asset), files))
}

/// Reads a landscape from its `scene.gltf`.
///
/// # Errors
/// Also if it is another glTF file.
pub fn scene(path: &Path, store: &Store) -> Result<Scene> {
    match load(path, store)? {
        Content::Landscape(scene) => Ok(*scene),
        Content::Asset(..) => Err(LoadError::foreign(path, "it has no land and no sky of ours")),
    }
}

fn landscape(path: &Path, bytes: &[u8], store: &Store) -> Result<Scene> {
    let document = Document::of(path, bytes, store)?;
    let scene = document.scene()?;
    let (ground, (trees, sky)) =
        rayon::join(|| ground::read(&document), || rayon::join(|| trees::read(&document), || sky(&document)));
    let (ground, trees, sky) = (ground?, trees?, sky?);
    let name = scene.name().unwrap_or("a landscape").to_owned();
    let start = start(&document, &ground);
    Ok(Scene { name, start, ground, trees, sky })
}

/// The camera of the bake; without one, the middle of the land, looking north.
fn start(document: &Document, ground: &Ground) -> StartView {
    if let Some(node) = document.node(START_NODE) {
        let (translation, rotation, _) = node.transform().decomposed();
        return StartView::of_camera(translation, rotation);
    }
    let position_m = Vec3::Y * (ground.field.height_m(0.0, 0.0) + StartView::EYE_HEIGHT_M);
    StartView { position_m, direction: Vec3::NEG_Z }
}

fn sky(document: &Document) -> Result<Sky> {
    let scene = document.scene()?;
    let SkyExtension { images, light } = document.extension(scene.extension_value(GSC_SKY), GSC_SKY)?;
    let face = |face: &Resource| images::exr(document, face);
    let mut images = images.try_map(|_| Ok(()), face, |layer| images::png(document, layer))?;
    if images.clear_faces.is_empty() {
        images.clear_faces = images.faces.clone();
    }
    let is_cube = |faces: &[HdrImage]| {
        let same = |face: &HdrImage| [face.width_px, face.height_px] == [faces[0].width_px; 2];
        faces.len() == 6 && faces.iter().all(same)
    };
    if !is_cube(&images.faces) || !is_cube(&images.clear_faces) {
        return Err(document.wrong("GSC_sky does not have six square faces of one size"));
    }
    Ok(Sky { images, light })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reason_is_told_once() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let error = load(folder.path(), &Store::default()).expect_err("a folder");
        let LoadError::FileUnreadable { reason, .. } = &error else { panic!("{error}") };
        let reason = reason.to_string();
        let told = format!("{:#}", anyhow::Error::from(error));
        assert_eq!(told.matches(&reason).count(), 1, "{told}");
    }
}
