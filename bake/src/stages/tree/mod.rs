//! Parameters → tree templates and their textures.
