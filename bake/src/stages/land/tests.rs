//! Properties of the land.

use super::*;

/// Genes anywhere in their ranges, from a number.
pub(crate) fn random_params(k: u32) -> LandParams {
    let gene = |i: i32, lo: f32, hi: f32| lo + (hi - lo) * crate::noise::hash01(k, i, 1, 2);
    let log = |i: i32, lo: f32, hi: f32| lo * libm::powf(hi / lo, gene(i, 0.0, 1.0));
    LandParams {
        terrain_seed: k * 37 % 256,
        relief_m: log(1, 15.0, 420.0),
        wavelength_m: log(2, 200.0, 2000.0),
        hurst: gene(3, 0.5, 1.3),
        lacunarity: gene(4, 1.8, 2.4),
        ridged: gene(5, 0.0, 1.0),
        domain_warp: gene(6, 0.0, 1.0),
        offset: gene(7, 0.0, 1.0),
        terraces: gene(8, 0.0, 1.0),
        stream_power_steps: gene(9, 0.0, 15.99) as u32,
        droplets: gene(10, 0.0, 60000.0),
        talus_angle_deg: gene(11, 20.0, 45.0),
        water_level: gene(12, 0.0, 0.6),
        snow_line: gene(13, 0.2, 1.0),
    }
}
