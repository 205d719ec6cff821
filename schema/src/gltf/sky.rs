//! `GSC_sky`, on a scene: what is above the land, and the light that comes from it.

use serde::{Deserialize, Serialize};

use super::Resource;

/// The extension's name.
pub const GSC_SKY: &str = "GSC_sky";

/// The extension's object on a scene. Radiometric values are relative: one unit of radiance is white at 0 EV.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct SkyExtension {
    /// The whole sky with its clouds as one equirectangular picture in linear light: the middle column looks along
    /// −z, columns run towards +x, row 0 is the zenith.
    pub equirect: Resource,
    /// The same as cube faces: +X, −X, +Y, −Y, +Z, −Z, oriented as cube maps of Vulkan and WebGPU.
    pub faces: Vec<Resource>,
    /// The cube without clouds, to draw drifting `layers` over; empty when there is none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clear_faces: Vec<Resource>,
    /// Sheets of cloud, lowest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layers: Vec<SkyLayer>,
    /// Unit vector towards the sun.
    pub sun_direction: [f32; 3],
    /// Half the sun's angular diameter in radians.
    pub sun_angular_radius_rad: f32,
    /// Irradiance of the sun on a surface that faces it, linear RGB, clouds not counted.
    pub sun_irradiance_linear: [f32; 3],
    /// Irradiance of the sky without the sun on open level ground, linear RGB.
    pub sky_irradiance_linear: [f32; 3],
    /// Radiance of the sky averaged over azimuth, linear RGB, in equal steps of elevation from 0 to π/2.
    pub zonal_radiance_linear: Vec<[f32; 3]>,
    /// Radiance that distant land fades to, linear RGB.
    pub haze_linear: [f32; 3],
    /// Extinction of that haze in 1/m.
    pub haze_extinction_per_m: f32,
    /// Factor on the whole picture: 2^EV.
    pub exposure: f32,
}

/// A horizontal sheet of cloud that can drift.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct SkyLayer {
    /// `cumulus` or `cirrus`.
    pub name: String,
    /// Height above the origin in metres.
    pub altitude_m: f32,
    /// Metres that the picture covers; it tiles.
    pub extent_m: f32,
    /// Colour (sRGB of tone-mapped radiance) with alpha.
    pub image: Resource,
}
