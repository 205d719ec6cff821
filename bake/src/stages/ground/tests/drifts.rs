//! Where the wind leaves snow and where it takes it away.

use super::*;
use crate::model::Heightfield;

/// Long dunes across the wind, 200 m from crest to crest, all above the snow line.
fn dunes() -> Landform {
    let (side, spacing_m) = (257, 4.0);
    let height_m = |k: u32| {
        let [x, z] = [k % side, k / side].map(|line| (line as f32 - 128.0) * spacing_m);
        15.0 * libm::sinf((0.91 * x + 0.41 * z) * std::f32::consts::TAU / 200.0)
    };
    let field = Heightfield { side, spacing_m, heights_m: (0..side * side).map(height_m).collect() };
    let apron = Heightfield { side: 2, spacing_m: 2048.0, heights_m: vec![0.0; 4] };
    Landform { snow_line_m: -40.0, ..Landform::bare(field, apron) }
}

/// Mean part of snow of the texels whose height and rise along the wind, in metres a metre, are wanted.
fn snow_where(wanted: impl Fn(f32, f32) -> bool) -> f32 {
    let (land, side_px) = (dunes(), 256);
    let maps = maps(&PARAMS, &Woods::none(Season::default()), &land, side_px);
    let texel_m = land.field.extent_m() / side_px as f32;
    let snow = (0..side_px * side_px).filter_map(|k| {
        let [x, z] =
            [k % side_px, k / side_px].map(|i| (i as f32 + 0.5) * texel_m - 0.5 * land.field.extent_m());
        let height = |along: f32| land.field.height_m(x + 0.91 * along, z + 0.41 * along);
        let inside = x.abs().max(z.abs()) < 420.0;
        let rise = (height(4.0) - height(-4.0)) / 8.0;
        (inside && wanted(height(0.0), rise))
            .then(|| f32::from(maps.weights.data[4 * k as usize + 2]) / 255.0)
    });
    let snow: Vec<f32> = snow.collect();
    assert!(snow.len() > 1000, "{}", snow.len());
    snow.iter().sum::<f32>() / snow.len() as f32
}

#[test]
fn snow_drifts_into_the_lee_and_is_blown_off_what_faces_the_wind() {
    let windward = snow_where(|_, rise| rise > 0.3);
    let lee = snow_where(|_, rise| rise < -0.3);
    let trough = snow_where(|height_m, _| height_m < -12.0);
    assert!(lee > 0.95 && trough > 0.9, "{lee} in the lee, {trough} in troughs");
    assert!((0.1..0.7).contains(&windward), "{windward} facing the wind");
}
