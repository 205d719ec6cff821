//! Linear pictures → OpenEXR 2 files: one part, RGB half floats in uncompressed scan lines, as Blender's World and
//! every compositor read them. The same picture always gives the same bytes: no timestamps, one thread.
//!
//! Lines are stored as they are: compressing them would cost time in every bake, and this makes the format simple enough
//! to write here (OpenEXR, "File Layout"): a header of named attributes, a table of offsets, and
//! per line its number, its size and its channels in alphabetical order.

use crate::model::ImageF16;

const MAGIC: [u8; 4] = [0x76, 0x2F, 0x31, 0x01];
const VERSION: u32 = 2;
const HALF: u32 = 1;

/// Encodes a linear RGB picture with the primaries of Rec. 709.
pub fn encode(image: &ImageF16) -> Vec<u8> {
    let (width, height) = (image.width as usize, image.height as usize);
    let line_bytes = width * 6;
    let mut file = header(image.width, image.height);
    file.reserve(height * (line_bytes + 16));
    let first_line = file.len() + height * 8;
    for line in 0..height {
        file.extend_from_slice(&((first_line + line * (line_bytes + 8)) as u64).to_le_bytes());
    }
    let mut packed = vec![0u8; line_bytes];
    for (line, pixels) in image.data.chunks_exact((width * 3).max(1)).enumerate() {
        file.extend_from_slice(&(line as u32).to_le_bytes());
        file.extend_from_slice(&(line_bytes as u32).to_le_bytes());
        pack(pixels, &mut packed);
        file.extend_from_slice(&packed);
    }
    file
}

/// The picture in a file that [`encode`] made; `None` for any other.
pub fn decode(file: &[u8]) -> Option<ImageF16> {
    const WINDOW: &[u8] = b"dataWindow\0box2i\0\x10\0\0\0";
    let window = file.windows(WINDOW.len()).position(|window| window == WINDOW)? + WINDOW.len();
    let last = |at: usize| Some(u32::from_le_bytes(*file.get(window + at..)?.first_chunk()?));
    let (width, height) = (last(8)?.checked_add(1)?, last(12)?.checked_add(1)?);
    let rest = file.strip_prefix(&header(width, height)[..])?;
    let line_bytes = width as usize * 6;
    let lines = rest.get(height as usize * 8..)?;
    if lines.len() != height as usize * (line_bytes + 8) {
        return None;
    }
    let mut data = Vec::with_capacity(lines.len() / 2);
    for line in lines.chunks_exact(line_bytes + 8) {
        let (blue, rest) = line[8..].split_at(line_bytes / 3);
        let (green, red) = rest.split_at(line_bytes / 3);
        for at in (0..blue.len()).step_by(2) {
            data.extend([red, green, blue].map(|run| u16::from_le_bytes([run[at], run[at + 1]])));
        }
    }
    Some(ImageF16 { width, height, data })
}

/// Interleaved RGB → a run of B, a run of G, a run of R, little endian.
fn pack(pixels: &[u16], packed: &mut [u8]) {
    let (blue, rest) = packed.split_at_mut(packed.len() / 3);
    let (green, red) = rest.split_at_mut(blue.len());
    let runs = blue.chunks_exact_mut(2).zip(green.chunks_exact_mut(2)).zip(red.chunks_exact_mut(2));
    for (rgb, ((b, g), r)) in pixels.chunks_exact(3).zip(runs) {
        r.copy_from_slice(&rgb[0].to_le_bytes());
        g.copy_from_slice(&rgb[1].to_le_bytes());
        b.copy_from_slice(&rgb[2].to_le_bytes());
    }
}

fn header(width: u32, height: u32) -> Vec<u8> {
    let mut head = MAGIC.to_vec();
    head.extend_from_slice(&VERSION.to_le_bytes());
    let words = |values: &[u32]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    let floats = |values: &[f32]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    let window = words(&[0, 0, width.saturating_sub(1), height.saturating_sub(1)]);
    let mut channels = Vec::new();
    for name in [b"B\0", b"G\0", b"R\0"] {
        channels.extend_from_slice(name);
        channels.extend_from_slice(&words(&[HALF, 0, 1, 1]));
    }
    channels.push(0);
    let rec709 = floats(&[0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290]);
    for (name, kind, value) in [
        ("channels", "chlist", channels),
        ("chromaticities", "chromaticities", rec709),
        ("compression", "compression", vec![0]),
        ("dataWindow", "box2i", window.clone()),
        ("displayWindow", "box2i", window),
        ("lineOrder", "lineOrder", vec![0]),
        ("pixelAspectRatio", "float", floats(&[1.0])),
        ("screenWindowCenter", "v2f", floats(&[0.0, 0.0])),
        ("screenWindowWidth", "float", floats(&[1.0])),
    ] {
        for text in [name, kind] {
            head.extend_from_slice(text.as_bytes());
            head.push(0);
        }
        head.extend_from_slice(&(value.len() as u32).to_le_bytes());
        head.extend_from_slice(&value);
    }
    head.push(0);
    head
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use exr::prelude::*;
    use half::f16;

    use super::encode;
    use crate::model::ImageF16;

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
                |size, _| ImageF16 {
                    width: size.0 as u32,
                    height: size.1 as u32,
                    data: vec![0; size.0 * size.1 * 3],
                },
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
        assert_eq!(super::decode(&encode(&image)), Some(image));
    }

    #[test]
    fn other_files_are_not_taken_for_ours() {
        let file = encode(&ramp(5, 3));
        for length in 0..file.len() {
            assert_eq!(super::decode(&file[..length]), None, "{length} bytes");
        }
        let other = file.iter().map(|byte| byte ^ u8::from(*byte == 1)).collect::<Vec<_>>();
        assert_eq!(super::decode(&other), None);
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
