//! Sky genes → what one sees of a sky, and of its light.

use super::Trait;
use super::color::{oklab, shown};
use crate::stages::sky::{SkyParams, light};

/// What [`traits`] gives, in this order.
pub const TRAITS: [Trait; 8] = [
    Trait { name: "sun height", spread: 1.18 },
    Trait { name: "zenith", spread: 0.13 },
    Trait { name: "horizon", spread: 0.063 },
    Trait { name: "sunlight", spread: 0.068 },
    Trait { name: "shadows", spread: 1.18 },
    Trait { name: "clouds", spread: 1.13 },
    Trait { name: "cirrus", spread: 0.32 },
    Trait { name: "haze", spread: 1.63 },
];

pub fn traits(params: &SkyParams) -> Vec<Vec<f32>> {
    let light = light(params);
    let zones = &light.zonal_radiance_linear;
    let band = |from: f32, to: f32| {
        let place = |part: f32| (part * zones.len() as f32) as usize;
        let band = &zones[place(from)..place(to).max(place(from) + 1)];
        let mean: [f32; 3] =
            std::array::from_fn(|k| band.iter().map(|zone| zone[k]).sum::<f32>() / band.len() as f32);
        shown(mean.map(|c| c * light.exposure)).to_vec()
    };
    let luminance = |[r, g, b]: [f32; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let (sun, sky) = (luminance(light.sun_irradiance_linear), luminance(light.sky_irradiance_linear));
    // Its hue alone: how bright it is the other traits tell.
    let sunlight = oklab(light.sun_irradiance_linear.map(|c| 0.5 * c / sun.max(1e-6)));
    let elevation = (params.sun_elevation_deg + 6.0).max(1.0);
    let cover = params.cloud_cover.clamp(0.0, 1.0);
    vec![
        vec![libm::log2f(elevation)],
        band(0.6, 1.0),
        band(0.0, 0.15),
        vec![sunlight[1], sunlight[2]],
        vec![libm::log2f(1.0 + sun / sky.max(1e-6)), 0.3 * libm::log2f(params.sun_size_deg)],
        vec![
            2.0 * cover,
            0.5 * cover * libm::log2f(params.cloud_scale_m / 300.0),
            0.5 * cover * libm::log2f(params.cloud_thickness_m / 100.0),
            0.5 * cover * libm::log2f(params.cloud_base_m / 500.0),
        ],
        vec![params.cirrus],
        vec![libm::log2f(params.haze_m)],
    ]
}
