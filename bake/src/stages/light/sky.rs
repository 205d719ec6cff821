//! Land and the sky's radiance by elevation → the part of the sky's irradiance that reaches the ground, relative to
//! open level ground: the visible sky weighted by radiance and by the angle to the normal, trees not counted.

use glam::Vec3;
use rayon::prelude::*;

use super::horizon::{Beyond, slopes};
use crate::math::{cell, interpolate, lerp_array};
use crate::model::{Heightfield, Landform, SkyLight};
use crate::raster::square;

/// Azimuths for which the horizon is found.
const AZIMUTHS: usize = 8;
/// Steps of the tables over the sine of the horizon's elevation, and of their integration over elevation.
const TABLE_STEPS: usize = 128;
const ELEVATION_STEPS: usize = 1024;
/// Samples a side at which the sky is computed, at most: it changes slowly.
const MAX_SAMPLES: u32 = 257;
/// Metres beyond the field within which hills count.
const REACH_M: f32 = 2500.0;

/// The sky's part for a square of samples over the field.
pub(super) fn on_land(light: &SkyLight, land: &Landform) -> Vec<f32> {
    let field = smoothed(&land.field);
    let side = field.side as usize;
    let beyond = Beyond { apron: &land.apron, reach_m: REACH_M };
    let table = Table::of(light);
    let normals = normals(&field);
    let mut sums = vec![0.0_f32; side * side];
    for azimuth in 0..AZIMUTHS {
        let angle = azimuth as f32 * (std::f32::consts::TAU / AZIMUTHS as f32);
        let towards = [libm::cosf(angle), libm::sinf(angle)];
        let slopes = slopes(&field, &beyond, towards);
        sums.par_chunks_mut(side).enumerate().for_each(|(j, row)| {
            let range = j * side..(j + 1) * side;
            for ((sum, slope), normal) in row.iter_mut().zip(&slopes[range.clone()]).zip(&normals[range]) {
                *sum += table.arriving(*normal, towards, *slope);
            }
        });
    }
    let whole = AZIMUTHS as f32 * table.0[0][0];
    sums.iter_mut().for_each(|sum| *sum = (*sum / whole).min(1.0));
    sums
}

fn normals(field: &Heightfield) -> Vec<Vec3> {
    let at = |k: u32| field.normal_at(k % field.side, k / field.side);
    (0..field.side * field.side).into_par_iter().map(at).collect()
}

/// At most `MAX_SAMPLES` samples a side, each the mean of its neighbourhood by weights 1-2-1.
fn smoothed(field: &Heightfield) -> Heightfield {
    let last = field.side - 1;
    let stride = last.div_ceil(MAX_SAMPLES - 1).next_power_of_two();
    if stride == 1 {
        return field.clone();
    }
    let side = last / stride + 1;
    let around = |k: usize| {
        let k = k as u32 * stride;
        [k.saturating_sub(stride / 2), k, (k + stride / 2).min(last)]
    };
    let mean = |[a, b, c]: [f32; 3]| 0.25 * a + 0.5 * b + 0.25 * c;
    let heights_m =
        square(side as usize, |i, j| mean(around(j).map(|j| mean(around(i).map(|i| field.at(i, j))))));
    Heightfield { side, spacing_m: field.spacing_m * stride as f32, heights_m }
}

/// Irradiance per azimuth from above a horizon, by the sine of its elevation: what falls on level ground, and what
/// falls on a wall that faces the azimuth.
struct Table(Vec<[f32; 2]>);

impl Table {
    fn of(light: &SkyLight) -> Self {
        let mut table = vec![[0.0; 2]; TABLE_STEPS + 1];
        let step = std::f32::consts::FRAC_PI_2 / ELEVATION_STEPS as f32;
        let (mut level, mut wall) = (0.0, 0.0);
        let mut entry = TABLE_STEPS;
        let radiance = radiance_by_elevation(light);
        // From the zenith down; the table's entry is filled when its horizon is reached.
        for k in (0..ELEVATION_STEPS).rev() {
            let elevation = (k as f32 + 0.5) * step;
            let (sin, cos) = libm::sincosf(elevation);
            while entry > 0 && sin * TABLE_STEPS as f32 <= entry as f32 - 1.0e-3 {
                table[entry] = [level, wall];
                entry -= 1;
            }
            let radiance = radiance(elevation);
            level += radiance * sin * cos * step;
            wall += radiance * cos * cos * step;
        }
        table[..=entry].fill([level, wall]);
        Self(table)
    }

    #[inline]
    fn arriving(&self, normal: Vec3, towards: [f32; 2], slope: f32) -> f32 {
        let slope = slope.max(0.0);
        let at = slope / (1.0 + slope * slope).sqrt() * TABLE_STEPS as f32;
        let facing = normal.x * towards[0] + normal.z * towards[1];
        let (k, part) = cell(at, self.0.len());
        let [upright, sideways] = lerp_array(self.0[k], self.0[k + 1], part);
        (normal.y * upright + facing * sideways).max(0.0)
    }
}

/// Luminance of the sky at an elevation in radians; a sky without zones or a black one counts as uniform.
fn radiance_by_elevation(light: &SkyLight) -> impl Fn(f32) -> f32 + use<> {
    let zones = &light.zonal_radiance_linear;
    let even = zones.len() < 2 || zones.iter().flatten().all(|&radiance| radiance <= 0.0);
    let luminance = |&[r, g, b]: &[f32; 3]| (0.2126 * r + 0.7152 * g + 0.0722 * b).max(0.0);
    let zones: Vec<f32> = if even { vec![1.0; 2] } else { zones.iter().map(luminance).collect() };
    move |elevation| interpolate(&zones, elevation / std::f32::consts::FRAC_PI_2 * (zones.len() - 1) as f32)
}
