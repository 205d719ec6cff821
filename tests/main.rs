//! What crosses the crates.

mod docs;
mod round;
