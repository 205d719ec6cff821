//! The sky's EXR → a JPEG to look at: exposure, then the film-like curve that the viewer draws with.

use anyhow::{Context, Result, bail};
use jpeg_encoder::{ColorType, Encoder};

use crate::gltf::exr;
use crate::math::{unit_to_byte, value_of_half};

/// Of 100: no blocks in a clear sky.
const QUALITY: u8 = 92;

/// # Errors
/// A picture that is not of the bake, or too large for a JPEG.
pub fn jpeg(sky_exr: &[u8], exposure: f32) -> Result<Vec<u8>> {
    let Some(sky) = exr::decode(sky_exr) else { bail!("the sky is no EXR file as bake writes it") };
    let size = |side: u32| u16::try_from(side).context("the sky is too large for a JPEG");
    let (width, height) = (size(sky.width)?, size(sky.height)?);
    let mut pixels = Vec::with_capacity(sky.data.len());
    for pixel in sky.data.as_chunks::<3>().0 {
        pixels.extend(film(pixel.map(|bits| value_of_half(bits) * exposure)).map(unit_to_byte));
    }
    let mut file = Vec::new();
    Encoder::new(&mut file, QUALITY).encode(&pixels, width, height, ColorType::Rgb)?;
    Ok(file)
}

/// Rows of the matrix from linear Rec. 709 to AgX's wider primaries, and of the one back.
const INSET: [[f32; 3]; 3] = [
    [0.842_479_1, 0.078_433_6, 0.079_223_745],
    [0.042_328_242, 0.878_468_64, 0.079_166_13],
    [0.042_375_655, 0.078_433_6, 0.879_143],
];
const OUTSET: [[f32; 3]; 3] = [
    [1.196_879, -0.098_020_88, -0.099_029_74],
    [-0.052_896_853, 1.151_903_1, -0.098_961_18],
    [-0.052_971_635, -0.098_043_45, 1.151_073_7],
];
/// The curve's range in stops.
const MIN_EV: f32 = -12.473_93;
const MAX_EV: f32 = 4.026_069;

/// AgX (Sobotka 2022, as fitted by Wrensch 2023) with the viewer's contrast: radiance → sRGB values.
pub(crate) fn film(linear: [f32; 3]) -> [f32; 3] {
    let ev = rows(&INSET, linear).map(|c| (libm::log2f(c.max(1e-10)) - MIN_EV) / (MAX_EV - MIN_EV));
    let toned = ev.map(|x| curve(x.clamp(0.0, 1.0)).max(0.0));
    let grey = libm::powf(0.2126 * toned[0] + 0.7152 * toned[1] + 0.0722 * toned[2], 1.25);
    rows(&OUTSET, toned.map(|c| grey + 1.22 * (libm::powf(c, 1.25) - grey)))
}

fn curve(x: f32) -> f32 {
    [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232]
        .into_iter()
        .fold(0.0, |sum, factor| sum * x + factor)
}

fn rows(matrix: &[[f32; 3]; 3], [x, y, z]: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * x + row[1] * y + row[2] * z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::half_bits;
    use crate::model::ImageF16;

    #[test]
    fn greys_stay_grey_and_rise_from_black_to_white() {
        let mut before = -1.0;
        for stop in -14..5 {
            let [r, g, b] = film([libm::exp2f(stop as f32); 3]);
            assert!((r - g).abs() < 2e-3 && (g - b).abs() < 2e-3, "{stop}: {r} {g} {b}");
            assert!(g >= before, "{stop}");
            before = g;
        }
        assert!(film([0.0; 3])[1] < 0.01 && before > 0.95, "{before}");
        assert!((film([0.18; 3])[1] - 0.4).abs() < 0.08, "middle grey is {}", film([0.18; 3])[1]);
    }

    #[test]
    fn a_picture_is_made_of_ours_alone() {
        let sky = ImageF16 { width: 16, height: 8, data: vec![half_bits(0.5); 16 * 8 * 3] };
        let file = jpeg(&exr::encode(&sky), 1.0).expect("a picture");
        assert!(file.starts_with(&[0xFF, 0xD8]) && file.ends_with(&[0xFF, 0xD9]));
        assert!(jpeg(b"no picture", 1.0).is_err());
    }
}
