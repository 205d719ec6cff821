//! What crosses the crates.

mod backdrop;
mod distance;
mod docs;
mod far_ground;
mod round;
mod strips;
mod wood;
