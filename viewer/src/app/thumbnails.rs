//! Small pictures of landscapes: taken once of what is on the screen, kept in the world's folder, read for the family tree.

use std::collections::BTreeMap;
use std::thread;

use egui::{ColorImage, Context, TextureHandle, TextureId, TextureOptions};
use genescape_world::World;
use image::codecs::jpeg::JpegEncoder;
use image::imageops::FilterType;
use image::{DynamicImage, RgbaImage};

/// Size of the files, and of what the family tree shows, in pixels.
const FILE_PX: [u32; 2] = [320, 200];
const SHOWN_PX: [u32; 2] = [160, 100];
const QUALITY: u8 = 82;
/// Files that are read in a frame at most: none of them may make it late.
const A_FRAME: usize = 2;

#[derive(Default)]
pub struct Thumbnails {
    /// What was read; `None` where there is none.
    read: BTreeMap<(u32, usize), Option<TextureHandle>>,
    /// Generations of which none has to be taken in this session.
    taken: Option<u32>,
}

impl Thumbnails {
    /// Those that can be shown.
    pub fn shown(&self) -> BTreeMap<(u32, usize), TextureId> {
        let texture = |(place, texture): (&_, &Option<TextureHandle>)| Some((*place, texture.as_ref()?.id()));
        self.read.iter().filter_map(texture).collect()
    }

    /// Reads some more of those that the family tree lacks; whether there may be others.
    pub fn read(&mut self, ctx: &Context, world: &World, generations: &[u32]) -> bool {
        let all = generations.iter().flat_map(|generation| (0..4).map(move |one| (*generation, one)));
        let lacking: Vec<(u32, usize)> = all.filter(|place| !self.read.contains_key(place)).collect();
        for place in lacking.iter().take(A_FRAME) {
            let picture =
                world.thumbnail(place.0, place.1).and_then(|jpeg| image::load_from_memory(&jpeg).ok());
            self.read.insert(*place, picture.map(|picture| texture(ctx, *place, &picture)));
        }
        lacking.len() > A_FRAME
    }

    /// Whether pictures of a generation are wanted, the first time that this is asked of it.
    pub fn wants(&mut self, world: &World, generation: u32) -> bool {
        let is_new = self.taken.replace(generation) != Some(generation);
        is_new && (0..4).any(|one| world.thumbnail(generation, one).is_none())
    }

    /// Keeps pictures of a generation's landscapes. What cannot be written is not worth a word: it can be taken again.
    pub fn keep(&mut self, ctx: &Context, world: &World, generation: u32, pictures: Vec<RgbaImage>) {
        let pictures: Vec<DynamicImage> = pictures.into_iter().map(DynamicImage::ImageRgba8).collect();
        for (one, picture) in pictures.iter().enumerate() {
            let place = (generation, one);
            self.read.insert(place, Some(texture(ctx, place, picture)));
        }
        let world = world.clone();
        let write = move || {
            for (one, picture) in pictures.into_iter().enumerate() {
                if let Some(jpeg) = jpeg(&picture) {
                    let _ = world.keep_thumbnail(generation, one, &jpeg);
                }
            }
        };
        let _ = thread::Builder::new().name("thumbnails".into()).spawn(write);
    }
}

/// The middle of a picture, as the family tree shows it.
fn texture(ctx: &Context, (generation, one): (u32, usize), picture: &DynamicImage) -> TextureHandle {
    let small = picture.resize_to_fill(SHOWN_PX[0], SHOWN_PX[1], FilterType::Triangle).to_rgba8();
    let image = ColorImage::from_rgba_unmultiplied(SHOWN_PX.map(|side| side as usize), &small);
    ctx.load_texture(format!("thumbnail {generation}.{one}"), image, TextureOptions::LINEAR)
}

/// The middle of a picture, small.
fn jpeg(picture: &DynamicImage) -> Option<Vec<u8>> {
    let small = picture.resize_to_fill(FILE_PX[0], FILE_PX[1], FilterType::Triangle).to_rgb8();
    let mut bytes = Vec::new();
    let mut encoder = JpegEncoder::new_with_quality(&mut bytes, QUALITY);
    encoder.encode_image(&small).ok()?;
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thumbnail_is_the_middle_of_the_picture() {
        // Red at both sides, green in the middle.
        let picture = RgbaImage::from_fn(800, 200, |x, _| {
            image::Rgba(if (250..550).contains(&x) { [0, 255, 0, 255] } else { [255, 0, 0, 255] })
        });
        let jpeg = jpeg(&DynamicImage::ImageRgba8(picture)).expect("a JPEG");
        let read = image::load_from_memory(&jpeg).expect("a picture").to_rgb8();
        assert_eq!(read.dimensions(), (FILE_PX[0], FILE_PX[1]));
        // At half its height, left of the middle too: the sides are cut off.
        for x in [30, FILE_PX[0] / 2] {
            let [red, green, _] = read.get_pixel(x, FILE_PX[1] / 2).0;
            assert!(green > 200 && red < 60, "{x}: {red} {green}");
        }
    }
}
