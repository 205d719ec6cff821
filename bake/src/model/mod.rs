//! The plain values that pass from stage to stage, besides those of the contract (`genescape_schema::scene`).
//!
//! Right-handed, y up, metres, radians; counter-clockwise front faces; colours linear unless a name says `_srgb`.

mod climate;
mod ground;
mod image;
mod leaf_color;
mod light;
mod lookout;
mod mesh;
mod terrain;
mod tree;

pub use genescape_schema::scene::{
    CloudLayer, DensityMap, GroundDetail, GroundPlants, Heightfield, Instance, Plant, PlantKind, PlantShape,
    SkyLight, StartView, TerrainLod, ground_m, rotation_from_z,
};

pub use climate::{Climate, SnowMap, dryness};
pub use ground::{Foreground, GroundMaps, Tiled};
pub use image::{AlphaMask, Image8, ImageF16};
pub use leaf_color::leaf_color;
pub use light::LightMap;
pub use lookout::Lookout;
pub use mesh::{Bounds, Material, Mesh, Part, PartKind};
pub use terrain::{FarGround, Landform, TerrainMesh};
pub use tree::{
    Caster, Clusters, Impostor, Level, LevelledMesh, Morph, Placement, TreeFootprint, TreeTemplate,
    TreeTextures, is_dead,
};

/// The sky as pixels.
pub type SkyImages = genescape_schema::scene::SkyImages<ImageF16, Image8>;
