//! The sky's images.

use std::sync::Arc;

use glam::{Vec2, Vec3, Vec4};
use half::f16;
use rayon::prelude::*;

use super::{ImageUse, Uploader};
use crate::gpu::flat;
use crate::scene::{HdrImage, Image, Sky};

/// Sky images on the device.
#[derive(Debug)]
pub struct SkyTextures {
    /// With clouds.
    pub cube: Arc<wgpu::Texture>,
    /// Without, down to the horizon: see [`dome`].
    pub clear_dome: Arc<wgpu::Texture>,
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
            clear_dome: self.dome(&sky.images.clear_faces),
            cumulus: texture("cumulus"),
            cirrus: texture("cirrus"),
            sheets_m: [a, b, c, d],
        }
    }

    fn dome(&self, faces: &[HdrImage]) -> Arc<wgpu::Texture> {
        let names: Vec<&str> = faces.iter().map(|face| face.name.as_str()).collect();
        self.shared(format!("dome {}", names.join(" ")), || {
            let (format, usage) = (wgpu::TextureFormat::Rgba16Float, wgpu::TextureUsages::TEXTURE_BINDING);
            let texture = flat("clear sky", [DOME_PX as u32; 2], format, usage);
            self.gpu.texture(&texture, bytemuck::cast_slice(&dome(faces)))
        })
    }
}

/// Texels along a side of the clear sky: no coarser than those of its cube are, 128 along a face.
const DOME_PX: usize = 256;

/// What a cube has above the horizon, row by row, where `on_dome` of `common.wgsl` asks for it.
fn dome(faces: &[HdrImage]) -> Vec<[f16; 4]> {
    let along = |texel: usize| 2.0 * texel as f32 / (DOME_PX - 1) as f32 - 1.0;
    let texel = |number: usize| {
        let [u, v] = [along(number % DOME_PX), along(number / DOME_PX)];
        // East and south, as parts of the way from straight up to the horizon.
        let [x, z] = [0.5 * (u + v), 0.5 * (u - v)];
        smooth(faces, Vec3::new(x, 1.0 - x.abs() - z.abs(), z)).to_array().map(f16::from_f32)
    };
    (0..DOME_PX * DOME_PX).into_par_iter().map(texel).collect()
}

/// Between the four texels of a cube that are nearest to a direction, also where its faces meet.
fn smooth(faces: &[HdrImage], way: Vec3) -> Vec4 {
    let (face, place) = on_face(way);
    let side = faces[face].width_px as f32;
    let at = 0.5 * side * (place + 1.0) - 0.5;
    let part = at - at.floor();
    let texel = |x: f32, y: f32| {
        let place = 2.0 * (at.floor() + Vec2::new(x, y) + 0.5) / side - 1.0;
        nearest(faces, towards(face, place))
    };
    let rows = [0.0, 1.0].map(|y| texel(0.0, y).lerp(texel(1.0, y), part.x));
    rows[0].lerp(rows[1], part.y)
}

fn nearest(faces: &[HdrImage], way: Vec3) -> Vec4 {
    let (face, place) = on_face(way);
    let image = &faces[face];
    let side = image.width_px as usize;
    let [x, y] = (0.5 * side as f32 * (place + 1.0)).to_array().map(|along| (along as usize).min(side - 1));
    let texel = &image.pixels[8 * (y * side + x)..];
    Vec4::from_array(std::array::from_fn(|part| {
        f16::from_le_bytes([texel[2 * part], texel[2 * part + 1]]).to_f32()
    }))
}

/// Faces in the order of their axes, +x, −x, +y and so on: its axis, and what points right and down on it, which seen from within
/// is mirrored, as it is in all cube maps.
const FACES: [[Vec3; 3]; 6] = [
    [Vec3::X, Vec3::NEG_Z, Vec3::NEG_Y],
    [Vec3::NEG_X, Vec3::Z, Vec3::NEG_Y],
    [Vec3::Y, Vec3::X, Vec3::Z],
    [Vec3::NEG_Y, Vec3::X, Vec3::NEG_Z],
    [Vec3::Z, Vec3::X, Vec3::NEG_Y],
    [Vec3::NEG_Z, Vec3::NEG_X, Vec3::NEG_Y],
];

/// Which face of a cube a direction meets, and where on it: right and down, −1 to 1.
fn on_face(way: Vec3) -> (usize, Vec2) {
    let axis = way.abs().max_position();
    let face = 2 * axis + usize::from(way[axis] < 0.0);
    let [_, right, down] = FACES[face];
    (face, Vec2::new(way.dot(right), way.dot(down)) / way[axis].abs())
}

fn towards(face: usize, place: Vec2) -> Vec3 {
    let [ahead, right, down] = FACES[face];
    ahead + place.x * right + place.y * down
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dome_has_each_direction_where_shaders_ask_for_it() {
        let side = 128;
        // Each texel is the direction in which it is seen.
        let face = |number: usize| {
            let texels = (0..side * side).map(|texel| {
                let place = [texel % side, texel / side].map(|t| 2.0 * (t as f32 + 0.5) / side as f32 - 1.0);
                towards(number, Vec2::from_array(place)).normalize().extend(1.0)
            });
            let pixels: Vec<u8> = texels
                .flat_map(|texel| texel.to_array())
                .flat_map(|part| f16::from_f32(part).to_le_bytes())
                .collect();
            HdrImage {
                name: String::new(),
                width_px: side as u32,
                height_px: side as u32,
                pixels: pixels.into(),
            }
        };
        let dome = dome(&[0, 1, 2, 3, 4, 5].map(face));
        for (number, texel) in dome.iter().enumerate() {
            let way = Vec4::from_array(texel.map(f16::to_f32)).truncate().normalize();
            // `on_dome` of `common.wgsl`.
            let flat = Vec2::new(way.x, way.z) / (way.x.abs() + way.y.abs() + way.z.abs());
            let at = 0.5 * (Vec2::new(flat.x + flat.y, flat.x - flat.y) + 1.0) * (DOME_PX - 1) as f32;
            let expected = Vec2::new((number % DOME_PX) as f32, (number / DOME_PX) as f32);
            // Near the corners of the cube there is no fourth texel.
            assert!((at - expected).length() < 0.3, "texel {expected}: {way} at {at}");
        }
        // No seam where faces meet.
        let step = |a: usize, b: usize| {
            let [a, b] = [a, b].map(|at| Vec4::from_array(dome[at].map(f16::to_f32)));
            (a - b).truncate().length()
        };
        let steps = (0..DOME_PX * (DOME_PX - 1)).map(|at| step(at, at + DOME_PX));
        let longest = steps.fold(0.0, f32::max);
        assert!(longest < 0.02, "{longest}");
    }

    #[test]
    fn faces_are_those_of_a_cube_map() {
        for (face, [ahead, right, down]) in FACES.into_iter().enumerate() {
            assert_eq!(right.cross(down), -ahead, "face {face}");
            assert_eq!(on_face(ahead).0, face);
        }
    }
}
