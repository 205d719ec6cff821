//! Properties of every tree.
