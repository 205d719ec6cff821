//! Landform → the look of the ground: an albedo map and blend weights over the field (one texel a
//! metre at 1024²), what the apron is like, and five tiling detail textures. Albedo holds no light: linear
//! reflectances of grass, rock, scree, snow, earth and sand as measured outdoors, written as sRGB where 8-bit.
//!
//! Cover follows slope, drained area, deposits, altitude and distance to water, as in
//! Hammes, "Modeling of ecosystems as a data source for real-time terrain rendering" (2001), with borders broken
//! up by noise of several sizes.

mod cover;
mod foreground;
mod glimpse;
mod grain;
mod grass;
mod palette;
mod patch;
mod patterns;
mod plants;
mod season;
mod shapes;
mod snow;
mod solids;
mod stage;
mod standing;
mod stones;
#[cfg(test)]
mod tests;
mod textures;
mod traits;
mod window;
mod woods;
mod woody;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::math::lerp_array;
use crate::model::{FarGround, GroundMaps, Image8, Landform};
use crate::raster::square;
use cover::{Noise, Painter};
pub use foreground::{Ground, foreground};
pub use glimpse::{Glimpse, glimpse};
use grain::Grain;
pub use grass::BLADE_WHITE;
pub use patch::BLOCK_M;
pub use season::Season;
pub use snow::snow_map;
pub use stage::{
    ForegroundStage, GroundMapsFiles, GroundMapsStage, GroundTextureFiles, GroundTextureStage, WoodsInput,
};
use textures::SrgbTable;
pub use textures::{Loose, TEXTURES, texture, tile_srgb};
use traits::{Patches, Traits, TraitsMap};
pub use woods::{LitterParams, Woods};

/// The genes that colour the ground; names, ranges and meanings as in the parameter space.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GroundParams {
    /// Chooses the rock, how dry the land is for its climate, where patches lie.
    pub terrain_seed: u32,
    /// Scree lies up to it.
    pub talus_angle_deg: f32,
    /// A low snow line means a cold land.
    pub snow_line: f32,
    /// Mean of the year where the land lies lowest.
    pub temperature_c: f32,
    /// A year's rain.
    pub rain_mm: f32,
}

/// Paints the field on `side_px`² texels: albedo and blend weights; and says what grows on it.
pub fn maps(params: &GroundParams, woods: &Woods, land: &Landform, side_px: u32) -> GroundMaps<Image8> {
    let side_px = side_px.max(1);
    let painter = Painter::new(params, land, woods);
    let patches = Patches::new(params.terrain_seed, land.field.extent_m(), 0.0..=1.0);
    let traits = TraitsMap::new(&patches, land, woods, 0.0..=1.0);
    let grain = Grain::new(params.terrain_seed, side_px);
    let encode = SrgbTable::new();
    // With what stands under water, where that may be.
    let channels = if land.paddies.is_some() { 4 } else { 3 };
    let mut color_srgb = Image8::new(side_px, side_px, channels as u8);
    let mut weights = Image8::new(side_px, side_px, 4);
    let n = side_px as usize;
    let rows = color_srgb.data.par_chunks_mut(n * channels).zip(weights.data.par_chunks_mut(n * 4));
    rows.enumerate().for_each(|(j, (colors, weights))| {
        let row = traits.row((j as f32 + 0.5) / side_px as f32);
        for i in 0..n {
            let here = row.at((i as f32 + 0.5) / side_px as f32);
            let noise = grain.at(i, j);
            let cover = painter.cover(&here, &noise);
            let color = painter.color(&here, &cover, &noise);
            let texel = &mut colors[channels * i..][..channels];
            texel[..3].copy_from_slice(&color.map(|c| encode.byte(c)));
            if let Some(dry) = texel.get_mut(3) {
                *dry = (255.0 * (1.0 - painter.flooded(&here))) as u8;
            }
            weights[4 * i..][..4].copy_from_slice(&cover.bytes());
        }
    });
    let mut plants = plants::plants(params, &painter, &traits, &grain, land, &weights);
    solids::set_apart(&mut plants, &plants::SOLID, &woods.stems_m, land.field.extent_m());
    GroundMaps { color: color_srgb, weights, plants }
}

/// What the ground is like at each of the apron's samples, row by row. On the field's border that is the mean of the maps around.
pub fn far_ground(params: &GroundParams, season: Season, land: &Landform) -> Vec<FarGround> {
    let painter = Painter::new(params, land, &Woods::none(season));
    let patches = Patches::new(params.terrain_seed, land.field.extent_m(), 0.0..=1.0);
    let apron = &land.apron;
    let half_m = 0.5 * land.field.extent_m();
    square(apron.side as usize, |i, j| {
        let (i, j) = (i as u32, j as u32);
        let (x, z) = (apron.place_m(i), apron.place_m(j));
        let (inner_x, inner_z) = (x.clamp(-half_m, half_m), z.clamp(-half_m, half_m));
        let away_m = (x - inner_x).abs().max((z - inner_z).abs());
        let own = || {
            let here = traits::far(&patches, land, i, j);
            mean_ground(&painter, |_| here)
        };
        let border = || {
            mean_ground(&painter, |s| {
                let (dx, dz) = ((s % 4) as f32 - 1.5, (s / 4) as f32 - 1.5);
                let at = |v: f32, d: f32| ((v + d * 14.0) / (2.0 * half_m) + 0.5).clamp(0.0, 1.0);
                traits::near(&patches, land, at(inner_x, dx), at(inner_z, dz))
            })
        };
        let t = (away_m / 300.0).min(1.0);
        let mean = match t {
            0.0 => border(),
            1.0 => own(),
            t => lerp_array(border(), own(), t),
        };
        let [r, g, b, weights @ ..] = mean;
        let [r, g, b] = [r, g, b].map(|c| (c * 255.0 + 0.5) as u8);
        // Rounded down, so that four of them cannot pass 255.
        FarGround { color: [r, g, b, 255], weights: weights.map(|part| (part * 255.0) as u8) }
    })
}

/// Mean colour, and parts of all kinds but grass, of sixteen texels that differ in grain.
fn mean_ground(painter: &Painter, traits: impl Fn(u32) -> Traits) -> [f32; 7] {
    let mut sum = [0.0; 7];
    for s in 0..16 {
        let here = traits(s);
        let noise = Noise::sample(s);
        let cover = painter.cover(&here, &noise);
        let [r, g, b] = painter.color(&here, &cover, &noise);
        let [_, rock, scree, snow, earth] = cover.parts();
        let found = [r, g, b, rock, scree, snow, earth];
        sum.iter_mut().zip(found).for_each(|(sum, found)| *sum += found * 0.0625);
    }
    sum
}
