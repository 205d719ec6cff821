//! The plain values that pass from stage to stage. A stage's output is one of these, written to the cache as
//! postcard; what other programs read (glTF, PNG, EXR) is made of them by the stages under `stages/export`.
//!
//! Right-handed, y up, metres, radians; counter-clockwise front faces; colours linear unless a name says `_srgb`.

mod floats;
mod ground;
mod image;
mod light;
mod mesh;
mod terrain;
mod tree;
mod view;

pub use ground::{Foreground, GroundMaps, GroundTexture, GroundTextures};
pub use image::{Image8, ImageF16};
pub use light::{CloudLayer, LightMap, SkyImages, SkyLight};
pub use mesh::{Bounds, Material, Mesh, Part, PartKind};
pub use terrain::{Heightfield, Landform, TerrainLod, TerrainMesh};
pub use tree::{Instance, Level, LevelledMesh, Morph, Placement, TreeTemplate, TreeTextures};
pub use view::{StartView, rotation_from_z};
