//! A picture and the light → its exposure: the log-average luminance of what is seen, as Reinhard et al., "Photographic
//! Tone Reproduction for Digital Images" (2002), take it, and a key that falls gently with that luminance, after Krawczyk,
//! Myszkowski and Seidel, "Lightness Perception in Tone Reproduction for High Dynamic Range Images" (2005): snow stays
//! brighter than grass, and dusk darker than noon, but by less than they are. What lies before one's feet is never lost in the
//! dark: a picture is lifted for it, within limits.

use super::panorama::{Kind, Seen};
use super::picture::Picture;
use super::sunlight::luminance;
use crate::math::{interpolate, lerp};
use crate::model::SkyLight;

/// The log-average that needs no exposure, in the units of [`SkyLight`].
const NEUTRAL: f32 = 0.25;
/// Part of a difference from it, in stops, that the eye adapts to.
const ADAPTED: f32 = 0.7;
/// What a photographer adds for snow, which a meter takes for grey; all of it where this part of the picture is snow.
const SNOW_EV: f32 = 1.0;
const MUCH_SNOW: f32 = 0.4;
/// The same for fog: all of it where nothing is seen at this many metres.
const FOG_EV: f32 = 2.4;
const INTO_FOG_M: f32 = 250.0;
/// No picture is dimmed or lifted by more than these factors.
const LIMITS: [f32; 2] = [0.25, 6.0];
/// The foreground's log-average, in shade as in the sun, that a picture is to show at least: of display luminance it is a tenth,
/// in which grass and trunks are still told apart. And the greatest factor by which a picture is lifted for it: dusk stays dusk.
const FOREGROUND: f32 = 0.125;
const MAX_LIFT: f32 = 2.7;
/// No more of the ground counts as lit by the sun: who walks on comes into shade.
const MAX_LIT: f32 = 0.5;
/// Metres up to which land and trees are foreground.
const NEAR_M: f32 = 40.0;
/// Part of the sky's light that reaches what the sun does not: what hides the sun hides some sky. And by how much less, as a
/// part, where all that is seen above the land is trees.
const OPEN_IN_SHADE: f32 = 0.7;
const HIDDEN_BY_TREES: f32 = 0.7;
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
    let fog = 1.0 - libm::expf(-INTO_FOG_M * light.haze_extinction_per_m);
    let key = libm::exp2f((SNOW_EV * (snow / MUCH_SNOW).min(1.0)).max(FOG_EV * fog));
    let [trees, sky] = [Kind::Tree, Kind::Sky].map(|wanted| picture.share(|kind| kind == wanted));
    let trees = trees / (trees + sky).max(f32::MIN_POSITIVE);
    let (scene, lit) = (Scene::of(light, 1.0 - HIDDEN_BY_TREES * trees), lit.min(MAX_LIT));
    let whole = scene.log_average(picture, lit, f32::INFINITY);
    let factor = key * libm::powf(NEUTRAL / whole, ADAPTED);
    let lift = FOREGROUND / (factor * scene.log_average(picture, lit, NEAR_M));
    (factor * lift.clamp(1.0, MAX_LIFT)).clamp(LIMITS[0], LIMITS[1])
}

/// The light as numbers to meter with.
struct Scene {
    /// By elevation, from the horizon to the zenith.
    sky: Vec<f32>,
    /// Irradiance of level ground over π, in the sun and in shade.
    sunny: f32,
    shady: f32,
    haze: f32,
    haze_per_m: f32,
}

impl Scene {
    /// Where trees leave that part of the sky open.
    fn of(light: &SkyLight, open: f32) -> Self {
        let around = luminance(light.sky_irradiance_linear);
        let sun = luminance(light.sun_irradiance_linear) * light.sun_direction.y.max(0.0);
        Self {
            sky: light.zonal_radiance_linear.iter().copied().map(luminance).collect(),
            sunny: (around + sun) * std::f32::consts::FRAC_1_PI,
            shady: around * OPEN_IN_SHADE * open * std::f32::consts::FRAC_1_PI,
            haze: luminance(light.haze_linear),
            haze_per_m: light.haze_extinction_per_m,
        }
    }

    /// Log-average luminance of what the picture shows up to a depth, the sun reaching the part `lit` of it. Without anything so
    /// near, neutral.
    fn log_average(&self, picture: &Picture<'_>, lit: f32, depth_m: f32) -> f32 {
        let (mut sum, mut weights) = (0.0, 0.0);
        for (slope, seen) in picture.rays().filter(|(_, seen)| seen.depth_m <= depth_m) {
            let weight = if seen.kind == Kind::Sky { SKY_WEIGHT } else { 1.0 };
            let log = |ground: f32| libm::logf(self.luminance(slope, seen, ground) + DARK * NEUTRAL);
            sum += weight * lerp(log(self.shady), log(self.sunny), lit);
            weights += weight;
        }
        if weights > 0.0 { libm::expf(sum / weights) } else { NEUTRAL }
    }

    fn sky(&self, slope: f32) -> f32 {
        let elevation = libm::atanf(slope.max(0.0)) * std::f32::consts::FRAC_2_PI;
        interpolate(&self.sky, elevation * (self.sky.len() - 1) as f32)
    }

    /// Of what is seen, where level ground gets that irradiance over π.
    fn luminance(&self, slope: f32, seen: &Seen, ground: f32) -> f32 {
        let bare = match seen.kind {
            Kind::Sky => return self.sky(slope),
            Kind::Ground => GROUND * ground,
            Kind::Snow => SNOW * ground,
            Kind::Tree => TREE * (self.shady + ground),
            Kind::Water => MIRRORED * self.sky(0.2),
        };
        let clear = libm::expf(-seen.depth_m * self.haze_per_m);
        bare * clear + self.haze * (1.0 - clear)
    }
}
