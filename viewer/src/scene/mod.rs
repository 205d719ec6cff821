//! A landscape as plain values, as read from its files and before any of it is on the GPU. Knows neither disk nor
//! device. Coordinates as in glTF: right-handed, y up, metres.

mod asset;
mod ground;
mod image;
mod impostor;
mod sky;
mod trees;

use std::sync::Arc;

pub use asset::{
    Alpha, Asset, AssetVertex, DirectionalLight, Facts, Part, Sampling, Shape, ShapeLevel, Slot, Staging,
    Surface, Texture, Transmission, Wrap,
};
pub use genescape_schema::scene::{
    GroundDetail, GroundSurface, Heightfield, Instance, StartView, TerrainLod,
};
pub use ground::{Apron, Ground};
pub use image::{HdrImage, Image};
pub use impostor::{Crown, IMPOSTOR_ROWS, Impostor, LEAVES, LeafSide, middles_m};
pub use sky::Sky;
pub use trees::{Level, Material, Range, Template, TreeVertex, Trees, sort_by_place};

/// One landscape.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The individual's name: "Oak valley in June".
    pub name: String,
    /// The land.
    pub ground: Ground,
    /// The trees.
    pub trees: Trees,
    /// Sky, sun and air.
    pub sky: Sky,
    /// Where a walk starts.
    pub start: StartView,
}

impl Scene {
    /// Without trees beyond the field: as other programs show it, and as the thesis's experiments have it.
    pub fn without_far_trees(mut self) -> Self {
        self.trees.far = Arc::default();
        self
    }
}
