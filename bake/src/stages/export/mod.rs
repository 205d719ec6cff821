//! Results → the files that other programs open: glTF, PNG, EXR.
pub mod exr;
pub mod png;
