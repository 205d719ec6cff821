//! Turns a population of genomes into landscapes: a graph of pure stages run through a content-addressed cache.

pub mod import;
pub mod model;
pub mod noise;
pub mod seed;
pub mod stages;
