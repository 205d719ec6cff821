//! The folder a person works in, and the only code that knows it: names of its files, populations, what is current,
//! atomic writes, and one watch for both programs.
//!
//! ```text
//! world/space.ron                              the parameter space, free to edit
//! world/population/g0000.ron …                 what the person made: only created, or edited in place
//! world/favourites.ron                         landscapes that a person has marked
//! world/kinds/tree/oak.ron …                  kinds of trees, lands and skies of a person's own, if there are any
//! world/baked/g0000/scene-0/scene.gltf …       what can be made again
//! world/baked/current.ron                      which scenes are ready
//! ```
//!
//! Besides, how a file is read and written that is nobody's yet: [`NamedFiles`] reads what a stranger's model names,
//! [`output`] says where a program may write.
//!
//! [`World`] reads and writes these files; a [`Snapshot`] is what lies there at one moment, and two of them compared
//! say what was saved in between; [`Watch`] takes one whenever something may have happened.

pub mod atomic_write;
mod error;
pub mod file_limit;
mod folder;
mod kinds;
mod named_files;
pub mod names;
mod near_name;
pub mod output;
pub mod regular_file;
mod snapshot;
mod source;
mod watch;

pub use error::WorldError;
pub use folder::{MAX_TEXT_BYTES, PopulationFile, STARTER_RON, World};
pub use kinds::WorldKinds;
pub use named_files::{MAX_MODEL_BYTES, NamedFiles};
pub use snapshot::{Change, Scope, Snapshot, Stamp};
pub use source::Source;
pub use watch::Watch;
