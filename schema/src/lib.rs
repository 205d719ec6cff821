//! The shared contract as plain checked data.

pub mod gltf;
