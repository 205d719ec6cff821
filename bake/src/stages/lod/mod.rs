//! Any mesh → distinguished meshes D_0 … D_k (half the vertices each), geomorphs between them, an error in metres
//! for each, triangle strips, and the whole progressive mesh as vertex splits.
//!
//! Surfaces simplify by edge collapse with quadric errors (Garland and Heckbert 1997; new vertices on the collapsed
//! edge as in Merry's thesis, appendix A, then, unless [`Placement::Edge`] is asked for, moved so that volume is kept,
//! Lindstrom and Turk 1998). Aggregates (leaf cards) simplify stochastically: elements go, the rest grow (Cook, Halstead,
//! Planck, Ryu 2007). One cost in metres orders both.
//!
//! Read `repair`, `state` and `log` (the mesh being simplified), `topology`, `quadric`, `edge`, `merge` and
//! `collapse` (one edge), `element`, `flattening`, `fitting` and `aggregate` (leaf cards), `coverage` and `calibration` (as many
//! pixels at every level), `sequence` (the order of all steps), `levels`, `progressive` (the file format) and `strip`.

mod aggregate;
mod calibration;
mod collapse;
mod coverage;
mod edge;
mod element;
mod fitting;
mod flattening;
mod levels;
mod log;
mod merge;
pub(crate) mod progressive;
mod quadric;
mod repair;
mod sequence;
mod state;
mod strip;
mod topology;

#[cfg(test)]
mod shapes;
#[cfg(test)]
mod tests;

use crate::model::{AlphaMask, Level, LevelledMesh, Mesh, Morph};
pub use flattening::fitted;

/// Where the new vertex of a collapsed edge goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Placement {
    /// Off the edge, so that the volume stays, where that folds nothing and costs little
    // Lindstrom and Turk (1998).
    #[default]
    Volume,
    /// On the edge, where the quadric is least, as in the thesis
    // Merry's thesis, appendix A.
    Edge,
}

/// Choices about levels of detail.
#[derive(Clone, Debug, PartialEq)]
pub struct LodOptions {
    /// Where new vertices of surfaces go.
    pub placement: Placement,
    /// The most levels after D_0.
    pub max_levels: u32,
    /// No level gets fewer vertices than this.
    pub min_vertices: u32,
    /// The error of removing all elements of an aggregate, as a part of their radius. Less removes leaves before bark.
    pub aggregate_weight: f32,
    /// Metres of error for each metre of thickness of a whole piece (a twig) that is removed: less removes twigs
    /// sooner.
    pub piece_weight: f32,
    /// How many times the metres of an edge collapse count beside those of what leaves lose: more keeps bark longer.
    pub surface_weight: f32,
    /// What the texture of each part's elements leaves opaque; all of it for parts beyond the list.
    pub masks: Vec<AlphaMask>,
    /// Up to this level, elements are scaled until they cover as many pixels as in D_0. Beyond it, where something else is
    /// shown in their place, they go on as they grew.
    pub counted_levels: u32,
    /// Whether surfaces grow along their normals so that the mesh covers as much as it did: right for branches, whose
    /// twigs go one by one, not for solid bodies.
    pub thickens: bool,
}

impl Default for LodOptions {
    fn default() -> Self {
        Self {
            placement: Placement::default(),
            max_levels: 8,
            surface_weight: 1.0,
            min_vertices: 100,
            aggregate_weight: 0.165,
            piece_weight: 1.0,
            masks: Vec::new(),
            counted_levels: u32::MAX,
            thickens: false,
        }
    }
}

/// Makes all levels of detail of a mesh.
///
/// D_0 is `mesh` itself. Each further level has half the vertices of the one before, to within one element or two per
/// cent, until one would have fewer than `min_vertices` or would be off by more than 6 % of the mesh's diagonal.
/// Vertices keep their order. `normals`, `uvs` and `colors` may each be empty. A mesh that breaks the rules of [`Mesh`]
/// is repaired first: a list of the wrong length is emptied, a triangle that names a vertex that does not exist is
/// dropped.
///
/// Errors are those of the collapses, in metres: how far the surface moves, how much elements grow.
pub fn levels(mesh: &Mesh, options: &LodOptions) -> LevelledMesh {
    levels::build(repair::repaired(mesh.clone()), options, None, &mut |_| ())
}

/// Finishes levels that have no errors yet: gives the errors of all but the first, in metres. Before, it may put something
/// else in the place of any part of any level but the first, of which the payload knows nothing, and take the last levels
/// away.
pub type Finish<'a> = dyn FnMut(&mut Vec<Level>, &Between<'_>) -> Vec<f32> + 'a;

/// Where the vertices of one level, by its number, go until it is another that is not finer, both as they were simplified.
pub type Between<'a> = dyn Fn(usize, usize) -> Morph + 'a;

/// The same with the errors that `finish` finds; tells when each part of the work has ended.
pub fn levels_finished(
    mesh: &Mesh,
    options: &LodOptions,
    finish: &mut Finish<'_>,
    ended: &mut dyn FnMut(Step),
) -> LevelledMesh {
    levels::build(repair::repaired(mesh.clone()), options, Some(finish), ended)
}

/// A part of the work, in the order in which they end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    DataStructures,
    ProgressiveMesh,
    Morphs,
    Strips,
    /// What finishes levels.
    Finish,
    /// Of the progressive mesh.
    Records,
}
