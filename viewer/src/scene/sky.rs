//! Sky, sun, clouds and air.

use super::{HdrPicture, Picture};

/// What `GSC_sky` says. Radiance and irradiance are relative: radiance 1 is white at an exposure of 1.
#[derive(Clone, Debug)]
pub struct Sky {
    /// The sky with its clouds: +X, −X, +Y, −Y, +Z, −Z.
    pub faces: [HdrPicture; 6],
    /// The same without clouds.
    pub clear_faces: [HdrPicture; 6],
    /// Sheets of clouds that may drift.
    pub layers: Vec<CloudLayer>,
    /// Unit vector towards the sun.
    pub sun_direction: [f32; 3],
    /// Half the sun's angular diameter.
    pub sun_angular_radius_rad: f32,
    /// On a surface that faces the sun.
    pub sun_irradiance_linear: [f32; 3],
    /// Of the sky, without sun, on open level ground.
    pub sky_irradiance_linear: [f32; 3],
    /// What distant land fades to.
    pub haze_linear: [f32; 3],
    /// Per metre.
    pub haze_extinction_per_m: f32,
    /// Factor on the whole picture.
    pub exposure: f32,
}

/// A horizontal sheet of clouds.
#[derive(Clone, Debug)]
pub struct CloudLayer {
    /// "cumulus", "cirrus".
    pub name: String,
    /// Height above the origin.
    pub altitude_m: f32,
    /// What one repeat of the picture covers.
    pub extent_m: f32,
    /// sRGB of tone-mapped radiance, with alpha.
    pub image: Picture,
}
