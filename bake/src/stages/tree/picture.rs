//! Samples of a tree, or of some of its leaves, from one side → a picture: averaged, bled, and with an alpha that keeps the area at the cutoff.

use std::cmp::Reverse;

use glam::Vec3;

use super::mips::Encoder;
use super::raster::Drawing;
use crate::math::unit_to_byte;
use crate::model::{Image8, Impostor};

/// How far colours are bled, in pixels: as far as a bilinear filter of three mip levels reaches. Beyond them is the mean.
const BLED_PX: usize = 8;
/// The first byte at which alpha is not cut away.
const KEPT: u8 = (255.0 * Impostor::ALPHA_CUTOFF) as u8 + 1;

/// What a pixel shows, on average over what is there.
#[derive(Clone, Copy, Default)]
struct Pixel {
    /// Linear.
    color: Vec3,
    /// Red and green of the relief; its blue is what is covered.
    relief: [f32; 2],
}

impl Pixel {
    /// And of how many pixels it is.
    fn sum(pixels: impl Iterator<Item = Self>) -> (Self, u32) {
        pixels.fold((Self::default(), 0), |(mut sum, count), pixel| {
            sum.color += pixel.color;
            (0..2).for_each(|c| sum.relief[c] += pixel.relief[c]);
            (sum, count + 1)
        })
    }

    /// The mean of which this is the sum.
    fn over(self, count: u32) -> Option<Self> {
        let over = 1.0 / count as f32;
        (count > 0).then(|| Self { color: self.color * over, relief: self.relief.map(|sum| sum * over) })
    }

    fn mean(pixels: impl Iterator<Item = Self>) -> Option<Self> {
        let (sum, count) = Self::sum(pixels);
        sum.over(count)
    }
}

/// Square, rows from the top.
pub(super) struct Picture {
    pixels: Vec<Pixel>,
    alpha: Vec<u8>,
    /// How many samples of each pixel are covered.
    covered: Vec<u32>,
    /// Samples of a pixel.
    all: u32,
}

impl Picture {
    /// Of what is drawn `width_m` wide, reduced to an `n`th of the width and height.
    pub fn of(drawing: &Drawing<'_>, n: usize, width_m: f32) -> Self {
        let side = drawing.size() / n;
        let (mut pixels, mut covered) = (Vec::new(), Vec::new());
        for (y, x) in (0..side).flat_map(|y| (0..side).map(move |x| (y, x))) {
            let samples =
                (0..n * n).filter_map(|sample| drawing.sample(x * n + sample % n, y * n + sample / n));
            let (sum, count) = Pixel::sum(samples.map(|sample| Pixel {
                color: sample.color,
                relief: [(0.5 + sample.depth_m / width_m).clamp(0.0, 1.0), f32::from(u8::from(sample.leaf))],
            }));
            pixels.push(sum.over(count));
            covered.push(count);
        }
        let all = (n * n) as u32;
        Self { pixels: bled(pixels, side), alpha: alpha(&covered, side, all), covered, all }
    }
}

/// Fills pixels in which nothing is from those around them.
fn bled(mut pixels: Vec<Option<Pixel>>, side: usize) -> Vec<Pixel> {
    let mean = Pixel::mean(pixels.iter().flatten().copied()).unwrap_or_default();
    let is_there: Vec<bool> = pixels.iter().map(Option::is_some).collect();
    let in_row = |i: usize| {
        let x = i % side;
        is_there[i] || x > 0 && is_there[i - 1] || x + 1 < side && is_there[i + 1]
    };
    let in_row: Vec<bool> = (0..pixels.len()).map(in_row).collect();
    let near = |&i: &usize| in_row[i] || i >= side && in_row[i - side] || in_row.get(i + side) == Some(&true);
    // Those in which nothing is, but beside them.
    let mut rim: Vec<usize> = (0..pixels.len()).filter(|i| !is_there[*i] && near(i)).collect();
    let mut is_listed = vec![false; pixels.len()];
    for _ in 0..BLED_PX {
        let fill = |&i: &usize| Pixel::mean(around(i, side).filter_map(|j| pixels[j]));
        let filled: Vec<_> = rim.iter().map(fill).collect();
        rim.iter().zip(filled).for_each(|(&i, pixel)| pixels[i] = pixel);
        let beside = rim.iter().flat_map(|&i| around(i, side));
        rim =
            beside.filter(|&i| pixels[i].is_none() && !std::mem::replace(&mut is_listed[i], true)).collect();
    }
    pixels.into_iter().map(|pixel| pixel.unwrap_or(mean)).collect()
}

/// A pixel and its neighbours.
fn around(i: usize, side: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (i % side, i / side);
    let near = move |t: usize| t.saturating_sub(1)..(t + 2).min(side);
    near(y).flat_map(move |y| near(x).map(move |x| y * side + x))
}

/// Alpha from how many samples of each pixel are covered, scaled so that as much of the picture passes the cutoff as
/// samples are covered (Castaño, "Computing Alpha Mipmaps", 2010).
///
/// A few samples give few different values, so that often hundreds of pixels are equally near to the cutoff; of these, the
/// ones with more around them pass.
fn alpha(covered: &[u32], side: usize, all: u32) -> Vec<u8> {
    let mut wanted = ((covered.iter().sum::<u32>() + all / 2) / all) as usize;
    let mut pixels_with = vec![0; all as usize + 1];
    covered.iter().for_each(|&count| pixels_with[count as usize] += 1);
    // All pixels with more samples than the lowest that is kept pass, and as many of those with just so many as are wanted yet.
    let mut lowest = all;
    while lowest > 1 && wanted > pixels_with[lowest as usize] {
        wanted -= pixels_with[lowest as usize];
        lowest -= 1;
    }
    let around_it = |&i: &usize| around(i, side).map(|j| covered[j]).sum::<u32>();
    let mut equal: Vec<usize> = (0..covered.len()).filter(|&i| covered[i] == lowest).collect();
    equal.sort_by_cached_key(|i| Reverse((around_it(i), *i)));
    let mut passes: Vec<bool> = covered.iter().map(|&count| count > lowest).collect();
    equal.iter().take(wanted).for_each(|&i| passes[i] = true);
    let scale = Impostor::ALPHA_CUTOFF / lowest as f32;
    let byte = |(&count, passes): (&u32, bool)| match (unit_to_byte(count as f32 * scale), passes) {
        (byte, true) => byte.max(KEPT),
        (byte, false) => byte.min(KEPT - 1),
    };
    covered.iter().zip(passes).map(byte).collect()
}

/// Colours with alpha, and relief, as files hold them.
pub(super) fn side_by_side(pictures: &[Picture], encoder: &Encoder) -> (Image8, Image8) {
    let side = pictures.first().map_or(0, |picture| picture.pixels.len().isqrt());
    let image = |channels| Image8::new((side * pictures.len()) as u32, side as u32, channels);
    let (mut colors, mut relief) = (image(4), image(3));
    for (k, picture) in pictures.iter().enumerate() {
        for (i, (pixel, &alpha)) in picture.pixels.iter().zip(&picture.alpha).enumerate() {
            let at = (i / side * pictures.len() + k) * side + i % side;
            let [r, g, b] = pixel.color.to_array().map(|linear| encoder.byte(linear));
            colors.data[4 * at..][..4].copy_from_slice(&[r, g, b, alpha]);
            let [depth, leaf] = pixel.relief.map(unit_to_byte);
            relief.data[3 * at..][..3].copy_from_slice(&[
                depth,
                leaf,
                (255 * picture.covered[i] / picture.all) as u8,
            ]);
        }
    }
    (colors, relief)
}
