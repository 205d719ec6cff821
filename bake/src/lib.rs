//! Turns a population of genomes into landscapes: a graph of pure stages run through a content-addressed cache.

pub mod say;

pub mod audition;
mod bad_input;
pub mod bench;
pub mod breed;
mod cache_commands;
pub mod chosen_parents;
pub mod cli;
pub mod commands;
mod distance_command;
pub mod events;
pub mod export;
pub mod export_command;
pub mod gltf;
pub mod graph;
pub mod import;
pub mod kinds;
mod kinds_command;
pub mod landscape;
pub mod lineage;
mod lineage_command;
pub mod lod_command;
mod manual;
mod math;
pub mod model;
pub mod noise;
pub mod phenotype;
pub mod plan;
mod progress;
pub mod random;
mod raster;
pub mod run;
pub mod seed;
pub mod session;
pub mod stages;
pub mod watch_loop;
