//! The sky's images.

use std::sync::Arc;

use super::{ImageUse, Uploader};
use crate::scene::{Image, Sky};

/// Sky images on the device.
#[derive(Debug)]
pub struct SkyTextures {
    /// With clouds.
    pub cube: Arc<wgpu::Texture>,
    /// Without.
    pub clear_cube: Arc<wgpu::Texture>,
    /// Sheet of cumulus.
    pub cumulus: Arc<wgpu::Texture>,
    /// Sheet of cirrus.
    pub cirrus: Arc<wgpu::Texture>,
    /// Altitude and extent of the cumulus, then of the cirrus; extent 0 if there is none.
    pub sheets_m: [f32; 4],
}

impl Uploader {
    pub(super) fn sky(&self, sky: &Sky) -> SkyTextures {
        let layer = |name: &str| sky.images.layers.iter().find(|layer| layer.name == name);
        let none = Image::of_one_pixel([0; 4]);
        let texture =
            |name: &str| self.image(layer(name).map_or(&none, |layer| &layer.image), ImageUse::Color);
        let measure = |name: &str| layer(name).map_or([0.0; 2], |layer| [layer.altitude_m, layer.extent_m]);
        let ([a, b], [c, d]) = (measure("cumulus"), measure("cirrus"));
        SkyTextures {
            cube: self.cube(&sky.images.faces),
            clear_cube: self.cube(&sky.images.clear_faces),
            cumulus: texture("cumulus"),
            cirrus: texture("cirrus"),
            sheets_m: [a, b, c, d],
        }
    }
}
