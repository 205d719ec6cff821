//! What light anyone's file is shown in, and how bright that is seen.

use glam::Vec3;

use super::lamps::{LAMPS, Lamp, lamps};
use crate::scene::{Alpha, Asset, DirectionalLight, Slot, Staging, Surface, Texture};

/// The most suns that are drawn, as in `asset.wgsl`.
const MAX_LIGHTS: usize = 2;
/// What the strongest sun of a file gives a white surface that faces it, as radiance. What unit a file's numbers are in
/// cannot be told: exporters differ by a factor of 683 and more.
const SUN_RADIANCE: f32 = 1.8;
/// How bright the room is beside a sun of the file.
const ROOM_BESIDE_SUN: f32 = 0.3;
/// What is shown as it is: things of this colour on average. A darker one is shown brighter, by far less than makes it as bright.
const USUAL_ALBEDO: f32 = 0.18;
const ADAPTATION: f32 = 0.3;
/// Texels of a picture that are asked for its colour.
const ASKED_TEXELS: usize = 4096;

/// `Studio` of `asset.wgsl`, which says what each field is; a test compares the two.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct StudioUniform {
    pub lights: [[[f32; 4]; 2]; MAX_LIGHTS],
    pub room: f32,
    pub radius: f32,
    pub cell: f32,
    pub middle: f32,
    pub lamps: [Lamp; LAMPS],
}

pub(super) fn studio(asset: &Asset, staging: &Staging) -> StudioUniform {
    let brightness = |light: &DirectionalLight| light.irradiance.max_element();
    let mut suns: Vec<&DirectionalLight> = asset.lights.iter().collect();
    suns.sort_by(|a, b| brightness(b).total_cmp(&brightness(a)));
    let strongest = suns.first().map_or(0.0, |sun| brightness(sun));
    let mut lights = [[[0.0; 4]; 2]; MAX_LIGHTS];
    for (slot, sun) in lights.iter_mut().zip(&suns) {
        let irradiance = sun.irradiance * (SUN_RADIANCE * std::f32::consts::PI / strongest);
        *slot = [sun.direction.extend(0.0).to_array(), irradiance.extend(0.0).to_array()];
    }
    StudioUniform {
        lights,
        room: if suns.is_empty() { 1.0 } else { ROOM_BESIDE_SUN },
        radius: staging.radius_m,
        cell: staging.cell_m,
        middle: staging.middle_m,
        lamps: lamps(suns.first().map(|sun| sun.direction)),
    }
}

/// A factor on radiance by how light the file's materials are, each as often as it has triangles.
pub(super) fn exposure(asset: &Asset) -> f32 {
    let albedos: Vec<f64> = asset.surfaces.iter().map(|surface| f64::from(albedo(surface))).collect();
    let (mut sum, mut triangles) = (0.0, 0.0);
    for shape in &asset.shapes {
        for part in shape.levels.first().into_iter().flat_map(|level| &level.parts) {
            let often = f64::from(part.range.count) * shape.copies.len() as f64;
            sum += often * albedos[part.surface];
            triangles += often;
        }
    }
    let mean = if triangles > 0.0 { (sum / triangles) as f32 } else { USUAL_ALBEDO };
    libm::powf(USUAL_ALBEDO / mean.clamp(0.02, 1.0), ADAPTATION)
}

/// How much of all light it gives back, about.
fn albedo(surface: &Surface) -> f32 {
    let [r, g, b, _] = surface.color;
    let factor = luma(Vec3::new(r, g, b));
    factor
        * surface.textures[Slot::Color as usize]
            .as_ref()
            .map_or(1.0, |texture| mean_of(texture, surface.alpha))
}

fn luma(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// Of what of it is seen.
fn mean_of(texture: &Texture, alpha: Alpha) -> f32 {
    let texels = texture.image.levels.first().map_or(&[][..], |level| level.as_chunks::<4>().0);
    let cutoff = if let Alpha::Mask(cutoff) = alpha { 255.0 * cutoff } else { 0.0 };
    let linear = |byte: u8| libm::powf(f32::from(byte) / 255.0, 2.2);
    let asked = texels.iter().step_by((texels.len() / ASKED_TEXELS).max(1) | 1);
    let seen: Vec<f32> = asked
        .filter(|texel| f32::from(texel[3]) >= cutoff)
        .map(|&[r, g, b, _]| luma(Vec3::new(linear(r), linear(g), linear(b))))
        .collect();
    if seen.is_empty() { 1.0 } else { seen.iter().sum::<f32>() / seen.len() as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_dark_is_shown_a_little_brighter_and_what_is_white_darker() {
        use crate::scene::{Part, Range, Shape, ShapeLevel};
        let exposure_of = |grey: f32| {
            let part = Part { surface: 0, range: Range { first: 0, count: 300 } };
            let level = ShapeLevel { error_m: 0.0, parts: vec![part] };
            let copies = vec![glam::DAffine3::IDENTITY];
            let surface = Surface { color: [grey, grey, grey, 1.0], ..Surface::default() };
            let shapes = vec![Shape { levels: vec![level], copies, ..Shape::default() }];
            exposure(&Asset { shapes, surfaces: vec![surface], ..Asset::default() })
        };
        let (white, usual, dark) = (exposure_of(1.0), exposure_of(0.18), exposure_of(0.05));
        assert!((usual - 1.0).abs() < 1e-3 && white < 0.7 && dark > 1.3, "{white} {usual} {dark}");
        assert!(white > usual * 0.18 && 0.05 * dark < 0.18 * usual, "dark things stay darker");
        assert!((exposure(&Asset::default()) - 1.0).abs() < 1e-3, "nothing to see");
    }
}
