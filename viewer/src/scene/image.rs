//! Images in memory.

use std::sync::Arc;

/// An 8-bit image, four channels, row 0 on top, with its coarser versions if the file brings them.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Its blob's name: equal names are equal images.
    pub name: String,
    /// Width in pixels.
    pub width_px: u32,
    /// Height in pixels.
    pub height_px: u32,
    /// Levels from the finest on, each half as wide and high as the one before; 4 bytes a pixel. One level if the
    /// file has no others.
    pub levels: Vec<Arc<[u8]>>,
}

impl Image {
    /// What stands in for an image that a file doesn't bring.
    pub fn of_one_pixel(rgba: [u8; 4]) -> Self {
        let levels = vec![Arc::from(rgba.as_slice())];
        Self { name: format!("one pixel {rgba:?}"), width_px: 1, height_px: 1, levels }
    }
}

/// An image of radiance: four half floats a pixel, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct HdrImage {
    /// Its blob's name.
    pub name: String,
    /// Width in pixels.
    pub width_px: u32,
    /// Height in pixels.
    pub height_px: u32,
    /// 8 bytes a pixel.
    pub pixels: Arc<[u8]>,
}
