//! What a scene is made of, declared once: the bake writes these types, the viewer reads them.
//!
//! Where a scene consists of images, its types are generic over what stands for one: pixels while the bake makes them,
//! a file of the cache once they are encoded, a [`Resource`] in the JSON of `scene.gltf`, a decoded image in the viewer.
//! `try_map` leads from one to the next.
//!
//! The JSON forms are those of our glTF extensions; each has a page under `schema/docs/` for everyone else. All six
//! are listed in `extensionsUsed` only, never in `extensionsRequired`: a program that does not know them shows the
//! whole scene without them. Property names are those of the fields here in camelCase, so a unit suffix stays visible
//! (`spacing_m` is `spacingM`). Every index refers to the arrays of the glTF file it stands in.
//!
//! Right-handed, y up, metres, radians; colours linear unless a name says `_srgb`.

pub mod bintree;
mod cutout;
pub mod floats;
mod ground;
mod heightfield;
mod heightfield_bytes;
mod impostor;
mod instances;
mod plants;
mod progressive_mesh;
mod resource;
mod sky;
pub mod svd;
mod view;

pub use cutout::Alpha;
pub use ground::{GroundDetail, GroundSurface};
pub use heightfield::{GROUND_WEIGHTS, GSC_HEIGHTFIELD, Heightfield, HeightfieldExtension, TerrainLod};
pub use heightfield_bytes::HeightfieldError;
pub use impostor::{GSC_IMPOSTOR, IMPOSTOR_PICTURES, ImpostorExtension};
pub use instances::{
    FAR_TREES_NODE, GSC_INSTANCES, Instance, InstancesError, InstancesExtension, InstancesTemplate,
    instance_count, read_instances, write_instances,
};
pub use plants::{DensityMap, GroundPlants, Plant, PlantKind, PlantShape, ground_m};
pub use progressive_mesh::{GSC_PROGRESSIVE_MESH, ProgressiveLevel, ProgressiveMeshExtension, error_weight};
pub use resource::Resource;
pub use sky::{CloudLayer, GSC_SKY, SkyExtension, SkyImages, SkyLight};
pub use view::{START_ASPECT, START_FOV_Y_DEG, START_NODE, StartView, rotation_from_z};

/// Names of all our extensions, in the order in which files list them.
pub const EXTENSIONS: [&str; 5] =
    [GSC_HEIGHTFIELD, GSC_IMPOSTOR, GSC_INSTANCES, GSC_PROGRESSIVE_MESH, GSC_SKY];
