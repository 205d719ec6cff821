//! Pictures → PNG files: 8-bit grey, RGB or RGBA tagged as sRGB where they hold colour, and 16-bit grey for heights.
//! The same picture always gives the same bytes.

use png::{BitDepth, ColorType, Compression, Encoder, Filter, SrgbRenderingIntent};

use crate::model::Image8;

/// Encodes a picture of 1, 3 or 4 channels. Colour (3 or 4 channels) gets an sRGB chunk; see [`encode_linear`] for
/// normals, weights and light.
pub fn encode(image: &Image8) -> Vec<u8> {
    write(image, true)
}

/// Encodes a picture whose values are not colours: no sRGB chunk.
pub fn encode_linear(image: &Image8) -> Vec<u8> {
    write(image, false)
}

/// Encodes width × height 16-bit values as grey, rows from the top.
pub fn encode_gray16(width: u32, height: u32, values: &[u16]) -> Vec<u8> {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_be_bytes()).collect();
    stream(width, height, ColorType::Grayscale, BitDepth::Sixteen, false, &bytes)
}

fn write(image: &Image8, colored: bool) -> Vec<u8> {
    let color = match image.channels {
        1 => ColorType::Grayscale,
        3 => ColorType::Rgb,
        _ => ColorType::Rgba,
    };
    let tagged = colored && image.channels > 1;
    stream(image.width, image.height, color, BitDepth::Eight, tagged, &image.data)
}

fn stream(width: u32, height: u32, color: ColorType, depth: BitDepth, srgb: bool, bytes: &[u8]) -> Vec<u8> {
    let mut file = Vec::with_capacity(bytes.len() / 2 + 1024);
    let mut encoder = Encoder::new(&mut file, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    // A bake is made anew more often than its pictures are sent anywhere: time counts, not the last byte.
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(Filter::Up);
    if srgb {
        encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    }
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(bytes)?;
        writer.finish()
    });
    debug_assert!(written.is_ok(), "a picture's data must fill it: {written:?}");
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decode(bytes: &[u8]) -> (png::OutputInfo, Vec<u8>, bool) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut data = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut data).unwrap();
        let tagged = reader.info().srgb.is_some();
        data.truncate(info.buffer_size());
        (info, data, tagged)
    }

    #[test]
    fn pictures_of_every_kind_read_back() {
        for channels in [1u8, 3, 4] {
            let mut image = Image8::new(37, 21, channels);
            for (i, byte) in image.data.iter_mut().enumerate() {
                *byte = (i * i / 7) as u8;
            }
            let (info, data, tagged) = decode(&encode(&image));
            assert_eq!((info.width, info.height, tagged), (37, 21, channels > 1));
            assert_eq!(data, image.data);
            assert!(!decode(&encode_linear(&image)).2);
        }
    }

    #[test]
    fn heights_keep_all_sixteen_bits() {
        let values: Vec<u16> = (0..65u32 * 33).map(|i| (i.wrapping_mul(2_654_435) >> 7) as u16).collect();
        let (info, data, _) = decode(&encode_gray16(65, 33, &values));
        assert_eq!((info.width, info.height, info.bit_depth), (65, 33, BitDepth::Sixteen));
        let read: Vec<u16> = data.chunks_exact(2).map(|b| u16::from_be_bytes([b[0], b[1]])).collect();
        assert_eq!(read, values);
    }
}
