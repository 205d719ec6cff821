//! What crosses the crates.

mod backdrop;
mod distance;
mod docs;
mod far_ground;
mod levels;
mod round;
mod strips;
mod wood;
