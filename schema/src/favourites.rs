//! Landscapes that a person has marked with a star, as a RON file that people edit.

use std::collections::BTreeSet;

use crate::check::read;
use crate::population::INDIVIDUALS;
use crate::report::Report;

/// The marked landscapes: generation, and which of its four, from 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Favourites(pub BTreeSet<(u32, usize)>);

impl Favourites {
    /// Reads the text of the file; `file` is its name for messages.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn load(file: &str, text: &str) -> Result<Self, Report> {
        read(file, text, |checker, root| {
            let fields = checker.root(root, "Favourites", &["landscapes"])?;
            let list = checker.need(&fields, root, "Favourites", "landscapes")?;
            let mut all = BTreeSet::new();
            for node in checker.list(list, "landscapes")? {
                let fields = checker.record(node, "a favourite", &["generation", "landscape"])?;
                let generation = checker.need(&fields, node, "a favourite", "generation");
                let generation = generation.and_then(|node| checker.whole(node, "generation", u32::MAX));
                let Some(place) = checker.need(&fields, node, "a favourite", "landscape") else { continue };
                let landscape = checker.whole(place, "landscape", INDIVIDUALS);
                match landscape.filter(|landscape| (1..=INDIVIDUALS).contains(landscape)) {
                    Some(landscape) => all.extend(generation.map(|generation| (generation, landscape - 1))),
                    None if landscape.is_some() => {
                        let text = format!("landscape: there are landscapes 1 to {INDIVIDUALS}");
                        checker.error(place.span(), text);
                    }
                    None => {}
                }
            }
            Some(Self(all))
        })
    }

    /// The file's text. Reading it gives these favourites again.
    pub fn to_ron(&self) -> String {
        let line = |(generation, landscape): &(u32, usize)| {
            format!("        (generation: {generation}, landscape: {}),\n", landscape + 1)
        };
        let lines: String = self.0.iter().map(line).collect();
        format!(
            "// Landscapes that you marked with a star; they count from 1.\nFavourites(\n    landscapes: [\n{lines}    ],\n)\n"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn they_are_read_as_they_are_written(
            all in prop::collection::btree_set((any::<u32>(), 0..INDIVIDUALS), 0..8)
        ) {
            let favourites = Favourites(all);
            prop_assert_eq!(Favourites::load("f.ron", &favourites.to_ron()), Ok(favourites));
        }
    }

    #[test]
    fn faults_are_told_all_at_once() {
        let text = "Favourites(landscapes: [(generation: 1, landscape: 5), (generation: -1, landscape: 2)])";
        let told = Favourites::load("f.ron", text).expect_err("wrong").to_string();
        assert!(
            told.contains("there are landscapes 1 to 4") && told.contains("generation: expected"),
            "{told}"
        );
    }
}
