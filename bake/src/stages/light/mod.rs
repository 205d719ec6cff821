//! Sun, sky, land and trees → light on the ground: one 8-bit image over the field (thesis 3.3 and 4.4.2). Linear
//! fractions of what open level ground receives; metres; row 0 is north. What R, G, B and A mean: [`LightMap`].
//!
//! - [`horizon`]: how high the land stands towards an azimuth, for each sample (Timonen & Westerholm 2010);
//! - [`sun`]: from there, which part of the sun's disc is above the land: a soft edge without sampling;
//! - [`sky`]: from a fan of azimuths, which part of the sky's irradiance arrives;
//! - [`caster`]: a tree's shadow as a filtered image in the plane across the light;
//! - [`trees`]: those images laid onto the ground for each tree.

mod caster;
mod horizon;
mod sky;
mod stage;
mod sun;
mod trees;

#[cfg(test)]
mod tests;

use std::borrow::Borrow;

use rayon::prelude::*;

use crate::math::{cell, lerp_array};
use crate::model::{Caster, Instance, Landform, LightMap, SkyLight};
use crate::raster::square_image;
pub use stage::LightMapStage;
use sun::Sun;
use trees::{Ground, Texels};

/// The light on the field of `land`, `side_px`² texels (at least one).
///
/// `casters[i]` stands for template i in shadows. Instances of templates without a caster, or flattened to nothing, cast no shadow.
/// Visibility of the sun is relative to open level ground: a sun that a flat horizon cuts still gives 255 there.
pub fn light_map(
    light: &SkyLight,
    land: &Landform,
    trees: &[Instance],
    casters: &[impl Borrow<Caster>],
    side_px: u32,
) -> LightMap {
    let casters: Vec<&Caster> = casters.iter().map(Borrow::borrow).collect();
    let side = side_px.max(1) as usize;
    let sun = Sun::of(light);
    let samples = land.field.side as usize;
    let to_samples = Resampling::from_samples(side, samples);
    let ground_m = to_samples.whole(&land.field.heights_m);
    let sun_on_land = sun::on_land(&sun, land);
    let sky_on_land = sky::on_land(light, land);
    let to_sky = Resampling::from_samples(side, sky_on_land.len().isqrt());
    let texels = Texels { side, extent_m: land.field.extent_m() };
    let shade = trees::shade(&sun, trees, &casters, &Ground { heights_m: &ground_m, texels });
    let to_crowns = Resampling::from_texels(side, shade.crowns.len().isqrt());
    let image = square_image(side, |j| {
        let struck = to_samples.row(j, &sun_on_land);
        let sky = to_sky.row(j, sky_on_land.as_chunks::<1>().0);
        let crowns = to_crowns.row(j, shade.crowns.as_chunks::<1>().0);
        let (leaves, sun) = (&shade.sun[j * side..(j + 1) * side], &sun);
        move |i| {
            let [margin, edge, cosine, _] = struck[i];
            let visible = sun.visibility(margin, edge);
            let noise = dither(i, j);
            let sky = (sky[i][0] * crowns[i][0]).min(1.0);
            [sky, cosine.max(0.0) * visible, visible, leaves[i]].map(|value| quantise(value, noise))
        }
    });
    LightMap { image }
}

/// Interleaved gradient noise (Jimenez 2014) in [0, 1): even over any 3×3 texels, so that it stays invisible. The
/// inner fraction is a 32-bit integer, which wraps by itself.
#[inline]
fn dither(i: usize, j: usize) -> f32 {
    const UNIT: f64 = 4_294_967_296.0;
    const ACROSS: u32 = (0.067_110_56 * UNIT) as u32;
    const DOWN: u32 = (0.005_837_15 * UNIT) as u32;
    let inner = (i as u32).wrapping_mul(ACROSS).wrapping_add((j as u32).wrapping_mul(DOWN));
    let outer = 52.982_918 * ((inner >> 8) as f32 * (1.0 / 16_777_216.0));
    outer - outer as i32 as f32
}

/// A value in [0, 1] as a byte, rounded up or down by the noise; 0 and 1 stay exact.
#[inline]
fn quantise(value: f32, noise: f32) -> u8 {
    (value * 255.0 + noise * 0.999) as i32 as u8
}

/// Bilinear interpolation from a square grid to the light map's texels: along each axis, where each texel's centre
/// lies.
struct Resampling {
    side: usize,
    places: Vec<(u32, f32)>,
}

impl Resampling {
    /// From samples on the field's edges and in between.
    fn from_samples(texels: usize, side: usize) -> Self {
        Self::new(texels, side, |at| at * (side - 1) as f32)
    }

    /// From another image's texels.
    fn from_texels(texels: usize, side: usize) -> Self {
        Self::new(texels, side, |at| at * side as f32 - 0.5)
    }

    fn new(texels: usize, side: usize, place: impl Fn(f32) -> f32) -> Self {
        let places = (0..texels).map(|texel| {
            let at = place((texel as f32 + 0.5) / texels as f32).clamp(0.0, (side - 1) as f32);
            let (whole, part) = cell(at, side.max(2));
            (whole as u32, part)
        });
        Self { side, places: places.collect() }
    }

    /// One row of texels, from a grid of vectors.
    fn row<const N: usize>(&self, texel_row: usize, grid: &[[f32; N]]) -> Vec<[f32; N]> {
        let (j, v) = self.places[texel_row];
        let line = |j: usize| &grid[j * self.side..(j + 1) * self.side];
        let (north, south) = (line(j as usize), line((j as usize + 1).min(self.side - 1)));
        let mut blended: Vec<[f32; N]> =
            north.iter().zip(south).map(|(&n, &s)| lerp_array(n, s, v)).collect();
        blended.push(blended[self.side - 1]);
        let texel = |&(i, u): &(u32, f32)| lerp_array(blended[i as usize], blended[i as usize + 1], u);
        self.places.iter().map(texel).collect()
    }

    /// All texels.
    fn whole(&self, grid: &[f32]) -> Vec<f32> {
        let rows = (0..self.places.len()).into_par_iter();
        rows.flat_map_iter(|j| self.row(j, grid.as_chunks::<1>().0).into_flattened()).collect()
    }
}
