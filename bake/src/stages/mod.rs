//! The stages: pure functions from parameters and earlier results to later ones. No I/O, no clock, no global
//! state, no unseeded randomness; transcendental functions come from `libm`.

pub mod ground;
pub mod land;
pub mod light;
pub mod lod;
pub mod placement;
pub mod scene;
pub mod sky;
pub mod start;
pub mod terrain_lod;
pub mod tree;
