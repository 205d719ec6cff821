//! Where fields of rice are under water.

use super::*;

#[test]
fn fields_are_flooded_where_they_are_level_and_are_mud_there() {
    let params = LandParams {
        terrain_seed: 5,
        relief_m: 60.0,
        wavelength_m: 900.0,
        hurst: 1.25,
        ridged: 0.0,
        snow_line: 1.0,
        stream_power_steps: 2,
        droplets: 4000.0,
        paddies: 0.8,
        ..LAND_PARAMS
    };
    let land = landform(&params, 257);
    let ground = GroundParams { snow_line: 1.0, temperature_c: 24.0, rain_mm: 2000.0, ..PARAMS };
    let (mut flooded, mut sloping, mut least_mud) = (0, 0, 255);
    // Of several crops some are young.
    for terrain_seed in 5..9 {
        let side_px = 512;
        let ground = GroundParams { terrain_seed, ..ground.clone() };
        let made = maps(&ground, &Woods::none(Season::default()), &land, side_px);
        for k in (0..side_px * side_px).filter(|&k| made.color.data[4 * k as usize + 3] < 64) {
            // The samples of the land are as far apart as two texels.
            let normal = land.field.normal_at(k % side_px / 2, k / side_px / 2);
            flooded += 1;
            sloping += u32::from(normal.y < 0.99);
            least_mud = least_mud.min(made.weights.data[4 * k as usize + 3]);
        }
    }
    assert!(flooded > 1000, "{flooded} texels are under water");
    // Between samples a slope is what those around say: of single ones some are beside a bank.
    assert!(sloping < flooded / 10, "{sloping} of {flooded} stand on slopes of more than 8°");
    assert!(least_mud > 128, "{least_mud} of 255 are mud under water");
}
