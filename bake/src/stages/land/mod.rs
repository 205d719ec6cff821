//! Terrain genes → the shape of the land: heights in metres over 1024 m × 1024 m, where water gathers and
//! loose stone lies, a lake, a snow line, and a coarse apron that carries the land to the horizon.
//!
//! A warped multifractal (Musgrave, "Texturing and Modeling", 2003) gives the raw land; rivers cut it by the stream
//! power law (Braun & Willett 2013), raindrops carve gullies and lay down fans (Beyer 2015), and slopes slide to
//! their angle of repose (Musgrave, Kolb & Mace 1989). At last the sea breaks off its coast, and people cut slopes into
//! fields. All erosion works on fixed grids, whatever the size asked for, so that a valley keeps its place; finer sizes
//! add finer noise. The apron follows the erosion of the border, less and less with distance, so that valleys lead out of
//! the field.

mod apron;
mod coast;
mod droplets;
mod grid;
mod paddies;
mod shape;
mod stage;
mod streams;
#[cfg(test)]
mod tests;
mod thermal;
mod water;

use serde::{Deserialize, Serialize};

use crate::model::{Heightfield, Landform};
use coast::Coast;
use grid::Grid;
use paddies::Paddies;
use shape::Shape;
pub use stage::LandStage;

/// Metres from edge to edge of the walkable field.
pub const FIELD_M: f32 = 1024.0;
/// The grids that erosion works on.
struct Grids {
    /// Samples a side for rivers, coarse to fine.
    rivers: [u32; 2],
    /// Samples a side for droplets and sliding stone.
    slopes: u32,
}

/// 8 m and 4 m, then 2 m from sample to sample.
const FULL: Grids = Grids { rivers: [129, 257], slopes: 513 };

/// Those of a sketch: a tenth of the work. Main valleys are cut on the grid on which those of the land itself are: on a coarser
/// one rivers take other ways.
const SKETCHED: Grids = Grids { rivers: [129, 129], slopes: 129 };

/// The genes that shape the land; names, units, ranges and meanings as in `configs/space.ron`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LandParams {
    pub terrain_seed: u32,
    pub relief_m: f32,
    pub wavelength_m: f32,
    pub hurst: f32,
    pub lacunarity: f32,
    pub ridged: f32,
    pub domain_warp: f32,
    pub offset: f32,
    pub terraces: f32,
    pub stream_power_steps: u32,
    pub droplets: f32,
    pub talus_angle_deg: f32,
    pub water_level: f32,
    pub snow_line: f32,
    pub cliff_m: f32,
    pub paddies: f32,
}

/// Shapes the land on a grid of `size`² samples; `size` is 2^k+1 and at least 3 (513, 1025 and 2049 are in use).
/// The lowest point of the field lies at about 0 m, the highest at about `relief_m`.
pub fn landform(params: &LandParams, size: u32) -> Landform {
    shaped(params, size.max(3), &FULL)
}

/// The same land without gullies, with samples 8 m apart: to judge it before it is made.
pub fn sketch(params: &LandParams) -> Landform {
    shaped(&LandParams { droplets: 0.0, ..params.clone() }, SKETCHED.slopes, &SKETCHED)
}

fn shaped(params: &LandParams, size: u32, grids: &Grids) -> Landform {
    let mut shape = Shape::new(params);
    let raw = shape.fit(grids.slopes);
    let (mut worn, mut loose) = erode(params, &raw, grids);
    let level = water::Level::new(params, &worn);

    let mut field = shape.sample(size, &raw);
    grid::add_change(&mut field, &raw, &worn);
    let mut apron = apron::heights(&shape, params);
    apron::follow(&mut apron, &raw, &worn);
    let flow = streams::flow(&worn, grids.rivers[1]);
    if let Some(coast) = Coast::new(params, &worn, size, level.water_m) {
        [&mut worn, &mut field].into_iter().for_each(|land| coast.raise(land));
        coast.raise_apron(&mut apron);
        coast.sweep(&mut loose);
    }
    let paddies = Paddies::new(params, &worn, level.water_m).map(|paddies| paddies.cut(&mut field));
    level.settle(&mut field.values);
    if let Some(water_m) = level.water_m {
        apron::sink_specks(&mut apron, water_m);
    }
    level.settle(&mut apron.values);
    apron::join(&mut apron, &field);

    let peak = apron.values.iter().chain(&field.values).fold(f32::MIN, |a, &b| a.max(b));
    Landform {
        flow: flow.resized(size).map(|f| f.clamp(0.0, 1.0)).values,
        deposit: loose.map(|m| m / (m + 0.4)).resized(size).map(|d| d.clamp(0.0, 1.0)).values,
        paddies,
        water_level_m: level.water_m,
        snow_line_m: if params.snow_line >= 0.999 { peak + 1.0 } else { params.snow_line * params.relief_m },
        field: into_field(field),
        apron: into_field(apron),
    }
}

fn into_field(grid: Grid) -> Heightfield {
    Heightfield { side: grid.side, spacing_m: grid.spacing_m, heights_m: grid.values }
}

/// The raw land after rivers, rain and gravity, and the thickness in metres of the loose material that they left.
fn erode(params: &LandParams, raw: &Grid, grids: &Grids) -> (Grid, Grid) {
    let mut land = raw.clone();
    let mut loose = raw.map(|_| 0.0);
    let guard = grid::border_guard(grids.slopes);
    streams::carve_valleys(&mut land, &mut loose, params, grids.rivers);
    droplets::rain(&mut land, &mut loose, &guard, params);
    // Before the slopes slide, so that stretching makes none too steep; and again for the relief lost by sliding.
    rescale(&mut land, params.relief_m);
    thermal::slide(&mut land, &mut loose, params);
    rescale(&mut land, params.relief_m);
    (land, loose)
}

/// Gives the worn land its full relief back.
fn rescale(land: &mut Grid, relief_m: f32) {
    let (lo, hi) = land.range();
    let gain = relief_m / (hi - lo).max(1e-3);
    land.values.iter_mut().for_each(|h| *h = (*h - lo) * gain);
}
