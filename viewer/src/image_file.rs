//! Finished pictures on the device → images in memory → a PNG file.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use image::{ImageFormat, RgbaImage};
use wgpu::util::DownloadBuffer;

use crate::gpu::Gpu;

/// Copies a texture of 4 bytes a pixel from the device. Waits for it.
pub fn read(gpu: &Gpu, texture: &wgpu::Texture) -> Result<RgbaImage> {
    let (width, height) = (texture.width(), texture.height());
    let row = (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let usage = wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
    let buffer = gpu.empty_buffer("picture", u64::from(row) * u64::from(height), usage);
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
    RgbaImage::from_raw(width, height, rgba).context("the device gives too little back")
}

/// Copies a buffer from the device. Waits for it.
pub fn read_buffer(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u8>> {
    let (sender, receiver) = std::sync::mpsc::channel();
    DownloadBuffer::read_buffer(&gpu.device, &gpu.queue, &buffer.slice(..), move |bytes| {
        // The receiver is gone if reading was given up.
        let _ = sender.send(bytes.map(|bytes| bytes.to_vec()));
    });
    gpu.wait();
    receiver.recv().context("the device was lost")?.context("the device gives nothing back")
}

/// Pixels of a picture: to draw one takes some 60 bytes for each.
const MAX_PIXELS: u64 = 1 << 26;

/// That a picture is larger than the device can draw.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct TooLarge(String);

/// Whether a device can draw a picture of that size.
///
/// # Errors
/// What the largest is.
pub fn check_size(gpu: &Gpu, [width, height]: [u32; 2]) -> Result<(), TooLarge> {
    let limits = gpu.device.limits();
    let (side, pixels) = (limits.max_texture_dimension_2d, (limits.max_buffer_size / 4).min(MAX_PIXELS));
    let is_small = width.max(height) <= side && u64::from(width) * u64::from(height) <= pixels;
    let name = &gpu.name;
    is_small.then_some(()).ok_or_else(|| {
        let millions = pixels / 1_000_000;
        TooLarge(format!(
            "--size {width}x{height}: at most {side} pixels a side and {millions} million in all, drawn by {name}"
        ))
    })
}

/// Puts images of one size side by side, `columns` in a row.
pub fn contact_sheet(images: &[RgbaImage], columns: usize) -> Option<RgbaImage> {
    let (width, height) = images.first()?.dimensions();
    let rows = images.len().div_ceil(columns) as u32;
    let mut sheet = RgbaImage::new(width * columns as u32, height * rows);
    for (index, image) in images.iter().enumerate() {
        let (column, row) = ((index % columns) as u32, (index / columns) as u32);
        image::imageops::replace(&mut sheet, image, (column * width).into(), (row * height).into());
    }
    Some(sheet)
}

/// Makes the folder of a file that is to be written.
pub fn make_folder(path: &Path) -> Result<()> {
    let Some(folder) = path.parent() else { return Ok(()) };
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))
}

/// Writes a PNG file; its folder must exist.
pub fn write_png(path: &Path, image: &RgbaImage) -> Result<()> {
    let written = image.save_with_format(path, ImageFormat::Png);
    written.with_context(|| format!("cannot write {}", path.display()))
}

/// Writes a picture into a folder, made if need be, under the first name that is free there: "genescape-0001.png".
pub fn write_numbered(folder: &Path, image: &RgbaImage) -> Result<PathBuf> {
    std::fs::create_dir_all(folder)?;
    let mut names = (1..10_000).map(|number| folder.join(format!("genescape-{number:04}.png")));
    let path = names.find(|path| !path.exists()).context("there are ten thousand pictures already")?;
    write_png(&path, image)?;
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
        let one = |value: u8| RgbaImage::from_pixel(2, 1, image::Rgba([value; 4]));
        let sheet = contact_sheet(&[one(1), one(2), one(3)], 2).expect("images");
        assert_eq!(sheet.dimensions(), (4, 2));
        assert_eq!(sheet.into_raw(), [[1; 8], [2; 8], [3; 8], [0; 8]].concat());
        assert_eq!(contact_sheet(&[], 2), None);
    }
}
