//! Light: sun, sky and what reaches the ground.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::{Image8, ImageF16};

/// Sun and sky as other stages need them: cheap, without pictures. Radiances and irradiances are relative, for an eye
/// that is adapted to the scene: noon and dusk are of like brightness, and one unit of radiance is about white at an
/// exposure of 0 EV.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    /// Colour that distant land fades to, linear RGB radiance, and the extinction of that haze per metre.
    pub haze_linear: [f32; 3],
    /// Extinction coefficient in 1/m: 3.912 / visibility (Koschmieder).
    pub haze_extinction_per_m: f32,
    /// Factor on the whole picture: 2^EV.
    pub exposure: f32,
}

/// A horizontal sheet of cloud that can drift.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CloudLayer {
    /// "cumulus" or "cirrus".
    pub name: String,
    /// Height above the origin in metres.
    pub altitude_m: f32,
    /// Metres that the picture covers; it tiles.
    pub extent_m: f32,
    /// Colour (sRGB of tone-mapped radiance) with alpha, RGBA.
    pub image_srgb: Image8,
}

/// The sky as pictures in linear light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SkyImages {
    /// +X, −X, +Y, −Y, +Z, −Z, each as seen from the middle, oriented as cube maps of Vulkan and WebGPU are.
    pub faces: Vec<ImageF16>,
    /// The same cube without clouds, 128 px a side, for viewers that draw `layers` themselves.
    pub clear_faces: Vec<ImageF16>,
    /// Equirectangular: the middle column looks along −z (north), columns run towards east (+x), row 0 is the zenith.
    pub equirect: ImageF16,
    /// Cloud sheets, lowest first.
    pub layers: Vec<CloudLayer>,
}

/// Light on the ground; covers the field as `GroundMaps` do. RGB:
/// R = part of the sky's irradiance that arrives, relative to open level ground (glTF reads occlusion from R);
/// G = the sun's irradiance relative to a surface that faces it: max(0, n·l) × visibility;
/// B = visibility of the sun's disc alone, trees and land included.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LightMap {
    /// RGB, linear, 8 bits.
    pub image: Image8,
}
