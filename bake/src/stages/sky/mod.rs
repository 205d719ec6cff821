//! Sky genes → sun, sky and clouds.
//!
//! The atmosphere is Hillaire's (2020), clouds are ray-marched in a field of billows, cirrus is a thin layer. `light`
//! gives the few numbers that other stages need; `images` paints the same sky. Both are linear sRGB in the
//! relative units of [`SkyLight`], for an eye adapted to the scene.

mod atmosphere;
mod billow;
mod cirrus;
mod clear;
mod clouds;
mod dome;
mod field;
mod layers;
mod math;
mod paint;
mod stage;
#[cfg(test)]
mod tests;

use glam::{Vec3, Vec3A};
use serde::{Deserialize, Serialize};

use crate::model::{SkyImages, SkyLight};
use clear::{ClearSky, SunDisc, sum_around};
use clouds::Clouds;
use dome::{Dome, Layers};
use paint::Painter;
pub use stage::{SkyImagesStage, SkyLightStage};

/// Pixels a side of the cloudless cube faces.
const CLEAR_FACE_PX: usize = 128;
/// Directions around and up in which the clouds are drawn.
const DOME_PX: (usize, usize) = (1088, 184);
/// Steps of elevation in `zonal_radiance_linear`.
const ZONES: usize = 32;

/// The genes of the sky; names, units, ranges and meanings as in `configs/space.ron`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SkyParams {
    pub sky_seed: u32,
    pub sun_elevation_deg: f32,
    pub sun_azimuth_deg: f32,
    pub turbidity: f32,
    pub sun_size_deg: f32,
    pub exposure_ev: f32,
    pub cloud_cover: f32,
    pub cloud_base_m: f32,
    pub cloud_thickness_m: f32,
    pub cloud_scale_m: f32,
    pub cirrus: f32,
    pub haze_m: f32,
}

/// Clear sky and clouds of one set of genes.
struct Sky {
    clear: ClearSky,
    layers: Layers,
}

impl Sky {
    fn new(params: &SkyParams, cirrus_px: usize) -> Self {
        let clear = ClearSky::new(params, cloud_dimming(params));
        let clouds = Clouds::new(params, &clear);
        let cirrus = cirrus::Cirrus::new(params, &clear, cirrus_px);
        Self { clear, layers: Layers { clouds, cirrus } }
    }

    /// Radiance without the sun's disc in a unit direction.
    fn radiance(&self, direction: Vec3A) -> Vec3A {
        let clear = self.clear.radiance(direction);
        if direction.y <= 0.0 || self.layers.is_empty() {
            return clear;
        }
        let seen = self.layers.seen(direction, &self.clear);
        clear * seen.w + Vec3A::from(seen.truncate())
    }
}

/// The approximate part of the clear sky's light that passes these clouds; only the eye's adaptation depends on it.
fn cloud_dimming(params: &SkyParams) -> f32 {
    let cover = params.cloud_cover.clamp(0.0, 1.0);
    let opacity = params.cloud_thickness_m / (params.cloud_thickness_m + 250.0);
    1.0 - 0.75 * opacity * cover * cover
}

/// Sun and sky as other stages need them; costs a few tens of milliseconds.
pub fn light(params: &SkyParams) -> SkyLight {
    let sky = Sky::new(params, cirrus::SIDE / 4);
    let clear = &sky.clear;
    let sun_through =
        sky.layers.clouds.as_ref().map_or(1.0, Clouds::sun_through) * (1.0 - 0.25 * params.cirrus);
    let spokes = if sky.layers.is_empty() { 96 } else { 40 };
    let zone = |zone: usize| {
        let elevation = zone as f32 / (ZONES - 1) as f32 * std::f32::consts::FRAC_PI_2;
        sum_around(libm::sinf(elevation), 0.0, spokes, |d| sky.radiance(d)) / spokes as f32
    };
    let zonal: Vec<Vec3A> = (0..ZONES).map(zone).collect();
    let irradiance = if sky.layers.is_empty() { clear.irradiance() } else { zonal_irradiance(&zonal) };
    SkyLight {
        sun_direction: Vec3::from(clear.sun),
        sun_angular_radius_rad: 0.5 * params.sun_size_deg.to_radians(),
        sun_irradiance_linear: (clear.sun_ground * sun_through).to_array(),
        sky_irradiance_linear: irradiance.to_array(),
        zonal_radiance_linear: zonal.iter().map(|zone| zone.to_array()).collect(),
        haze_linear: clear.haze.to_array(),
        haze_extinction_per_m: 3.912 / params.haze_m.max(100.0),
        exposure: libm::exp2f(params.exposure_ev),
    }
}

/// Irradiance on level ground from a radiance that is linear between equal steps of elevation.
fn zonal_irradiance(zonal: &[Vec3A]) -> Vec3A {
    let step = std::f32::consts::FRAC_PI_2 / (zonal.len() - 1) as f32;
    let mut sum = Vec3A::ZERO;
    for (zone, pair) in zonal.windows(2).enumerate() {
        for part in 0..4 {
            let f = (part as f32 + 0.5) * 0.25;
            let elevation = (zone as f32 + f) * step;
            let weight = libm::sinf(2.0 * elevation) * 0.25 * step;
            sum += pair[0].lerp(pair[1], f) * weight;
        }
    }
    sum * std::f32::consts::PI
}

/// The sky as images: cube faces of `face_px` (384 is usual), an equirectangular image `equirect_width_px` wide
/// (1536 is usual; even), and cloud layers. Exposure is not applied.
pub fn images(params: &SkyParams, light: &SkyLight, face_px: u32, equirect_width_px: u32) -> SkyImages {
    let sky = Sky::new(params, cirrus::SIDE);
    debug_assert!((light.sun_direction - Vec3::from(sky.clear.sun)).length() < 1e-4);
    let clear = &sky.clear;
    let dome = (!sky.layers.is_empty()).then(|| Dome::new(&sky.layers, clear, DOME_PX.0, DOME_PX.1));
    let painter = |dome| Painter { sky: clear, disc: SunDisc::new(clear, params.sun_size_deg), dome };
    let (full, empty) = (painter(dome.as_ref()), painter(None));
    let faces = (0..6).map(|face| full.face(face, face_px.max(4) as usize)).collect();
    let clear_faces = (0..6).map(|face| empty.face(face, CLEAR_FACE_PX)).collect();
    let equirect = full.equirect((equirect_width_px.max(8) / 2 * 2) as usize);
    let Layers { clouds, cirrus } = sky.layers;
    SkyImages { faces, clear_faces, equirect, layers: layers::layers(clouds, cirrus.as_ref()) }
}
