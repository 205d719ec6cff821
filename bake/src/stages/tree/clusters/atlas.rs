//! Cards with the leaves that they show → pictures, side by side in one image.

use glam::Vec3;
use rayon::prelude::*;

use super::card::Card;
use crate::math::unit_to_byte;
use crate::model::{Clusters, Image8, Mesh};
use crate::stages::tree::mips::Encoder;
use crate::stages::tree::raster::{Drawing, Look, Sample};
use crate::stages::tree::surfaces::{Atlas, Surfaces};

/// Pixels a side of one picture. A cluster is some twenty pixels of the screen wide where it begins to be shown.
pub const SIDE: usize = 16;
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
    /// In the card's space, turned to the eye.
    normal: [u8; 3],
    /// As [`super::super::raster::Sample::sunlit`].
    sunlit: f32,
}

/// Rows from the top.
type Picture = [Pixel; SIDE * SIDE];

fn picture(leaves: &Mesh, card: &Card, surfaces: &Surfaces, encoder: &Encoder) -> Picture {
    let look = Look::before(card.middle_m, card.axes, card.half_m, SIDE);
    let drawing = Drawing::new(leaves, surfaces, &look);
    let seen: [Option<Sample>; SIDE * SIDE] = std::array::from_fn(|i| drawing.sample(i % SIDE, i / SIDE));
    let (sum, count) =
        seen.iter().flatten().fold((Vec3::ZERO, 0), |(sum, count), s| (sum + s.color, count + 1));
    // What is empty has the mean colour, which filters and mip levels mix with what is beside it.
    let empty =
        Pixel { color: srgb(sum / count.max(1) as f32, 0, encoder), normal: packed(Vec3::Z), sunlit: 0.0 };
    seen.map(|sample| {
        sample.map_or(empty, |sample| Pixel {
            color: srgb(sample.color, u8::MAX, encoder),
            normal: packed(card.toward_eye(sample.normal).normalize_or(Vec3::Z)),
            sunlit: sample.sunlit,
        })
    })
}

fn srgb(linear: Vec3, alpha: u8, encoder: &Encoder) -> [u8; 4] {
    let [r, g, b] = linear.to_array().map(|linear| encoder.byte(linear));
    [r, g, b, alpha]
}

/// A unit vector as a pixel of a picture of normals.
fn packed(normal: Vec3) -> [u8; 3] {
    normal.to_array().map(|x| unit_to_byte(0.5 + 0.5 * x))
}

/// Texture coordinates of the corners of the nth card, counter-clockwise from the lower left one, where there are `count`.
pub fn corners(number: usize, count: usize) -> [[f32; 2]; 4] {
    let (columns, rows) = (COLUMNS as f32, count.div_ceil(COLUMNS).max(1) as f32);
    let (left, top) = ((number % COLUMNS) as f32, (number / COLUMNS) as f32);
    [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]].map(|[x, y]| [(left + x) / columns, (top + y) / rows])
}
