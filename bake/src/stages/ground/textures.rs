//! Nothing → five tiling detail textures of 512² with tangent-space normals: grass, rock, scree, snow and mud.
//!
//! Detail multiplies the ground's colour: its bytes have the mean 128 in every channel, so that bytes / 128 is the
//! factor. Normals are those of OpenGL and glTF: red to the right, green to the top of the picture, blue outwards.

use rayon::prelude::*;

use super::patterns::{self, Pattern};
use super::{SrgbTable, cover::KINDS};
use crate::model::{GroundDetail, Image8};

/// Texels a side.
pub(super) const SIDE: usize = 512;

/// Names of the textures, in order.
pub const TEXTURES: [&str; KINDS] = ["grass", "rock", "scree", "snow", "mud"];

/// Metres that a tile of each covers.
pub(super) const TILE_M: [f32; KINDS] = [3.0, 6.0, 4.0, 5.0, 4.0];

/// Mean linear value of each kind's [`tile_srgb`]: as bright as leaves room for its highlights, and for the brightest
/// ground of the kind as a factor of at most 1.
pub(super) const TILE_MEAN: [f32; KINDS] = [0.45, 0.45, 0.45, 0.86, 0.45];

/// The detail of the kth texture as a base colour for core glTF, whose factors cannot exceed 1: its linear mean is
/// `TILE_MEAN[k]`.
pub fn tile_srgb(kind: usize, detail: &Image8) -> Image8 {
    let encode = SrgbTable::new();
    let mean = TILE_MEAN[kind.min(KINDS - 1)];
    let table: Vec<u8> = (0..=255_u8).map(|byte| encode.byte(f32::from(byte) / 128.0 * mean)).collect();
    let data = detail.data.iter().map(|&byte| table[usize::from(byte)]).collect();
    Image8 { data, ..*detail }
}

/// Makes the five textures; they are the same for every scene.
pub fn textures() -> Vec<GroundDetail<Image8>> {
    type Make = fn() -> Pattern;
    let kinds: [(f32, Make); KINDS] = [
        (2.2, patterns::grass),
        (4.5, patterns::rock),
        (3.0, patterns::scree),
        (3.2, patterns::snow),
        (2.4, patterns::mud),
    ];
    kinds
        .into_par_iter()
        .zip(TEXTURES.into_par_iter().zip(TILE_M))
        .map(|((depth_px, make), (name, tile_m))| {
            let pattern = make();
            let (detail_srgb, normal) = (detail(&pattern), normals(&pattern.height, depth_px));
            GroundDetail { name: name.into(), detail: detail_srgb, normal, tile_m }
        })
        .collect()
}

/// Tones as bytes of mean 128.
fn detail(pattern: &Pattern) -> Image8 {
    let mut image = Image8::new(SIDE as u32, SIDE as u32, 3);
    for channel in 0..3 {
        let scale = scale_to_mean(&pattern.tone, channel);
        for (pixel, tone) in image.data.chunks_exact_mut(3).zip(&pattern.tone) {
            pixel[channel] = (tone[channel] * scale).clamp(0.0, 255.0) as u8;
        }
    }
    image
}

/// The factor that gives one channel the mean 128 after clamping to bytes, by the secant of its clamped mean.
fn scale_to_mean(tone: &[[f32; 3]], channel: usize) -> f32 {
    let mut scale = 1.0;
    for _ in 0..3 {
        // Truncation to bytes takes half a step off.
        let rows = tone
            .chunks_exact(SIDE)
            .map(|row| row.iter().map(|t| (t[channel] * scale).clamp(0.0, 255.0)).sum::<f32>());
        let mean = rows.sum::<f32>() / tone.len() as f32;
        scale *= 128.5 / mean.max(1e-3);
    }
    scale
}

/// Normals of a height that is 0 to 1 for `depth_px` texels.
fn normals(height: &[f32], depth_px: f32) -> Image8 {
    let mut image = Image8::new(SIDE as u32, SIDE as u32, 3);
    image.data.par_chunks_mut(SIDE * 3).enumerate().for_each(|(j, row)| {
        let line = |j: usize| &height[(j % SIDE) * SIDE..][..SIDE];
        let (above, here, below) = (line(j + SIDE - 1), line(j), line(j + 1));
        for (i, pixel) in row.chunks_exact_mut(3).enumerate() {
            let (west, east) = ((i + SIDE - 1) % SIDE, (i + 1) % SIDE);
            // Sobel, so that single texels do not glitter.
            let dx =
                above[east] + 2.0 * here[east] + below[east] - above[west] - 2.0 * here[west] - below[west];
            let dy = below[west] + 2.0 * below[i] + below[east] - above[west] - 2.0 * above[i] - above[east];
            let (nx, ny) = (-dx * 0.125 * depth_px, dy * 0.125 * depth_px);
            let length = (nx * nx + ny * ny + 1.0).sqrt();
            for (byte, n) in pixel.iter_mut().zip([nx, ny, 1.0]) {
                *byte = (127.5 + 127.0 * n / length + 0.5) as u8;
            }
        }
    });
    image
}
