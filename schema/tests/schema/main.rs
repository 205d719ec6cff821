//! The contract as other crates use it: files as people write them, and genes.

mod files;
mod genes;
mod kinds;
