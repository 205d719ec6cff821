//! Four landscapes by chance, each a land of some kind with trees and a sky that go with it, and no two of a kind.

use genescape_schema::{Category, Genome, INDIVIDUALS, Individual, Kind, Kinds, Population, Space};

use crate::kinds::pick::Picker;
use crate::kinds::{Company, Home, ORDER, name};
use crate::seed::Dice;

/// Whole landscapes that are drawn until all parts of one are new.
const TRIES: u32 = 24;

/// A population by chance.
pub struct Drawn {
    pub population: Population,
    /// For people: what was asked for although it does not go together.
    pub notices: Vec<String>,
}

/// The same for the same seed, generation, space and kinds. Of a category of which `wanted` names kinds, only these
/// are drawn; of the first such category, each in its turn.
/// `None` unless there is a kind of each category.
pub fn population(
    space: &Space,
    kinds: &Kinds,
    wanted: &[&Kind],
    seed: u64,
    generation: u32,
) -> Option<Drawn> {
    let is_open = |kind: &&Kind| {
        let mut same = wanted.iter().filter(|one| one.category == kind.category).peekable();
        same.peek().is_none() || same.any(|one| one.id == kind.id)
    };
    // What is asked for comes first, and the rest is drawn to go with it.
    let mut order = ORDER;
    order.sort_by_key(|category| wanted.iter().all(|kind| kind.category != *category));
    // Each in its turn, so that a landscape that is drawn again is of the same kind.
    let turns: Vec<&Kind> = wanted.iter().copied().filter(|kind| kind.category == order[0]).collect();
    let picker = |number: usize| {
        let turn = turns.get(number % turns.len().max(1));
        let is_its_turn =
            |kind: &&Kind| turn.is_none_or(|turn| turn.category != kind.category || turn.id == kind.id);
        Picker { space, kinds, pool: kinds.iter().filter(is_open).filter(is_its_turn).collect() }
    };
    let mut dice = Dice::new(seed, "random", u64::from(generation));
    let (mut seen, mut notices) = (Vec::new(), Vec::new());
    let mut individuals = Vec::new();
    for number in 0..INDIVIDUALS {
        let picker = picker(number);
        let landscape = best(|| draw(&picker, order, &seen, &mut dice))?;
        if !landscape.suits {
            let name = &landscape.individual.name;
            notices.push(format!("landscape {} ({name}): these kinds do not go together", number + 1));
        }
        seen.extend(landscape.homes.into_iter().filter_map(Home::main));
        individuals.push(landscape.individual);
    }
    let individuals = individuals.try_into().ok()?;
    let population = Population::new(generation, seed, individuals);
    Some(Drawn { population, notices })
}

struct Landscape<'a> {
    individual: Individual,
    homes: [Home<'a>; 3],
    /// How many of its parts show what was seen before, or are taken for another kind.
    stale: usize,
    suits: bool,
}

/// One that goes together and shows nothing that was seen, or of those that were drawn the one that comes nearest to this.
fn best<'a>(mut draw: impl FnMut() -> Option<Landscape<'a>>) -> Option<Landscape<'a>> {
    let mut best: Option<Landscape<'a>> = None;
    for _ in 0..TRIES {
        let one = draw()?;
        let rank = |one: &Landscape| (!one.suits, one.stale);
        let is_best = best.as_ref().is_none_or(|best| rank(&one) < rank(best));
        if is_best {
            best = Some(one);
        }
        if best.as_ref().is_some_and(|best| rank(best) == (false, 0)) {
            break;
        }
    }
    best
}

fn draw<'a>(
    picker: &Picker<'a>,
    order: [Category; 3],
    seen: &[&Kind],
    dice: &mut Dice,
) -> Option<Landscape<'a>> {
    let space = picker.space;
    let mut company = Company::new(space);
    let mut genome = Genome::zero(space);
    let mut homes = [Home::Wild; 3];
    let (mut stale, mut suits) = (0, true);
    for category in order {
        let picked = picker.pick(category, &company, seen, dice)?;
        company.add(category, picked.chromosome.clone(), picked.home);
        *genome.chromosome_mut(category) = picked.chromosome;
        homes[category as usize] = picked.home;
        stale += usize::from(!picked.is_new);
        suits &= picked.suits;
    }
    let name = name::landscape(homes).unwrap_or_default();
    let individual = Individual { name, descent: String::new(), genome };
    Some(Landscape { individual, homes, stale, suits })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::kinds::testing::{drawn, kinds};

    fn homes<'a>(space: &Space, kinds: &'a Kinds, one: &Individual) -> [Home<'a>; 3] {
        Category::ALL.map(|category| Home::of(space, kinds, category, one.genome.chromosome(category)))
    }

    #[test]
    fn every_landscape_is_of_kinds_that_go_together() {
        let space = Space::builtin();
        let kinds = kinds(&space);
        let mut blends = 0;
        for seed in 0..100 {
            for one in drawn(&space, &kinds, seed, 0).individuals {
                let homes = homes(&space, &kinds, &one);
                for (home, category) in homes.into_iter().zip(Category::ALL) {
                    let genes = one.genome.chromosome(category);
                    assert!(home.bounds().expect("of a kind").contains(&space, genes), "{}", one.name);
                    blends += usize::from(matches!(home, Home::Between(..)));
                }
                for kind in homes.into_iter().flat_map(Home::kinds) {
                    for category in Category::ALL {
                        let goes = kind.goes_with(&space, category, one.genome.chromosome(category));
                        assert!(goes, "{}: {} does not go with its {category}", one.name, kind.id);
                    }
                }
                assert_eq!(Some(one.name), name::landscape(homes));
            }
        }
        assert!((50..500).contains(&blends), "{blends} of 1200");
    }

    #[test]
    fn the_four_are_of_different_kinds() {
        let space = Space::builtin();
        let kinds = kinds(&space);
        for seed in 0..100 {
            let population = drawn(&space, &kinds, seed, 0);
            for category in Category::ALL {
                let of = |one: &Individual| {
                    homes(&space, &kinds, one)[category as usize].main().map(|kind| &kind.id)
                };
                let ids: BTreeSet<_> = population.individuals.iter().map(of).collect();
                assert_eq!(ids.len(), INDIVIDUALS, "seed {seed}: {ids:?}");
            }
        }
    }

    #[test]
    fn the_same_seed_makes_the_same_population_and_another_one_another() {
        let space = Space::builtin();
        let kinds = kinds(&space);
        let text = |seed, generation| drawn(&space, &kinds, seed, generation).to_ron(&space);
        assert_eq!(text(7, 0), text(7, 0));
        assert_ne!(text(7, 0), text(8, 0));
        assert_ne!(text(7, 0).replace("generation: 0", ""), text(7, 1).replace("generation: 1", ""));
    }

    #[test]
    fn most_members_are_near_what_is_typical_and_some_are_odd() {
        let space = Space::builtin();
        let kinds = kinds(&space);
        let (mut near, mut far, mut all) = (0, 0, 0);
        for seed in 0..100 {
            for one in drawn(&space, &kinds, seed, 0).individuals {
                let genes = one.genome.chromosome(Category::Tree);
                let Home::Of(kind) = Home::of(&space, &kinds, Category::Tree, genes) else { continue };
                for (gene, allowed) in
                    kind.bounds.genes(&space).filter(|(gene, a)| !gene.is_seed() && !a.is_fixed())
                {
                    let deviation = allowed.deviation(genes.code(gene), gene.last_code());
                    near += usize::from(deviation < 0.5);
                    far += usize::from(deviation > 0.8);
                    all += 1;
                }
            }
        }
        assert!(near * 3 > all * 2 && far > 0, "{near} near, {far} far of {all}");
    }

    #[test]
    fn kinds_that_are_asked_for_are_drawn_in_turn() {
        let space = Space::builtin();
        let (kinds, _) = Kinds::shipped(&space);
        let (mut drawn, mut missing) = (0, Vec::new());
        for category in Category::ALL {
            let all: Vec<&Kind> = kinds.iter().filter(|kind| kind.category == category).collect();
            for (seed, wanted) in (1..).zip(all.chunks(INDIVIDUALS)) {
                let population = population(&space, &kinds, wanted, seed, 0).expect("kinds").population;
                for (kind, one) in wanted.iter().zip(&population.individuals) {
                    let home = homes(&space, &kinds, one)[category as usize];
                    missing.extend(home.main().is_none_or(|main| main.id != kind.id).then_some(&kind.id));
                    drawn += 1;
                }
            }
        }
        assert!(drawn > 90 && missing.is_empty(), "{missing:?} of {drawn}");
    }

    #[test]
    fn what_a_person_asks_for_is_drawn_even_if_it_does_not_go_together() {
        let space = Space::builtin();
        let kinds = kinds(&space);
        let drawn = |ids: &[&str]| {
            let wanted: Vec<&Kind> = ids.iter().flat_map(|id| kinds.called(id)).collect();
            population(&space, &kinds, &wanted, 3, 0).expect("kinds")
        };
        let Drawn { population, notices } = drawn(&["birch", "downs"]);
        assert!(population.individuals.iter().all(|one| one.name.starts_with("Birches on downs, ")));
        assert_eq!(notices, [""; 0]);
        let Drawn { population, notices } = drawn(&["palm", "lake"]);
        assert!(population.individuals.iter().all(|one| one.name.starts_with("Palms by a lake, ")));
        assert_eq!(notices.len(), INDIVIDUALS, "{notices:?}");
    }
}
