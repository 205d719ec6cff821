//! Atmosphere and ground haze → radiance of the cloudless sky in any direction, in the relative units of `SkyLight`,
//! cheap enough for every pixel: a table over elevation and azimuth from the sun, with the sharp Mie lobe multiplied
//! in afterwards. Below the horizon the sky goes on as hazy ground, so that no image has a black half.

use glam::{Vec3, Vec3A};

use super::SkyParams;
use super::atmosphere::{Atmosphere, RAYLEIGH_PER_KM, mie_phase};
use super::math::{dot, exp, exp3, luminance};
use crate::math::{cell, lerp, smoothstep};

/// Height of the eye above the sea in km.
const EYE_KM: f32 = 0.15;
/// Scale height in km of the haze that hides distant land.
const HAZE_SCALE_KM: f32 = 0.12;
const ROWS: usize = 64;
const COLUMNS: usize = 32;
/// The sun's irradiance above the atmosphere when the eye is adapted to high noon.
const NOON_SUN: f32 = 7.5;
/// `key` in `adapt` at noon, for a sun of irradiance 1.
const NOON_KEY: f32 = 0.115;
/// Degree to which the eye takes the light's colour for white, as D in CIECAM02; 1 would make a sunset grey. Who sees a
/// picture sits in another light, and adapts to it less than who stands in it.
const WHITE_ADAPTED: f32 = 0.35;
/// Parts of the sun's light at their height and of the clear sky's that clouds send to level ground: only its colour counts.
const CLOUDS_OF_SUN: f32 = 0.5;
const CLOUDS_OF_SKY: f32 = 0.5;

/// The cloudless sky.
pub struct ClearSky {
    /// Unit vector towards the sun.
    pub sun: Vec3A,
    /// The sun's irradiance above the atmosphere in our units.
    pub sun_above: Vec3A,
    /// The sun's irradiance at the ground on a surface that faces it.
    pub sun_ground: Vec3A,
    /// Radiance of the ground.
    pub ground: Vec3A,
    /// Colour that distant land fades to: the mean around the horizon.
    pub haze: Vec3A,
    /// Part of the air's light that is left under a closed deck of clouds.
    shade: f32,
    haze_per_km: f32,
    sun_flat: (f32, f32),
    table: Vec<(Vec3A, Vec3A)>,
    horizon: Vec<(Vec3A, Vec3A)>,
    air: Atmosphere,
}

/// Unit vector towards the sun: azimuth runs clockwise from north (−z) as seen from above.
pub fn sun_direction(params: &SkyParams) -> Vec3 {
    let (elevation, azimuth) = (params.sun_elevation_deg.to_radians(), params.sun_azimuth_deg.to_radians());
    let flat = libm::cosf(elevation);
    Vec3::new(flat * libm::sinf(azimuth), libm::sinf(elevation), -flat * libm::cosf(azimuth)).normalize()
}

/// Row of a table at the sine of an elevation: rows crowd at the horizon.
fn row_of(sine: f32) -> f32 {
    sine.max(0.0).sqrt() * (ROWS - 1) as f32
}

impl ClearSky {
    /// The sky of these parameters; `dimming` in (0, 1] says how much light clouds leave, to which the eye adapts.
    pub fn new(params: &SkyParams, dimming: f32) -> Self {
        let air = Atmosphere::new(params.turbidity);
        let sun = Vec3A::from(sun_direction(params));
        let flat = (sun.x * sun.x + sun.z * sun.z).sqrt().max(1e-6);
        let haze_per_km = 3.912 / (params.haze_m.max(100.0) * 0.001);
        let mut sky = Self {
            sun,
            sun_above: Vec3A::ONE,
            sun_ground: air.sun_transmittance(EYE_KM, sun.y, 64),
            ground: Vec3A::ZERO,
            haze: Vec3A::ZERO,
            shade: 1.0 - 0.45 * smoothstep(0.5, 1.0, params.cloud_cover) * smoothstep(1.0, 0.5, dimming),
            haze_per_km,
            sun_flat: (sun.x / flat, sun.z / flat),
            table: Vec::new(),
            horizon: vec![(Vec3A::ZERO, Vec3A::ZERO); COLUMNS],
            air,
        };
        // Half of the light that haze takes from the beam goes on nearly straight.
        sky.sun_ground *= exp(-0.5 * haze_per_km * HAZE_SCALE_KM / (sun.y + 0.06));
        sky.fill_table();
        sky.adapt(dimming, params.cloud_cover.clamp(0.0, 1.0), 0.001 * params.cloud_base_m);
        sky
    }

    fn fill_table(&mut self) {
        let sun_sine = (1.0 - self.sun.y * self.sun.y).max(0.0).sqrt();
        let entry = |k: usize| {
            let unit = (k / COLUMNS) as f32 / (ROWS - 1) as f32;
            let mu = unit * unit;
            let sine = (1.0 - mu * mu).max(0.0).sqrt();
            let azimuth = 2.0 * (k % COLUMNS) as f32 / (COLUMNS - 1) as f32 - 1.0;
            let cos_angle = mu * self.sun.y + sine * sun_sine * azimuth;
            let light = self.air.gather(EYE_KM, mu, self.sun.y, cos_angle.clamp(-1.0, 1.0));
            (light.smooth, light.mie)
        };
        self.table = (0..ROWS * COLUMNS).map(entry).collect();
    }

    /// Scales all light as an adapted eye sees it: a bright noon stays as it is, dusk and overcast are lifted most
    /// of the way, and the colour of the light on level ground, the clouds' included, is partly taken for white (von
    /// Kries): grass at sunset is golden, not brown.
    fn adapt(&mut self, dimming: f32, cloud_cover: f32, cloud_base_km: f32) {
        self.fill_horizon();
        let sky = self.irradiance();
        let open = self.sun_ground * self.sun.y + sky;
        // The eye rests mostly on the sky itself.
        let key = luminance(sky).max(1e-6) + 0.03 * luminance(self.sun_ground) * self.sun.y;
        let bright = NOON_SUN * libm::powf(NOON_KEY / key, 0.85) * libm::powf(dimming, -0.45);
        let clouds = CLOUDS_OF_SUN * self.sun_at(cloud_base_km) + CLOUDS_OF_SKY * sky;
        let all = open.lerp(clouds, cloud_cover);
        let white = Vec3A::splat(luminance(all)) / all.max(Vec3A::splat(1e-6));
        let scale = bright * Vec3A::ONE.lerp(white, WHITE_ADAPTED);
        self.sun_above = scale;
        self.sun_ground *= scale;
        for entry in &mut self.table {
            *entry = (entry.0 * scale, entry.1 * scale);
        }
        let albedo = Vec3A::new(0.17, 0.16, 0.12);
        self.ground = pale(open, 0.4) * self.shade * scale * albedo * std::f32::consts::FRAC_1_PI;
        self.fill_horizon();
    }

    /// The haze around the horizon: the air's own light low above it, paler, and more alike all round the denser it is.
    fn fill_horizon(&mut self) {
        let (first_row, last_row) = (row_of(0.012) as usize, row_of(0.16) as usize);
        let rows = (last_row - first_row + 1) as f32;
        let (grey, glow) = (0.25 + 1.1 * (1.0 - self.shade), glow_left(self.shade));
        let mut mean = (Vec3A::ZERO, Vec3A::ZERO);
        for column in 0..COLUMNS {
            let mut sum = (Vec3A::ZERO, Vec3A::ZERO);
            for row in first_row..=last_row {
                let entry = self.table[row * COLUMNS + column];
                sum = (sum.0 + entry.0, sum.1 + entry.1);
            }
            self.horizon[column] = (pale(sum.0 / rows, grey) * self.shade, pale(sum.1 / rows, grey) * glow);
            // Columns are even in cos φ; the measure of an azimuth is dφ.
            let weight = column_weight(column);
            mean = (mean.0 + self.horizon[column].0 * weight, mean.1 + self.horizon[column].1 * weight);
        }
        let alike = smoothstep(0.05, 3.0, self.haze_per_km) * 0.75;
        for entry in &mut self.horizon {
            *entry = (entry.0.lerp(mean.0, alike), entry.1.lerp(mean.1, alike));
        }
        let haze = |step: u32| {
            let azimuth = (step as f32 + 0.5) * std::f32::consts::TAU / 64.0;
            self.haze_towards(Vec3A::new(libm::sinf(azimuth), 0.0, libm::cosf(azimuth)))
        };
        self.haze = (0..64).map(haze).sum::<Vec3A>() / 64.0;
    }

    /// Cosine of the azimuth from the sun, as a table column.
    #[inline]
    fn column_of(&self, direction: Vec3A) -> f32 {
        let flat = (direction.x * direction.x + direction.z * direction.z).sqrt().max(1e-6);
        let cosine = (direction.x * self.sun_flat.0 + direction.z * self.sun_flat.1) / flat;
        (cosine * 0.5 + 0.5).clamp(0.0, 1.0) * (COLUMNS - 1) as f32
    }

    /// Haze at the horizon in the azimuth of a direction.
    #[inline]
    pub fn haze_towards(&self, direction: Vec3A) -> Vec3A {
        let flat = (direction.x * direction.x + direction.z * direction.z).sqrt();
        let level = if flat > 1e-6 { direction.with_y(0.0) / flat } else { Vec3A::X };
        let (i, f) = cell(self.column_of(level), COLUMNS);
        let smooth = self.horizon[i].0.lerp(self.horizon[i + 1].0, f);
        let mie = self.horizon[i].1.lerp(self.horizon[i + 1].1, f);
        smooth + mie * mie_phase(dot(direction, self.sun))
    }

    /// Radiance without the sun's disc in a unit direction.
    #[inline]
    pub fn radiance(&self, direction: Vec3A) -> Vec3A {
        if direction.y <= 0.0 {
            return self.below(direction);
        }
        let ((i, fu), (j, fv)) = (cell(self.column_of(direction), COLUMNS), cell(row_of(direction.y), ROWS));
        let at = j * COLUMNS + i;
        let (a, b) = (&self.table[at], &self.table[at + 1]);
        let (c, d) = (&self.table[at + COLUMNS], &self.table[at + COLUMNS + 1]);
        let smooth = a.0.lerp(b.0, fu).lerp(c.0.lerp(d.0, fu), fv);
        let mie = a.1.lerp(b.1, fu).lerp(c.1.lerp(d.1, fu), fv);
        let above = smooth + mie * mie_phase(dot(direction, self.sun));
        let through = exp(-self.haze_per_km * HAZE_SCALE_KM / (direction.y + 0.0035));
        let haze = self.haze_towards(direction);
        haze + (above - haze) * through
    }

    /// Aerial perspective, the light of the air in front of clouds: under a deck, dimmer and without the sun's glow.
    #[inline]
    pub fn air(&self, direction: Vec3A) -> Vec3A {
        let lit = self.radiance(direction);
        if self.shade == 1.0 { lit } else { self.haze.lerp(lit * self.shade, glow_left(self.shade)) }
    }

    /// The lower half: hazy ground, the paler the nearer to the horizon.
    fn below(&self, direction: Vec3A) -> Vec3A {
        let haze = self.haze_towards(direction);
        let deep = 1.0 - exp(direction.y * 5.0);
        let ground = self.ground.lerp(self.haze, 0.3);
        // At the nadir azimuth means nothing: the mean haze takes over.
        let around = haze.lerp(self.haze, smoothstep(0.0, 0.3, -direction.y));
        around.lerp(ground, deep)
    }

    /// Part of light that crosses the air from `distance_km` away and `height_km` up in a direction of sine `sine`.
    #[inline]
    pub fn clearness(&self, sine: f32, distance_km: f32, height_km: f32) -> Vec3A {
        let air = distance_km * (1.0 - 0.055 * height_km.min(6.0));
        let mie_path = distance_km / (1.0 + 0.45 * height_km);
        let haze = self.haze_per_km * HAZE_SCALE_KM / (sine + 0.0035);
        let depth = RAYLEIGH_PER_KM * air + self.air.mie_extinction * mie_path + Vec3A::splat(haze);
        exp3(-depth)
    }

    /// The sun's irradiance at a height above the ground, haze at the ground not counted.
    pub fn sun_at(&self, height_km: f32) -> Vec3A {
        self.air.sun_transmittance(EYE_KM + height_km, self.sun.y, 48) * self.sun_above
    }

    /// Irradiance on open level ground, by a quadrature of even solid angles.
    pub fn irradiance(&self) -> Vec3A {
        const RINGS: usize = 48;
        const SPOKES: usize = 96;
        let sun_azimuth = libm::atan2f(self.sun.x, -self.sun.z);
        let ring = |ring: usize| {
            // Even steps of sin² of the elevation weigh every sample alike under the cosine.
            let sine = ((ring as f32 + 0.5) / RINGS as f32).sqrt();
            sum_around(sine, sun_azimuth, SPOKES, |direction| self.radiance(direction))
        };
        (0..RINGS).map(ring).sum::<Vec3A>() * (std::f32::consts::PI / (RINGS * SPOKES) as f32)
    }
}

/// Sum of a radiance over evenly spaced azimuths, counted from `start_rad`, at a sine of elevation.
pub fn sum_around(sine: f32, start_rad: f32, spokes: usize, radiance: impl Fn(Vec3A) -> Vec3A) -> Vec3A {
    let flat = (1.0 - sine * sine).max(0.0).sqrt();
    let spoke = |spoke: usize| {
        let azimuth = start_rad + (spoke as f32 + 0.5) * std::f32::consts::TAU / spokes as f32;
        radiance(Vec3A::new(flat * libm::sinf(azimuth), sine, -flat * libm::cosf(azimuth)))
    };
    (0..spokes).map(spoke).sum()
}

fn glow_left(shade: f32) -> f32 {
    ((shade - 0.55) / 0.45).clamp(0.0, 1.0)
}

/// A colour drawn towards white of the same luminance.
pub fn pale(color: Vec3A, amount: f32) -> Vec3A {
    color.lerp(Vec3A::splat(luminance(color)), amount)
}

/// Share of the half circle of azimuths that belongs to a column.
fn column_weight(column: usize) -> f32 {
    let edge = |c: f32| libm::acosf((2.0 * c / (COLUMNS - 1) as f32 - 1.0).clamp(-1.0, 1.0));
    let c = column as f32;
    (edge(c - 0.5) - edge(c + 0.5)) * std::f32::consts::FRAC_1_PI
}

/// The sun's disc as the images show it. The light of the real sun is `sun_ground`: as scenes also have a lamp for
/// it, the disc shines only as bright as a camera would show it (twenty times its aureole) and adds next to nothing.
pub struct SunDisc {
    sun: Vec3A,
    radius_rad: f32,
    middle: Vec3A,
}

impl SunDisc {
    /// The disc of an angular diameter in degrees.
    pub fn new(sky: &ClearSky, size_deg: f32) -> Self {
        let radius_rad = 0.5 * size_deg.to_radians();
        let solid_angle = std::f32::consts::PI * radius_rad * radius_rad;
        // Limb darkening 0.4 + 0.6 cos has the mean 0.8.
        let real = sky.sun_ground / (solid_angle * 0.8);
        let aureole = luminance(sky.radiance(sky.sun)).max(1e-3);
        // A large disc shines less, so that its share of the sky's light stays below about two per cent.
        let share = 0.02 * luminance(sky.irradiance()) / (solid_angle * 0.8 * sky.sun.y.max(0.1));
        let cap = (20.0 * aureole).min(share.max(3.0 * aureole)).min(6e4);
        let bright = luminance(real).max(1e-6);
        let middle = real * (cap.min(bright) / bright);
        Self { sun: sky.sun, radius_rad, middle }
    }

    /// Radiance of the disc in a direction, its edge as soft as a pixel.
    pub fn radiance(&self, direction: Vec3A, pixel_rad: f32) -> Vec3A {
        let away = direction - self.sun;
        let angle = dot(away, away).sqrt();
        let inside = smoothstep(self.radius_rad + 0.5 * pixel_rad, self.radius_rad - 0.5 * pixel_rad, angle);
        let rim = (angle / self.radius_rad).min(1.0);
        let limb = lerp(0.4, 1.0, (1.0 - rim * rim).max(0.0).sqrt());
        let horizon = smoothstep(-0.002, 0.003, direction.y);
        // Where the disc is smaller than a pixel, it fills only a part of it.
        let filled = (self.radius_rad / pixel_rad.max(1e-6)).min(1.0);
        self.middle * (inside * limb * horizon * filled)
    }
}
