//! Properties of the sky.
