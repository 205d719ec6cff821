//! The land: its heights, what its levels of detail need, and what it looks like.

use std::sync::Arc;

use super::Picture;

/// All of the land.
#[derive(Clone, Debug)]
pub struct Ground {
    /// Blob that the heights came from: equal names are equal heights.
    pub name: String,
    /// Heights and levels of detail.
    pub field: Arc<Heightfield>,
    /// Surface of the lake in metres; `None` when the land is dry.
    pub water_level_m: Option<f32>,
    /// What covers it.
    pub surface: Surface,
    /// The coarse land around the field, to the horizon.
    pub apron: Arc<Apron>,
}

/// Heights on a grid of (2^k+1)² samples with what the levels of detail need; the page on `GSC_heightfield` says what
/// each array means. Sample (i, j) lies at x = (i − (side−1)/2)·spacing, z = (j − (side−1)/2)·spacing and is entry
/// j·side + i of every array of side² values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Heightfield {
    /// Samples a side, 2^k+1.
    pub side: u32,
    /// Metres between samples.
    pub spacing_m: f32,
    /// side² heights in metres.
    pub heights_m: Vec<f32>,
    /// Half thickness in metres of the wedgie of the triangles that each sample splits.
    pub wedgies_m: Vec<f32>,
    /// Lowest and highest of each block, coarsest level first: level l has 2^l × 2^l blocks of 2^(k−l) cells a side,
    /// row by row from the north-west, and starts at entry (4^l − 1)/3.
    pub block_ranges_m: Vec<[f32; 2]>,
}

impl Heightfield {
    /// Metres from edge to edge.
    pub fn extent_m(&self) -> f32 {
        (self.side - 1) as f32 * self.spacing_m
    }

    /// k: the number of levels of blocks.
    pub fn depth(&self) -> u32 {
        (self.side - 1).trailing_zeros()
    }

    /// The sample (i, j); both less than `side`.
    #[inline]
    pub fn at(&self, i: u32, j: u32) -> f32 {
        self.heights_m[(j * self.side + i) as usize]
    }

    /// Lowest and highest of the whole.
    pub fn range_m(&self) -> [f32; 2] {
        self.block_ranges_m.first().copied().unwrap_or([0.0, 0.0])
    }

    /// World coordinate (x or z) in metres of a line of samples.
    #[inline]
    pub fn place_m(&self, line: u32) -> f32 {
        (line as f32 - 0.5 * (self.side - 1) as f32) * self.spacing_m
    }

    /// Bilinear height in metres at world (x, z); beyond the edge, that of the edge.
    pub fn height_m(&self, x_m: f32, z_m: f32) -> f32 {
        let cell = |along_m: f32| {
            let last = (self.side - 1) as f32;
            let g = (along_m / self.spacing_m + 0.5 * last).clamp(0.0, last);
            let whole = (g as u32).min(self.side - 2);
            (whole, g - whole as f32)
        };
        let ((i, u), (j, v)) = (cell(x_m), cell(z_m));
        let near = self.at(i, j) * (1.0 - u) + self.at(i + 1, j) * u;
        let far = self.at(i, j + 1) * (1.0 - u) + self.at(i + 1, j + 1) * u;
        near * (1.0 - v) + far * v
    }
}

/// What covers the land. Pictures cover the field once, row 0 in the north.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Albedo, sRGB.
    pub color: Picture,
    /// Parts of `details` 1 to 4 in RGBA; the rest is `details` 0.
    pub weights: Picture,
    /// R: the sky's irradiance that arrives, G: the sun's with n·l, B: visibility of the sun's disc; linear.
    pub light: Picture,
    /// Grass, rock, scree, snow, mud: tiling textures.
    pub details: Vec<Detail>,
}

/// A tiling texture.
#[derive(Clone, Debug)]
pub struct Detail {
    /// "grass".
    pub name: String,
    /// Factor on the albedo: byte / 128, not decoded from sRGB.
    pub detail: Picture,
    /// Normals as in glTF.
    pub normal: Picture,
    /// Metres that one tile covers.
    pub tile_m: f32,
}

/// The ring of coarse land around the field as triangles; its inner edge joins the field's border as the near mesh
/// of the file has it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Apron {
    /// Metres.
    pub positions_m: Vec<[f32; 3]>,
    /// Unit length.
    pub normals: Vec<[f32; 3]>,
    /// Linear albedo in 8 bits a channel, alpha unused.
    pub colors: Vec<[u8; 4]>,
    /// Triangles, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
}
