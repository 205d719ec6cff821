//! What crosses the crates.

mod backdrop;
mod distance;
mod docs;
mod round;
mod strips;
mod wood;
