//! The climate of a land and where snow lies, on which trees and ground cover agree.

use super::Landform;
use crate::math::cell;

/// How much colder a metre up is (ICAO standard atmosphere).
const LAPSE_C_PER_M: f32 = 0.0065;
/// What the genes are where files lack them: neither water nor warmth is short, and nothing is different from what it was
/// before there was climate.
const TEMPERATE_C: f32 = 9.0;
const TEMPERATE_MM: f32 = 800.0;

/// Mean temperature and rain of a year.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Climate {
    /// Where the land lies lowest.
    pub temperature_c: f32,
    pub rain_mm: f32,
    lowest_m: f32,
}

impl Climate {
    pub fn new(temperature_c: f32, rain_mm: f32, land: &Landform) -> Self {
        Self { temperature_c, rain_mm, lowest_m: land.field.range_m()[0] }
    }

    /// Mean temperature of a year at a height.
    #[inline]
    pub fn at_c(&self, height_m: f32) -> f32 {
        self.temperature_c - LAPSE_C_PER_M * (height_m - self.lowest_m)
    }

    /// See [`dryness`].
    pub fn dryness(&self) -> f32 {
        dryness(self.temperature_c, self.rain_mm)
    }
}

/// How often De Martonne's index of aridity, rain over temperature (1926), must be doubled to be that of 9 °C and 800 mm:
/// -1.5 in a rainforest, 0 where meadows grow, 1.2 in a steppe, 2.6 in a desert. Within ±4.
pub fn dryness(temperature_c: f32, rain_mm: f32) -> f32 {
    let index = |temperature_c: f32, rain_mm: f32| rain_mm.max(1.0) / (temperature_c + 10.0).max(1.0);
    let here = index(temperature_c, rain_mm);
    libm::log2f(index(TEMPERATE_C, TEMPERATE_MM) / here).clamp(-4.0, 4.0)
}

/// Where snow may lie: a square grid over the field.
#[derive(Clone, Debug, PartialEq)]
pub struct SnowMap {
    /// Samples a side.
    pub side: usize,
    /// Metres from the first sample to the last.
    pub extent_m: f32,
    /// Cover, 0 to 1, row by row from the north-west.
    pub parts: Vec<f32>,
}

impl SnowMap {
    /// The greatest cover of the samples around a point.
    pub fn at(&self, x_m: f32, z_m: f32) -> f32 {
        let place = |m: f32| {
            let last = (self.side - 1) as f32;
            cell(((m / self.extent_m + 0.5) * last).clamp(0.0, last), self.side).0
        };
        let at = place(z_m) * self.side + place(x_m);
        [0, 1, self.side, self.side + 1].iter().fold(0.0, |most, k| f32::max(most, self.parts[at + k]))
    }
}
