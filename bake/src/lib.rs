//! Turns a population of genomes into landscapes: a graph of pure stages run through a content-addressed cache.

pub mod bench;
pub mod breed;
pub mod cli;
pub mod commands;
pub mod events;
pub mod follow;
pub mod gltf;
pub mod graph;
pub mod import;
mod inputs;
pub mod lod_file;
mod math;
pub mod model;
pub mod noise;
pub mod plan;
mod raster;
pub mod run;
pub mod seed;
pub mod session;
pub mod stages;
pub mod watch;
pub mod world;
