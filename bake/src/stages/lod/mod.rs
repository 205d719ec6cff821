//! Any mesh → progressive mesh, distinguished meshes, geomorphs, strips.
