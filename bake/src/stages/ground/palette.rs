//! Climate → the colours of a land: what grows, from lush to dry to the bare soil under it, rock and shores. Linear
//! reflectances.
//!
//! A table over temperature and dryness in the manner of Whittaker, "Communities and Ecosystems" (1975), read between its
//! entries, so that no two neighbouring climates differ by a jump.

use super::Season;
use crate::math::{hermite, lerp, lerp_array};
use crate::model::Climate;
use crate::noise::hash01;
use crate::seed::noise_seed;

/// Linear reflectance.
pub(super) type Rgb = [f32; 3];

/// Growth from lush to dry, and at last bare soil; the moisture of a place chooses between neighbours.
pub(super) type Ramp = [Rgb; 6];

/// Mean annual temperatures of the table's columns: tundra, taiga, temperate, Mediterranean, tropics.
const TEMPERATURES_C: [f32; 5] = [-7.0, 1.0, 9.0, 17.0, 26.0];
/// Dryness of its rows, as [`Climate::dryness`]: forest, meadow, steppe, desert.
const DRYNESS: [f32; 4] = [-1.5, 0.0, 1.2, 2.6];

/// Grass of the temperate meadow.
const MEADOW: Ramp = [
    [0.028, 0.060, 0.014],
    [0.046, 0.084, 0.020],
    [0.074, 0.108, 0.028],
    [0.118, 0.128, 0.042],
    [0.205, 0.175, 0.078],
    [0.290, 0.230, 0.135],
];

const RAMPS: [[Ramp; 5]; 4] = [
    [
        // Sedges and moss; bog; fern; evergreen scrub; jungle on laterite.
        ramp([0.034, 0.058, 0.013], [0.080, 0.092, 0.024], [0.160, 0.135, 0.080]),
        ramp([0.026, 0.058, 0.013], [0.054, 0.088, 0.022], [0.135, 0.120, 0.062]),
        ramp([0.022, 0.060, 0.012], [0.042, 0.088, 0.018], [0.120, 0.115, 0.045]),
        ramp([0.020, 0.062, 0.010], [0.040, 0.092, 0.017], [0.140, 0.095, 0.042]),
        ramp([0.010, 0.050, 0.008], [0.022, 0.082, 0.012], [0.150, 0.100, 0.042]),
    ],
    [
        // Dwarf shrubs; fell; meadow; garrigue; moist savanna.
        ramp([0.044, 0.066, 0.017], [0.112, 0.112, 0.032], [0.215, 0.180, 0.105]),
        ramp([0.032, 0.066, 0.016], [0.074, 0.104, 0.028], [0.205, 0.180, 0.100]),
        MEADOW,
        ramp([0.034, 0.058, 0.015], [0.085, 0.095, 0.032], [0.300, 0.215, 0.115]),
        ramp([0.025, 0.065, 0.012], [0.075, 0.100, 0.026], [0.220, 0.145, 0.062]),
    ],
    [
        // Dry tundra; cold steppe; steppe; maquis; straw of dry savanna on red soil.
        ramp([0.078, 0.080, 0.027], [0.170, 0.148, 0.058], [0.250, 0.212, 0.145]),
        ramp([0.064, 0.086, 0.029], [0.175, 0.165, 0.064], [0.280, 0.240, 0.150]),
        ramp([0.080, 0.090, 0.032], [0.218, 0.190, 0.080], [0.335, 0.272, 0.152]),
        ramp([0.070, 0.075, 0.032], [0.215, 0.165, 0.075], [0.370, 0.265, 0.150]),
        ramp([0.085, 0.100, 0.028], [0.310, 0.245, 0.092], [0.350, 0.190, 0.088]),
    ],
    [
        // Polar desert; cold desert; sagebrush; hammada; dunes.
        ramp([0.130, 0.115, 0.085], [0.200, 0.180, 0.145], [0.270, 0.250, 0.215]),
        ramp([0.130, 0.115, 0.075], [0.240, 0.205, 0.145], [0.330, 0.285, 0.210]),
        ramp([0.140, 0.125, 0.075], [0.280, 0.230, 0.150], [0.390, 0.325, 0.220]),
        ramp([0.160, 0.130, 0.070], [0.340, 0.260, 0.155], [0.470, 0.365, 0.225]),
        ramp([0.170, 0.130, 0.060], [0.420, 0.285, 0.145], [0.520, 0.350, 0.185]),
    ],
];

/// Iron that stains rock where it is hot and dry, lichen and moss where it is wet.
const STAINED: Rgb = [0.300, 0.155, 0.085];
const MOSSY: Rgb = [0.095, 0.105, 0.070];
/// Shells and quartz of warm shores.
const BEACH: Rgb = [0.520, 0.450, 0.330];

/// Of flowers.
const PETALS: [Rgb; 7] = [
    [0.72, 0.72, 0.66],
    [0.75, 0.52, 0.03],
    [0.34, 0.16, 0.52],
    [0.60, 0.06, 0.02],
    [0.66, 0.28, 0.40],
    [0.13, 0.20, 0.62],
    [0.74, 0.66, 0.20],
];

/// Petals of a land's flowers: of the colours that there are most have one, and some its neighbours.
pub(super) fn petals(terrain_seed: u32) -> [Rgb; 5] {
    mostly_one(&PETALS, terrain_seed, 0, [0, 0, 0, 1, 3])
}

/// Of flowers on tall spikes: lupins, foxgloves, willowherb, mullein, asphodel.
const SPIRES: [Rgb; 5] =
    [[0.20, 0.15, 0.48], [0.44, 0.13, 0.29], [0.38, 0.09, 0.30], [0.60, 0.44, 0.07], [0.62, 0.58, 0.55]];
/// Of cow parsley, yarrow and hogweed.
pub(super) const UMBELS: [Rgb; 3] = [[0.70, 0.71, 0.64], [0.62, 0.64, 0.54], [0.72, 0.66, 0.62]];

/// Petals of a land's spikes: most have one colour.
pub(super) fn spires(terrain_seed: u32) -> [Rgb; 4] {
    mostly_one(&SPIRES, terrain_seed, 1, [0, 0, 0, 1])
}

/// Of these colours those that lie so many steps after one that a land's seed chooses.
fn mostly_one<const N: usize>(colors: &[Rgb], terrain_seed: u32, item: u64, steps: [usize; N]) -> [Rgb; N] {
    let seed = noise_seed(terrain_seed.into(), "ground plants", item);
    let first = (hash01(seed, 1, 0, 0) * colors.len() as f32) as usize;
    steps.map(|step| colors[(first + step) % colors.len()])
}

/// Six colours through three: lush, usual, bare.
const fn ramp(lush: Rgb, usual: Rgb, bare: Rgb) -> Ramp {
    let mut ramp = [lush, lush, usual, usual, usual, bare];
    let mut k = 0;
    while k < 3 {
        ramp[1][k] = 0.5 * (lush[k] + usual[k]);
        ramp[3][k] = usual[k] + (bare[k] - usual[k]) / 3.0;
        ramp[4][k] = usual[k] + (bare[k] - usual[k]) * (2.0 / 3.0);
        k += 1;
    }
    ramp
}

/// The colours of one climate, and what is short in it.
pub(super) struct Palette {
    pub growth: Ramp,
    pub season: Season,
    /// 0 where there is rain enough, 1 in a desert.
    pub thirst: f32,
    /// 0 where summers are warm enough for grass, 1 where hardly anything grows.
    pub frost: f32,
    /// 0 up to temperate climates, 1 in the tropics.
    pub heat: f32,
    /// 0 where meadows grow, 1 in a rainforest.
    pub rain: f32,
}

impl Palette {
    pub fn new(climate: &Climate, season: Season) -> Self {
        let dryness = climate.dryness();
        let ((i, u), (j, v)) = (place(&TEMPERATURES_C, climate.temperature_c), place(&DRYNESS, dryness));
        let growth = std::array::from_fn(|k| {
            let along = |row: &[Ramp; 5]| lerp_array(row[i][k], row[i + 1][k], u);
            lerp_array(along(&RAMPS[j]), along(&RAMPS[j + 1]), v)
        });
        Self {
            growth: season.growth(growth),
            season,
            thirst: step(0.0, 2.4, dryness),
            frost: step(0.0, 1.0, (1.0 - climate.temperature_c) / 9.0),
            heat: step(11.0, 25.0, climate.temperature_c),
            rain: step(0.2, 1.6, -dryness),
        }
    }

    /// The colour of rock in this climate.
    pub fn rock(&self, rock: Rgb) -> Rgb {
        let stained = lerp_array(rock, STAINED, 0.65 * self.thirst * lerp(0.25, 1.0, self.heat));
        lerp_array(stained, MOSSY, 0.4 * self.rain)
    }

    /// The colour of a shore.
    pub fn shore(&self, shore: Rgb) -> Rgb {
        let soil = self.growth[5];
        lerp_array(lerp_array(shore, BEACH, 0.8 * self.heat), soil, 0.6 * self.thirst)
    }
}

/// The interval of ascending numbers that one lies in, and how far along; those beyond lie at the ends.
fn place<const N: usize>(ascending: &[f32; N], x: f32) -> (usize, f32) {
    let k = (1..N - 1).filter(|&k| ascending[k] <= x).count();
    let (low, high) = (ascending[k], ascending[k + 1]);
    (k, ((x - low) / (high - low)).clamp(0.0, 1.0))
}

/// [`crate::math::smoothstep`] by a multiplication, which is not the same to the last bit.
#[inline]
pub(super) fn step(lo: f32, hi: f32, x: f32) -> f32 {
    let t = (x - lo) * (1.0 / (hi - lo));
    let t = if t > 0.0 { t } else { 0.0 };
    hermite(if t < 1.0 { t } else { 1.0 })
}
