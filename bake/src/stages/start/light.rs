//! Sun and land → how good the light is in a look, from 0 to 1: the sun beside or behind, and the ground before the eyes
//! in its light. Under an overcast sky any heading is as good.

use glam::{Vec2, Vec3};

use super::panorama::{Surroundings, Tree};
use super::sunlight::luminance;
use crate::math::ramp;
use crate::model::SkyLight;

/// Distances at which the ground is asked whether the sun reaches it.
const ASKED_M: [f32; 4] = [5.0, 15.0, 40.0, 100.0];
/// Trees farther than this from the eye are not asked whether they shade what is before it.
pub(super) const SHADES_M: f32 = 90.0;
/// Cosines of the angles from the sun's azimuth: at the edge of the picture, well within it, and behind.
const AT_EDGE: f32 = 0.75;
const WITHIN: f32 = 0.93;
/// Sine of the sun's elevation above which it is not in the picture.
const ABOVE: f32 = 0.5;
/// The same below which its colour is worth having at the picture's edge.
const LOW: f32 = 0.2;

/// What a look loses that shows nothing but shade, where the sun gives most of the light: meadows in the shade of a wood are
/// dark, and dull.
const IN_SHADE: f32 = 0.8;

pub(super) struct Sun {
    towards: Vec3,
    /// Part of the light on level ground that is the sun's.
    part: f32,
}

impl Sun {
    pub fn of(light: &SkyLight) -> Self {
        let [sun, sky] = [light.sun_irradiance_linear, light.sky_irradiance_linear].map(luminance);
        let level = sun * light.sun_direction.y.max(0.05);
        Self { towards: light.sun_direction, part: level / (level + sky).max(1e-6) }
    }

    /// How good the light is in a look from a place along a unit vector; `trees` are those that may stand before the
    /// sun, see [`SHADES_M`].
    pub fn suits(&self, scene: &Surroundings<'_>, trees: &[&Tree], place: Vec2, along: Vec2) -> f32 {
        let lit = self.lit(scene, trees, place, along);
        let weight = ramp(0.05, 0.5, self.part);
        // A sun that is dim still blinds.
        let glare = 0.4 + 0.6 * weight;
        (1.0 - glare * (1.0 - self.side(along))) * (1.0 - weight * IN_SHADE * (1.0 - lit))
    }

    /// Part of the ground ahead that the sun reaches.
    pub fn lit(&self, scene: &Surroundings<'_>, trees: &[&Tree], place: Vec2, along: Vec2) -> f32 {
        let lit =
            ASKED_M.iter().filter(|&&distance_m| self.reaches(scene, trees, place + along * distance_m));
        lit.count() as f32 / ASKED_M.len() as f32
    }

    /// Of the angle between the look and the sun.
    fn side(&self, along: Vec2) -> f32 {
        let level = Vec2::new(self.towards.x, self.towards.z).normalize_or_zero();
        let (facing, height) = (along.dot(level), self.towards.y);
        if height > ABOVE {
            return 1.0 - 0.2 * ramp(0.3, 1.0, facing);
        }
        let behind = 1.0 - 0.2 * ramp(0.7, 1.0, -facing);
        let edge = if height < LOW { 1.0 } else { 0.75 };
        if facing > AT_EDGE { edge - 0.6 * ramp(AT_EDGE, WITHIN, facing) } else { behind }
    }

    /// Whether neither hill nor tree stands between a place and the sun.
    fn reaches(&self, scene: &Surroundings<'_>, trees: &[&Tree], place: Vec2) -> bool {
        let ground_m = scene.surface_m(place);
        let ground = Vec3::new(place.x, ground_m, place.y);
        if trees.iter().any(|tree| tree.hides(ground, self.towards)) {
            return false;
        }
        (1..14).all(|step| {
            let p = Vec3::new(place.x, ground_m + 0.5, place.y) + self.towards * (4.0 * (step * step) as f32);
            scene.ground_m(Vec2::new(p.x, p.z)) < p.y
        })
    }
}
