//! Clouds and cirrus → horizontal cloud layers with alpha that tile and can drift (thesis 5.1): as seen
//! straight up, tone-mapped to sRGB.

use glam::Vec3A;

use super::cirrus::{self, Cirrus};
use super::clouds::Clouds;
use super::math::exp;
use crate::math::{lerp_array, srgb_from_linear};
use crate::model::{CloudLayer, Image8};
use crate::raster::{square, square_image};

/// Pixels a side.
const SIDE: usize = 512;
/// Rays of the cumulus layer a side; the image is interpolated between.
const RAYS: usize = 160;

/// All layers, lowest first.
pub fn layers(clouds: Option<Clouds>, cirrus: Option<&Cirrus>) -> Vec<CloudLayer<Image8>> {
    let cumulus = clouds.map(|clouds| cumulus_layer(&clouds.into_tiling()));
    let high = cirrus.map(cirrus_layer);
    cumulus.into_iter().chain(high).collect()
}

/// Linear radiance → sRGB bytes, by Reinhard's curve with white at 4 and the standard transfer function.
struct ToneMapping([u8; 4096]);

impl ToneMapping {
    fn new() -> Self {
        let byte = |i: usize| (srgb_from_linear(i as f32 / 4095.0) * 255.0 + 0.5) as u8;
        Self(std::array::from_fn(byte))
    }

    fn byte(&self, radiance: f32) -> u8 {
        let x = radiance.max(0.0);
        let mapped = (x * (1.0 + x / 16.0) / (1.0 + x)).min(1.0);
        self.0[(mapped * 4095.0 + 0.5) as usize]
    }

    fn rgba(&self, light: Vec3A, alpha: f32) -> [u8; 4] {
        let alpha = (alpha.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        [self.byte(light.x), self.byte(light.y), self.byte(light.z), alpha]
    }
}

fn cumulus_layer(clouds: &Clouds) -> CloudLayer<Image8> {
    let extent_m = clouds.field.tile_m;
    let tone = ToneMapping::new();
    let place = |i: usize| (i as f32 + 0.5) / RAYS as f32 * extent_m;
    let rays = square(RAYS, |column, row| {
        let seen = clouds.march_vertical(place(column), place(row));
        let alpha = 1.0 - seen.through;
        // Unpremultiplied; where there is nothing, the colour of a thin edge.
        let light = if alpha > 0.004 { seen.light / alpha } else { clouds.edge_light() };
        tone.rgba(light, alpha)
    });
    CloudLayer { name: "cumulus".into(), altitude_m: clouds.field.base_m, extent_m, image: enlarged(&rays) }
}

/// The layer at full size, interpolated with wrapping.
fn enlarged(rays: &[[u8; 4]]) -> Image8 {
    square_image(SIDE, |row| {
        let (y0, y1, fy) = neighbours(row);
        move |column| {
            let (x0, x1, fx) = neighbours(column);
            let [a, b, c, d] =
                [(x0, y0), (x1, y0), (x0, y1), (x1, y1)].map(|(x, y)| rays[y * RAYS + x].map(f32::from));
            let mixed: [f32; 4] = lerp_array(lerp_array(a, b, fx), lerp_array(c, d, fx), fy);
            mixed.map(|byte| (byte + 0.5) as u8)
        }
    })
}

fn neighbours(pixel: usize) -> (usize, usize, f32) {
    let at = (pixel as f32 + 0.5) * RAYS as f32 / SIDE as f32 - 0.5 + RAYS as f32;
    let whole = at as usize;
    (whole % RAYS, (whole + 1) % RAYS, at - whole as f32)
}

fn cirrus_layer(cirrus: &Cirrus) -> CloudLayer<Image8> {
    const { assert!(cirrus::SIDE == SIDE) };
    let [r, g, b, _] = ToneMapping::new().rgba(cirrus.source(0.4), 0.0);
    let image = square_image(SIDE, |row| {
        move |column| {
            let alpha = 1.0 - exp(-cirrus.depth_at(column, row));
            [r, g, b, (alpha * 255.0 + 0.5) as u8]
        }
    });
    CloudLayer { name: "cirrus".into(), altitude_m: cirrus::ALTITUDE_M, extent_m: cirrus::TILE_M, image }
}
