//! Cards with the leaves that they show → pictures, side by side in one image.

use glam::Vec3;
use rayon::prelude::*;

use super::card::Card;
use crate::math::unit_to_byte;
use crate::model::{Clusters, Image8, Mesh};
use crate::stages::tree::ALPHA_CUTOFF;
use crate::stages::tree::mips::Encoder;
use crate::stages::tree::raster::{Drawing, Look, Sample};
use crate::stages::tree::surfaces::{Atlas, Surfaces};

/// Pixels a side of one picture. A cluster is some twenty pixels of the screen wide where it begins to be shown.
pub const SIDE: usize = 16;
/// Each is drawn this many times as wide and high, and reduced.
const SAMPLES: usize = 2;
/// Pictures in a row of the image: images of all templates are of one width.
const COLUMNS: usize = 64;
/// A card is larger by this than what it shows, which leaves a pixel transparent along each edge of its picture.
pub const MARGIN: f32 = SIDE as f32 / (SIDE - 2) as f32;

/// What the cards of one cluster show, and the cards.
pub struct Subject {
    pub leaves: Mesh,
    pub cards: Vec<Card>,
}

/// Draws the cards of all subjects, one after the other; gives the pictures of the file, and the same as the bake's own
/// rasteriser sees them. The same bytes for any number of threads.
pub fn draw(subjects: &[Subject], surfaces: &Surfaces) -> (Clusters, Atlas) {
    let encoder = Encoder::new();
    let of_subject = |subject: &Subject| -> Vec<_> {
        subject.cards.iter().map(|card| picture(&subject.leaves, card, surfaces, &encoder)).collect()
    };
    let pictures: Vec<Picture> = subjects.par_iter().flat_map_iter(of_subject).collect();
    let (width, height) = (COLUMNS * SIDE, pictures.len().div_ceil(COLUMNS).max(1) * SIDE);
    let image = |channels| Image8::new(width as u32, height as u32, channels);
    let (mut colors, mut normals) = (image(4), image(3));
    let mut sunlit = vec![0.0; width * height];
    for (number, pixels) in pictures.iter().enumerate() {
        let (left, top) = (number % COLUMNS * SIDE, number / COLUMNS * SIDE);
        for (i, pixel) in pixels.iter().enumerate() {
            let at = (top + i / SIDE) * width + left + i % SIDE;
            colors.data[4 * at..][..4].copy_from_slice(&pixel.color);
            normals.data[3 * at..][..3].copy_from_slice(&pixel.normal);
            sunlit[at] = pixel.sunlit;
        }
    }
    let atlas = Atlas::new(&colors, sunlit);
    (Clusters { colors, normals }, atlas)
}

/// What a pixel shows.
#[derive(Clone, Copy)]
struct Pixel {
    /// sRGB with alpha.
    color: [u8; 4],
    /// Turned to the eye, in the card's space.
    normal: [u8; 3],
    /// As [`super::super::raster::Sample::sunlit`].
    sunlit: f32,
}

/// Rows from the top.
type Picture = [Pixel; SIDE * SIDE];

fn picture(leaves: &Mesh, card: &Card, surfaces: &Surfaces, encoder: &Encoder) -> Picture {
    let look = Look::before(card.middle_m, card.axes, card.half_m, SAMPLES * SIDE);
    let drawing = Drawing::new(leaves, surfaces, &look);
    let sums: [Sum; SIDE * SIDE] = std::array::from_fn(|i| {
        let (x, y) = (i % SIDE * SAMPLES, i / SIDE * SAMPLES);
        let sample = |k: usize| drawing.sample(x + k % SAMPLES, y + k / SAMPLES);
        (0..SAMPLES * SAMPLES).filter_map(sample).fold(Sum::default(), |sum, sample| sum.with(&sample, card))
    });
    let mean = sums.iter().fold(Sum::default(), |all, one| all.and(one));
    let fewest = fewest_samples(&sums);
    sums.map(|sum| {
        // What is empty has the mean colour, which filters and mip levels mix with what is beside it.
        let shown = if sum.count > 0 { sum } else { mean };
        let over = 1.0 / shown.count.max(1) as f32;
        let [r, g, b] = (shown.color * over).to_array().map(|linear| encoder.byte(linear));
        let alpha = unit_to_byte(ALPHA_CUTOFF * sum.count as f32 / fewest as f32 + MARGIN_OF_ALPHA);
        Pixel {
            color: [r, g, b, alpha],
            normal: shown.normal.normalize_or(Vec3::Z).to_array().map(|x| unit_to_byte(0.5 + 0.5 * x)),
            sunlit: shown.sunlit * over,
        }
    })
}

/// So much more alpha than the cutoff has what is just kept, lest it be lost in rounding.
const MARGIN_OF_ALPHA: f32 = 0.004;

/// Samples that a pixel must have for it to be kept, so that as nearly as possible as many pixels are kept as are covered in
/// all (Castaño, "Computing Alpha Mipmaps", 2010).
fn fewest_samples(sums: &[Sum]) -> u32 {
    const ALL: u32 = (SAMPLES * SAMPLES) as u32;
    let covered: u32 = sums.iter().map(|sum| sum.count).sum();
    let kept = |fewest: u32| ALL * sums.iter().filter(|sum| sum.count >= fewest).count() as u32;
    (1..=ALL).min_by_key(|&fewest| kept(fewest).abs_diff(covered)).unwrap_or(1)
}

/// Of the samples of a pixel at which anything is seen.
#[derive(Clone, Copy, Default)]
struct Sum {
    /// Linear.
    color: Vec3,
    /// Turned to the eye, in the card's space.
    normal: Vec3,
    sunlit: f32,
    count: u32,
}

impl Sum {
    fn with(self, sample: &Sample, card: &Card) -> Self {
        let front = card.front();
        let turned = sample.normal * 1.0_f32.copysign(sample.normal.dot(front));
        let normal = Vec3::new(turned.dot(card.axes[0]), turned.dot(card.axes[1]), turned.dot(front));
        self.and(&Self { color: sample.color, normal, sunlit: sample.sunlit, count: 1 })
    }

    fn and(self, other: &Self) -> Self {
        Self {
            color: self.color + other.color,
            normal: self.normal + other.normal,
            sunlit: self.sunlit + other.sunlit,
            count: self.count + other.count,
        }
    }
}

/// Texture coordinates of the corners of the nth card, counter-clockwise from the lower left one, where there are `count`.
pub fn corners(number: usize, count: usize) -> [[f32; 2]; 4] {
    let (columns, rows) = (COLUMNS as f32, count.div_ceil(COLUMNS).max(1) as f32);
    let (left, top) = ((number % COLUMNS) as f32, (number / COLUMNS) as f32);
    [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]].map(|[x, y]| [(left + x) / columns, (top + y) / rows])
}
