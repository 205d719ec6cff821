//! Pictures and times to judge by, made on request: `cargo test --release -- --ignored sky::pictures` writes views of
//! sixteen skies, tone-mapped, into the folder `genescape-sky` of the system's temporary folder.

use half::f16;

use super::{SkyParams, images, light};
use crate::gltf::png;
use crate::model::{Image8, ImageF16};

const VIEW_PX: (u32, u32) = (480, 270);
const FIELD_OF_VIEW: f32 = 60.0;

/// Rows: the sun's elevation. Columns: clear, scattered cumulus, towering cumulus, overcast.
fn params(row: usize, column: usize) -> SkyParams {
    let (cloud_cover, cloud_base_m, cloud_thickness_m, cloud_scale_m) = [
        (0.0, 1200.0, 600.0, 1200.0),
        (0.35, 1200.0, 900.0, 1300.0),
        (0.6, 1500.0, 1200.0, 2200.0),
        (1.0, 1000.0, 700.0, 2500.0),
    ][column];
    SkyParams {
        sky_seed: (row * 4 + column) as u32,
        sun_elevation_deg: [2.0, 8.0, 25.0, 60.0][row],
        sun_azimuth_deg: 40.0,
        turbidity: [2.0, 2.5, 4.0, 6.0][column],
        sun_size_deg: 0.6,
        exposure_ev: 0.0,
        cloud_cover,
        cloud_base_m,
        cloud_thickness_m,
        cloud_scale_m,
        cirrus: [0.0, 0.3, 0.7, 0.5][column],
        haze_m: [50_000.0, 40_000.0, 25_000.0, 12_000.0][column],
    }
}

/// Narkowicz's fit to the ACES curve, then sRGB.
fn byte(linear: f32) -> u8 {
    let x = linear * 0.6;
    let y = ((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0);
    let srgb = if y <= 0.003_130_8 { 12.92 * y } else { 1.055 * libm::powf(y, 1.0 / 2.4) - 0.055 };
    (srgb * 255.0 + 0.5) as u8
}

/// The panorama at (u, v) in 0..1, interpolated.
fn sample(image: &ImageF16, u: f32, v: f32) -> [f32; 3] {
    let (width, height) = (image.width as i64, image.height as i64);
    let (x, y) = (u * width as f32 - 0.5, v * height as f32 - 0.5);
    let (i, j) = (x.floor() as i64, y.floor() as i64);
    let (fx, fy) = (x - i as f32, y - j as f32);
    let texel = |i: i64, j: i64, c: usize| {
        let at = (j.clamp(0, height - 1) * width + i.rem_euclid(width)) as usize * 3 + c;
        f16::from_bits(image.data[at]).to_f32()
    };
    std::array::from_fn(|c| {
        let above = texel(i, j, c) * (1.0 - fx) + texel(i + 1, j, c) * fx;
        let below = texel(i, j + 1, c) * (1.0 - fx) + texel(i + 1, j + 1, c) * fx;
        above * (1.0 - fy) + below * fy
    })
}

/// What a camera 11° above the horizon sees towards `azimuth_deg`, written into `sheet` from its pixel (x, y).
fn view(sheet: &mut Image8, (x, y): (u32, u32), panorama: &ImageF16, azimuth_deg: f32) {
    let (sin, cos) = libm::sincosf(11.0_f32.to_radians());
    let half = libm::tanf(0.5 * FIELD_OF_VIEW.to_radians());
    let (width, height) = VIEW_PX;
    for j in 0..height {
        for i in 0..width {
            let right = ((2 * i + 1) as f32 / width as f32 - 1.0) * half;
            let up = (height as f32 - (2 * j + 1) as f32) / width as f32 * half;
            let (up, ahead) = (up * cos + sin, cos - up * sin);
            let length = (right * right + up * up + ahead * ahead).sqrt();
            let azimuth = libm::atan2f(right, ahead) + azimuth_deg.to_radians();
            let u = (azimuth / std::f32::consts::TAU + 0.5).rem_euclid(1.0);
            let color = sample(panorama, u, libm::acosf(up / length) / std::f32::consts::PI).map(byte);
            let at = (((y + j) * sheet.width + x + i) * 3) as usize;
            sheet.data[at..at + 3].copy_from_slice(&color);
        }
    }
}

#[test]
#[ignore = "writes pictures to look at"]
fn sheet_of_skies() {
    let folder = std::env::temp_dir().join("genescape-sky");
    std::fs::create_dir_all(&folder).unwrap();
    let (width, height) = VIEW_PX;
    for (name, azimuth_deg) in [("towards-sun", 50.0), ("aside", 160.0)] {
        let mut sheet = Image8::new(4 * width, 4 * height, 3);
        for (row, column) in (0..16).map(|k| (k / 4, k % 4)) {
            let params = params(row, column);
            let sky = images(&params, &light(&params), 384, 1536);
            view(&mut sheet, (column as u32 * width, row as u32 * height), &sky.equirect, azimuth_deg);
        }
        std::fs::write(folder.join(format!("{name}.png")), png::encode(&sheet)).unwrap();
    }
}
