//! A picture and the light → its exposure: the log-average luminance of what is seen, as Reinhard et al., "Photographic
//! Tone Reproduction for Digital Images" (2002), take it, and a key that falls gently with that luminance, after Krawczyk,
//! Myszkowski and Seidel, "Lightness Perception in Tone Reproduction for High Dynamic Range Images" (2005): snow stays
//! brighter than grass, and dusk darker than noon, but by less than they are.

use super::light::luminance;
use super::panorama::{Kind, Seen};
use super::picture::Picture;
use crate::math::interpolate;
use crate::model::SkyLight;

/// The log-average that needs no exposure, in the units of [`SkyLight`].
const NEUTRAL: f32 = 0.25;
/// Part of a difference from it, in stops, that the eye adapts to.
const ADAPTED: f32 = 0.7;
/// What a photographer adds for snow, which a meter takes for grey; all of it where this part of the picture is snow.
const SNOW_EV: f32 = 1.0;
const MUCH_SNOW: f32 = 0.4;
/// No picture is dimmed or lifted by more than these factors.
const LIMITS: [f32; 2] = [0.25, 6.0];
/// How much the sky counts beside as large a part of the land: who looks at a bright sky still wants to see the ground.
const SKY_WEIGHT: f32 = 0.5;
/// Black enough to be no measure, as a part of the neutral luminance.
const DARK: f32 = 0.02;

/// Reflectances: of trees with the shade between their leaves; of ground, grass or rock; of snow.
const TREE: f32 = 0.05;
const GROUND: f32 = 0.10;
const SNOW: f32 = 0.80;
/// Part of the low sky that water mirrors at a grazing look.
const MIRRORED: f32 = 0.35;

/// Factor by which the picture is to be made brighter; `lit` is the part of its ground that the sun reaches.
pub(super) fn exposure(picture: &Picture<'_>, light: &SkyLight, lit: f32) -> f32 {
    let snow = picture.share(|kind| kind == Kind::Snow);
    let key = libm::exp2f(SNOW_EV * (snow / MUCH_SNOW).min(1.0));
    let factor = key * libm::powf(NEUTRAL / log_average(picture, light, lit), ADAPTED);
    factor.clamp(LIMITS[0], LIMITS[1])
}

/// Log-average luminance of the picture.
fn log_average(picture: &Picture<'_>, light: &SkyLight, lit: f32) -> f32 {
    let scene = Scene::of(light, lit);
    let (mut sum, mut weights) = (0.0, 0.0);
    for (slope, seen) in picture.rays() {
        let weight = if seen.kind == Kind::Sky { SKY_WEIGHT } else { 1.0 };
        sum += weight * libm::logf(scene.luminance(slope, seen) + DARK * NEUTRAL);
        weights += weight;
    }
    libm::expf(sum / f32::max(weights, 1.0))
}

/// The light as numbers to meter with.
struct Scene {
    /// By elevation, from the horizon to the zenith.
    sky: Vec<f32>,
    /// Irradiance of level ground over π.
    ground: f32,
    /// The same without the sun.
    shade: f32,
    haze: f32,
    haze_per_m: f32,
}

impl Scene {
    fn of(light: &SkyLight, lit: f32) -> Self {
        let shade = luminance(light.sky_irradiance_linear) * std::f32::consts::FRAC_1_PI;
        let sun = luminance(light.sun_irradiance_linear) * light.sun_direction.y.max(0.0);
        Self {
            sky: light.zonal_radiance_linear.iter().copied().map(luminance).collect(),
            ground: shade + lit * sun * std::f32::consts::FRAC_1_PI,
            shade,
            haze: luminance(light.haze_linear),
            haze_per_m: light.haze_extinction_per_m,
        }
    }

    fn sky(&self, slope: f32) -> f32 {
        let elevation = libm::atanf(slope.max(0.0)) * std::f32::consts::FRAC_2_PI;
        interpolate(&self.sky, elevation * (self.sky.len() - 1) as f32)
    }

    fn luminance(&self, slope: f32, seen: &Seen) -> f32 {
        let bare = match seen.kind {
            Kind::Sky => return self.sky(slope),
            Kind::Ground => GROUND * self.ground,
            Kind::Snow => SNOW * self.ground,
            Kind::Tree => TREE * (self.shade + self.ground),
            Kind::Water => MIRRORED * self.sky(0.2),
        };
        let clear = libm::expf(-seen.depth_m * self.haze_per_m);
        bare * clear + self.haze * (1.0 - clear)
    }
}
