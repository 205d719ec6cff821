//! Landform → what the ground looks like.
