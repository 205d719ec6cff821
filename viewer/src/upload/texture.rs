//! Images → textures with all their mip levels.

use std::sync::Arc;

use genescape_schema::scene::Alpha;
use glam::{Vec3, Vec4};
use half::f16;
use rayon::prelude::*;

use super::Uploader;
use crate::gpu::flat;
use crate::scene::{HdrImage, Image};

/// What an image's numbers mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageUse {
    /// Colour in sRGB of a file that is no landscape: filtered as light, as glTF demands.
    Color,
    /// The same of a landscape. On the device it is square roots of light, which shaders square: software filters these as bytes,
    /// but decodes each texel of sRGB that it reads, eight for a pixel.
    Albedo,
    /// Albedo of which nothing is drawn where alpha is below ½: each level covers as much as the first.
    Cutout,
    /// Numbers: normals, weights, light.
    Data,
}

/// Pixels a side of a cutout's last mip level. One pixel is seen or not: leaves that cover less than half of their card would
/// be gone in the distance, and others be squares.
const MIN_CUTOUT_PX: u32 = 16;

impl ImageUse {
    fn format(self) -> wgpu::TextureFormat {
        match self {
            Self::Color => wgpu::TextureFormat::Rgba8UnormSrgb,
            Self::Albedo | Self::Cutout | Self::Data => wgpu::TextureFormat::Rgba8Unorm,
        }
    }
}

impl Uploader {
    /// An image as a texture. Mip levels that its file brings are used as they are (leaves keep their coverage by
    /// them); an image without gets averages.
    pub(super) fn image(&self, image: &Image, kind: ImageUse) -> Arc<wgpu::Texture> {
        let min_px = if kind == ImageUse::Cutout { MIN_CUTOUT_PX } else { 1 };
        self.shared(format!("{kind:?} {}", image.name), || self.array(&[image], kind, min_px))
    }

    /// Several strips of square pictures of one size as the layers of one texture, down to `min_px` a side: smaller, and
    /// pictures run into each other.
    pub(super) fn strips(&self, images: &[&Image], kind: ImageUse, min_px: u32) -> Arc<wgpu::Texture> {
        let names: Vec<&str> = images.iter().map(|image| image.name.as_str()).collect();
        self.shared(format!("strips {kind:?} {}", names.join(" ")), || self.array(images, kind, min_px))
    }

    /// Several images of one size as the layers of one texture, with mip levels down to `min_px` a side.
    pub(super) fn array(&self, images: &[&Image], kind: ImageUse, min_px: u32) -> wgpu::Texture {
        let chains: Vec<Vec<Arc<[u8]>>> = images.par_iter().map(|image| mip_levels(image, kind)).collect();
        let wanted =
            (images[0].height_px.max(images[0].width_px) / min_px.max(1)).max(1).ilog2() as usize + 1;
        let levels = chains.iter().map(Vec::len).min().unwrap_or(1).min(wanted);
        let (first, usage) = (images[0], wgpu::TextureUsages::TEXTURE_BINDING);
        let mut texture = flat(&first.name, [first.width_px, first.height_px], kind.format(), usage);
        texture.size.depth_or_array_layers = images.len() as u32;
        texture.mip_level_count = levels as u32;
        let texels: Vec<&[u8]> = chains.iter().flat_map(|chain| &chain[..levels]).map(Arc::as_ref).collect();
        let mut texels = texels.concat();
        if matches!(kind, ImageUse::Albedo | ImageUse::Cutout) {
            take_roots(&mut texels);
        }
        self.gpu.texture(&texture, &texels)
    }

    /// Six faces of half floats, all squares of one size, as a cube with mip levels.
    pub(super) fn cube(&self, faces: &[HdrImage]) -> Arc<wgpu::Texture> {
        let names: Vec<&str> = faces.iter().map(|face| face.name.as_str()).collect();
        self.shared(names.join(" "), || {
            let (format, usage) = (wgpu::TextureFormat::Rgba16Float, wgpu::TextureUsages::TEXTURE_BINDING);
            let mut texture = flat("sky", [faces[0].width_px, faces[0].height_px], format, usage);
            texture.size.depth_or_array_layers = faces.len() as u32;
            texture.mip_level_count = CUBE_LEVELS.min(faces[0].width_px.ilog2() + 1);
            let levels = |face: &HdrImage| radiance_levels(face, texture.mip_level_count);
            let texels: Vec<Vec<u8>> = faces.par_iter().map(levels).collect();
            self.gpu.texture(&texture, &texels.concat())
        })
    }

    /// A square of numbers that each sample of a field has, for `textureLoad`.
    pub(super) fn samples(
        &self,
        name: &str,
        side: u32,
        format: wgpu::TextureFormat,
        texels: &[u8],
    ) -> Arc<wgpu::Texture> {
        self.shared(name.into(), || {
            let texture = flat(name, [side, side], format, wgpu::TextureUsages::TEXTURE_BINDING);
            self.gpu.texture(&texture, texels)
        })
    }
}

/// Mip levels of the sky: waves mirror it blurred, never by more than so many.
const CUBE_LEVELS: u32 = 6;

/// A face and its mip levels, four half floats a texel.
fn radiance_levels(face: &HdrImage, levels: u32) -> Vec<u8> {
    let (mut all, mut side) = (face.pixels.to_vec(), face.width_px as usize);
    let texel = |bytes: &[[u8; 2]; 4]| Vec4::from_array(bytes.map(|part| f16::from_le_bytes(part).to_f32()));
    let mut finer: Vec<Vec4> = face.pixels.as_chunks().0.as_chunks().0.iter().map(texel).collect();
    for _ in 1..levels {
        let half = side / 2;
        let mean = |number: usize| {
            let first = 2 * (number / half * side + number % half);
            0.25 * (finer[first] + finer[first + 1] + finer[first + side] + finer[first + side + 1])
        };
        let coarser: Vec<Vec4> = (0..half * half).map(mean).collect();
        let parts = coarser.iter().flat_map(|texel| texel.to_array().map(f16::from_f32));
        all.extend(parts.flat_map(f16::to_le_bytes));
        (finer, side) = (coarser, half);
    }
    all
}

/// The least alpha that is drawn of a cutout.
const CUTOFF: f32 = 0.5;

/// An image's mip levels: its own, or averages down to one pixel.
pub(super) fn mip_levels(image: &Image, kind: ImageUse) -> Vec<Arc<[u8]>> {
    if image.levels.len() > 1 {
        return image.levels.clone();
    }
    let mut levels = image.levels.clone();
    let (mut width, mut height) = (image.width_px, image.height_px);
    while let Some(finer) = levels.last().filter(|_| width > 1 || height > 1) {
        let coarser = halve(finer, width, height, kind);
        (width, height) = ((width / 2).max(1), (height / 2).max(1));
        levels.push(coarser.into());
    }
    if kind == ImageUse::Cutout {
        keep_coverage(&mut levels, image.width_px as usize);
    }
    levels
}

/// Scales the alpha of each level so that as much of it is drawn as of the first, which is so wide.
fn keep_coverage(levels: &mut [Arc<[u8]>], mut width: usize) {
    let Some((first, coarser)) = levels.split_first_mut() else { return };
    let share = Alpha::new(&alphas(first), width).share(CUTOFF);
    for level in coarser {
        width = (width / 2).max(1);
        let scale = Alpha::new(&alphas(level), width).scale_for(share, CUTOFF);
        let scaled = level.chunks_exact(4).flat_map(|pixel| {
            let alpha = (f32::from(pixel[3]) * scale).round().min(255.0) as u8;
            [pixel[0], pixel[1], pixel[2], alpha]
        });
        *level = scaled.collect();
    }
}

fn alphas(level: &[u8]) -> Vec<f32> {
    level.chunks_exact(4).map(|pixel| f32::from(pixel[3]) / 255.0).collect()
}

/// Averages of 2 × 2 pixels; colour is averaged as light.
fn halve(pixels: &[u8], width: u32, height: u32, kind: ImageUse) -> Vec<u8> {
    let table = linear_table();
    let plain = |four: [u8; 4]| ((four.iter().map(|&byte| u32::from(byte)).sum::<u32>() + 2) / 4) as u8;
    let light = |four: [u8; 4]| encode(0.25 * four.iter().map(|&byte| table[usize::from(byte)]).sum::<f32>());
    let (pixels, width, height) = (pixels.as_chunks::<4>().0, width as usize, height as usize);
    let row = |y: usize| &pixels[y.min(height - 1) * width..][..width];
    let (half_width, half_height) = ((width / 2).max(1), (height / 2).max(1));
    let mut halved = Vec::with_capacity(half_width * half_height);
    for y in 0..half_height {
        let (upper, lower) = (row(2 * y), row(2 * y + 1));
        halved.extend((0..half_width).map(|x| {
            let (left, right) = (2 * x, (2 * x + 1).min(width - 1));
            let four = [upper[left], upper[right], lower[left], lower[right]];
            let channel = |c: usize| four.map(|pixel| pixel[c]);
            match kind {
                ImageUse::Data => [0, 1, 2, 3].map(|c| plain(channel(c))),
                _ => [light(channel(0)), light(channel(1)), light(channel(2)), plain(channel(3))],
            }
        }));
    }
    halved.into_flattened()
}

/// The mean of an image's colours, linear, by some of its pixels, evenly spread.
pub(super) fn mean_light(image: &Image) -> Vec3 {
    let pixels = image.levels.first().map_or(&[][..], |level| level.as_chunks::<4>().0);
    // No side is a multiple of it, so that all columns are among them.
    let some = || pixels.iter().step_by(61);
    some().map(linear).sum::<Vec3>() / some().count().max(1) as f32
}

/// The light of a pixel in sRGB, [0, 1].
pub(super) fn linear(&[r, g, b, _]: &[u8; 4]) -> Vec3 {
    let table = linear_table();
    Vec3::from_array([r, g, b].map(|byte| table[usize::from(byte)]))
}

/// Light of each byte of sRGB, [0, 1].
fn linear_table() -> &'static [f32; 256] {
    static TABLE: std::sync::OnceLock<[f32; 256]> = std::sync::OnceLock::new();
    TABLE.get_or_init(|| {
        std::array::from_fn(|byte| {
            let value = byte as f32 / 255.0;
            if value <= 0.04045 { value / 12.92 } else { libm::powf((value + 0.055) / 1.055, 2.4) }
        })
    })
}

/// sRGB to square roots of light, with alpha as it is.
fn take_roots(texels: &mut [u8]) {
    let roots = linear_table().map(|light| (255.0 * light.sqrt()).round() as u8);
    for [colors @ .., _] in texels.as_chunks_mut::<4>().0 {
        *colors = colors.map(|byte| roots[usize::from(byte)]);
    }
}

/// The byte of sRGB whose light is nearest.
fn encode(light: f32) -> u8 {
    // For each of so many steps of light, the first byte that is as bright as it: near black one byte has almost a step.
    const STEPS: usize = 4096;
    static FIRST: std::sync::OnceLock<Vec<u8>> = std::sync::OnceLock::new();
    let table = linear_table();
    let first = FIRST.get_or_init(|| {
        let first = |step: usize| table.partition_point(|&known| known < step as f32 / STEPS as f32);
        (0..=STEPS).map(|step| first(step).min(255) as u8).collect()
    });
    let mut above = usize::from(first[((light * STEPS as f32) as usize).min(STEPS)]);
    while above < 255 && table[above] < light {
        above += 1;
    }
    if above > 0 && light - table[above - 1] < table[above] - light { above as u8 - 1 } else { above as u8 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checkered(a: u8, b: u8) -> Image {
        let pixels: Vec<u8> = (0..16).flat_map(|p| [if (p + p / 4) % 2 == 0 { a } else { b }; 4]).collect();
        Image { name: "checkers".into(), width_px: 4, height_px: 4, levels: vec![pixels.into()] }
    }

    #[test]
    fn coarser_faces_of_the_sky_keep_its_light() {
        let light = |texel: usize| [texel as f32, 0.5, 60.0 - texel as f32, 1.0];
        let pixels: Vec<u8> = (0..64).flat_map(light).map(f16::from_f32).flat_map(f16::to_le_bytes).collect();
        let face = HdrImage { name: "face".into(), width_px: 8, height_px: 8, pixels: pixels.clone().into() };
        let all = radiance_levels(&face, 3);
        assert_eq!(all[..512], pixels);
        let values = |bytes: &[u8]| -> Vec<f32> {
            bytes.as_chunks().0.iter().map(|&bytes| f16::from_le_bytes(bytes).to_f32()).collect()
        };
        let (second, third) = (values(&all[512..640]), values(&all[640..]));
        assert_eq!([second.len(), third.len()], [64, 16]);
        assert_eq!(second[..4], [4.5, 0.5, 55.5, 1.0], "of texels 0, 1, 8 and 9");
        let mean = |values: &[f32]| values.iter().step_by(4).sum::<f32>() / (values.len() / 4) as f32;
        assert_eq!([mean(&second), mean(&third)], [31.5, 31.5]);
    }

    #[test]
    fn mips_go_down_to_one_pixel_and_keep_the_mean_of_light() {
        let levels = mip_levels(&checkered(0, 255), ImageUse::Color);
        assert_eq!(levels.iter().map(|level| level.len()).collect::<Vec<_>>(), [64, 16, 4]);
        // Half the light of white is sRGB 188, not 128; alpha is no light.
        assert_eq!(levels[2][..], [188, 188, 188, 128]);
        assert_eq!(mip_levels(&checkered(0, 255), ImageUse::Data)[2][..], [128; 4]);
    }

    #[test]
    fn cutouts_cover_as_much_at_every_level() {
        let pixels = (0..64u32 * 64).flat_map(|n| {
            let (x, y) = (n % 64, n / 64);
            [90, 120, 60, if (x * x + 3 * y) % 7 < 2 || x.abs_diff(y) < 9 { 255 } else { 0 }]
        });
        let pixels: Vec<u8> = pixels.collect();
        let image = Image { name: "leaf".into(), width_px: 64, height_px: 64, levels: vec![pixels.into()] };
        let share = |level: &Arc<[u8]>| {
            let alphas = alphas(level);
            Alpha::new(&alphas, alphas.len().isqrt()).share(CUTOFF)
        };
        let [cut, plain] = [ImageUse::Cutout, ImageUse::Color].map(|kind| mip_levels(&image, kind));
        for level in &cut[1..4] {
            assert!((share(level) - share(&cut[0])).abs() < 0.02, "{} of {}", share(level), share(&cut[0]));
        }
        assert!((share(&plain[3]) - share(&plain[0])).abs() > 0.1, "plain averages would not");
    }

    #[test]
    fn the_mean_of_an_image_is_that_of_its_light() {
        let pixels: Vec<u8> =
            (0..64u32 * 64).flat_map(|n| [if n % 64 < 32 { 255 } else { 0 }, 188, 0, 9]).collect();
        let image = Image { name: "halves".into(), width_px: 64, height_px: 64, levels: vec![pixels.into()] };
        assert!(mean_light(&image).abs_diff_eq(Vec3::new(0.5, 0.503, 0.0), 0.02), "{}", mean_light(&image));
    }

    #[test]
    fn a_file_s_own_mips_are_left_as_they_are() {
        let mut image = checkered(10, 20);
        image.levels.push(vec![7; 16].into());
        assert_eq!(mip_levels(&image, ImageUse::Color), image.levels);
    }

    #[test]
    fn every_byte_of_srgb_comes_back() {
        for byte in 0..=255u8 {
            assert_eq!(encode(linear_table()[usize::from(byte)]), byte);
        }
    }
}
