//! Turbidity and sun → light scattered by clear air, after Hillaire, "A Scalable and Production Ready Sky and
//! Atmosphere Rendering Technique" (EGSR 2020): Rayleigh, Mie and ozone, one order of scattering exactly, all
//! higher orders as isotropic. Lengths are kilometres; the colour channels stand for 680, 550 and 440 nm.
//!
//! Radiances are for a sun of irradiance 1 above the atmosphere.

use glam::Vec3A;

use super::math::{exp, exp3, henyey_greenstein};
use crate::math::cell;

/// Radius of the Earth in km.
const GROUND_KM: f32 = 6360.0;
const TOP_KM: f32 = 6440.0;
/// Scattering, and so extinction, by the molecules of the air at the ground.
pub const RAYLEIGH_PER_KM: Vec3A = Vec3A::new(5.802e-3, 13.558e-3, 33.1e-3);
const RAYLEIGH_SCALE_KM: f32 = 8.0;
const OZONE_PER_KM: Vec3A = Vec3A::new(0.650e-3, 1.881e-3, 0.085e-3);
const MIE_SCALE_KM: f32 = 1.2;
const MIE_ALBEDO: f32 = 0.9;
const GROUND_ALBEDO: f32 = 0.2;

const HEIGHTS: usize = 24;
const COSINES: usize = 96;
const MULTI_HEIGHTS: usize = 8;
const MULTI_COSINES: usize = 20;

/// Clear air, with tables of the sun's light in it.
pub struct Atmosphere {
    mie_scattering: Vec3A,
    /// Extinction by haze at the ground, per km.
    pub mie_extinction: Vec3A,
    transmittance: Table,
    multiple: Table,
}

/// Light gathered along a view ray: with its phase function applied, and Mie light still to be multiplied by
/// [`mie_phase`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Gathered {
    /// Rayleigh scattering and all higher orders.
    pub smooth: Vec3A,
    /// First-order Mie scattering without its phase function.
    pub mie: Vec3A,
}

/// The phase function of haze droplets per steradian: a broad lobe and a narrow one, the sun's aureole.
#[inline]
pub fn mie_phase(cos_angle: f32) -> f32 {
    0.93 * henyey_greenstein(0.72, cos_angle) + 0.07 * henyey_greenstein(0.955, cos_angle)
}

fn rayleigh_phase(cos_angle: f32) -> f32 {
    3.0 / (16.0 * std::f32::consts::PI) * (1.0 + cos_angle * cos_angle)
}

/// The air at a place: scattering by molecules and by haze, and extinction, per km.
struct Local {
    rayleigh: Vec3A,
    mie: Vec3A,
    extinction: Vec3A,
}

/// Distance from the Earth's centre after `t` km along a ray of direction cosine `mu` from radius `r`.
fn radius_at(r: f32, mu: f32, t: f32) -> f32 {
    (r * r + t * t + 2.0 * r * mu * t).sqrt()
}

/// Distance along a ray of direction cosine `mu` from radius `r` to where the air ends.
fn distance_up(r: f32, mu: f32) -> f32 {
    -r * mu + (r * r * (mu * mu - 1.0) + TOP_KM * TOP_KM).max(0.0).sqrt()
}

/// Distance to the ground, if the ray meets it.
fn distance_down(r: f32, mu: f32) -> Option<f32> {
    let root = r * r * (mu * mu - 1.0) + GROUND_KM * GROUND_KM;
    (mu < 0.0 && root >= 0.0).then(|| -r * mu - root.sqrt()).filter(|&t| t > 0.0)
}

/// Direction cosines crowd around the horizon in the tables.
fn cosine_to_unit(mu: f32) -> f32 {
    ((mu / (mu.abs() + 0.1) + 0.667) / 1.577).clamp(0.0, 1.0)
}

fn unit_to_cosine(unit: f32) -> f32 {
    let m = unit * 1.577 - 0.667;
    0.1 * m / (1.0 - m.abs())
}

/// A table over height and the direction cosine of the sun.
#[derive(Default)]
struct Table {
    columns: usize,
    rows: usize,
    values: Vec<Vec3A>,
}

impl Table {
    fn new(columns: usize, rows: usize, value: impl Fn(f32, f32) -> Vec3A) -> Self {
        let entry = |k: usize| {
            let unit = (k / columns) as f32 / (rows - 1) as f32;
            let mu = unit_to_cosine((k % columns) as f32 / (columns - 1) as f32);
            value(unit * unit * (TOP_KM - GROUND_KM), mu)
        };
        Self { columns, rows, values: (0..columns * rows).map(entry).collect() }
    }

    fn at(&self, height_km: f32, mu: f32) -> Vec3A {
        let (u, v) = (cosine_to_unit(mu), (height_km / (TOP_KM - GROUND_KM)).clamp(0.0, 1.0).sqrt());
        let (i, x) = cell(u * (self.columns - 1) as f32, self.columns);
        let (j, y) = cell(v * (self.rows - 1) as f32, self.rows);
        let row = |j: usize| {
            let at = j * self.columns + i;
            self.values[at] + (self.values[at + 1] - self.values[at]) * x
        };
        let (low, high) = (row(j), row(j + 1));
        low + (high - low) * y
    }
}

/// Steps along a ray that grow with the square of their number: the middle and the length of each.
fn steps(length: f32, count: usize) -> impl Iterator<Item = (f32, f32)> {
    let end = move |step: usize| {
        let share = step as f32 / count as f32;
        length * share * share
    };
    (0..count).map(move |step| (0.5 * (end(step) + end(step + 1)), end(step + 1) - end(step)))
}

impl Atmosphere {
    /// Air of a turbidity (Linke's and Preetham's: optical thickness of haze and molecules over that of molecules).
    ///
    /// Haze scatters so strongly forwards that most of its scattered light counts as not scattered (the delta scaling
    /// of Joseph, Wiscombe and Weinman 1976); 0.42 of its thickness remains.
    pub fn new(turbidity: f32) -> Self {
        let thickness = 0.108 * (turbidity - 1.0).max(0.05) * 0.42;
        let spectrum = Vec3A::new(0.84, 1.0, 1.18);
        let mie_extinction = spectrum * (thickness / MIE_SCALE_KM);
        let mut air = Self {
            mie_scattering: mie_extinction * MIE_ALBEDO,
            mie_extinction,
            transmittance: Table::default(),
            multiple: Table::default(),
        };
        air.transmittance = Table::new(COSINES, HEIGHTS, |height, mu| air.sun_transmittance(height, mu, 20));
        air.multiple = Table::new(MULTI_COSINES, MULTI_HEIGHTS, |height, mu| {
            air.multiple_scattering(height.max(0.02), mu)
        });
        air
    }

    fn local(&self, height_km: f32) -> Local {
        let (air, haze) = (exp(-height_km / RAYLEIGH_SCALE_KM), exp(-height_km / MIE_SCALE_KM));
        let ozone = (1.0 - (height_km - 25.0).abs() / 15.0).max(0.0);
        let extinction = RAYLEIGH_PER_KM * air + self.mie_extinction * haze + OZONE_PER_KM * ozone;
        Local { rayleigh: RAYLEIGH_PER_KM * air, mie: self.mie_scattering * haze, extinction }
    }

    /// Part of the sun's light that arrives at a height (km) when the sun stands at direction cosine `mu`.
    pub fn sun_transmittance(&self, height_km: f32, mu: f32, count: usize) -> Vec3A {
        let r = GROUND_KM + height_km.max(0.0);
        if distance_down(r, mu).is_some() {
            return Vec3A::ZERO;
        }
        let mut depth = Vec3A::ZERO;
        for (t, dt) in steps(distance_up(r, mu), count) {
            depth += self.local(radius_at(r, mu, t) - GROUND_KM).extinction * dt;
        }
        exp3(-depth)
    }

    /// Radiance of all orders above the first, per unit of scattering: second order over 1 − its own feedback.
    fn multiple_scattering(&self, height_km: f32, sun_mu: f32) -> Vec3A {
        const DIRECTIONS: usize = 24;
        let sun_sine = (1.0 - sun_mu * sun_mu).max(0.0).sqrt();
        let (mut light, mut feedback) = (Vec3A::ZERO, Vec3A::ZERO);
        for i in 0..DIRECTIONS {
            // A Fibonacci spiral over the sphere.
            let mu = 1.0 - (2 * i + 1) as f32 / DIRECTIONS as f32;
            let azimuth = i as f32 * 2.399_963_2;
            let cos_angle = mu * sun_mu + (1.0 - mu * mu).max(0.0).sqrt() * sun_sine * libm::cosf(azimuth);
            let (l, f) = self.second_order(height_km, mu, sun_mu, cos_angle);
            light += l;
            feedback += f;
        }
        let n = 1.0 / DIRECTIONS as f32;
        light * n / (Vec3A::ONE - feedback * n)
    }

    fn second_order(&self, height_km: f32, mu: f32, sun_mu: f32, cos_angle: f32) -> (Vec3A, Vec3A) {
        let r = GROUND_KM + height_km;
        let ground = distance_down(r, mu);
        let length = ground.unwrap_or_else(|| distance_up(r, mu));
        let (mut light, mut feedback, mut through) = (Vec3A::ZERO, Vec3A::ZERO, Vec3A::ONE);
        for (t, dt) in steps(length, 12) {
            let radius = radius_at(r, mu, t);
            let Local { rayleigh, mie, extinction } = self.local(radius - GROUND_KM);
            let scattering = rayleigh + mie;
            let passed = exp3(-extinction * dt);
            let gathered = scattering * through * (Vec3A::ONE - passed) / extinction.max(Vec3A::splat(1e-9));
            let mu_here = (r * sun_mu + t * cos_angle) / radius;
            light += gathered
                * self.transmittance.at(radius - GROUND_KM, mu_here)
                * (0.25 * std::f32::consts::FRAC_1_PI);
            feedback += gathered;
            through *= passed;
        }
        if let Some(t) = ground {
            let mu_ground = (r * sun_mu + t * cos_angle) / GROUND_KM;
            let bounce = GROUND_ALBEDO * std::f32::consts::FRAC_1_PI * mu_ground.max(0.0);
            light += through * self.transmittance.at(0.0, mu_ground) * bounce;
        }
        (light, feedback)
    }

    /// Light that reaches an eye at `height_km` along a ray upwards of direction cosine `mu`, at an angle to the sun
    /// of cosine `cos_angle`.
    pub fn gather(&self, height_km: f32, mu: f32, sun_mu: f32, cos_angle: f32) -> Gathered {
        let r = GROUND_KM + height_km;
        let length = distance_up(r, mu);
        let phase = rayleigh_phase(cos_angle);
        let mut sum = Gathered::default();
        let mut through = Vec3A::ONE;
        for (t, dt) in steps(length, 26) {
            let radius = radius_at(r, mu, t);
            let height = radius - GROUND_KM;
            let Local { rayleigh, mie, extinction } = self.local(height);
            let passed = exp3(-extinction * dt);
            let weight = through * (Vec3A::ONE - passed) / extinction.max(Vec3A::splat(1e-9));
            let mu_here = (r * sun_mu + t * cos_angle) / radius;
            let sun = self.transmittance.at(height, mu_here);
            sum.smooth +=
                weight * (rayleigh * sun * phase + (rayleigh + mie) * self.multiple.at(height, mu_here));
            sum.mie += weight * mie * sun;
            through *= passed;
        }
        sum
    }
}
