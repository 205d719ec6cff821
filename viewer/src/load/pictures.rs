//! PNG and EXR → pictures in memory.

use std::io::Cursor;
use std::sync::Arc;

use exr::prelude::{ReadChannels, ReadLayers};
use genescape_schema::scene::Resource;
use half::f16;

use super::LoadError;
use super::document::Document;
use crate::scene::{HdrPicture, Picture};

/// An 8-bit PNG of any kind of colour as RGBA.
pub(super) fn png(document: &Document, resource: &Resource) -> Result<Picture, LoadError> {
    with_mips(document, resource, &[])
}

/// The same with coarser versions from files of their own.
pub(super) fn with_mips(
    document: &Document,
    resource: &Resource,
    mipmaps: &[Resource],
) -> Result<Picture, LoadError> {
    let name = document.name_of(resource);
    // The size is the first of the levels, as eight bytes: what the store keeps is one list.
    let levels = document.store.get::<Vec<Arc<[u8]>>>(&format!("png {name}"), || {
        let (width, height, pixels) = decode(document, resource)?;
        let mut levels: Vec<Arc<[u8]>> = vec![size_bytes(width, height).into(), pixels.into()];
        for (level, mipmap) in mipmaps.iter().enumerate() {
            let (w, h, pixels) = decode(document, mipmap)?;
            if (w, h) != ((width >> (level + 1)).max(1), (height >> (level + 1)).max(1)) {
                return Err(document.wrong(format!("mip level {} of {name} has another size", level + 1)));
            }
            levels.push(pixels.into());
        }
        Ok(levels)
    })?;
    let (width_px, height_px) = size(&levels[0]);
    Ok(Picture { name, width_px, height_px, levels: levels[1..].to_vec() })
}

fn size_bytes(width: u32, height: u32) -> Vec<u8> {
    [width.to_le_bytes(), height.to_le_bytes()].concat()
}

fn size(bytes: &[u8]) -> (u32, u32) {
    let number = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
    (number(0), number(4))
}

fn decode(document: &Document, resource: &Resource) -> Result<(u32, u32, Vec<u8>), LoadError> {
    let bytes = document.bytes(resource)?;
    let wrong = |error: png::DecodingError| {
        document.wrong(format!("{} is no PNG: {error}", document.name_of(resource)))
    };
    let mut decoder = png::Decoder::new(Cursor::new(&bytes[..]));
    decoder.set_transformations(png::Transformations::normalize_to_color8() | png::Transformations::ALPHA);
    let mut reader = decoder.read_info().map_err(wrong)?;
    let size = reader.output_buffer_size().ok_or_else(|| document.wrong("a PNG is too large"))?;
    let mut pixels = vec![0; size];
    let info = reader.next_frame(&mut pixels).map_err(wrong)?;
    pixels.truncate(info.buffer_size());
    let rgba = match info.color_type {
        png::ColorType::GrayscaleAlpha => {
            pixels.chunks_exact(2).flat_map(|p| [p[0], p[0], p[0], p[1]]).collect()
        }
        _ => pixels,
    };
    Ok((info.width, info.height, rgba))
}

/// An EXR picture of radiance, kept as half floats.
pub(super) fn exr(document: &Document, resource: &Resource) -> Result<HdrPicture, LoadError> {
    let name = document.name_of(resource);
    let levels = document.store.get::<Vec<Arc<[u8]>>>(&format!("exr {name}"), || {
        let bytes = document.bytes(resource)?;
        decode_exr(&bytes).map_err(|error| document.wrong(format!("{name} is no EXR picture: {error}")))
    })?;
    let (width_px, height_px) = size(&levels[0]);
    Ok(HdrPicture { name, width_px, height_px, pixels: levels[1].clone() })
}

fn decode_exr(bytes: &[u8]) -> Result<Vec<Arc<[u8]>>, exr::error::Error> {
    struct Canvas {
        width: usize,
        size: (u32, u32),
        pixels: Vec<f16>,
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            |resolution, _| Canvas {
                width: resolution.width(),
                size: (resolution.width() as u32, resolution.height() as u32),
                pixels: vec![f16::ONE; resolution.area() * 4],
            },
            |canvas: &mut Canvas, at, (r, g, b, a): (f16, f16, f16, f16)| {
                let first = (at.y() * canvas.width + at.x()) * 4;
                canvas.pixels[first..first + 4].copy_from_slice(&[r, g, b, a]);
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))?;
    let canvas = image.layer_data.channel_data.pixels;
    let pixels: Vec<u8> = bytemuck::cast_slice(&canvas.pixels).to_vec();
    Ok(vec![size_bytes(canvas.size.0, canvas.size.1).into(), pixels.into()])
}
