//! Pictures in memory. Row 0 is the top row, as in glTF, PNG and EXR.

use glam::Vec4;
use serde::{Deserialize, Serialize};

/// An 8-bit picture; `channels` is 1, 3 or 4, `data` holds width × height × channels bytes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Image8 {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Bytes a pixel.
    pub channels: u8,
    /// Rows from the top.
    pub data: Vec<u8>,
}

impl Image8 {
    /// A picture of zeros.
    pub fn new(width: u32, height: u32, channels: u8) -> Self {
        let data = vec![0; width as usize * height as usize * channels as usize];
        Self { width, height, channels, data }
    }

    /// The bytes of one pixel.
    pub fn pixel(&self, x: u32, y: u32) -> &[u8] {
        let n = self.channels as usize;
        let at = (y as usize * self.width as usize + x as usize) * n;
        &self.data[at..at + n]
    }
}

/// A linear-light RGB picture; `data` holds width × height × 3 IEEE half floats as their bits.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ImageF16 {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Rows from the top, three half floats a pixel.
    pub data: Vec<u16>,
}

/// Texels a side of an [`AlphaMask`].
const MASK_SIDE: usize = 64;

/// Which part of a texture is opaque, in 64 × 64 texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AlphaMask {
    /// A word a row from the top, a bit a texel from the left.
    rows: [u64; MASK_SIDE],
    /// The same of texels in which anything is.
    reach: [u64; MASK_SIDE],
}

impl Default for AlphaMask {
    /// Nothing is cut away.
    fn default() -> Self {
        Self { rows: [u64::MAX; MASK_SIDE], reach: [u64::MAX; MASK_SIDE] }
    }
}

impl AlphaMask {
    /// The texels of a square picture of 64, 32, 16 … RGBA pixels a side whose alpha reaches `cutoff`; all of any other picture.
    pub fn of(image: &Image8, cutoff: f32) -> Self {
        let side = image.width as usize;
        let is_square = side > 0 && image.height == image.width;
        if !is_square || !MASK_SIDE.is_multiple_of(side) || image.channels != 4 {
            return Self::default();
        }
        let texels = MASK_SIDE / side;
        let is_opaque = |x: usize, y: usize| f32::from(image.data[4 * (y * side + x) + 3]) >= 255.0 * cutoff;
        let rows = std::array::from_fn(|y| {
            (0..MASK_SIDE).fold(0, |row, x| row | u64::from(is_opaque(x / texels, y / texels)) << x)
        });
        Self { rows, reach: rows }
    }

    /// The same of lines thinner than the picture's texels, which reach wherever alpha is above 0.
    pub fn of_lines(image: &Image8, cutoff: f32) -> Self {
        Self { reach: Self::of(image, 1.0 / 255.0).rows, ..Self::of(image, cutoff) }
    }

    /// Whether the texture is opaque at texture coordinates; it is nowhere outside of [0, 1], but for rounding.
    pub fn is_opaque(&self, [u, v]: [f32; 2]) -> bool {
        self.opaque([u, v].map(Vec4::splat)) & 1 == 1
    }

    /// The same at four places: a bit for each.
    #[inline]
    pub fn opaque(&self, uv: [Vec4; 2]) -> u64 {
        const ROUNDING: f32 = 1e-3;
        let inside = |t: Vec4| t.cmpge(Vec4::splat(-ROUNDING)) & t.cmple(Vec4::splat(1.0 + ROUNDING));
        let last = Vec4::splat((MASK_SIDE - 1) as f32);
        let texels =
            |t: Vec4| (t * MASK_SIDE as f32).clamp(Vec4::ZERO, last).to_array().map(|t| t as i32 as usize);
        let [x, y] = uv.map(texels);
        let bit = |k: usize| (self.rows[y[k] % MASK_SIDE] >> x[k] & 1) << k;
        (bit(0) | bit(1) | bit(2) | bit(3)) & u64::from((inside(uv[0]) & inside(uv[1])).bitmask())
    }

    /// Whether it is of lines thinner than its texels.
    pub fn is_of_lines(&self) -> bool {
        self.reach != self.rows
    }

    /// Whether nothing of the texture is cut away.
    pub fn is_full(&self) -> bool {
        *self == Self::default()
    }

    /// Texture coordinates of the middles of texels in which anything is, of every second row and column.
    pub fn shown(&self) -> impl Iterator<Item = [f32; 2]> {
        let every_second = || (0..MASK_SIDE).step_by(2);
        let texels = every_second().flat_map(move |y| every_second().map(move |x| [x, y]));
        let shown = texels.filter(|&[x, y]| self.reach[y] >> x & 1 == 1);
        shown.map(|texel| texel.map(|t| (t as f32 + 0.5) / MASK_SIDE as f32))
    }

    /// Texture coordinates of the corners of the first and the last texel of each row in which anything is: all of the convex
    /// hull of what is shown is among them.
    pub fn outline(&self) -> impl Iterator<Item = [f32; 2]> {
        let of_row = |(y, row): (usize, &u64)| {
            let ends = [row.trailing_zeros(), u64::BITS - row.leading_zeros()];
            ends.map(|x| [y, y + 1].map(|y| [x as f32, y as f32].map(|t| t / MASK_SIDE as f32)))
        };
        let rows = self.reach.iter().enumerate().filter(|(_, row)| **row != 0);
        rows.flat_map(of_row).flatten()
    }
}
