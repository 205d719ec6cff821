//! Results → the files that other programs open: glTF, PNG, EXR.
