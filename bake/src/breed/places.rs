//! What is decided of four landscapes → in which of them a further part may stand: where it goes with the rest.

use genescape_schema::INDIVIDUALS;

use crate::kinds::{Company, Home};

/// Of the four landscapes those in which a part goes with the rest.
pub type Places = [bool; INDIVIDUALS];

/// What is decided of each landscape.
pub struct Settings<'a> {
    pub companies: [Company<'a>; INDIVIDUALS],
}

impl Settings<'_> {
    /// Where a part of these kinds goes with the rest.
    pub fn places(&self, home: Home<'_>) -> Places {
        self.companies.each_ref().map(|company| company.suits_all(home))
    }
}

/// Whether each of these parts finds a landscape of its own, of those after the first `taken`.
pub fn find_room(parts: &[Places], taken: usize) -> bool {
    find(parts, &mut std::array::from_fn(|landscape| landscape < taken))
}

/// Whether another one finds a landscape, too.
pub fn has_room(parts: &[Places], other: Places, taken: usize) -> bool {
    find_room(&[parts, &[other]].concat(), taken)
}

fn find(parts: &[Places], taken: &mut [bool; INDIVIDUALS]) -> bool {
    let Some((part, rest)) = parts.split_first() else { return true };
    (0..INDIVIDUALS).any(|landscape| {
        if taken[landscape] || !part[landscape] {
            return false;
        }
        taken[landscape] = true;
        let found = find(rest, taken);
        taken[landscape] = false;
        found
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_that_go_with_the_same_landscape_alone_find_no_room() {
        let (second, any) = ([false, true, false, false], [true; INDIVIDUALS]);
        assert!(find_room(&[any, any, any], 1) && find_room(&[any, second, any], 1));
        assert!(!find_room(&[second, any, second], 1), "both go with the second alone");
        assert!(!find_room(&[[true, false, false, false]], 1), "the first is taken");
        assert!(!find_room(&[any; INDIVIDUALS], 1), "there are three");
    }
}
