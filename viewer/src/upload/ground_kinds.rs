//! Albedo and blend weights of the ground → the colour of each kind of it by itself, which a map of a texel a metre has only in
//! mixtures where two kinds meet.

use glam::Vec3;

use super::texture::linear;
use crate::scene::{GroundSurface, Image};

/// Kinds of ground, each with a tiling texture.
pub const KINDS: usize = 5;

/// No side is a multiple of it, so that all columns are among the texels that are looked at.
const STEP: usize = 61;

/// How many texels the mean of the whole map counts as, which is all that is known of what lies nowhere.
const UNKNOWN: f32 = 1e-3;

/// Linear colour on average where a kind lies nearly alone, and metres that a tile covers; `albedo_linear` is the mean of the map.
pub(super) fn of(surface: &GroundSurface<Image>, albedo_linear: Vec3) -> [[f32; 4]; KINDS] {
    let GroundSurface { color, weights, details, .. } = surface;
    let mut sums = [albedo_linear.extend(1.0) * UNKNOWN; KINDS];
    let texels = |image: &Image| image.levels.first().cloned().unwrap_or_default();
    let (colors, parts) = (texels(color), texels(weights));
    let width = color.width_px.max(1) as usize;
    for (n, texel) in colors.as_chunks().0.iter().enumerate().step_by(STEP) {
        // The maps need not have as many texels as each other.
        let same = |at: usize, of: u32, side: u32| at * side as usize / of.max(1) as usize;
        let i = same(n % width, color.width_px, weights.width_px);
        let j = same(n / width, color.height_px, weights.height_px);
        let Some(parts) = parts.as_chunks().0.get(j * weights.width_px as usize + i) else { continue };
        let seen = linear(texel).extend(1.0);
        for (sum, part) in sums.iter_mut().zip(all_parts(parts)) {
            *sum += seen * (part * part * part);
        }
    }
    std::array::from_fn(|kind| {
        let mean = sums[kind].truncate() / sums[kind].w;
        mean.extend(details[kind].tile_m).to_array()
    })
}

/// How much of each kind there is, the first being what is left.
fn all_parts(weights: &[u8; 4]) -> [f32; KINDS] {
    let [a, b, c, d] = weights.map(|weight| f32::from(weight) / 255.0);
    [(1.0 - a - b - c - d).max(0.0), a, b, c, d]
}
