//! Levels of detail as plain arithmetic, without a GPU: which blocks, triangles and trees a frame needs.
//!
//! - [`block`]: the squares that the land is drawn in;
//! - [`morph`]: what a vertex's level of detail λ depends on by distance alone, and why sliding by it leaves no crack;
//! - [`nested`]: triangles that follow distance and roughness, and whose corners rise without a crack;
//! - [`quadtree`]: blocks of one instanced draw (thesis 3.2, the vertex-program algorithm; Vlietinck 2003);
//! - [`roam`]: one generalised triangle strip (thesis 3.2; Duchaineau et al. 1997, Lindstrom et al. 1996);
//! - [`tree`]: what the LOD number of a tree is chosen by (thesis 4.3.2 and 4.3.3).

pub mod block;
pub mod morph;
pub mod nested;
pub mod quadtree;
pub mod roam;
pub mod tree;

#[cfg(test)]
mod tests;
