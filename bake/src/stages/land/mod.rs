//! Parameters → the shape of the land.
