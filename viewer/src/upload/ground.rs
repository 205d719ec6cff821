//! The land's textures.

use std::sync::Arc;

use super::{ImageUse, Lake, PlantBuffers, Ring, Uploader};
use crate::lod::block;
use crate::lod::reach::Roughness;
use crate::scene::{Ground, GroundDetail, Image};

/// The land on the device.
#[derive(Debug)]
pub struct GroundBuffers {
    /// How far its coarser triangulations are from it, and where.
    pub roughness: Roughness,
    /// One float a sample.
    pub heights: Arc<wgpu::Texture>,
    /// Albedo over the field.
    pub color: Arc<wgpu::Texture>,
    /// Parts of the tiling textures 1 to 4.
    pub weights: Arc<wgpu::Texture>,
    /// Light that arrives: sky, sun, visibility of the sun.
    pub light: Arc<wgpu::Texture>,
    /// Tiling textures, a layer each.
    pub details: Arc<wgpu::Texture>,
    /// Their normals.
    pub detail_normals: Arc<wgpu::Texture>,
    /// Metres that each tile covers.
    pub tiles_m: [f32; 5],
    /// The coarse land around the field.
    pub ring: Ring,
    /// Where water is, if there is any.
    pub lake: Option<Lake>,
    /// Small plants, stones and leaves.
    pub plants: PlantBuffers,
}

impl Uploader {
    pub(super) fn ground(&self, ground: &Ground) -> Result<GroundBuffers, String> {
        let surface = &ground.surface;
        let pick = |choose: fn(&GroundDetail<Image>) -> &Image| {
            surface.details.iter().map(choose).collect::<Vec<_>>()
        };
        if surface.details.len() != 5 {
            return Err(format!("the ground has {} tiling textures instead of 5", surface.details.len()));
        }
        if ground.field.side <= 1 << block::BLOCK_BITS {
            let side = ground.field.side;
            return Err(format!("a heightfield of {side} samples a side is too small to be drawn"));
        }
        Ok(GroundBuffers {
            roughness: Roughness::of(&ground.field),
            heights: self.heights(&ground.name, ground.field.side, &ground.field.heights_m),
            color: self.image(&surface.color, ImageUse::Color),
            weights: self.image(&surface.weights, ImageUse::Data),
            light: self.image(&surface.light, ImageUse::Data),
            details: self.layers(&pick(|detail| &detail.detail), ImageUse::Data)?,
            detail_normals: self.layers(&pick(|detail| &detail.normal), ImageUse::Data)?,
            tiles_m: std::array::from_fn(|layer| surface.details[layer].tile_m),
            ring: self.ring(&ground.apron, 0.5 * ground.field.extent_m()),
            lake: Lake::of(ground),
            plants: self.plants(ground),
        })
    }
}
