//! A canvas → a mip chain in sRGB with alpha whose coverage at the cutoff is that of its first level.
//!
//! Alpha-tested foliage thins out in the distance because averaged alpha falls below the cutoff; each level's alpha
//! is scaled until as much of it passes as at level 0 (`Alpha`). Colour is averaged by alpha and bled outwards under
//! transparent texels, so no dark rim appears.

use genescape_schema::scene::Alpha;

use super::ALPHA_CUTOFF;
use super::canvas::Canvas;
use crate::math::{linear_from_srgb, unit_to_byte};
use crate::model::Image8;

/// One level while it is made: linear RGB multiplied by alpha, and alpha.
struct Level {
    size: usize,
    pixels: Vec<[f32; 4]>,
}

/// A card's picture.
pub(super) struct Chain {
    /// All levels down to one texel.
    pub levels: Vec<Image8>,
    /// One of them of which as many texels pass as of level 0: for those who don't interpolate.
    pub small: Image8,
}

/// All levels; `small` is the number of the one that is made twice.
pub(super) fn chain(canvas: &Canvas, small: usize) -> Chain {
    let pixels = canvas.pixels.iter().map(|&[r, g, b, a]| [r * a, g * a, b * a, a]).collect();
    let mut levels = vec![Level { size: canvas.size, pixels }];
    while let Some(last) = levels.last().filter(|level| level.size > 1) {
        levels.push(halved(last));
    }
    let whole = &levels[0];
    let (shown, passing) = (whole.shown(), whole.passing());
    let small = small.min(levels.len() - 1);
    let mut colors: Vec<[f32; 3]> = Vec::new();
    let mut chain = Chain { levels: Vec::with_capacity(levels.len()), small: Image8::default() };
    let encode = Encoder::new();
    for (n, level) in levels.iter().enumerate().rev() {
        colors = bled(level, &colors);
        let scale = if n == 0 { 1.0 } else { level.scale_to_show(shown) };
        chain.levels.push(encode.image(level, &colors, scale));
        if n == small {
            chain.small = encode.image(level, &colors, level.scale_to_pass(passing));
        }
    }
    chain.levels.reverse();
    chain
}

impl Level {
    fn alphas(&self) -> Vec<f32> {
        self.pixels.iter().map(|p| p[3]).collect()
    }

    /// The share that is left by the cutoff.
    fn shown(&self) -> f32 {
        Alpha::new(&self.alphas(), self.size).share(ALPHA_CUTOFF)
    }

    fn scale_to_show(&self, share: f32) -> f32 {
        Alpha::new(&self.alphas(), self.size).scale_for(share, ALPHA_CUTOFF)
    }

    /// The same of texels that each are there or not.
    fn passing(&self) -> f32 {
        let passes = |p: &&[f32; 4]| f32::from(unit_to_byte(p[3])) >= 255.0 * ALPHA_CUTOFF;
        self.pixels.iter().filter(passes).count() as f32 / self.pixels.len() as f32
    }

    fn scale_to_pass(&self, share: f32) -> f32 {
        let wanted = (share * self.pixels.len() as f32 + 0.5) as usize;
        if wanted == 0 {
            return 1.0;
        }
        let mut alphas = self.alphas();
        let (_, &mut lowest, _) = alphas.select_nth_unstable_by(wanted - 1, |a, b| b.total_cmp(a));
        if lowest < 1e-3 { 1.0 } else { (ALPHA_CUTOFF + 0.4 / 255.0) / lowest }
    }
}

fn halved(level: &Level) -> Level {
    let size = level.size / 2;
    let mut pixels = Vec::with_capacity(size * size);
    for rows in level.pixels.chunks_exact(2 * level.size) {
        let (upper, lower) = rows.split_at(level.size);
        for (a, b) in upper.chunks_exact(2).zip(lower.chunks_exact(2)) {
            pixels.push(std::array::from_fn(|c| 0.25 * (a[0][c] + a[1][c] + b[0][c] + b[1][c])));
        }
    }
    Level { size, pixels }
}

/// Colour of every texel: its own where it has alpha, else that of the coarser level.
fn bled(level: &Level, coarser: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let half = level.size / 2;
    (0..level.pixels.len())
        .map(|i| {
            let [r, g, b, a] = level.pixels[i];
            if a > 0.02 || coarser.is_empty() {
                let over = 1.0 / a.max(1e-4);
                return [r * over, g * over, b * over];
            }
            coarser[(i / level.size / 2) * half + (i % level.size) / 2]
        })
        .collect()
}

/// Linear light to 8-bit sRGB by a table.
pub(super) struct Encoder(Vec<u8>);

impl Encoder {
    const STEPS: usize = 8192;

    /// Fills the table: 8-bit thresholds are inverted, so only 256 powers are taken.
    pub fn new() -> Self {
        let mut table = Vec::with_capacity(Self::STEPS + 1);
        for byte in 0..256_u32 {
            let upper = linear_from_srgb((byte as f32 + 0.5) / 255.0);
            while table.len() <= Self::STEPS && (table.len() as f32 / Self::STEPS as f32) < upper {
                table.push(byte as u8);
            }
        }
        table.resize(Self::STEPS + 1, 255);
        Self(table)
    }

    #[inline]
    pub fn byte(&self, linear: f32) -> u8 {
        self.0[(linear.clamp(0.0, 1.0) * Self::STEPS as f32 + 0.5) as usize]
    }

    fn image(&self, level: &Level, colors: &[[f32; 3]], scale: f32) -> Image8 {
        let mut image = Image8::new(level.size as u32, level.size as u32, 4);
        for ((out, color), pixel) in image.data.chunks_exact_mut(4).zip(colors).zip(&level.pixels) {
            let [r, g, b] = color.map(|linear| self.byte(linear));
            out.copy_from_slice(&[r, g, b, unit_to_byte(pixel[3] * scale)]);
        }
        image
    }
}
