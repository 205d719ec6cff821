//! `scene.gltf` and the blobs that it names → [`Scene`]. What was read for one landscape is kept while any landscape
//! uses it, so that a reload reads only blobs with new names.

mod document;
mod ground;
mod pictures;
mod store;
mod trees;

use std::path::{Path, PathBuf};

use genescape_schema::scene::{Resource, SkyExtension};
use thiserror::Error;

pub use store::Store;

use crate::scene::{CloudLayer, HdrPicture, Scene, Sky};
use document::Document;

/// Why a landscape cannot be shown.
#[derive(Debug, Error)]
pub enum LoadError {
    /// A file cannot be read.
    #[error("cannot read {path}: {source}; `bake` makes it again")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A blob's bytes are not those that its name promises.
    #[error("{path} is damaged: its bytes are not those that its name promises; `bake` makes it again")]
    Damaged {
        /// The file.
        path: PathBuf,
    },
    /// The scene is no glTF.
    #[error("{path} is no glTF file: {source}")]
    NoGltf {
        /// The file.
        path: PathBuf,
        /// Why.
        source: Box<gltf::Error>,
    },
    /// The scene is glTF, but none of ours.
    #[error("{path} is no landscape of Genescape: {what}")]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What is missing or wrong.
        what: String,
    },
}

impl LoadError {
    fn foreign(path: &Path, what: impl Into<String>) -> Self {
        Self::Foreign { path: path.to_owned(), what: what.into() }
    }
}

/// Reads a landscape from its `scene.gltf`.
pub fn load(path: &Path, store: &Store) -> Result<Scene, LoadError> {
    let document = Document::open(path, store)?;
    let scene = document.scene()?;
    let ground = ground::read(&document)?;
    let trees = trees::read(&document)?;
    let name = scene.name().unwrap_or("a landscape").to_owned();
    Ok(Scene { name, genome: genome(&document), ground, trees, sky: sky(&document)? })
}

/// The genome's values from the scene's extras; none if the file does not tell them.
fn genome(document: &Document) -> Vec<(String, f64)> {
    #[derive(serde::Deserialize)]
    struct Extras {
        genome: serde_json::Map<String, serde_json::Value>,
    }
    let extras = document.scene().ok().and_then(|scene| scene.extras().as_ref());
    let parsed = extras.and_then(|raw| serde_json::from_str::<Extras>(raw.get()).ok());
    let fields = parsed.map(|extras| extras.genome).unwrap_or_default();
    fields.into_iter().filter_map(|(gene, value)| Some((gene, value.as_f64()?))).collect()
}

fn sky(document: &Document) -> Result<Sky, LoadError> {
    let scene = document.scene()?;
    let extension: SkyExtension = document.extension(scene.extension_value("GSC_sky"), "GSC_sky")?;
    let six = |resources: &[Resource]| -> Result<[HdrPicture; 6], LoadError> {
        let faces =
            resources.iter().map(|face| pictures::exr(document, face)).collect::<Result<Vec<_>, _>>()?;
        faces.try_into().map_err(|_| document.wrong("GSC_sky has not six faces"))
    };
    let faces = six(&extension.images.faces)?;
    let clear_faces = if extension.images.clear_faces.is_empty() {
        faces.clone()
    } else {
        six(&extension.images.clear_faces)?
    };
    let layer = |layer: &genescape_schema::scene::CloudLayer<Resource>| -> Result<CloudLayer, LoadError> {
        Ok(CloudLayer {
            name: layer.name.clone(),
            altitude_m: layer.altitude_m,
            extent_m: layer.extent_m,
            image: pictures::png(document, &layer.image)?,
        })
    };
    Ok(Sky {
        faces,
        clear_faces,
        layers: extension.images.layers.iter().map(layer).collect::<Result<_, _>>()?,
        sun_direction: extension.light.sun_direction.to_array(),
        sun_angular_radius_rad: extension.light.sun_angular_radius_rad,
        sun_irradiance_linear: extension.light.sun_irradiance_linear,
        sky_irradiance_linear: extension.light.sky_irradiance_linear,
        haze_linear: extension.light.haze_linear,
        haze_extinction_per_m: extension.light.haze_extinction_per_m,
        exposure: extension.light.exposure,
    })
}
