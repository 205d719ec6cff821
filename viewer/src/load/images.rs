//! PNG and EXR → images in memory.

use std::io::Cursor;
use std::sync::Arc;

use exr::error::Error;
use exr::meta::MetaData;
use exr::prelude::{ReadChannels, ReadLayers};
use genescape_schema::scene::Resource;
use half::f16;
use image::{ImageFormat, ImageReader, Limits, RgbaImage};

use super::Result;
use super::bounds::{MAX_PICTURE_PX, MAX_SKY_PX};
use super::document::Document;
use crate::scene::{HdrImage, Image};

/// An 8-bit PNG of any kind of colour as RGBA.
pub(super) fn png(document: &Document, resource: &Resource) -> Result<Image> {
    with_mips(document, resource, &[])
}

/// The same with coarser versions from files of their own.
pub(super) fn with_mips(document: &Document, resource: &Resource, mipmaps: &[Resource]) -> Result<Image> {
    let name = document.name_of(resource);
    let image = document.store.get::<Image>(&name, || {
        let finest = decode(document, resource)?;
        let (width_px, height_px) = finest.dimensions();
        let mut levels: Vec<Arc<[u8]>> = vec![finest.into_raw().into()];
        for (level, mipmap) in (1..).zip(mipmaps) {
            let coarser = decode(document, mipmap)?;
            if coarser.dimensions() != ((width_px >> level).max(1), (height_px >> level).max(1)) {
                return Err(document.wrong(format!("mip level {level} of {name} has another size")));
            }
            levels.push(coarser.into_raw().into());
        }
        Ok(Image { name: name.clone(), width_px, height_px, levels })
    })?;
    Ok((*image).clone())
}

fn decode(document: &Document, resource: &Resource) -> Result<RgbaImage> {
    let bytes = document.bytes(resource)?;
    let mut reader = ImageReader::with_format(Cursor::new(&**bytes), ImageFormat::Png);
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(MAX_PICTURE_PX), Some(MAX_PICTURE_PX));
    reader.limits(limits);
    match reader.decode() {
        Ok(image) => Ok(image.into_rgba8()),
        Err(error) => Err(document.wrong(format!("{} is no PNG: {error}", document.name_of(resource)))),
    }
}

/// An EXR image of radiance, kept as half floats.
pub(super) fn exr(document: &Document, resource: &Resource) -> Result<HdrImage> {
    let name = document.name_of(resource);
    let image = document.store.get::<HdrImage>(&name, || {
        let bytes = document.bytes(resource)?;
        decode_exr(&name, &bytes).map_err(|error| document.wrong(format!("{name} is no EXR image: {error}")))
    })?;
    Ok((*image).clone())
}

/// By the `exr` crate itself: `image` would make floats of the halves first, in 5 ms for 384² instead of 0.4.
fn decode_exr(name: &str, bytes: &[u8]) -> exr::error::Result<HdrImage> {
    // Before memory is taken for what the header says.
    let header = MetaData::read_from_buffered(Cursor::new(bytes), false)?;
    let sizes = header.headers.iter().map(|header| header.layer_size);
    if { sizes }.any(|size| size.width().max(size.height()) > MAX_SKY_PX) {
        return Err(Error::Invalid(format!("more than {MAX_SKY_PX} pixels a side").into()));
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            |size, _| (size.width(), vec![[f16::ONE; 4]; size.area()]),
            |(width, pixels): &mut (usize, Vec<[f16; 4]>), at, (r, g, b, a): (f16, f16, f16, f16)| {
                pixels[at.y() * *width + at.x()] = [r, g, b, a];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))?;
    let layer = image.layer_data;
    Ok(HdrImage {
        name: name.to_owned(),
        width_px: layer.size.width() as u32,
        height_px: layer.size.height() as u32,
        pixels: bytemuck::cast_slice::<_, u8>(&layer.channel_data.pixels.1).into(),
    })
}

#[cfg(test)]
mod tests {
    use exr::prelude::{Image, SpecificChannels, Vec2, WritableImage};

    use super::*;

    #[test]
    fn an_exr_of_halves_keeps_its_bits_and_is_opaque() {
        let value = |at: Vec2<usize>, channel: usize| {
            f16::from_f32((at.y() * 10 + at.x()) as f32 + channel as f32 / 4.0)
        };
        let channels = SpecificChannels::rgb(|at| (value(at, 0), value(at, 1), value(at, 2)));
        let mut bytes = Cursor::new(Vec::new());
        Image::from_channels((3, 2), channels).write().to_buffered(&mut bytes).expect("written");
        let image = decode_exr("sky.exr", &bytes.into_inner()).expect("an EXR image");
        let places = [(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)].map(|(x, y)| Vec2(x, y));
        let right = places.map(|at| [value(at, 0), value(at, 1), value(at, 2), f16::ONE]);
        assert_eq!((image.width_px, image.height_px), (3, 2));
        assert_eq!(*image.pixels, *bytemuck::cast_slice::<_, u8>(&right));
        assert!(decode_exr("sky.exr", b"no image").is_err());
    }

    #[test]
    fn an_exr_that_says_it_is_huge_is_refused_before_memory_is_taken() {
        let channels = SpecificChannels::rgb(|_: Vec2<usize>| (f16::ONE, f16::ONE, f16::ONE));
        let mut bytes = Cursor::new(Vec::new());
        Image::from_channels((3, 2), channels).write().to_buffered(&mut bytes).expect("written");
        let mut bytes = bytes.into_inner();
        // Both windows end at (2, 1).
        let end: Vec<u8> = [2i32, 1].iter().flat_map(|end| end.to_le_bytes()).collect();
        let places: Vec<usize> = (0..bytes.len() - 8).filter(|&at| bytes[at..at + 8] == end).collect();
        assert!(places.len() >= 2, "{places:?}");
        for at in places {
            bytes[at..at + 8].copy_from_slice(&[[0xff, 0xff, 0xff, 0]; 2].concat());
        }
        let error = decode_exr("sky.exr", &bytes).expect_err("16 million pixels a side").to_string();
        assert!(error.contains("4096"), "{error}");
    }
}
