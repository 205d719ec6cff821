//! A picture on the device → pixels in memory ↔ a PNG file.

use std::path::Path;

use anyhow::{Context, Result};

use crate::gpu::Gpu;

/// Pixels in memory: RGBA, 8 bits, row 0 on top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    /// Width.
    pub width_px: u32,
    /// Height.
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
        // Nobody waits any more if the receiver is gone.
        let _ = sender.send(result);
    });
    gpu.wait();
    receiver.recv().context("the device was lost")?.context("the device gives nothing back")?;
    let bytes = buffer.slice(..).get_mapped_range().context("the device gives nothing back")?.to_vec();
    buffer.unmap();
    Ok(bytes)
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
