//! A picture on the device → pixels in memory ↔ a PNG file.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::gpu::Gpu;

/// Pixels in memory: RGBA, 8 bits, row 0 on top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    pub width_px: u32,
    pub height_px: u32,
    /// 4 bytes a pixel.
    pub rgba: Vec<u8>,
}

/// Copies a texture of 4 bytes a pixel from the device. Waits for it.
pub fn read(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Pixels> {
    let (width, height) = (texture.width(), texture.height());
    let row = (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("picture"),
        size: u64::from(row) * u64::from(height),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None },
        },
        texture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    let bytes = read_buffer(gpu, &buffer)?;
    let rows = bytes.chunks_exact(row as usize);
    let rgba = rows.flat_map(|pixels| &pixels[..width as usize * 4]).copied().collect();
    Ok(Pixels { width_px: width, height_px: height, rgba })
}

/// Copies a buffer that can be mapped from the device. Waits for it.
pub fn read_buffer(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u8>> {
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.slice(..).map_async(wgpu::MapMode::Read, move |result| {
        // The receiver is gone if reading was given up.
        let _ = sender.send(result);
    });
    gpu.wait();
    receiver.recv().context("the device was lost")?.context("the device gives nothing back")?;
    let bytes = buffer.slice(..).get_mapped_range().context("the device gives nothing back")?.to_vec();
    buffer.unmap();
    Ok(bytes)
}

/// Puts pictures of one size side by side, `columns` in a row.
pub fn contact_sheet(pictures: &[Pixels], columns: usize) -> Option<Pixels> {
    let first = pictures.first()?;
    let (width, height) = (first.width_px as usize, first.height_px as usize);
    let rows = pictures.len().div_ceil(columns);
    let mut rgba = vec![0; width * columns * height * rows * 4];
    for (index, picture) in pictures.iter().enumerate() {
        let (column, row) = (index % columns, index / columns);
        for y in 0..height {
            let to = (((row * height + y) * columns + column) * width) * 4;
            rgba[to..to + width * 4].copy_from_slice(&picture.rgba[y * width * 4..(y + 1) * width * 4]);
        }
    }
    Some(Pixels { width_px: (width * columns) as u32, height_px: (height * rows) as u32, rgba })
}

/// Writes a PNG file; its folder must exist.
pub fn write_png(path: &Path, pixels: &Pixels) -> Result<()> {
    let Pixels { width_px, height_px, rgba } = pixels;
    image::save_buffer(path, rgba, *width_px, *height_px, image::ExtendedColorType::Rgba8)
        .with_context(|| format!("cannot write {}", path.display()))
}

/// Reads a PNG file of any kind of colour.
pub fn read_png(path: &Path) -> Result<Pixels> {
    let picture = image::open(path).with_context(|| format!("cannot read {}", path.display()))?.into_rgba8();
    Ok(Pixels { width_px: picture.width(), height_px: picture.height(), rgba: picture.into_raw() })
}

/// Writes a picture into a folder, made if need be, under the first name that is free there: "genescape-0001.png".
pub fn write_numbered(folder: &Path, pixels: &Pixels) -> Result<PathBuf> {
    std::fs::create_dir_all(folder)?;
    let mut names = (1..10_000).map(|number| folder.join(format!("genescape-{number:04}.png")));
    let path = names.find(|path| !path.exists()).context("there are ten thousand pictures already")?;
    write_png(&path, pixels)?;
    Ok(path)
}

/// Width and height as a person writes them: "1280x800".
pub fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let sides: Vec<u32> = text.split(['x', 'X', '×']).filter_map(|side| side.trim().parse().ok()).collect();
    match sides[..] {
        [width, height] if (16..=16384).contains(&width) && (16..=16384).contains(&height) => {
            Ok([width, height])
        }
        _ => Err("a size is WIDTHxHEIGHT in pixels, 16 to 16384 each, as in 1280x800".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_or_refused() {
        assert_eq!(parse_size("640x480"), Ok([640, 480]));
        for wrong in ["640", "0x480", "640x480x3", "x", "99999x10"] {
            assert!(parse_size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_contact_sheet_is_filled_row_by_row() {
        let one = |value: u8| Pixels { width_px: 2, height_px: 1, rgba: vec![value; 8] };
        let sheet = contact_sheet(&[one(1), one(2), one(3)], 2).expect("pictures");
        assert_eq!((sheet.width_px, sheet.height_px), (4, 2));
        assert_eq!(sheet.rgba, [[1; 8], [2; 8], [3; 8], [0; 8]].concat());
        assert_eq!(contact_sheet(&[], 2), None);
    }
}
