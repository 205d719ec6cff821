//! Cloud field, sun and clear sky → light and transparency of the clouds along a ray. Single scattering with a
//! two-lobed phase function, higher orders as in Wrenninge, "Art-directable multiple volumetric scattering"
//! (SIGGRAPH 2015) and, deep inside, the two-stream approximation; steps as in Hillaire, "Physically Based Sky,
//! Atmosphere and Cloud Rendering in Frostbite" (2016).

use std::ops::Range;

use glam::{Vec3A, Vec4};

use super::SkyParams;
use super::clear::{ClearSky, pale};
use super::field::{CloudField, Shape};
use super::math::{dot, exp, henyey_greenstein, normalize};
use crate::math::{lerp, smoothstep};

const EARTH_M: f32 = 6_360_000.0;
/// Extinction inside a cloud per metre: droplets of 10 µm, 0.2 g/m³.
const EXTINCTION_PER_M: f32 = 0.035;

/// Distance beyond which small billows are finer than a pixel.
const FINE_M: f32 = 30_000.0;

/// Cumulus or stratus under a certain light.
pub struct Clouds {
    /// Where the clouds are.
    pub field: CloudField,
    sun: Vec3A,
    sun_light: Vec3A,
    sky_light: Vec3A,
    ground_light: Vec3A,
}

/// Light and transparency along a ray.
#[derive(Clone, Copy)]
pub struct Marched {
    /// Light towards the eye, without the air in between.
    pub light: Vec3A,
    /// Transparency, 0 to 1.
    pub through: f32,
    /// Mean distance of the cloud seen in metres.
    pub distance_m: f32,
}

/// Distance in metres at which a ray of sine `sine` reaches a height above the curved Earth.
#[inline]
pub fn distance_to_height(sine: f32, height_m: f32) -> f32 {
    let cosine2 = 1.0 - sine * sine;
    2.0 * height_m / (sine + (sine * sine + 2.0 * cosine2 * height_m / EARTH_M).sqrt())
}

impl Clouds {
    /// The clouds of these genes under a clear sky, or `None` when there are none.
    pub fn new(params: &SkyParams, sky: &ClearSky) -> Option<Self> {
        let field = CloudField::new(params)?;
        let middle_km = 0.001 * (field.base_m + 0.6 * field.height_m);
        let sky_light = sky.irradiance() * std::f32::consts::FRAC_1_PI;
        // A deck is lit from above, where a low sun is less red; below it, light has been scattered so often that its
        // colours have mixed.
        let top_km = 0.001 * (field.base_m + field.height_m);
        let sun_light = sky.sun_at(lerp(middle_km, top_km, field.deck));
        let sun_light = pale(sun_light, 0.8 * field.deck);
        Some(Self { field, sun: sky.sun, sun_light, sky_light, ground_light: sky.ground })
    }

    /// The same clouds in a field that repeats exactly.
    pub fn into_tiling(self) -> Self {
        Self { field: self.field.into_tiling(), ..self }
    }

    /// Marches from the ground along a unit direction with y > 0.
    pub fn march(&self, direction: Vec3A) -> Marched {
        let field = &self.field;
        let reach = field.reach_m();
        let near = distance_to_height(direction.y, (field.base_m - 0.3 * reach).max(1.0));
        let far = distance_to_height(direction.y, field.base_m + field.height_m + reach);
        let bend = (1.0 - direction.y * direction.y) / (2.0 * EARTH_M);
        let height = |t: f32| t * direction.y + t * t * bend - field.base_m;
        self.walk(Vec3A::ZERO, direction, near..far, height)
    }

    /// Marches straight up or down through the whole layer at a place, as if the Earth were flat.
    pub fn march_vertical(&self, x: f32, z: f32) -> Marched {
        let field = &self.field;
        let reach = field.reach_m();
        let origin = Vec3A::new(x, 0.0, z);
        self.walk(origin, Vec3A::Y, 0.0..field.height_m + 1.3 * reach, |t| t - 0.3 * reach)
    }

    /// Marches along a ray, `height` metres above the base at a distance: long steps in clear air, short ones where a
    /// cloud may be, and back by one when a short step with all detail finds it.
    fn walk(&self, origin: Vec3A, along: Vec3A, range: Range<f32>, height: impl Fn(f32) -> f32) -> Marched {
        let field = &self.field;
        let phases = Phases::new(dot(along, self.sun));
        let mut inside = Inside { through: 1.0, ..Inside::default() };
        let mut t = range.start;
        let mut empty = 2i32;
        while t < range.end && inside.through > 0.0 {
            let fine_step = (0.17 * field.billow_m).max(0.005 * t).max((range.end - range.start) / 128.0);
            let point = Vec3A::new(origin.x + along.x * t, height(t), origin.z + along.z * t);
            let shape = field.shape(point.x, point.y, point.z);
            let outside = -shape.depth_m - field.reach_m();
            if outside > 0.0 {
                t += (outside * 0.8).max(fine_step);
                empty = 2;
                continue;
            }
            let soft = 0.003 * t;
            let searching = empty >= 2;
            let density = field.density(shape, point.x, point.y, point.z, soft, t < FINE_M && !searching);
            if density <= 0.001 {
                // Longer steps while nothing is near.
                empty += 1;
                t += if searching { 1.6 * fine_step } else { fine_step };
            } else if searching {
                // Here again with all detail; `empty` now delays the next search.
                empty = -2;
            } else {
                empty = 0;
                if inside.steps.is_multiple_of(2) {
                    // Light changes slowly: every other step will do.
                    inside.source = self.source(shape, point, soft, &phases);
                }
                inside.gather(t, exp(-EXTINCTION_PER_M * density * fine_step));
                t += fine_step;
            }
        }
        let distance_m = if inside.weight > 0.0 { inside.distance / inside.weight } else { range.end };
        Marched { light: inside.light, through: inside.through, distance_m }
    }

    /// Optical depth from a point towards the sun.
    fn depth_to_sun(&self, point: Vec3A, soft: f32) -> f32 {
        let field = &self.field;
        // A sun at the horizon shines from a little above, or every cloud would stand in another's shadow.
        let sun = Vec3A::new(self.sun.x, self.sun.y.max(0.1), self.sun.z);
        let (mut depth, mut from) = (0.0, 0.0);
        for (i, reach) in [0.28f32, 0.95, 2.8].into_iter().enumerate() {
            let to = reach * field.billow_m;
            let p = point + sun * (0.5 * (from + to));
            if p.y > field.height_m + field.reach_m() {
                break;
            }
            let shape = field.shape(p.x, p.y, p.z);
            let density = if i == 0 {
                field.density(shape, p.x, p.y, p.z, soft, false)
            } else {
                field.smooth_density(shape)
            };
            depth += (to - from) * density;
            from = to;
        }
        depth * EXTINCTION_PER_M
    }

    /// Light scattered towards the eye per unit of optical depth at a point.
    #[inline]
    fn source(&self, shape: Shape, point: Vec3A, soft: f32, phases: &Phases) -> Vec3A {
        let field = &self.field;
        let near_depth = self.depth_to_sun(point, soft);
        // In a deck, all the cloud above counts; a single cloud is lit from its sides as well.
        let above = (shape.top_m - point.y).max(0.0) * EXTINCTION_PER_M / self.sun.y.max(0.3);
        let sun_depth = near_depth.max(above * (0.35 + 0.65 * field.deck));
        let inside = smoothstep(-0.5 * field.billow_m, 0.6 * field.billow_m, shape.depth_m);
        let up = (point.y / field.height_m.max(1.0)).clamp(0.0, 1.0);
        let first = phases.narrow * exp(-sun_depth);
        let second = 0.55 * phases.wide * exp(-0.33 * sun_depth);
        // Many orders: builds up inwards (the powder effect), falls off as in the two-stream solution.
        let many = 0.19 * (0.5 + 0.5 * inside) / (1.0 + 0.14 * sun_depth);
        let open = 0.3 + 0.7 * up;
        let ambient =
            self.sky_light * (open * (1.0 - 0.35 * inside)) + self.ground_light * (0.5 * (1.0 - up));
        self.sun_light * (first + second + many) + ambient * 0.75
    }

    /// Colour of a thin edge: transparent texels need one, too, to blend with.
    pub fn edge_light(&self) -> Vec3A {
        self.sun_light * 0.1 + self.sky_light * 0.5
    }

    /// Mean part of the sun's beam that the clouds let through to the ground.
    pub fn sun_through(&self) -> f32 {
        const SIDE: usize = 12;
        let direction = normalize(Vec3A::new(self.sun.x, self.sun.y.max(0.1), self.sun.z));
        let slant = 1.0 / direction.y;
        let field = &self.field;
        let mut sum = 0.0;
        for place in 0..SIDE * SIDE {
            let x = (place % SIDE) as f32 / SIDE as f32 * field.tile_m * 1.7;
            let z = (place / SIDE) as f32 / SIDE as f32 * field.tile_m * 1.7;
            let mut depth = 0.0;
            for step in 0..8 {
                let y = (step as f32 + 0.5) / 8.0 * field.height_m;
                let p = direction * (y * slant);
                let shape = field.shape(x + p.x, y, z + p.z);
                depth += field.density(shape, x + p.x, y, z + p.z, 0.0, false);
            }
            sum += exp(-EXTINCTION_PER_M * depth * field.height_m / 8.0 * slant.min(3.0));
        }
        sum / (SIDE * SIDE) as f32
    }
}

/// What a ray has gathered inside clouds.
#[derive(Default)]
struct Inside {
    steps: u32,
    /// Light per unit of optical depth.
    source: Vec3A,
    light: Vec3A,
    through: f32,
    /// Sum of distances, weighted by the opacity there, and sum of the weights.
    distance: f32,
    weight: f32,
}

impl Inside {
    /// A step at a distance that lets the part `passed` of the light through. A transparency below 2 % counts as 0.
    fn gather(&mut self, distance: f32, passed: f32) {
        let gathered = self.through * (1.0 - passed);
        self.steps += 1;
        self.light += self.source * gathered;
        self.distance += distance * gathered;
        self.weight += gathered;
        let through = self.through * passed;
        self.through = if through < 0.02 { 0.0 } else { through };
    }
}

struct Phases {
    narrow: f32,
    wide: f32,
}

impl Phases {
    fn new(cosine: f32) -> Self {
        let narrow = 0.75 * henyey_greenstein(0.82, cosine) + 0.25 * henyey_greenstein(-0.25, cosine);
        Self { narrow: narrow.min(0.7), wide: henyey_greenstein(0.4, cosine) }
    }
}

/// A marched ray as seen through the air: light and transparency.
pub fn through_air(marched: &Marched, direction: Vec3A, height_m: f32, sky: &ClearSky) -> Vec4 {
    if marched.through >= 0.999 {
        return Vec4::new(0.0, 0.0, 0.0, 1.0);
    }
    let clearness = sky.clearness(direction.y, 0.001 * marched.distance_m, 0.001 * height_m);
    let air = sky.air(direction) * (Vec3A::ONE - clearness) * (1.0 - marched.through);
    (marched.light * clearness + air).extend(marched.through)
}
