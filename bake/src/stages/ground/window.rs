//! Landform → the part of the ground map around the foreground, painted again: colour, parts and grass at any point, in
//! metres.

use bytemuck::{Pod, Zeroable};
use glam::Vec2;

use super::GroundParams;
use super::cover::{KINDS, Painter};
use super::grain::Grain;
use super::patch::SIDE_M;
use super::traits::{Patches, TraitsMap};
use super::woods::Woods;
use crate::math;
use crate::model::Landform;
use crate::raster::raster;

/// What a texel of the map shows.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Look {
    /// Albedo, linear.
    pub color: [f32; 3],
    pub parts: [f32; KINDS],
    /// The colour that grass has there.
    pub grass: [f32; 3],
}

/// The texels of the map around the piece.
pub(super) struct MapWindow {
    first: [i32; 2],
    across: usize,
    texel_m: f32,
    half_m: f32,
    values: Vec<[f32; size_of::<Look>() / 4]>,
}

impl MapWindow {
    pub fn new(params: &GroundParams, woods: &Woods, land: &Landform, map_px: u32, corner: Vec2) -> Self {
        let extent_m = land.field.extent_m();
        let texel_m = extent_m / map_px as f32;
        let across = (SIDE_M / texel_m) as usize + 3;
        let first = [corner.x, corner.y].map(|m| ((m + 0.5 * extent_m) / texel_m) as i32 - 1);
        let painter = Painter::new(params, land, woods);
        let place = |k: i32| (k.clamp(0, map_px as i32 - 1) as f32 + 0.5) / map_px as f32;
        let rows = place(first[1])..=place(first[1] + across as i32);
        // Traits are kept on a grid, so patches are needed as far as the samples around.
        let apart = 2.0 / (land.field.side - 1).min(512) as f32;
        let wider = (rows.start() - apart).max(0.0)..=(rows.end() + apart).min(1.0);
        let traits = TraitsMap::new(&Patches::new(params.terrain_seed, extent_m, wider), land, woods, rows);
        let grain = Grain::new(params.terrain_seed, map_px);
        let values = raster(across, across, |j| {
            let j = (first[1] + j as i32).clamp(0, map_px as i32 - 1);
            let (traits, grain, painter, place) = (traits.row(place(j)), &grain, &painter, &place);
            move |i| {
                let i = (first[0] + i as i32).clamp(0, map_px as i32 - 1);
                let (here, noise) = (traits.at(place(i)), grain.at(i as usize, j as usize));
                let cover = painter.cover(&here, &noise);
                let (color, grass) = (painter.color(&here, &cover, &noise), painter.grass(&here, &noise));
                bytemuck::cast(Look { color, parts: cover.parts(), grass })
            }
        });
        Self { first, across, texel_m, half_m: 0.5 * extent_m, values }
    }

    /// The map at a point, as a viewer filters it.
    pub fn at(&self, p: Vec2) -> Look {
        let cell = |m: f32, first: i32| {
            let place = (m + self.half_m) / self.texel_m - 0.5 - first as f32;
            math::cell(place.clamp(0.0, (self.across - 1) as f32), self.across)
        };
        let ((i, u), (j, v)) = (cell(p.x, self.first[0]), cell(p.y, self.first[1]));
        let k = j * self.across + i;
        let [a, b, c, d] = [k, k + 1, k + self.across, k + self.across + 1].map(|k| &self.values[k]);
        bytemuck::cast::<[f32; size_of::<Look>() / 4], _>(std::array::from_fn(|n| {
            (a[n] * (1.0 - u) + b[n] * u) * (1.0 - v) + (c[n] * (1.0 - u) + d[n] * u) * v
        }))
    }
}
