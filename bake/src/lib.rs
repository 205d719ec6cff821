//! Turns a population of genomes into landscapes: a graph of pure stages run through a content-addressed cache.

pub mod bench;
pub mod breed;
pub mod cli;
pub mod commands;
pub mod events;
mod execute;
pub mod gltf;
pub mod import;
pub mod lod_file;
pub mod model;
pub mod noise;
pub mod plan;
pub mod run;
pub mod seed;
pub mod session;
pub mod stages;
pub mod watch_loop;
