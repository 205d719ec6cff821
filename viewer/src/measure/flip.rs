//! How different a person finds two pictures that they see in turn: FLIP for pictures of low dynamic range (Andersson,
//! Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: A Difference Evaluator for Alternating Images", 2020).

/// Pixels that a degree of the field of view covers: a monitor 0.7 m wide and 3840 pixels across, seen from 0.7 m.
const PIXELS_PER_DEGREE: f32 = 67.02;
/// Colour differences are raised to this power; beyond `NEAR_MAX` of the greatest they are compressed to what is left
/// above `COMPRESSED`.
const COLOR_POWER: f32 = 0.7;
const NEAR_MAX: f32 = 0.4;
const COMPRESSED: f32 = 0.95;
/// Width of the feature detectors in degrees.
const FEATURE_WIDTH_DEG: f32 = 0.082;
/// CIE XYZ of linear sRGB white (D65).
const WHITE: [f32; 3] = [0.950_428_5, 1.0, 1.088_900_4];
/// Sums of Gaussians (weight, spread) that the eye sees achromatic, red-green and blue-yellow patterns through.
const CONTRAST: [&[(f32, f32)]; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];

/// Mean FLIP of two pictures of 8-bit sRGB with alpha, rows from the top: 0 for equal ones, 1 for black and white.
/// Transparency counts not. 0 unless both have `width` columns and as many rows.
pub fn flip(reference: &[u8], test: &[u8], width: u32) -> f64 {
    let width = width as usize;
    if width == 0 || reference.len() != test.len() || !reference.len().is_multiple_of(4 * width) {
        return 0.0;
    }
    let [a, b] = [reference, test].map(|rgba| Seen::of(rgba, width));
    let (greatest, mut sum) = (greatest_color_difference(), 0.0);
    for at in 0..a.colors.len() {
        let color = color_difference(a.colors[at], b.colors[at], greatest);
        let [edge, point] = [0, 1].map(|kind| (a.features[at][kind] - b.features[at][kind]).abs());
        let feature = (edge.max(point) * std::f32::consts::FRAC_1_SQRT_2).sqrt();
        sum += f64::from(libm::powf(color, 1.0 - feature));
    }
    sum / a.colors.len().max(1) as f64
}

/// What somebody sees of a picture, pixel by pixel.
struct Seen {
    /// CIE L*a*b* with Hunt's adjustment, of what is left of fine patterns.
    colors: Vec<[f32; 3]>,
    /// How much of an edge and of a point there is.
    features: Vec<[f32; 2]>,
}

impl Seen {
    fn of(rgba: &[u8], width: usize) -> Self {
        let opponent: Vec<[f32; 3]> = rgba.chunks_exact(4).map(|rgba| ycxcz(linear(rgba))).collect();
        let plane = |channel: usize| opponent.iter().map(|color| color[channel]).collect::<Vec<_>>();
        let [y, cx, cz] = [0, 1, 2].map(|channel| through_eye(&plane(channel), width, CONTRAST[channel]));
        let colors = (0..y.len()).map(|at| hunt(lab(rgb_of_ycxcz([y[at], cx[at], cz[at]])))).collect();
        let brightness: Vec<f32> = opponent.iter().map(|color| (color[0] + 16.0) / 116.0).collect();
        Self { colors, features: features(&brightness, width) }
    }
}

fn linear(rgba: &[u8]) -> [f32; 3] {
    [rgba[0], rgba[1], rgba[2]].map(|value| {
        let value = f32::from(value) / 255.0;
        if value <= 0.04045 { value / 12.92 } else { libm::powf((value + 0.055) / 1.055, 2.4) }
    })
}

/// CIE XYZ over white.
fn xyz([r, g, b]: [f32; 3]) -> [f32; 3] {
    let rows = [
        [0.412_386_56, 0.357_591_5, 0.180_450_5],
        [0.212_636_8, 0.715_183, 0.072_180_2],
        [0.019_330_62, 0.119_197_17, 0.950_372_6],
    ];
    let row = |k: usize| (rows[k][0] * r + rows[k][1] * g + rows[k][2] * b) / WHITE[k];
    [row(0), row(1), row(2)]
}

fn ycxcz(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = xyz(rgb);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Clamped to what a monitor shows.
fn rgb_of_ycxcz([y, cx, cz]: [f32; 3]) -> [f32; 3] {
    let y = (y + 16.0) / 116.0;
    let [x, y, z] = [(y + cx / 500.0) * WHITE[0], y * WHITE[1], (y - cz / 200.0) * WHITE[2]];
    [
        3.241_003_2 * x - 1.537_399 * y - 0.498_615_9 * z,
        -0.969_224_2 * x + 1.875_93 * y + 0.041_554_226 * z,
        0.055_639_42 * x - 0.204_011_2 * y + 1.057_149 * z,
    ]
    .map(|value| value.clamp(0.0, 1.0))
}

fn lab(rgb: [f32; 3]) -> [f32; 3] {
    const DELTA: f32 = 6.0 / 29.0;
    let [x, y, z] = xyz(rgb).map(|value| {
        if value > DELTA * DELTA * DELTA {
            libm::cbrtf(value)
        } else {
            value / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Colours of dark places are hardly seen.
fn hunt([l, a, b]: [f32; 3]) -> [f32; 3] {
    [l, 0.01 * l * a, 0.01 * l * b]
}

/// HyAB to the power of [`COLOR_POWER`].
fn raised_distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    libm::powf((a[0] - b[0]).abs() + libm::hypotf(a[1] - b[1], a[2] - b[2]), COLOR_POWER)
}

/// That of green and blue.
fn greatest_color_difference() -> f32 {
    raised_distance(hunt(lab([0.0, 1.0, 0.0])), hunt(lab([0.0, 0.0, 1.0])))
}

/// 0 … 1.
fn color_difference(a: [f32; 3], b: [f32; 3], greatest: f32) -> f32 {
    let (difference, near_max) = (raised_distance(a, b), NEAR_MAX * greatest);
    if difference < near_max {
        COMPRESSED / near_max * difference
    } else {
        COMPRESSED + (difference - near_max) / (greatest - near_max) * (1.0 - COMPRESSED)
    }
}

/// A plane as seen through a sum of Gaussians.
fn through_eye(plane: &[f32], width: usize, contrast: &[(f32, f32)]) -> Vec<f32> {
    use std::f32::consts::PI;
    // Of the widest, that of blue and yellow.
    let radius = (3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as i32;
    let mut seen = vec![0.0; plane.len()];
    let mut whole = 0.0;
    for &(weight, spread) in contrast {
        let at = |pixel: i32| {
            let degrees = pixel as f32 / PIXELS_PER_DEGREE;
            libm::expf(-PI * PI * degrees * degrees / spread)
        };
        let kernel: Vec<f32> = (-radius..=radius).map(at).collect();
        let area: f32 = kernel.iter().sum();
        let weight = weight * (PI / spread).sqrt();
        whole += weight * area * area;
        let blurred = vertical(&horizontal(plane, width, &kernel), width, &kernel);
        seen.iter_mut().zip(blurred).for_each(|(sum, blurred)| *sum += weight * blurred);
    }
    seen.iter_mut().for_each(|value| *value /= whole);
    seen
}

fn features(brightness: &[f32], width: usize) -> Vec<[f32; 2]> {
    let spread = 0.5 * FEATURE_WIDTH_DEG * PIXELS_PER_DEGREE;
    let radius = (3.0 * spread).ceil() as i32;
    let kernel = |of: &dyn Fn(f32) -> f32| {
        let at = |pixel: i32| {
            let x = pixel as f32 / spread;
            of(x) * libm::expf(-0.5 * x * x)
        };
        let mut kernel: Vec<f32> = (-radius..=radius).map(at).collect();
        // What is above zero and what is below each sum up to one.
        let sum = |sign: f32| kernel.iter().map(|value| (sign * value).max(0.0)).sum::<f32>();
        let (above, below) = (sum(1.0), sum(-1.0));
        kernel.iter_mut().for_each(|value| *value /= if *value > 0.0 { above } else { below.max(1e-9) });
        kernel
    };
    let smooth = kernel(&|_| 1.0);
    let [edges, points] = [kernel(&|x| -x), kernel(&|x| x * x - 1.0)];
    let [smooth_rows, edge_rows, point_rows] =
        [&smooth, &edges, &points].map(|kernel| horizontal(brightness, width, kernel));
    let [edge_x, edge_y] =
        [(&edge_rows, &smooth), (&smooth_rows, &edges)].map(|(p, k)| vertical(p, width, k));
    let [point_x, point_y] =
        [(&point_rows, &smooth), (&smooth_rows, &points)].map(|(p, k)| vertical(p, width, k));
    let at = |at: usize| [libm::hypotf(edge_x[at], edge_y[at]), libm::hypotf(point_x[at], point_y[at])];
    (0..brightness.len()).map(at).collect()
}

/// Each row through a kernel; beyond its ends it goes on as it ends.
fn horizontal(plane: &[f32], width: usize, kernel: &[f32]) -> Vec<f32> {
    let (radius, last) = (kernel.len() / 2, width - 1);
    let mut out = Vec::with_capacity(plane.len());
    for row in plane.chunks_exact(width) {
        for x in 0..width {
            let taps = kernel.iter().enumerate();
            out.push(
                taps.map(|(tap, weight)| weight * row[(x + tap).saturating_sub(radius).min(last)]).sum(),
            );
        }
    }
    out
}

/// The same of each column.
fn vertical(plane: &[f32], width: usize, kernel: &[f32]) -> Vec<f32> {
    let (radius, height) = (kernel.len() / 2, plane.len() / width);
    let mut out = vec![0.0; plane.len()];
    for (y, row) in out.chunks_exact_mut(width).enumerate() {
        for (tap, weight) in kernel.iter().enumerate() {
            let from = (y + tap).saturating_sub(radius).min(height - 1) * width;
            row.iter_mut().zip(&plane[from..from + width]).for_each(|(sum, value)| *sum += weight * value);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    /// Blurred noise of several sizes, as pictures have it.
    fn picture(seed: u64, side: u32) -> Vec<u8> {
        let mut random = rand_pcg::Pcg64::seed_from_u64(seed);
        let (mut coarse, size) = (vec![0_u8; 300], 8);
        random.fill(&mut coarse[..]);
        let pixel = |at: u32| {
            let (x, y) = (at % side / size, at / side / size);
            let color = |channel: u32| coarse[((y * 9 + x) * 3 + channel) as usize % 300];
            [color(0), color(1), color(2), 255]
        };
        (0..side * side).flat_map(pixel).collect()
    }

    #[test]
    fn it_says_what_the_reference_implementation_says() {
        let side = 48;
        let rgb =
            |rgba: &[u8]| -> Vec<u8> { rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect() };
        for seed in 0..4 {
            let a = picture(seed, side);
            let b: Vec<u8> = match seed {
                0 => picture(9, side),
                1 => a.iter().map(|value| value.saturating_add(9)).collect(),
                _ => a
                    .iter()
                    .enumerate()
                    .map(|(at, value)| if at % 7 < seed as usize { !value } else { *value })
                    .collect(),
            };
            let [image_a, image_b] =
                [&a, &b].map(|one| nv_flip::FlipImageRgb8::with_data(side, side, &rgb(one)));
            let expected = nv_flip::flip(image_a, image_b, PIXELS_PER_DEGREE);
            let expected = f64::from(nv_flip::FlipPool::from_image(&expected).mean());
            let ours = flip(&a, &b, side);
            assert!((ours - expected).abs() < 2e-3, "{seed}: {ours} for {expected}");
            assert!(expected > 0.01, "there is something to see");
        }
    }

    #[test]
    fn equal_pictures_do_not_differ_and_odd_ones_are_nothing() {
        let a = picture(1, 16);
        assert_eq!(flip(&a, &a, 16), 0.0);
        assert_eq!((flip(&a, &a[4..], 16), flip(&a, &a, 0), flip(&[], &[], 3)), (0.0, 0.0, 0.0));
    }
}
