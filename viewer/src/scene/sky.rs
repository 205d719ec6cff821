//! Sky, sun, clouds and air.

use genescape_schema::scene::{SkyImages, SkyLight};

use super::{HdrImage, Image};

/// What `GSC_sky` says.
#[derive(Clone, Debug)]
pub struct Sky {
    /// Six faces, and six faces without clouds.
    pub images: SkyImages<HdrImage, Image, ()>,
    pub light: SkyLight,
}
