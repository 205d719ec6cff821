//! How near each level of the land's detail may come, as bound for one picture: made anew when the picture's resolution, its
//! field of view or the error allowed changes, not while one walks.

use crate::gpu::Gpu;
use crate::lod::reach::{Reach, Roughness};
use crate::lod_mode::TerrainLodMode;

/// Steps by which pixels a radian are rounded up, in one doubling: a zoom does not make all anew for each picture.
const STEPS: f32 = 4.0;

/// Reaches, and the texture that the terrain's vertices read.
#[derive(Debug)]
pub struct BoundReach {
    pub reach: Reach,
    pub(super) texture: wgpu::Texture,
    /// Pixels a radian for each pixel of error, and whether by distance alone.
    made_for: (f32, bool),
}

impl BoundReach {
    pub(super) fn new(gpu: &Gpu, roughness: &Roughness) -> Self {
        let made_for = (1.0, false);
        let reach = roughness.reach(made_for.0);
        let [side, layers] = reach.texture_size();
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("reach"),
            size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let bound = Self { reach, texture, made_for };
        bound.write(gpu);
        bound
    }

    /// Makes reaches for pictures in which a radian has `focal_px` pixels and land may look `error_px` off.
    pub fn set(
        &mut self,
        gpu: &Gpu,
        roughness: &Roughness,
        mode: TerrainLodMode,
        focal_px: f32,
        error_px: f32,
    ) {
        let pixels = focal_px / error_px.max(f32::MIN_POSITIVE);
        let rounded = libm::exp2f((libm::log2f(pixels.clamp(1.0, 1e6)) * STEPS).ceil() / STEPS);
        let made_for = (rounded, mode == TerrainLodMode::Distance);
        if self.made_for != made_for {
            self.made_for = made_for;
            let by_distance = made_for.1;
            self.reach =
                if by_distance { roughness.reach_by_distance(rounded) } else { roughness.reach(rounded) };
            self.write(gpu);
        }
    }

    fn write(&self, gpu: &Gpu) {
        let texels = self.reach.texels();
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(self.texture.width() * size_of::<[f32; 4]>() as u32),
            rows_per_image: Some(self.texture.height()),
        };
        let bytes = bytemuck::cast_slice(&texels);
        gpu.queue.write_texture(self.texture.as_image_copy(), bytes, layout, self.texture.size());
    }
}
