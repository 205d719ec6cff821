//! `GSC_sky`, on a scene: what is above the land, and the light that comes from it.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::Resource;

pub const GSC_SKY: &str = "GSC_sky";

/// Sun, sky and haze as numbers. Radiances and irradiances are relative, for an eye that is adapted to the scene: noon
/// and dusk are of like brightness, and one unit of radiance is about white at an exposure of 0 EV.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct SkyLight {
    /// Unit vector towards the sun.
    pub sun_direction: Vec3,
    /// Half the sun's angular diameter.
    pub sun_angular_radius_rad: f32,
    /// Irradiance of the sun on a surface that faces it, linear RGB: what air and, in the mean over the land, clouds let
    /// through.
    pub sun_irradiance_linear: [f32; 3],
    /// Irradiance of the sky (without sun) on open level ground, linear RGB.
    pub sky_irradiance_linear: [f32; 3],
    /// Radiance of the sky averaged over azimuth, linear RGB, in equal steps of elevation from 0 to π/2.
    pub zonal_radiance_linear: Vec<[f32; 3]>,
    /// Radiance that distant land fades to, linear RGB.
    pub haze_linear: [f32; 3],
    /// Extinction coefficient of that haze in 1/m: 3.912 / visibility (Koschmieder).
    pub haze_extinction_per_m: f32,
    /// Factor on the whole picture: 2^EV.
    pub exposure: f32,
}

/// The sky as images of radiance `H`, with sheets of cloud as images `C` that can be shown without tone mapping. `W` is
/// the picture of the whole, `()` where only the faces are looked at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct SkyImages<H, C = H, W = H> {
    /// The whole sky with its clouds, equirectangular: the middle column looks along −z (north), columns run towards
    /// east (+x), row 0 is the zenith.
    pub equirect: W,
    /// The same as cube faces: +X, −X, +Y, −Y, +Z, −Z, each as seen from the middle, oriented as cube maps of Vulkan
    /// and WebGPU are.
    pub faces: Vec<H>,
    /// The cube without clouds, for viewers that draw drifting `layers` themselves; empty when there is none.
    #[serde(default = "Vec::new", skip_serializing_if = "Vec::is_empty")]
    pub clear_faces: Vec<H>,
    /// Cloud layers, lowest first.
    #[serde(default = "Vec::new", skip_serializing_if = "Vec::is_empty")]
    pub layers: Vec<CloudLayer<C>>,
}

/// A horizontal sheet of cloud that can drift.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct CloudLayer<C> {
    /// "cumulus" or "cirrus".
    pub name: String,
    /// Height above the origin in metres.
    pub altitude_m: f32,
    /// Metres that the image covers; it tiles.
    pub extent_m: f32,
    /// Colour (sRGB of tone-mapped radiance) with alpha, RGBA.
    pub image: C,
}

/// The extension's object on a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SkyExtension {
    #[serde(flatten)]
    pub images: SkyImages<Resource>,
    #[serde(flatten)]
    pub light: SkyLight,
}

impl<H, C> SkyImages<H, C> {
    /// The same with `f` of the whole, `g` of each face and `h` of each cloud layer's image.
    ///
    /// # Errors
    /// The first that any of them gives.
    pub fn try_map<V, I, D, E>(
        &self,
        f: impl FnOnce(&H) -> Result<V, E>,
        mut g: impl FnMut(&H) -> Result<I, E>,
        mut h: impl FnMut(&C) -> Result<D, E>,
    ) -> Result<SkyImages<I, D, V>, E> {
        let layer = |layer: &CloudLayer<C>| {
            let CloudLayer { name, altitude_m, extent_m, image } = layer;
            Ok(CloudLayer {
                name: name.clone(),
                altitude_m: *altitude_m,
                extent_m: *extent_m,
                image: h(image)?,
            })
        };
        Ok(SkyImages {
            equirect: f(&self.equirect)?,
            faces: self.faces.iter().map(&mut g).collect::<Result<_, _>>()?,
            clear_faces: self.clear_faces.iter().map(&mut g).collect::<Result<_, _>>()?,
            layers: self.layers.iter().map(layer).collect::<Result<_, _>>()?,
        })
    }
}
