//! The land and what its levels of detail need.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::{Mesh, floats};

/// Heights on a square grid of (2^k+1)² samples, centred on the origin.
///
/// Sample (i, j) lies at x = (i − (side−1)/2)·spacing, z = (j − (side−1)/2)·spacing and is
/// `heights_m[j·side + i]`: i runs east (+x), j runs south (+z).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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

    /// Lowest and highest sample in metres.
    pub fn range_m(&self) -> (f32, f32) {
        self.heights_m.iter().fold((f32::MAX, f32::MIN), |(lo, hi), &h| (lo.min(h), hi.max(h)))
    }

    /// The sample (i, j); both less than `side`.
    #[inline]
    pub fn at(&self, i: u32, j: u32) -> f32 {
        self.heights_m[(j * self.side + i) as usize]
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

/// The finished land: heights and what the forces that shaped it left behind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Landform {
    /// The walkable land, 1024 m from edge to edge.
    pub field: Heightfield,
    /// Drained area per sample, log-scaled to [0, 1]: 0 on a ridge, 1 in the greatest river bed.
    #[serde(with = "floats")]
    pub flow: Vec<f32>,
    /// Loose material laid down by erosion, per sample, [0, 1].
    #[serde(with = "floats")]
    pub deposit: Vec<f32>,
    /// Surface of the lake in metres; `None` when the land is dry.
    pub water_level_m: Option<f32>,
    /// Altitude in metres above which snow lies; above the highest point when there is none.
    pub snow_line_m: f32,
    /// The same land, coarse and several times as wide, to stand at the horizon: only its part outside `field` is
    /// drawn. Its heights agree with `field` along the border of `field`.
    pub apron: Heightfield,
}

/// The land as triangles for any viewer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TerrainMesh {
    /// The adaptive mesh of `Landform::field`; uv 0..1 over the field (u = east, v = south).
    pub near: Mesh,
    /// The ring of `Landform::apron` around it, joined to its border without a crack; uv continues beyond 0..1.
    pub apron: Mesh,
    /// The water surface: two triangles or empty.
    pub water: Mesh,
    /// Greatest vertical distance in metres between `near` and the heightfield, as verified.
    pub error_m: f32,
}

/// What the terrain's levels of detail need at run time (thesis 3.2.1 and 3.2.2). The page on `GSC_heightfield`
/// says which sample splits which triangle of the bintree, and what its parents a and b are. Arrays of side² values
/// are indexed like `Heightfield::heights_m`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TerrainLod {
    /// Half thickness in metres of the wedgie of the triangles that a sample splits: |displacement| plus the
    /// greatest among the samples that split their halves. So a wedgie holds those of its children, and never is
    /// thinner. The four corners, which split nothing, hold the greatest of all.
    pub wedgies_m: Vec<f32>,
    /// ½(h(a) + h(b)) − h in metres: from the sample to its place in the uniform triangulation of the next level,
    /// diagonals alternating as in the bintree. 0 for the four corners.
    pub displacements_m: Vec<f32>,
    /// The coarsest level of detail at which a sample is still used (0 = only at full resolution): the greatest l
    /// such that 2^l divides both its coordinates; k for the four corners.
    pub levels: Vec<u8>,
    /// Lowest and highest sample of each block, displaced or not, its border included; from the one block of the
    /// whole field down to blocks of 2×2 cells, row by row from the north-west, coarsest first: Σ 4^l pairs,
    /// l = 0 … k−1.
    pub block_ranges_m: Vec<[f32; 2]>,
}
