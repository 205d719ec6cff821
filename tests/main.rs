//! What crosses the crates.

mod distance;
mod docs;
mod round;
mod strips;
mod wood;
