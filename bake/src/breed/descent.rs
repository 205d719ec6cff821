//! What children are called, and where their parts come from.

use genescape_schema::{Category, INDIVIDUALS, Individual, Kinds, Population};

use crate::kinds::{Home, name};

/// Where a chromosome comes from; parents count from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    Of(usize),
    /// A variation.
    Like(usize),
    /// Another individual of the same genes.
    Another(usize),
    /// A crossover, of the favourite first.
    Crossed(usize, usize),
    /// A crossover with what is none of the parents.
    Widened(usize),
    New,
}

/// What parents are called.
#[derive(Clone, Copy)]
pub struct Parents<'a> {
    pub population: &'a Population,
    /// Where landscape 1 has trees, land and sky from, if a person chose these.
    pub chosen: Option<&'a [String; 3]>,
}

impl Parents<'_> {
    /// The number that a landscape has under its picture, from 1, or where it comes from.
    fn name(self, category: Category, parent: usize) -> String {
        match self.chosen {
            None => (parent + 1).to_string(),
            Some(chosen) if parent == 0 => chosen[category as usize].clone(),
            Some(_) => format!("{}.{}", self.population.generation, parent + 1),
        }
    }
}

impl Origin {
    fn favourite(self) -> Option<usize> {
        match self {
            Self::Of(one) | Self::Like(one) | Self::Another(one) => Some(one),
            Self::Crossed(one, _) | Self::Widened(one) => Some(one),
            Self::New => None,
        }
    }

    fn phrase(self, parents: Parents<'_>, category: Category) -> String {
        let (part, name) = (PARTS[category as usize], |one| parents.name(category, one));
        match self {
            Self::Of(one) => format!("{part} of {}", name(one)),
            Self::Like(one) => format!("{part} like {}", name(one)),
            Self::Another(one) => format!("{part} as {}, drawn anew", name(one)),
            Self::Crossed(one, other) => format!("{part} of {} × {}", name(one), name(other)),
            Self::Widened(one) => format!("{part} of {} × new", name(one)),
            Self::New => format!("new {part}"),
        }
    }
}

/// What parts of a landscape are called, as in [`Category::ALL`].
const PARTS: [&str; 3] = ["trees", "land", "sky"];
/// Between the parts of a descent or a name.
const SEPARATOR: &str = Individual::SEPARATOR;

/// "trees of 2 · land like 3 · new sky": where each part comes from.
pub fn descent(parents: Parents<'_>, origins: [Origin; 3]) -> String {
    Category::ALL.map(|category| origins[category as usize].phrase(parents, category)).join(SEPARATOR)
}

/// What kind of place a child is: "Birches on karst, mackerel sky". One that has two or three parts of a parent that
/// a person gave a name keeps that, and says only what differs: "Grandmother's valley · mackerel sky". Parts of no
/// kind are called by their descent.
pub fn name(kinds: &Kinds, parents: Parents<'_>, origins: [Origin; 3], homes: [Home<'_>; 3]) -> String {
    let descends = |parent: usize| origins.iter().filter(|origin| origin.favourite() == Some(parent)).count();
    let main = (0..INDIVIDUALS).find(|parent| descends(*parent) >= 2);
    let given = main.and_then(|main| given_name(kinds, &parents.population.individuals[main].name));
    if let (None, Some(name)) = (given, name::landscape(homes)) {
        return name;
    }
    let is_said = |origin: Origin| given.is_some() && origin.favourite() == main;
    let differ = (0..3).filter(|&part| !is_said(origins[part]));
    let called = |part: usize| {
        let category = Category::ALL[part];
        name::part(category, homes[part]).unwrap_or_else(|| origins[part].phrase(parents, category))
    };
    given.map(str::to_owned).into_iter().chain(differ.map(called)).collect::<Vec<_>>().join(SEPARATOR)
}

/// The part of a name that a person gave; none of a name that this program made, now or in an older version.
fn given_name<'a>(kinds: &Kinds, name: &'a str) -> Option<&'a str> {
    let first = name.split(SEPARATOR).next().unwrap_or_default();
    let is_descent = |part: &&str| first.starts_with(&format!("{part} ")) || first == format!("new {part}");
    let is_phrase = PARTS.iter().any(is_descent) && (name.contains(SEPARATOR) || first.starts_with("new "));
    let is_older = first.starts_with(|c: char| c.is_ascii_digit()) && first.contains(": tree ");
    let is_made = is_phrase || is_older || is_of_kinds(kinds, first);
    (!first.is_empty() && !is_made).then_some(first)
}

/// Whether a name is "TREES LAND, SKY", or one of these parts alone.
fn is_of_kinds(kinds: &Kinds, name: &str) -> bool {
    let ends = |sky: &str| name.strip_suffix(sky).is_some_and(|rest| rest.ends_with(", "));
    let is_whole = kinds.of(Category::Tree).any(|tree| name.starts_with(&format!("{} ", tree.name)))
        && kinds.of(Category::Sky).any(|sky| ends(&sky.name));
    let is_part = |kind| name::part(Category::Tree, Home::Of(kind)).is_some_and(|part| part == name);
    is_whole || kinds.iter().any(|kind| kind.name == name || is_part(kind))
}

#[cfg(test)]
mod tests {
    use super::*;
    use genescape_schema::Space;

    #[test]
    fn parents_are_read_from_a_descent() {
        let parents = |descent: &str| {
            let random = Population::random(&Space::builtin(), 1, 7);
            let [one, ..] = random.individuals;
            Individual { descent: descent.to_owned(), ..one }.parents()
        };
        let population = Population::random(&Space::builtin(), 1, 7);
        let chosen = ["3.2", "fjord", "old.ron:1"].map(str::to_owned);
        let numbered = Parents { population: &population, chosen: None };
        for (origins, expected) in [
            ([Origin::Of(1), Origin::Like(2), Origin::New], [vec![2], vec![3], vec![]]),
            ([Origin::Crossed(0, 3), Origin::Another(3), Origin::Widened(2)], [vec![1, 4], vec![4], vec![3]]),
        ] {
            assert_eq!(parents(&descent(numbered, origins)), expected);
        }
        let origins = [Origin::Of(0), Origin::Like(0), Origin::Crossed(0, 2)];
        let descent = descent(Parents { chosen: Some(&chosen), ..numbered }, origins);
        assert_eq!(descent, "trees of 3.2 · land like fjord · sky of old.ron:1 × 7.3");
        let nothing = [const { Vec::<usize>::new() }; 3];
        for other in [descent.as_str(), "", "by hand", "trees of 9 · land like 0", "as 1234 · 2.5"] {
            assert_eq!(parents(other), nothing, "{other}");
        }
    }
}
