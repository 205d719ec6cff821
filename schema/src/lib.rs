//! The shared contract as plain checked data: text in, checked values out, text out. No disk, no clock.
//!
//! [`Space`] says which genes exist; a [`Genome`] holds one landscape's genes as bits; a [`Population`] is four of
//! them with the votes cast on them, as a RON file that people edit. Whatever is wrong with a file is found at once
//! and told as one [`Report`], each fault with line and column.

mod check;
mod current;
mod decode;
pub mod edit;
mod favourites;
mod genome;
pub mod html;
mod kind;
pub mod lanes;
mod lineage;
mod load;
mod parameter;
mod population;
mod printable;
mod report;
mod ron_tree;
pub mod scene;
mod space;
mod strategy;
mod table;
mod variety;
mod write;

pub use current::Current;
pub use decode::decode;
pub use favourites::Favourites;
pub use genome::{Chromosome, Genome, GenomeError};
pub use kind::{Allowed, Bounds, Demand, Kind, Kinds, SHIPPED, ShippedKind};
pub use lineage::{Lineage, unanswered};
pub use parameter::{Category, Parameter, Scale};
pub use population::{
    INDIVIDUALS, Individual, Loaded, LoadedPreset, Parent, Population, TreePreset, Votes, landscape_named,
};
pub use printable::printable;
pub use report::{Diagnostic, Report};
pub use space::Space;
pub use strategy::Strategy;
pub use variety::Variety;
