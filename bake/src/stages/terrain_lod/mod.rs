//! Landform → adaptive mesh, and the data of the terrain's levels of detail.
//!
//! Everything here follows one hierarchy, the bintree of right triangles (4–8 mesh) of Lindstrom et al. 1996 and
//! ROAM (Duchaineau et al. 1997): see [`genescape_schema::scene::bintree`]. Metres throughout; samples are indexed as
//! in [`crate::model::Heightfield`].
//!
//! - [`lod`]: wedgies and block height ranges (thesis 3.2.1 and 3.2.2);
//! - [`mesh`]: the land as triangles for any viewer, within a verified error bound.

mod apron;
mod curved;
mod data;
mod near;
mod stage;
mod verify;

#[cfg(test)]
mod tests;

pub use data::lod;
pub use near::{default_error_m, mesh};
pub use stage::{TerrainFiles, TerrainStage};
