//! The sky as stages: genes → light, and light → images, as files.

use genescape_schema::scene::{CloudLayer, SkyImages};
use rayon::prelude::*;
use serde::Serialize;

use super::{SkyParams, images, light};
use crate::gltf::{exr, png};
use crate::graph::{Context, File, Input, Stage, StageError};
use crate::model::{ImageF16, SkyLight};

/// Sky genes → sun and ambient light.
#[derive(Serialize)]
pub struct SkyLightStage {
    pub params: SkyParams,
}

impl Stage for SkyLightStage {
    const NAME: &'static str = "sky light";
    const VERSION: u32 = 5;
    type Output = SkyLight;

    fn run(&self, _: &Context<'_>) -> Result<SkyLight, StageError> {
        Ok(light(&self.params))
    }
}

/// Sky genes and light → cube, panorama, cloud layers.
#[derive(Serialize)]
pub struct SkyImagesStage {
    pub params: SkyParams,
    /// Pixels a side of a face.
    pub face_px: u32,
    /// Columns of the panorama.
    pub equirect_px: u32,
    pub light: Input<SkyLight>,
}

impl Stage for SkyImagesStage {
    const NAME: &'static str = "sky pictures";
    const VERSION: u32 = 5;
    type Output = SkyImages<File>;

    fn run(&self, context: &Context<'_>) -> Result<SkyImages<File>, StageError> {
        let images = images(&self.params, &*context.get(&self.light)?, self.face_px, self.equirect_px);
        let exr = |image: &ImageF16| context.file("exr", exr::encode(image));
        let layer = |layer: &CloudLayer<_>| CloudLayer {
            name: layer.name.clone(),
            altitude_m: layer.altitude_m,
            extent_m: layer.extent_m,
            image: context.file("png", png::encode(&layer.image)),
        };
        let faces = |faces: &[ImageF16]| faces.par_iter().map(exr).collect();
        let (equirect, (faces, clear_faces)) = rayon::join(
            || exr(&images.equirect),
            || rayon::join(|| faces(&images.faces), || faces(&images.clear_faces)),
        );
        let layers = images.layers.par_iter().map(layer).collect();
        Ok(SkyImages { equirect, faces, clear_faces, layers })
    }
}
