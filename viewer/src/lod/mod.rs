//! Levels of detail as plain arithmetic, without a GPU: which blocks, triangles and trees a frame needs.
//!
//! - [`block`]: the squares that the land is drawn in;
//! - [`morph`]: what a vertex's level of detail λ depends on, and why sliding by it leaves no crack;
//! - [`quadtree`]: blocks of one instanced draw (thesis 3.2, the vertex-program algorithm; Vlietinck 2003);
//! - [`reach`]: how near each level of detail may come where the land is rough, and where it is not;
//! - [`roam`]: one generalised triangle strip (thesis 3.2; Duchaineau et al. 1997, Lindstrom et al. 1996);
//! - [`tree`]: what the LOD number of a tree is chosen by (thesis 4.3.2 and 4.3.3).

pub mod block;
pub mod morph;
pub mod quadtree;
pub mod reach;
pub mod roam;
pub mod tree;

#[cfg(test)]
mod tests;
