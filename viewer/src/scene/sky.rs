//! Sky, sun, clouds and air.

use genescape_schema::scene::{SkyImages, SkyLight};

use super::{HdrPicture, Picture};

/// What `GSC_sky` says.
#[derive(Clone, Debug)]
pub struct Sky {
    /// Six faces, and six faces without clouds.
    pub images: SkyImages<HdrPicture, Picture>,
    pub light: SkyLight,
}
