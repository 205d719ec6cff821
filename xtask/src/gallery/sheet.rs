//! Pictures in rows with a line of text under each → one JPEG file.

use std::path::Path;

use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};
use anyhow::{Context, Result, ensure};
use image::{GenericImageView, Rgb, RgbImage, imageops};

/// Between pictures, and around them.
const GAP_PX: u32 = 6;
const CAPTION_PX: u32 = 22;
const TEXT_PX: f32 = 15.0;
const PAPER: Rgb<u8> = Rgb([250, 250, 248]);
const JPEG_QUALITY: u8 = 88;

/// How high a picture of that width is.
pub fn height(width: u32) -> u32 {
    width * 2 / 3
}

/// A contact sheet.
pub struct Sheet {
    image: RgbImage,
    width: u32,
    columns: u32,
    count: u64,
    hung: u64,
}

impl Sheet {
    /// Room for `count` pictures.
    pub fn new(width: u32, columns: u32, count: u64) -> Self {
        let rows = count.div_ceil(u64::from(columns)) as u32;
        let size =
            [columns * (width + GAP_PX) + GAP_PX, rows * (height(width) + CAPTION_PX + GAP_PX) + GAP_PX];
        Self { image: RgbImage::from_pixel(size[0], size[1], PAPER), width, columns, count, hung: 0 }
    }

    /// Cuts a picture of two by two into four, and hangs them as far as there is room.
    pub fn hang(&mut self, picture: &Path, captions: &[String]) -> Result<()> {
        let four = image::open(picture).with_context(|| format!("cannot read {}", picture.display()))?;
        let (width, height) = (self.width, height(self.width));
        ensure!(four.dimensions() == (2 * width, 2 * height), "{} is of another size", picture.display());
        for (quarter, caption) in (0u32..4).zip(captions) {
            if self.hung == self.count {
                return Ok(());
            }
            let one = four.view(quarter % 2 * width, quarter / 2 * height, width, height);
            let (column, row) = (self.hung as u32 % self.columns, self.hung as u32 / self.columns);
            let (x, y) = (GAP_PX + column * (width + GAP_PX), GAP_PX + row * (height + CAPTION_PX + GAP_PX));
            let rgb = image::DynamicImage::from(one.to_image()).to_rgb8();
            imageops::replace(&mut self.image, &rgb, x.into(), y.into());
            self.write_text(caption, [x, y + height]);
            self.hung += 1;
        }
        Ok(())
    }

    /// One line below a picture, as far as it fits.
    fn write_text(&mut self, text: &str, [x, y]: [u32; 2]) {
        let Ok(font) = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT) else { return };
        let font = font.as_scaled(PxScale::from(TEXT_PX * 1.15));
        let (end, mut at) = ((x + self.width) as f32, x as f32 + 2.0);
        for letter in text.chars() {
            let glyph = font.scaled_glyph(letter);
            let advance = font.h_advance(glyph.id);
            let mut placed = glyph;
            placed.position = point(at, y as f32 + TEXT_PX + 1.0);
            at += advance;
            if at > end {
                return;
            }
            let Some(outline) = font.outline_glyph(placed) else { continue };
            let corner = outline.px_bounds().min;
            outline.draw(|dx, dy, cover| {
                let (px, py) = (corner.x as u32 + dx, corner.y as u32 + dy);
                if let Some(pixel) = self.image.get_pixel_mut_checked(px, py) {
                    pixel.0 = pixel.0.map(|value| (f32::from(value) * (1.0 - cover.min(1.0))) as u8);
                }
            });
        }
    }

    pub fn write(&self, path: &Path) -> Result<()> {
        let (width, height) = self.image.dimensions();
        let [width, height] = [width, height].map(u16::try_from);
        let (width, height) = (width.context("too wide for JPEG")?, height.context("too high for JPEG")?);
        let encoder = jpeg_encoder::Encoder::new_file(path, JPEG_QUALITY)
            .with_context(|| format!("cannot write {}", path.display()))?;
        encoder.encode(&self.image, width, height, jpeg_encoder::ColorType::Rgb)?;
        println!("{}", path.display());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_pictures_hang_in_order_each_over_its_caption() {
        let (width, height) = (90, height(90));
        let colours = [Rgb([200u8, 0, 0]), Rgb([0, 200, 0]), Rgb([0, 0, 200]), Rgb([200, 200, 0])];
        let four =
            RgbImage::from_fn(2 * width, 2 * height, |x, y| colours[(x / width + y / height * 2) as usize]);
        let path = std::env::temp_dir().join(format!("genescape-sheet-{}.png", std::process::id()));
        four.save(&path).expect("written");
        // There is room for three of the four.
        let mut sheet = Sheet::new(width, 2, 3);
        let captions =
            ["1  Oaks", "", "3  Birches on karst, mackerel sky, far too long", "4"].map(str::to_owned);
        sheet.hang(&path, &captions).expect("hung");
        std::fs::remove_file(&path).expect("there");
        let middle = |column: u32, row: u32| {
            let (x, y) = (column * (width + GAP_PX), row * (height + CAPTION_PX + GAP_PX));
            *sheet.image.get_pixel(GAP_PX + x + width / 2, GAP_PX + y + height / 2)
        };
        assert_eq!([middle(0, 0), middle(1, 0), middle(0, 1)], [colours[0], colours[1], colours[2]]);
        assert_eq!(middle(1, 1), PAPER);
        let ink = |column: u32, row: u32| {
            let (x, y) = (column * (width + GAP_PX), row * (height + CAPTION_PX + GAP_PX) + GAP_PX + height);
            let caption = sheet.image.view(x, y, GAP_PX + width, CAPTION_PX);
            caption.pixels().filter(|(_, _, pixel)| *pixel != PAPER).count()
        };
        assert!(ink(0, 0) > 20 && ink(0, 1) > ink(0, 0), "{} {}", ink(0, 0), ink(0, 1));
        assert_eq!((ink(1, 0), ink(1, 1)), (0, 0));
    }
}
