//! The land's textures.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use super::far_sun::FarSun;
use super::ground_kinds;
use super::texture::{mean_light, mip_levels};
use super::{ImageUse, Lake, PlantBuffers, Ring, Uploader};
use crate::lod::block;
use crate::lod::nested::Nested;
use crate::scene::{GroundDetail, Heightfield, Image, Scene};

/// The land on the device.
#[derive(Debug)]
pub struct GroundBuffers {
    /// How far its coarser triangulations are from it, and where.
    pub nested: Nested,
    /// The same on the device: error and radius of each sample.
    pub bounds: Arc<wgpu::Texture>,
    /// One float a sample.
    pub heights: Arc<wgpu::Texture>,
    /// Albedo over the field.
    pub color: Arc<wgpu::Texture>,
    /// The same on average.
    pub albedo_linear: Vec3,
    /// Whether water stands on it: the colour's alpha is less there.
    pub is_wet: bool,
    /// x and z of its normals, a texel a sample.
    pub normals: Arc<wgpu::Texture>,
    /// Parts of the tiling textures 1 to 4.
    pub weights: Arc<wgpu::Texture>,
    /// Light that arrives: sky, sun, what the land leaves visible of the sun, what trees let through of it.
    pub light: Arc<wgpu::Texture>,
    /// Tiling textures, a layer each, as [`packed`] has them.
    pub details: Arc<wgpu::Texture>,
    /// Of the ground of each tiling texture: linear colour on average, and metres that a tile covers.
    pub kinds: [[f32; 4]; ground_kinds::KINDS],
    /// The coarse land around the field.
    pub ring: Ring,
    /// What trees leave there of the sun.
    pub far_shade: wgpu::Texture,
    /// Where water is, if there is any.
    pub lake: Option<Lake>,
    /// Small plants, stones and leaves.
    pub plants: PlantBuffers,
}

impl Uploader {
    pub(super) fn ground(&self, scene: &Scene, far_sun: &FarSun) -> Result<GroundBuffers, String> {
        let ground = &scene.ground;
        let surface = &ground.surface;
        if surface.details.len() != 5 {
            return Err(format!("the ground has {} tiling textures instead of 5", surface.details.len()));
        }
        if ground.field.side <= 1 << block::BLOCK_BITS {
            let side = ground.field.side;
            return Err(format!("a heightfield of {side} samples a side is too small to be drawn"));
        }
        let (field, nested) = (&ground.field, Nested::of(&ground.field));
        let half_m = 0.5 * field.extent_m();
        let albedo_linear = mean_light(&surface.color);
        let samples = |what: &str, format, bytes: &[u8]| {
            self.samples(&format!("{what} {}", ground.name), field.side, format, bytes)
        };
        Ok(GroundBuffers {
            heights: samples(
                "heights",
                wgpu::TextureFormat::R32Float,
                bytemuck::cast_slice(&field.heights_m),
            ),
            bounds: samples("bounds", wgpu::TextureFormat::Rg32Float, bytemuck::cast_slice(&nested.bounds)),
            nested,
            normals: self.shared(format!("normals {}", ground.name), || {
                self.array(&[&normals(field)], ImageUse::Data, 1)
            }),
            color: self.image(&surface.color, ImageUse::Albedo),
            albedo_linear,
            is_wet: is_wet(&surface.color),
            weights: self.image(&surface.weights, ImageUse::Data),
            light: self.image(&surface.light, ImageUse::Data),
            details: self.tiling(&surface.details)?,
            kinds: ground_kinds::of(surface, albedo_linear),
            ring: self.ring(&ground.apron, half_m, far_sun),
            far_shade: self.far_shade(&scene.trees, &ground.apron, half_m, scene.sky.light.sun_direction),
            lake: Lake::of(ground),
            plants: self.plants(ground),
        })
    }

    /// Tiling textures as the layers of one.
    fn tiling(&self, details: &[GroundDetail<Image>]) -> Result<Arc<wgpu::Texture>, String> {
        let images: Vec<&Image> =
            details.iter().flat_map(|detail| [&detail.detail, &detail.normal]).collect();
        let size = |image: &Image| (image.width_px, image.height_px);
        if let Some(odd) = images.iter().find(|&&image| size(image) != size(images[0])) {
            let first = images[0];
            return Err(format!(
                "tiling textures differ in size: {} is {} × {}, {} is {} × {}",
                first.name, first.width_px, first.height_px, odd.name, odd.width_px, odd.height_px
            ));
        }
        let names: Vec<&str> = images.iter().map(|image| image.name.as_str()).collect();
        Ok(self.shared(format!("tiling {}", names.join(" ")), || {
            let packed: Vec<Image> = details.par_iter().map(packed).collect();
            self.array(&packed.iter().collect::<Vec<_>>(), ImageUse::Data, 1)
        }))
    }
}

/// From this alpha of the ground's colour on no water stands there.
pub const DRY_ALPHA: f32 = 0.7;

fn is_wet(color: &Image) -> bool {
    let is_wet = |texel: &[u8]| f32::from(texel[3]) < 255.0 * DRY_ALPHA;
    color.levels.first().is_some_and(|texels| texels.chunks_exact(4).any(is_wet))
}

/// x and z of the normal at each sample.
fn normals(field: &Heightfield) -> Image {
    let texel = |n: u32| {
        let normal = field.normal_at(n % field.side, n / field.side);
        [byte(normal.x), byte(normal.z), 0, 255]
    };
    let texels: Vec<[u8; 4]> = (0..field.side * field.side).into_par_iter().map(texel).collect();
    Image {
        name: "normals".into(),
        width_px: field.side,
        height_px: field.side,
        levels: vec![texels.into_flattened().into()],
    }
}

/// A part of a unit vector.
fn byte(part: f32) -> u8 {
    (127.5 + 127.5 * part).round() as u8
}

/// Colour and normal in one image: red and blue, of which the shader makes green, then x and y of the normal, of which it makes z.
fn packed(detail: &GroundDetail<Image>) -> Image {
    let [colors, normals] = [&detail.detail, &detail.normal].map(|image| mip_levels(image, ImageUse::Data));
    let levels = colors.iter().zip(&normals).map(|(colors, normals)| {
        let texels = colors.as_chunks::<4>().0.iter().zip(normals.as_chunks::<4>().0);
        let texels = texels.map(|(&[r, _, b, _], &normal)| {
            let [x, y] = leaning(normal);
            [r, b, x, y]
        });
        texels.collect::<Vec<_>>().into_flattened().into()
    });
    Image { levels: levels.collect(), ..detail.detail.clone() }
}

/// x and y of a mean of normals once it is as long as a normal.
fn leaning([x, y, z, _]: [u8; 4]) -> [u8; 2] {
    let mean = Vec3::new(f32::from(x), f32::from(y), f32::from(z)) - 127.5;
    let normal = mean.normalize_or(Vec3::Z);
    [normal.x, normal.y].map(byte)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(name: &str, pixel: impl Fn(u32) -> [u8; 4]) -> Image {
        let pixels: Vec<u8> = (0..4).flat_map(pixel).collect();
        Image { name: name.into(), width_px: 2, height_px: 2, levels: vec![pixels.into()] }
    }

    #[test]
    fn packed_tiles_keep_red_and_blue_and_the_direction_of_mean_normals() {
        // Half of it leans to the right by 60°, the other half not at all: on average by 30°.
        let leaning = |n: u32| if n < 2 { [238, 128, 191, 255] } else { [128, 128, 255, 255] };
        let tile = GroundDetail {
            name: "grass".into(),
            detail: image("tones", |n| [40 + n as u8, 99, 200, 255]),
            normal: image("normals", leaning),
            tile_m: 3.0,
        };
        let levels = packed(&tile).levels;
        assert_eq!(levels[0][..8], [40, 200, 238, 128, 41, 200, 238, 128]);
        let [red, blue, x, y] = levels[1][..] else { panic!("{} bytes for one pixel", levels[1].len()) };
        assert_eq!([red, blue, y], [42, 200, 128]);
        assert!(x.abs_diff(191) <= 1, "sin 30° is 191, not {x}");
    }
}
