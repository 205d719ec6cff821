//! All kinds that a world knows: those that ship, and a person's own in their place or beside them.

use crate::kind::Kind;
use crate::parameter::Category;
use crate::report::Report;
use crate::space::Space;

/// A kind as it ships.
#[derive(Clone, Copy, Debug)]
pub struct ShippedKind {
    pub category: Category,
    /// The name of its file, without ending.
    pub id: &'static str,
    /// The text of its file.
    pub text: &'static str,
}

// Written by build.rs from the folder configs/kinds.
include!(concat!(env!("OUT_DIR"), "/shipped_kinds.rs"));

/// Kinds by category and id, at most one of each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Kinds {
    kinds: Vec<Kind>,
}

impl Kinds {
    /// Those that ship, with genes of this space; and what is wrong with those that cannot be read with it.
    pub fn shipped(space: &Space) -> (Self, Vec<Report>) {
        let (mut kinds, mut faults) = (Self::default(), Vec::new());
        for ShippedKind { category, id, text } in SHIPPED {
            match Kind::load_as(space, *category, id, &file_name(*category, id), text, true) {
                Ok(kind) => kinds.insert(kind),
                Err(report) => faults.push(report),
            }
        }
        (kinds, faults)
    }

    /// Adds a kind, in place of one of the same category and id.
    pub fn insert(&mut self, kind: Kind) {
        let key = |kind: &Kind| (kind.category, kind.id.clone());
        match self.kinds.binary_search_by_key(&key(&kind), key) {
            Ok(at) => self.kinds[at] = kind,
            Err(at) => self.kinds.insert(at, kind),
        }
    }

    /// All, by category and id.
    pub fn iter(&self) -> impl Iterator<Item = &Kind> {
        self.kinds.iter()
    }

    /// Those of a category, by id.
    pub fn of(&self, category: Category) -> impl Iterator<Item = &Kind> {
        self.kinds.iter().filter(move |kind| kind.category == category)
    }

    /// Those that a word of a person means; see [`Kind::is_called`].
    pub fn called<'a>(&'a self, word: &'a str) -> impl Iterator<Item = &'a Kind> {
        self.kinds.iter().filter(move |kind| kind.is_called(word))
    }
}

/// `kinds/tree/oak.ron`: where the file of a kind lies.
fn file_name(category: Category, id: &str) -> String {
    format!("kinds/{category}/{id}.ron")
}
