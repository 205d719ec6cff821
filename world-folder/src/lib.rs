//! The folder a person works in, and the only code that knows it: names of its files, populations, what is current,
//! atomic writes, and one watch for both programs.
//!
//! ```text
//! world/space.ron                              the parameter space, free to edit
//! world/population/g0000.ron …                 what the person made: only created, or edited in place
//! world/baked/g0000/scene-0/scene.gltf …       what can be made again
//! world/baked/current.ron                      which scenes are ready
//! ```
//!
//! [`World`] reads and writes these files; a [`Snapshot`] is what lies there at one moment, and two of them compared
//! say what was saved in between; [`Watch`] takes one whenever something may have happened.

pub mod atomic_write;
mod error;
mod folder;
pub mod names;
mod snapshot;
mod source;
mod watch;

pub use error::WorldError;
pub use folder::{PopulationFile, STARTER_RON, World};
pub use snapshot::{Change, Scope, Snapshot};
pub use source::Source;
pub use watch::Watch;
