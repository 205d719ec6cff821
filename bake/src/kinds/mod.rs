//! Chromosomes as members of kinds: which one a chromosome belongs to, what goes together in a landscape, how a member is
//! drawn, and what the whole is called. No kind is named here: `configs/kinds` and people's own files say all.

mod called;
pub mod company;
pub mod draw;
pub mod home;
pub mod name;
pub mod pick;
#[cfg(test)]
pub mod testing;

use genescape_schema::Category;

/// In which the parts of a landscape are decided: trees and sky follow the land.
pub const ORDER: [Category; 3] = [Category::Terrain, Category::Tree, Category::Sky];

pub use called::called;
pub use company::Company;
pub use home::Home;
