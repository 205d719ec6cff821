//! The sky's images.

use std::sync::Arc;

use half::f16;

use super::{ImageUse, Uploader};
use crate::gpu::flat;
use crate::scene::{HdrImage, Image, Sky};

/// Sky images on the device.
#[derive(Debug)]
pub struct SkyTextures {
    /// With clouds.
    pub cube: Arc<wgpu::Texture>,
    /// Without.
    pub clear_cube: Arc<wgpu::Texture>,
    /// The same at the horizon: one row, once around, as `around` of `common.wgsl` has it.
    pub horizon: wgpu::Texture,
    /// Sheet of cumulus.
    pub cumulus: Arc<wgpu::Texture>,
    /// Sheet of cirrus.
    pub cirrus: Arc<wgpu::Texture>,
    /// Altitude and extent of the cumulus, then of the cirrus; extent 0 if there is none.
    pub sheets_m: [f32; 4],
}

impl Uploader {
    pub(super) fn sky(&self, sky: &Sky) -> SkyTextures {
        let layer = |name: &str| sky.images.layers.iter().find(|layer| layer.name == name);
        let none = Image::of_one_pixel([0; 4]);
        // Of sheets only alpha is read.
        let texture =
            |name: &str| self.image(layer(name).map_or(&none, |layer| &layer.image), ImageUse::Data);
        let measure = |name: &str| layer(name).map_or([0.0; 2], |layer| [layer.altitude_m, layer.extent_m]);
        let ([a, b], [c, d]) = (measure("cumulus"), measure("cirrus"));
        SkyTextures {
            cube: self.cube(&sky.images.faces),
            clear_cube: self.cube(&sky.images.clear_faces),
            horizon: self.horizon(&sky.images.clear_faces),
            cumulus: texture("cumulus"),
            cirrus: texture("cirrus"),
            sheets_m: [a, b, c, d],
        }
    }

    fn horizon(&self, faces: &[HdrImage]) -> wgpu::Texture {
        let row = horizon(faces);
        let (format, usage) = (wgpu::TextureFormat::Rgba16Float, wgpu::TextureUsages::TEXTURE_BINDING);
        let texture = flat("horizon", [row.len() as u32, 1], format, usage);
        self.gpu.texture(&texture, bytemuck::cast_slice(&row))
    }
}

/// What a cube has half-way between up and down, from north-east by east, south and west: east is +x, south +z. Faces are in the order of
/// their axes, +x, −x, +y and so on.
fn horizon(faces: &[HdrImage]) -> Vec<[f16; 4]> {
    let around = [0, 4, 1, 5].into_iter().filter_map(|side| faces.get(side));
    let middle = |face: &HdrImage| {
        let (wide, high) = (face.width_px as usize, face.height_px as usize);
        let at = move |x: usize, y: usize, part: usize| {
            let first = 8 * (y * wide + x) + 2 * part;
            f16::from_le_bytes([face.pixels[first], face.pixels[first + 1]]).to_f32()
        };
        let mean = move |x: usize| {
            let rows = [(high - 1) / 2, high / 2];
            std::array::from_fn(|part| f16::from_f32(0.5 * rows.map(|y| at(x, y, part)).iter().sum::<f32>()))
        };
        // Seen from within, all go from left to right around the other way.
        (0..wide).rev().map(mean).collect::<Vec<[f16; 4]>>()
    };
    around.flat_map(middle).collect()
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn the_horizon_goes_around_once() {
        let side = 8;
        // Each texel is the direction in which it is seen.
        let face = |number: usize| {
            let texels = (0..side * side).map(|texel| {
                let [u, v] = [texel % side, texel / side].map(|t| 2.0 * (t as f32 + 0.5) / side as f32 - 1.0);
                match number {
                    0 => Vec3::new(1.0, -v, -u),
                    1 => Vec3::new(-1.0, -v, u),
                    4 => Vec3::new(u, -v, 1.0),
                    5 => Vec3::new(-u, -v, -1.0),
                    _ => Vec3::ZERO,
                }
            });
            let pixels: Vec<u8> = texels
                .flat_map(|way| way.extend(1.0).to_array())
                .flat_map(|part| f16::from_f32(part).to_le_bytes())
                .collect();
            HdrImage {
                name: String::new(),
                width_px: side as u32,
                height_px: side as u32,
                pixels: pixels.into(),
            }
        };
        let row = horizon(&[0, 1, 2, 3, 4, 5].map(face));
        let ways: Vec<Vec3> =
            row.iter().map(|texel| Vec3::from_slice(&texel.map(f16::to_f32)).normalize()).collect();
        assert_eq!(ways.len(), 4 * side);
        for (number, way) in ways.iter().enumerate() {
            let next = ways[(number + 1) % ways.len()];
            assert!(
                way.y == 0.0 && way.dot(next) > 0.95 && way.cross(next).y < 0.0,
                "{number}: {way}, {next}"
            );
        }
        // From north-east to south-east the first quarter: by so much it is as a shader asks for it.
        assert!(ways[0].abs_diff_eq(Vec3::new(1.0, 0.0, -0.875).normalize(), 1e-3), "{}", ways[0]);
    }
}
