//! Clouds and clear sky → a map of what clouds add to the upper half of the sky: light (RGB) and transparency, over
//! azimuth and elevation, with rows crowded towards the horizon, where most looks go.

use glam::{Vec3A, Vec4};
use rayon::prelude::*;

use super::cirrus::Cirrus;
use super::clear::ClearSky;
use super::clouds::{Clouds, through_air};
use super::math::turn;
use crate::math::{cell, interpolate, split};
use crate::raster::raster;

/// Elevation grows with this power of the row.
const CROWDING: f32 = 1.4;
const LOOKUP: usize = 2048;

/// Per texel the clouds' light in RGB and, in w, their transparency.
pub struct Dome {
    width: usize,
    height: usize,
    texels: Vec<Vec4>,
    row_of_sine: Vec<f32>,
}

/// The clouds of a sky: either may be missing.
pub struct Layers {
    /// Cumulus or stratus.
    pub clouds: Option<Clouds>,
    /// The high layer.
    pub cirrus: Option<Cirrus>,
}

impl Layers {
    pub fn is_empty(&self) -> bool {
        self.clouds.is_none() && self.cirrus.is_none()
    }

    /// Light and transparency of all clouds in a unit direction with y > 0.
    pub fn seen(&self, direction: Vec3A, sky: &ClearSky) -> Vec4 {
        let mut seen = Vec4::new(0.0, 0.0, 0.0, 1.0);
        if let Some(clouds) = &self.clouds {
            let height = clouds.field.base_m + 0.4 * clouds.field.height_m;
            seen = through_air(&clouds.march(direction), direction, height, sky);
        }
        if let Some(cirrus) = &self.cirrus
            && seen.w > 0.0
        {
            let behind = cirrus.seen(direction, sky);
            let light = seen.truncate() + behind.truncate() * seen.w;
            seen = light.extend(seen.w * behind.w);
        }
        seen
    }
}

impl Dome {
    /// Draws the clouds; `width` directions around, `height` from horizon to zenith. Rows near the zenith are
    /// drawn with fewer directions.
    pub fn new(layers: &Layers, sky: &ClearSky, width: usize, height: usize) -> Self {
        let row_of_sine = (0..=LOOKUP).map(|i| row_at(i as f32 / LOOKUP as f32, height)).collect();
        let heading = |column: usize| {
            let azimuth = (column as f32 + 0.5) / width as f32 * std::f32::consts::TAU;
            (libm::sinf(azimuth), -libm::cosf(azimuth))
        };
        let around: Vec<(f32, f32)> = (0..width).map(heading).collect();
        let seen = |row: Row, column: usize| {
            let (x, z) = around[column];
            layers.seen(Vec3A::new(row.flat * x, row.sine, row.flat * z), sky)
        };
        // First every other texel of every other row; then the rest, but only where neighbours differ.
        let half = width / 2;
        let mut sparse = vec![Vec4::ZERO; half * (height / 2 + 1)];
        sparse.par_chunks_exact_mut(half).enumerate().for_each(|(row, texels)| {
            let row = Row::new(2 * row, width, height);
            let stride = row.stride.max(2) / 2;
            for column in (0..half).step_by(stride) {
                texels[column] = seen(row, 2 * column);
            }
            fill_between(texels, stride);
        });
        let mut texels = vec![Vec4::ZERO; width * height];
        texels.par_chunks_exact_mut(width).enumerate().for_each(|(row_index, texels)| {
            let row = Row::new(row_index, width, height);
            let (low, high) = sparse[row_index / 2 * half..].split_at(half);
            let high = if row_index % 2 == 0 { low } else { high };
            for column in (0..width).step_by(row.stride) {
                let (i, next) = (column / 2, (column / 2 + 1) % half);
                let known = row_index % 2 == 0 && column % 2 == 0;
                texels[column] = if known || alike([low[i], low[next], high[i], high[next]]) {
                    let j = if column % 2 == 0 { i } else { next };
                    (low[i] + low[j] + high[i] + high[j]) * 0.25
                } else {
                    seen(row, column)
                };
            }
            fill_between(texels, row.stride);
        });
        let texels = smoothed(&without_glints(&texels, width), width);
        Self { width, height, texels, row_of_sine }
    }

    /// Row coordinate of a sine of elevation.
    #[inline]
    pub fn row(&self, sine: f32) -> f32 {
        interpolate(&self.row_of_sine, sine.clamp(0.0, 1.0).sqrt() * LOOKUP as f32)
    }

    /// Column coordinate of a flat direction.
    #[inline]
    pub fn column(&self, x: f32, z: f32) -> f32 {
        turn(x, -z) * self.width as f32 - 0.5
    }

    /// Clouds at a column and row, interpolated.
    #[inline]
    pub fn at(&self, column: f32, row: f32) -> Vec4 {
        let (i, fx) = split(column);
        let (j, fy) = cell(row.clamp(0.0, (self.height - 1) as f32), self.height);
        let width = self.width as i32;
        let x0 = if i < 0 { i + width } else { i } as usize;
        let x1 = if i + 1 >= width { i + 1 - width } else { i + 1 } as usize;
        let (low, high) = (&self.texels[j * self.width..], &self.texels[(j + 1) * self.width..]);
        low[x0].lerp(low[x1], fx).lerp(high[x0].lerp(high[x1], fx), fy)
    }
}

/// A row of the map: its elevation, and how many columns lie between those that are drawn.
#[derive(Clone, Copy)]
struct Row {
    sine: f32,
    flat: f32,
    stride: usize,
}

impl Row {
    fn new(row: usize, width: usize, height: usize) -> Self {
        let unit = ((row as f32 + 0.5) / height as f32).min(1.0);
        let elevation = libm::powf(unit, CROWDING) * std::f32::consts::FRAC_PI_2;
        let (sine, flat) = (libm::sinf(elevation), libm::cosf(elevation));
        // At the horizon air blurs all detail away.
        let stride = if sine < 0.025 { 2 } else { stride_at(flat, width) };
        Self { sine, flat, stride }
    }
}

/// Whether nothing can be lost by interpolating between these.
fn alike(texels: [Vec4; 4]) -> bool {
    let low = texels[0].min(texels[1]).min(texels[2].min(texels[3]));
    let high = texels[0].max(texels[1]).max(texels[2].max(texels[3]));
    let span = high - low;
    let light = 0.15 * (high.x + high.y + high.z) + 0.006;
    span.w < 0.12 && span.x + span.y + span.z < light
}

/// The map with every texel made anew from itself and its eight neighbours, row by row; columns wrap around.
fn from_neighbours(texels: &[Vec4], width: usize, make: impl Fn([[Vec4; 3]; 3]) -> Vec4 + Sync) -> Vec<Vec4> {
    let height = texels.len() / width;
    raster(width, height, |row| {
        let make = &make;
        let rows = [row.saturating_sub(1), row, (row + 1).min(height - 1)];
        let rows = rows.map(|row| &texels[row * width..][..width]);
        move |column| {
            let west = if column == 0 { width - 1 } else { column - 1 };
            let columns = [west, column, if column + 1 == width { 0 } else { column + 1 }];
            make(rows.map(|row| columns.map(|column| row[column])))
        }
    })
}

/// A ray that grazes a cloud's lit edge gives a texel that outshines its surroundings, and glitters where it is a few
/// pixels large. Unless two neighbours are like it, as in a silver lining, it becomes like the others.
fn without_glints(texels: &[Vec4], width: usize) -> Vec<Vec4> {
    let light = |texel: Vec4| texel.x + texel.y + texel.z;
    from_neighbours(texels, width, |[above, here, below]| {
        let own = light(here[1]);
        if own == 0.0 {
            return here[1];
        }
        let (mut first, mut second) = (0.0f32, 0.0f32);
        for around in [above[0], above[1], above[2], here[0], here[2], below[0], below[1], below[2]] {
            let other = light(around);
            second = second.max(other.min(first));
            first = first.max(other);
        }
        if own <= 1.2 * second { here[1] } else { (above[1] + here[0] + here[2] + below[1]) * 0.25 }
    })
}

/// Weighted 1 : 4 : 1 both ways, the cubic B-spline at its knots: interpolated texels no longer show as stairs.
fn smoothed(texels: &[Vec4], width: usize) -> Vec<Vec4> {
    let mean = |[a, b, c]: [Vec4; 3]| (a + b * 4.0 + c) * (1.0 / 6.0);
    from_neighbours(texels, width, |rows| mean(rows.map(mean)))
}

fn row_at(root_of_sine: f32, height: usize) -> f32 {
    let elevation = libm::asinf((root_of_sine * root_of_sine).min(1.0));
    libm::powf(elevation * std::f32::consts::FRAC_2_PI, 1.0 / CROWDING) * height as f32 - 0.5
}

/// Columns between drawn directions: a power of two that divides the width.
fn stride_at(flat: f32, width: usize) -> usize {
    let mut stride = 1;
    while (stride * 2) as f32 * flat < 1.25 && stride < 32 && width.is_multiple_of(stride * 2) {
        stride *= 2;
    }
    stride
}

fn fill_between(texels: &mut [Vec4], stride: usize) {
    let width = texels.len();
    for start in (0..width).step_by(stride) {
        let (a, b) = (texels[start], texels[(start + stride) % width]);
        for k in 1..stride {
            texels[start + k] = a.lerp(b, k as f32 / stride as f32);
        }
    }
}
