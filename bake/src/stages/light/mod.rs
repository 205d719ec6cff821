//! Sun, land and trees → light on the ground.
