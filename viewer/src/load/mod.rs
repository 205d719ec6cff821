//! `scene.gltf` and the blobs that it names → [`Scene`]. What was read for one landscape is kept while any landscape
//! uses it, so that a reload reads only blobs with new names.

mod accessor;
mod bounds;
mod document;
mod ground;
mod images;
mod store;
mod trees;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use genescape_schema::scene::{
    GSC_LOOKOUTS, GSC_SKY, Lookouts, LookoutsExtension, START_NODE, SkyExtension, StartView,
};
use glam::Vec3;
use thiserror::Error;

pub use store::Store;

use crate::scene::{Ground, HdrImage, Scene, Sky};
use document::Document;

/// Why a landscape cannot be shown.
#[derive(Debug, Error)]
pub enum LoadError {
    #[error("cannot read {path}: {source}; `bake` makes it again")]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error(
        "{path} is damaged: its bytes are not those that its name promises; \
         `bake cache verify`, then `bake` make it again"
    )]
    Damaged { path: PathBuf },
    #[error("{path} is no glTF file: {source}")]
    NoGltf { path: PathBuf, source: Box<gltf::Error> },
    /// The scene is glTF, but none of ours.
    #[error("{path} is no landscape of Genescape: {what}")]
    Foreign { path: PathBuf, what: String },
}

type Result<T> = std::result::Result<T, LoadError>;

impl LoadError {
    fn foreign(path: &Path, what: impl Into<String>) -> Self {
        Self::Foreign { path: path.to_owned(), what: what.into() }
    }
}

/// Reads a landscape from its `scene.gltf`.
pub fn load(path: &Path, store: &Store) -> Result<Scene> {
    let document = Document::open(path, store)?;
    let scene = document.scene()?;
    let ground = ground::read(&document)?;
    let trees = trees::read(&document)?;
    let name = scene.name().unwrap_or("a landscape").to_owned();
    let (start, lookouts) = (start(&document, &ground), lookouts(&document)?);
    Ok(Scene { name, start, lookouts, ground, trees, sky: sky(&document)? })
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

/// What the camera of the bake says of other views; a file of an older bake says nothing.
fn lookouts(document: &Document) -> Result<Option<Arc<Lookouts>>> {
    let node = document.node(START_NODE);
    let Some(object) = node.as_ref().and_then(|node| node.extension_value(GSC_LOOKOUTS)) else {
        return Ok(None);
    };
    let extension: LookoutsExtension = document.extension(Some(object), GSC_LOOKOUTS)?;
    let bytes = document.bytes(&extension.prospects)?;
    let lookouts = Lookouts::from_bytes(&bytes).map_err(|what| document.wrong(what.to_string()))?;
    Ok(Some(Arc::new(lookouts)))
}

fn sky(document: &Document) -> Result<Sky> {
    let scene = document.scene()?;
    let SkyExtension { images, light } = document.extension(scene.extension_value(GSC_SKY), GSC_SKY)?;
    let mut images =
        images.try_map(|face| images::exr(document, face), |layer| images::png(document, layer))?;
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
