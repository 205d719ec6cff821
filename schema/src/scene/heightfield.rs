//! `GSC_heightfield`, on the terrain's node: the land as a heightfield with its levels of detail and its surface.

use std::sync::Arc;

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::{GroundSurface, Resource, floats};

pub const GSC_HEIGHTFIELD: &str = "GSC_heightfield";
/// Attribute of the vertices of the land around the field: parts of the surface's details 1 to 4, as `weights` has them.
pub const GROUND_WEIGHTS: &str = "_GROUND_WEIGHTS";

/// Heights on a square grid of (2^k+1)² samples, centred on the origin.
///
/// Sample (i, j) lies at x = (i − (side−1)/2)·spacing, z = (j − (side−1)/2)·spacing and is
/// `heights_m[j·side + i]`: i runs east (+x), j runs south (+z).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Heightfield {
    /// Samples a side, 2^k+1.
    pub side: u32,
    /// Metres between samples.
    pub spacing_m: f32,
    /// side² heights in metres.
    #[serde(with = "floats")]
    pub heights_m: Vec<f32>,
}

impl Heightfield {
    /// Metres from edge to edge.
    pub fn extent_m(&self) -> f32 {
        (self.side - 1) as f32 * self.spacing_m
    }

    /// k of side = 2^k+1: the number of levels of blocks.
    pub fn depth(&self) -> u32 {
        (self.side - 1).trailing_zeros()
    }

    /// Lowest and highest sample in metres. Looks at all of them.
    pub fn range_m(&self) -> [f32; 2] {
        // Side by side, since each comparison waits for the one before.
        let (lines, rest) = self.heights_m.as_chunks::<16>();
        let (mut low, mut high) = ([f32::MAX; 16], [f32::MIN; 16]);
        for line in lines {
            low = std::array::from_fn(|k| if line[k] < low[k] { line[k] } else { low[k] });
            high = std::array::from_fn(|k| if line[k] > high[k] { line[k] } else { high[k] });
        }
        let lowest = rest.iter().chain(&low).copied().fold(f32::MAX, f32::min);
        [lowest, rest.iter().chain(&high).copied().fold(f32::MIN, f32::max)]
    }

    /// The sample (i, j); both less than `side`.
    #[inline]
    pub fn at(&self, i: u32, j: u32) -> f32 {
        self.heights_m[(j * self.side + i) as usize]
    }

    /// World coordinate (x or z) in metres of a line of samples.
    #[inline]
    pub fn place_m(&self, line: u32) -> f32 {
        (line as f32 - 0.5 * (self.side - 1) as f32) * self.spacing_m
    }

    /// Grid coordinates of a point, clamped to the land: whole cell and fraction within it.
    #[inline]
    fn cell(&self, along_m: f32) -> (u32, f32) {
        let last = (self.side - 1) as f32;
        let g = (along_m / self.spacing_m + 0.5 * last).clamp(0.0, last);
        let whole = (g as u32).min(self.side - 2);
        (whole, g - whole as f32)
    }

    /// Bilinear height in metres at world (x, z); beyond the edge, that of the edge.
    #[inline]
    pub fn height_m(&self, x_m: f32, z_m: f32) -> f32 {
        let ((i, u), (j, v)) = (self.cell(x_m), self.cell(z_m));
        let near = self.at(i, j) * (1.0 - u) + self.at(i + 1, j) * u;
        let far = self.at(i, j + 1) * (1.0 - u) + self.at(i + 1, j + 1) * u;
        near * (1.0 - v) + far * v
    }

    /// Unit normal at sample (i, j) by central differences (one-sided at the edge).
    pub fn normal_at(&self, i: u32, j: u32) -> Vec3 {
        let last = self.side - 1;
        let (west, east) = (i.saturating_sub(1), (i + 1).min(last));
        let (north, south) = (j.saturating_sub(1), (j + 1).min(last));
        let dx = (self.at(east, j) - self.at(west, j)) / ((east - west) as f32 * self.spacing_m);
        let dz = (self.at(i, south) - self.at(i, north)) / ((south - north) as f32 * self.spacing_m);
        Vec3::new(-dx, 1.0, -dz).normalize()
    }
}

/// What the terrain's levels of detail need at run time (thesis 3.2.1 and 3.2.2), heights included. The page on
/// `GSC_heightfield` says which sample splits which triangle of the bintree.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TerrainLod {
    pub field: Arc<Heightfield>,
    /// Half thickness in metres of the wedgie of the triangles that a sample splits: how far the sample lies off the
    /// middle of their hypotenuse plus the greatest wedgie among the samples that split their halves. So a wedgie
    /// holds those of its children. The four corners, which split nothing, hold the greatest of all. Indexed like
    /// `Heightfield::heights_m`.
    pub wedgies_m: Vec<f32>,
    /// Lowest and highest sample of each block in metres, morphed or not, its border included: level l has 2^l × 2^l
    /// blocks of 2^(k−l) cells a side, row by row from the north-west, and starts at entry (4^l − 1)/3;
    /// l = 0 … k−1.
    pub block_ranges_m: Vec<[f32; 2]>,
}

impl TerrainLod {
    /// Lowest and highest of the whole land in metres, morphed or not.
    pub fn range_m(&self) -> [f32; 2] {
        self.block_ranges_m.first().copied().unwrap_or([0.0, 0.0])
    }
}

/// The extension's object on a node.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct HeightfieldExtension {
    /// Samples a side, 2^k+1. The field is centred on the node's origin; rows run south (+z), columns east (+x).
    pub side: u32,
    /// Metres between samples.
    pub spacing_m: f32,
    /// Height in metres of value 0 of `heights`.
    pub min_m: f32,
    /// Height in metres of value 65535 of `heights`.
    pub max_m: f32,
    /// Surface of the lake in metres; absent when the land is dry.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub water_level_m: Option<f32>,
    /// The heights as a 16-bit grey PNG of side² pixels.
    pub heights: Resource,
    /// [`TerrainLod`] as bytes.
    pub lod: Resource,
    pub surface: GroundSurface<Resource>,
}
