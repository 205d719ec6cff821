//! Nothing → five tiling detail textures of 512² with tangent-space normals: grass, rock, scree, snow and earth, which in
//! dry lands is sand.
//!
//! Detail multiplies the ground's colour: its bytes have the mean 128 in every channel, so that bytes / 128 is the
//! factor. Normals are those of OpenGL and glTF: red to the right, green to the top of the image, blue outwards.

use serde::{Deserialize, Serialize};

use super::GroundParams;
use super::cover::KINDS;
use super::patterns::{self, Pattern, SIDE, Texel};
use crate::math::srgb_from_linear;
use crate::model::{GroundDetail, Image8, dryness};
use crate::raster::square_image;

/// Names of the textures, in order.
pub const TEXTURES: [&str; KINDS] = ["grass", "rock", "scree", "snow", "earth"];

/// Metres that a tile of each covers.
pub(super) const TILE_M: [f32; KINDS] = [3.0, 6.0, 4.0, 5.0, 4.0];

/// Mean linear value of each kind's [`tile_srgb`]: as bright as possible without clipping its highlights, and bright
/// enough that the kind's brightest ground is a factor of at most 1.
pub(super) const TILE_MEAN: [f32; KINDS] = [0.45, 0.45, 0.45, 0.86, 0.56];

/// The detail of the kth texture as a base colour for core glTF, whose factors cannot exceed 1: its linear mean is
/// `TILE_MEAN[k]`.
pub fn tile_srgb(kind: usize, detail: &Image8) -> Image8 {
    let encode = SrgbTable::new();
    let mean = TILE_MEAN[kind.min(KINDS - 1)];
    let table: Vec<u8> = (0..=255_u8).map(|byte| encode.byte(f32::from(byte) / 128.0 * mean)).collect();
    let data = detail.data.iter().map(|&byte| table[usize::from(byte)]).collect();
    Image8 { data, ..*detail }
}

/// An albedo as a vertex colour, of what is so white where that is 1.
pub(super) fn factor_on(white: f32, albedo: [f32; 3]) -> [u8; 4] {
    let [r, g, b] = albedo.map(|c| (c / white * 255.0 + 0.5).clamp(0.0, 255.0) as u8);
    [r, g, b, 255]
}

/// What the ground is tiled with where it is bare and loose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Loose {
    Earth,
    Sand,
}

impl Loose {
    /// Sand from a steppe's dryness on.
    pub fn of(params: &GroundParams) -> Self {
        if dryness(params.temperature_c, params.rain_mm) > 1.0 { Self::Sand } else { Self::Earth }
    }
}

/// The textures of the kind `k`: those of loose ground differ from land to land.
pub fn texture(k: usize, loose: Loose) -> GroundDetail<Image8> {
    type Make = fn() -> Pattern;
    let (name, depth_px, make): (_, f32, Make) = match (k, loose) {
        (0, _) => (TEXTURES[0], 2.2, patterns::grass),
        (1, _) => (TEXTURES[1], 20.0, patterns::rock),
        (2, _) => (TEXTURES[2], 3.0, patterns::scree),
        (3, _) => (TEXTURES[3], 4.2, patterns::snow),
        (_, Loose::Earth) => (TEXTURES[4], 2.6, patterns::earth),
        (_, Loose::Sand) => ("sand", 2.4, patterns::sand),
    };
    let pattern = make();
    let (detail, normal) = (detail(&pattern), normals(&pattern, depth_px));
    GroundDetail { name: name.into(), detail, normal, tile_m: TILE_M[k.min(KINDS - 1)] }
}

/// Tones as bytes of mean 128.
fn detail(pattern: &[Texel]) -> Image8 {
    let scale = [0, 1, 2].map(|channel| scale_to_mean(pattern, channel));
    square_image(SIDE, |j| {
        let row = &pattern[j * SIDE..];
        move |i| std::array::from_fn::<_, 3, _>(|c| (row[i].tone[c] * scale[c]).clamp(0.0, 255.0) as u8)
    })
}

/// The factor that gives one channel the mean 128 after clamping to bytes, by the secant of its clamped mean.
fn scale_to_mean(pattern: &[Texel], channel: usize) -> f32 {
    let mut scale = 1.0;
    for _ in 0..3 {
        // Truncation to bytes takes half a step off.
        let rows = pattern
            .chunks_exact(SIDE)
            .map(|row| row.iter().map(|t| (t.tone[channel] * scale).clamp(0.0, 255.0)).sum::<f32>());
        let mean = rows.sum::<f32>() / pattern.len() as f32;
        scale *= 128.5 / mean.max(1e-3);
    }
    scale
}

/// Normals of a height that is 0 to 1 for `depth_px` texels.
fn normals(pattern: &[Texel], depth_px: f32) -> Image8 {
    square_image(SIDE, |j| {
        let line = |j: usize| &pattern[(j % SIDE) * SIDE..][..SIDE];
        let rows = [line(j + SIDE - 1), line(j), line(j + 1)];
        move |i| {
            let columns = [(i + SIDE - 1) % SIDE, i, (i + 1) % SIDE];
            // Sobel, so that single texels do not glitter.
            let [[nw, n, ne], [w, _, e], [sw, s, se]] = rows.map(|row| columns.map(|i| row[i].height));
            let dx = ne + 2.0 * e + se - nw - 2.0 * w - sw;
            let dy = sw + 2.0 * s + se - nw - 2.0 * n - ne;
            let (nx, ny) = (-dx * 0.125 * depth_px, dy * 0.125 * depth_px);
            let length = (nx * nx + ny * ny + 1.0).sqrt();
            [nx, ny, 1.0].map(|n| (127.5 + 127.0 * n / length + 0.5) as u8)
        }
    })
}

/// Linear reflectance to sRGB bytes by table: 4096 steps, finer than a byte everywhere above 0.001.
pub(super) struct SrgbTable(Vec<u8>);

impl SrgbTable {
    pub fn new() -> Self {
        Self((0..4096).map(|k| (255.0 * srgb_from_linear((k as f32 + 0.5) / 4096.0) + 0.5) as u8).collect())
    }

    #[inline]
    pub fn byte(&self, linear: f32) -> u8 {
        self.0[((linear * 4096.0) as usize).min(4095)]
    }
}
