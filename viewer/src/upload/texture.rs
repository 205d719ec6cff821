//! Pictures → textures with all their mip levels.

use std::sync::Arc;

use super::Uploader;
use crate::gpu::flat;
use crate::scene::{HdrPicture, Picture};

/// What a picture's numbers mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureUse {
    /// Colour in sRGB.
    Color,
    /// Numbers: normals, weights, light.
    Data,
}

impl PictureUse {
    fn format(self) -> wgpu::TextureFormat {
        match self {
            Self::Color => wgpu::TextureFormat::Rgba8UnormSrgb,
            Self::Data => wgpu::TextureFormat::Rgba8Unorm,
        }
    }
}

impl Uploader {
    /// A picture as a texture. Mip levels that its file brings are used as they are (leaves keep their coverage by
    /// them); a picture without gets averages.
    pub(super) fn picture(&self, picture: &Picture, kind: PictureUse) -> Arc<wgpu::Texture> {
        self.shared(format!("{kind:?} {}", picture.name), || self.array(&[picture], kind))
    }

    /// Several pictures of one size as the layers of one texture.
    pub(super) fn layers(
        &self,
        pictures: &[&Picture],
        kind: PictureUse,
    ) -> Result<Arc<wgpu::Texture>, String> {
        let first = pictures.first().ok_or("there are no tiling textures")?;
        let odd = pictures.iter().find(|p| (p.width_px, p.height_px) != (first.width_px, first.height_px));
        if let Some(odd) = odd {
            return Err(format!(
                "tiling textures differ in size: {} is {} × {}, {} is {} × {}",
                first.name, first.width_px, first.height_px, odd.name, odd.width_px, odd.height_px
            ));
        }
        let names: Vec<&str> = pictures.iter().map(|picture| picture.name.as_str()).collect();
        Ok(self.shared(format!("{kind:?} {}", names.join(" ")), || self.array(pictures, kind)))
    }

    fn array(&self, pictures: &[&Picture], kind: PictureUse) -> wgpu::Texture {
        let chains: Vec<Vec<Arc<[u8]>>> = pictures.iter().map(|picture| chain(picture, kind)).collect();
        let levels = chains.iter().map(Vec::len).min().unwrap_or(1);
        let (first, usage) = (pictures[0], wgpu::TextureUsages::TEXTURE_BINDING);
        let mut texture = flat(&first.name, [first.width_px, first.height_px], kind.format(), usage);
        texture.size.depth_or_array_layers = pictures.len() as u32;
        texture.mip_level_count = levels as u32;
        let texels: Vec<&[u8]> = chains.iter().flat_map(|chain| &chain[..levels]).map(Arc::as_ref).collect();
        self.gpu.texture(&texture, &texels.concat())
    }

    /// Six faces of half floats, all squares of one size, as a cube.
    pub(super) fn cube(&self, faces: &[HdrPicture]) -> Arc<wgpu::Texture> {
        let names: Vec<&str> = faces.iter().map(|face| face.name.as_str()).collect();
        self.shared(names.join(" "), || {
            let (format, usage) = (wgpu::TextureFormat::Rgba16Float, wgpu::TextureUsages::TEXTURE_BINDING);
            let mut texture = flat("sky", [faces[0].width_px, faces[0].height_px], format, usage);
            texture.size.depth_or_array_layers = faces.len() as u32;
            let texels: Vec<&[u8]> = faces.iter().map(|face| &*face.pixels).collect();
            self.gpu.texture(&texture, &texels.concat())
        })
    }

    /// A square of heights, one float a texel, for `textureLoad`.
    pub(super) fn heights(&self, name: &str, side: u32, heights_m: &[f32]) -> Arc<wgpu::Texture> {
        self.shared(format!("heights {name}"), || {
            let (format, usage) = (wgpu::TextureFormat::R32Float, wgpu::TextureUsages::TEXTURE_BINDING);
            let texture = flat("heights", [side, side], format, usage);
            self.gpu.texture(&texture, bytemuck::cast_slice(heights_m))
        })
    }
}

/// A picture's mip levels: its own, or averages down to one pixel.
fn chain(picture: &Picture, kind: PictureUse) -> Vec<Arc<[u8]>> {
    if picture.levels.len() > 1 {
        return picture.levels.clone();
    }
    let mut levels = picture.levels.clone();
    let (mut width, mut height) = (picture.width_px, picture.height_px);
    while let Some(finer) = levels.last().filter(|_| width > 1 || height > 1) {
        let coarser = halve(finer, width, height, kind);
        (width, height) = ((width / 2).max(1), (height / 2).max(1));
        levels.push(coarser.into());
    }
    levels
}

/// Averages of 2 × 2 pixels; colour is averaged as light.
fn halve(pixels: &[u8], width: u32, height: u32, kind: PictureUse) -> Vec<u8> {
    let (half_width, half_height) = ((width / 2).max(1), (height / 2).max(1));
    let mut halved = Vec::with_capacity((half_width * half_height * 4) as usize);
    let table = linear_table();
    for y in 0..half_height {
        for x in 0..half_width {
            let at = |dx: u32, dy: u32| {
                let (x, y) = ((2 * x + dx).min(width - 1), (2 * y + dy).min(height - 1));
                ((y * width + x) * 4) as usize
            };
            let four = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
            for channel in 0..4 {
                let plain = || (four.iter().map(|&p| u32::from(pixels[p + channel])).sum::<u32>() + 2) / 4;
                let value = if kind == PictureUse::Color && channel < 3 {
                    let light: f32 = four.iter().map(|&p| table[usize::from(pixels[p + channel])]).sum();
                    encode(0.25 * light)
                } else {
                    plain() as u8
                };
                halved.push(value);
            }
        }
    }
    halved
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

/// The byte of sRGB whose light is nearest.
fn encode(light: f32) -> u8 {
    let table = linear_table();
    let above = table.partition_point(|&known| known < light).min(255);
    if above > 0 && light - table[above - 1] < table[above] - light { above as u8 - 1 } else { above as u8 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checkered(a: u8, b: u8) -> Picture {
        let pixels: Vec<u8> = (0..16).flat_map(|p| [if (p + p / 4) % 2 == 0 { a } else { b }; 4]).collect();
        Picture { name: "checkers".into(), width_px: 4, height_px: 4, levels: vec![pixels.into()] }
    }

    #[test]
    fn mips_go_down_to_one_pixel_and_keep_the_mean_of_light() {
        let levels = chain(&checkered(0, 255), PictureUse::Color);
        assert_eq!(levels.iter().map(|level| level.len()).collect::<Vec<_>>(), [64, 16, 4]);
        // Half the light of white is sRGB 188, not 128; alpha is no light.
        assert_eq!(levels[2][..], [188, 188, 188, 128]);
        assert_eq!(chain(&checkered(0, 255), PictureUse::Data)[2][..], [128; 4]);
    }

    #[test]
    fn a_file_s_own_mips_are_left_as_they_are() {
        let mut picture = checkered(10, 20);
        picture.levels.push(vec![7; 16].into());
        assert_eq!(chain(&picture, PictureUse::Color), picture.levels);
    }

    #[test]
    fn every_byte_of_srgb_comes_back() {
        for byte in 0..=255u8 {
            assert_eq!(encode(linear_table()[usize::from(byte)]), byte);
        }
    }
}
