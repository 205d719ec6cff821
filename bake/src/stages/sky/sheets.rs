//! Clouds and cirrus → horizontal sheets with alpha that tile and can drift (thesis 5.1): what one sees of the layer
//! looking straight up, in its light, tone-mapped to sRGB.

use glam::Vec3A;
use rayon::prelude::*;

use super::cirrus::{self, Cirrus};
use super::clouds::Clouds;
use crate::model::{CloudLayer, Image8};

/// Pixels a side.
const SIDE: usize = 512;
/// Rays of the cumulus sheet a side; the picture is interpolated between.
const RAYS: usize = 160;

/// Sheets of the layers that there are, lowest first.
pub fn layers(clouds: Option<Clouds>, cirrus: Option<&Cirrus>) -> Vec<CloudLayer<Image8>> {
    let cumulus = clouds.map(|clouds| cumulus_sheet(&clouds.into_tiling()));
    let high = cirrus.map(cirrus_sheet);
    cumulus.into_iter().chain(high).collect()
}

/// Linear radiance → sRGB bytes, by Reinhard's curve with white at 4 and the standard transfer function.
struct Tone([u8; 4096]);

impl Tone {
    fn new() -> Self {
        let byte = |i: usize| {
            let x = i as f32 / 4095.0;
            let srgb = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * libm::powf(x, 1.0 / 2.4) - 0.055 };
            (srgb * 255.0 + 0.5) as u8
        };
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

fn cumulus_sheet(clouds: &Clouds) -> CloudLayer<Image8> {
    let extent_m = clouds.field.tile_m;
    let tone = Tone::new();
    let mut rays = vec![[0u8; 4]; RAYS * RAYS];
    rays.par_chunks_exact_mut(RAYS).enumerate().for_each(|(row, rays)| {
        for (column, ray) in rays.iter_mut().enumerate() {
            let place = |i: usize| (i as f32 + 0.5) / RAYS as f32 * extent_m;
            let seen = clouds.march_vertical(place(column), place(row));
            let alpha = 1.0 - seen.through;
            // Unpremultiplied; where there is nothing, the colour of a thin edge.
            let light = if alpha > 0.004 { seen.light / alpha } else { clouds.edge_light() };
            *ray = tone.rgba(light, alpha);
        }
    });
    CloudLayer { name: "cumulus".into(), altitude_m: clouds.field.base_m, extent_m, image: enlarged(&rays) }
}

/// The sheet at full size, interpolated with wrapping.
fn enlarged(rays: &[[u8; 4]]) -> Image8 {
    let mut image = Image8::new(SIDE as u32, SIDE as u32, 4);
    image.data.par_chunks_exact_mut(SIDE * 4).enumerate().for_each(|(row, out)| {
        let (y0, y1, fy) = neighbours(row);
        for (column, out) in out.chunks_exact_mut(4).enumerate() {
            let (x0, x1, fx) = neighbours(column);
            let corners = [(x0, y0), (x1, y0), (x0, y1), (x1, y1)].map(|(x, y)| rays[y * RAYS + x]);
            for (channel, byte) in out.iter_mut().enumerate() {
                let [a, b, c, d] = corners.map(|corner| f32::from(corner[channel]));
                let (near, far) = (a + (b - a) * fx, c + (d - c) * fx);
                *byte = (near + (far - near) * fy + 0.5) as u8;
            }
        }
    });
    image
}

fn neighbours(pixel: usize) -> (usize, usize, f32) {
    let at = (pixel as f32 + 0.5) * RAYS as f32 / SIDE as f32 - 0.5 + RAYS as f32;
    let whole = at as usize;
    (whole % RAYS, (whole + 1) % RAYS, at - whole as f32)
}

fn cirrus_sheet(sheet: &Cirrus) -> CloudLayer<Image8> {
    const { assert!(cirrus::SIDE == SIDE) };
    let color = Tone::new().rgba(sheet.source(0.4), 0.0);
    let mut image = Image8::new(SIDE as u32, SIDE as u32, 4);
    for (at, pixel) in image.data.chunks_exact_mut(4).enumerate() {
        let alpha = 1.0 - super::math::exp(-sheet.depth_at(at % SIDE, at / SIDE));
        pixel.copy_from_slice(&[color[0], color[1], color[2], (alpha * 255.0 + 0.5) as u8]);
    }
    CloudLayer {
        name: "cirrus".into(),
        altitude_m: cirrus::ALTITUDE_M,
        extent_m: cirrus::TILE_M,
        image: image,
    }
}
