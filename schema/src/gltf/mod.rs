//! The JSON and binary forms of Genescape's glTF extensions, shared by the bake that writes them and the viewer that
//! reads them. Each has a page under `schema/docs/` for everyone else.
//!
//! All four are listed in `extensionsUsed` only, never in `extensionsRequired`: a program that does not know them
//! shows the whole scene without them. Property names are those of the fields here in camelCase, so a unit suffix
//! stays visible (`spacing_m` is `spacingM`). Every list of indices refers to the arrays of the glTF file it stands in.

mod heightfield;
mod heightfield_data;
mod instances;
mod progressive_mesh;
mod resource;
mod sky;

pub use heightfield::{GSC_HEIGHTFIELD, GroundDetail, GroundSurface, HeightfieldExtension};
pub use heightfield_data::{HeightfieldData, HeightfieldError, read_heightfield, write_heightfield};
pub use instances::{
    GSC_INSTANCES, INSTANCE_BYTES, INSTANCES_HEADER_BYTES, InstanceRecord, InstancesError,
    InstancesExtension, InstancesTemplate, read_instances, write_instances,
};
pub use progressive_mesh::{GSC_PROGRESSIVE_MESH, ProgressiveLevel, ProgressiveMeshExtension};
pub use resource::Resource;
pub use sky::{GSC_SKY, SkyExtension, SkyLayer};

/// Names of all our extensions, in the order in which files list them.
pub const EXTENSIONS: [&str; 4] = [GSC_HEIGHTFIELD, GSC_INSTANCES, GSC_PROGRESSIVE_MESH, GSC_SKY];
