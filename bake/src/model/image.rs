//! Pictures in memory. Row 0 is the top row, as in glTF, PNG and EXR.

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
