//! Any mesh → distinguished meshes D_0 … D_k (half the vertices each), geomorphs between them, an error in metres
//! for each, triangle strips, and the whole progressive mesh as vertex splits.
//!
//! Surfaces simplify by edge collapse with quadric errors (Garland and Heckbert 1997; new vertices on the collapsed
//! edge as in Merry's thesis, appendix A, then moved so that volume is kept, Lindstrom and Turk 1998). Aggregates
//! (leaf cards) simplify stochastically: elements go, the rest grow (Cook, Halstead, Planck, Ryu 2007). One cost in
//! metres orders both. Read: `state` (the mesh being changed), `topology`, `quadric`, `collapse` (one edge),
//! `aggregate`, `sequence` (the order of everything), `levels`, `progressive` (the file format), `strip`.

mod aggregate;
mod collapse;
mod coverage;
mod levels;
pub mod progressive;
mod quadric;
mod sequence;
mod state;
pub mod strip;
mod topology;

#[cfg(test)]
mod look;
#[cfg(test)]
mod shapes;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

pub use quadric::{Metric, Placed, QuadricMetric};

use crate::model::{LevelledMesh, Mesh};

/// Where a collapse puts its new vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Placement {
    /// On the collapsed edge (thesis, appendix A).
    Edge,
    /// On the edge, then along the mean normal until the enclosed volume is as before, so that branches keep their
    /// radius (Lindstrom and Turk 1998).
    Volume,
}

/// What a person may choose about levels of detail.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LodOptions {
    /// At most so many levels after D_0.
    pub max_levels: u32,
    /// No level gets fewer vertices than this.
    pub min_vertices: u32,
    /// Where a collapse puts its new vertex.
    pub placement: Placement,
    /// Metres of error for each metre by which an aggregate's elements grow: less makes leaves go before bark.
    pub aggregate_weight: f32,
    /// Metres of error for each metre of thickness of a whole piece (a twig) that goes: less makes twigs go sooner.
    pub piece_weight: f32,
    /// Part of an element's area that its texture leaves opaque, (0, 1]: coverage is kept for elements so much
    /// smaller.
    pub element_fill: f32,
}

impl Default for LodOptions {
    fn default() -> Self {
        Self {
            max_levels: 8,
            min_vertices: 100,
            placement: Placement::Volume,
            aggregate_weight: 0.25,
            piece_weight: 1.0,
            element_fill: 0.7,
        }
    }
}

/// Makes all levels of detail of a mesh.
///
/// D_0 is `mesh` itself. Each further level has half the vertices of the one before, to within one element or two
/// per cent, until one would have fewer than `min_vertices` or would be off by more than 6 % of the mesh's diagonal. Vertices keep their
/// order. `normals`, `uvs` and `colors` may each be empty. A mesh that breaks the rules of [`Mesh`] is repaired
/// first: a list of the wrong length is emptied, a triangle that names a vertex that isn't there is dropped.
pub fn levels(mesh: &Mesh, options: &LodOptions) -> LevelledMesh {
    match state::repaired(mesh) {
        None => levels::build(mesh, options),
        Some(sound) => levels::build(&sound, options),
    }
}
