//! Light → colours whose distances are those that an eye sees: OKLab (B. Ottosson, "A perceptual color space for image
//! processing", 2020).

/// L, a and b of a linear sRGB colour.
pub fn oklab([r, g, b]: [f32; 3]) -> [f32; 3] {
    let cone = |weights: [f32; 3]| libm::cbrtf(weights[0] * r + weights[1] * g + weights[2] * b);
    let l = cone([0.412_221_46, 0.536_332_55, 0.051_445_995]);
    let m = cone([0.211_903_5, 0.680_699_5, 0.107_396_96]);
    let s = cone([0.088_302_46, 0.281_718_85, 0.629_978_7]);
    [
        0.210_454_26 * l + 0.793_617_8 * m - 0.004_072_047 * s,
        1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s,
        0.025_904_037 * l + 0.782_771_77 * m - 0.808_675_77 * s,
    ]
}

/// Of any brightness, as a picture shows it.
pub fn shown(linear: [f32; 3]) -> [f32; 3] {
    oklab(linear.map(|c| c.max(0.0) / (1.0 + c.max(0.0))))
}

/// The mean of several, and how far lightness strays from it.
pub fn mean_and_contrast(colors: &[[f32; 3]]) -> ([f32; 3], f32) {
    let count = colors.len().max(1) as f32;
    let mean = std::array::from_fn(|k| colors.iter().map(|color| color[k]).sum::<f32>() / count);
    let square = colors.iter().map(|color| (color[0] - mean[0]) * (color[0] - mean[0])).sum::<f32>() / count;
    (mean, square.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn oklab_is_as_published() {
        for (linear, expected) in [
            ([1.0, 1.0, 1.0], [1.0, 0.0, 0.0]),
            ([1.0, 0.0, 0.0], [0.628, 0.225, 0.126]),
            ([0.0, 0.0, 1.0], [0.452, -0.032, -0.312]),
        ] {
            let lab = oklab(linear);
            assert!(lab.iter().zip(expected).all(|(x, y)| (x - y).abs() < 2e-3), "{lab:?} for {expected:?}");
        }
    }
}
