//! Breeding by a model of what the person wants.

use genescape_schema::{Parent, Strategy};
use proptest::prelude::*;

use super::*;
use crate::bench::person::{Person, Taste};
use crate::kinds::testing::kinds;
use crate::phenotype::Phenotype;

fn breed(space: &Space, kinds: &Kinds, past: &[Population], parents: &Population, next: u32) -> Population {
    let breeder = Breeder::new(space, kinds, Strategy::Learned, past, parents).expect("votes");
    breeder.bred(next, parents.seed)
}

/// How far the last favourite is from what a simulated person wants, a mean over categories.
fn distance_after(strategy: Strategy, space: &Space, kinds: &Kinds, rounds: u32, seed: u64) -> f32 {
    let start = |seed| match kinds.iter().next() {
        Some(_) => drawn(space, kinds, seed, 0),
        None => Population::random(space, seed, 0),
    };
    let target = start(seed + 1000).individuals[0].genome.clone();
    let mut person = Person::new(space, &target, Taste::Separable, 0.02, seed);
    let mut history = vec![start(seed)];
    loop {
        let (now, past) = history.split_last_mut().expect("a first one");
        let votes = person.vote(now);
        now.votes = Some(votes);
        if past.len() as u32 == rounds {
            let of = |category: Category| {
                let chosen = &now.individuals[votes.get(category).expect("a vote")];
                person.distances(&chosen.genome)[category as usize]
            };
            return Category::ALL.into_iter().map(of).sum::<f32>() / 3.0;
        }
        let next = now.generation + 1;
        let breeder = Breeder::new(space, kinds, strategy, past, now).expect("votes");
        let child = breeder.bred(next, seed);
        history.push(child);
    }
}

fn mean(values: impl Iterator<Item = f32>) -> f32 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

#[test]
fn ten_votes_teach_much_more_than_the_genetic_algorithm_learns() {
    let space = Space::builtin();
    let all = [Kinds::shipped(&space).0, Kinds::default()];
    // Measured: 0.3 and 0.75 of the distance. Means of 8 persons of three categories differ by a tenth from seed to seed.
    for (kinds, part) in all.iter().zip([0.6, 0.92]) {
        let after = |strategy| mean((0..8).map(|seed| distance_after(strategy, &space, kinds, 10, seed)));
        let (learned, classic) = (after(Strategy::Learned), after(Strategy::Classic));
        assert!(learned < part * classic, "{learned} and {classic}");
    }
}

#[test]
fn more_votes_bring_it_nearer() {
    let space = Space::builtin();
    let (kinds, _) = Kinds::shipped(&space);
    let after =
        |rounds| mean((20..68).map(|seed| distance_after(Strategy::Learned, &space, &kinds, rounds, seed)));
    let [start, few, many] = [0, 4, 16].map(after);
    // Measured: 0.45 and 0.75. Means of 16 persons differ by a tenth with whatever changes a kind.
    assert!(few < 0.6 * start && many < 0.8 * few, "{start}, {few}, {many}");
}

#[test]
fn every_child_is_of_a_kind_or_between_two_that_mix() {
    let space = Space::builtin();
    let kinds = kinds(&space);
    let strays: usize = (0..4).map(|seed| strays(Strategy::Learned, &space, (&kinds, &kinds), seed, 8)).sum();
    assert_eq!(strays, 0);
}

#[test]
fn kinds_that_did_not_please_are_not_shown_again_soon() {
    let space = Space::builtin();
    let (kinds, _) = Kinds::shipped(&space);
    let mut again = 0;
    for seed in 0..30 {
        let parents = voted(&space, &kinds, seed, 0, [None, Some(0), Some(0)]);
        let main =
            |one: &Individual| home(&space, &kinds, Category::Tree, one).main().map(|kind| kind.id.clone());
        let seen: Vec<_> = parents.individuals.iter().map(main).collect();
        let children = breed(&space, &kinds, &[], &parents, 1);
        again += children.individuals.iter().filter(|child| seen.contains(&main(child))).count();
    }
    // By chance a tenth are of the four kinds that were shown.
    assert!(again < 8, "{again} of 120");
}

#[test]
fn a_favourite_better_than_four_that_do_not_please_comes_back() {
    let space = Space::builtin();
    let kinds = kinds(&space);
    for seed in 0..10 {
        let first = voted(&space, &kinds, seed, 0, [Some(2); 3]);
        let mut second = breed(&space, &kinds, &[], &first, 1);
        second.votes = Some(Votes::default());
        let third = breed(&space, &kinds, std::slice::from_ref(&first), &second, 2);
        let liked =
            |category| home(&space, &kinds, category, &first.individuals[2]).main().map(|kind| &kind.id);
        for category in Category::ALL {
            let guess = home(&space, &kinds, category, &third.individuals[0]).main().map(|kind| &kind.id);
            assert_eq!(guess, liked(category), "seed {seed}");
        }
    }
}

#[test]
fn what_a_person_set_outside_its_kind_stays() {
    let space = Space::builtin();
    let kinds = kinds(&space);
    let height = space.find("height_m").expect("a gene");
    let mut seen = 0;
    for seed in 0..20 {
        let mut parents = voted(&space, &kinds, seed, 0, [Some(0); 3]);
        let main =
            |one: &Individual| home(&space, &kinds, Category::Tree, one).main().map(|kind| kind.id.clone());
        let bounds =
            home(&space, &kinds, Category::Tree, &parents.individuals[0]).bounds().expect("of a kind");
        let set = bounds.gene(&space, "height_m").expect("a gene").ends().1 + 12;
        if set > height.last_code() {
            continue;
        }
        parents.individuals[0].genome.set_code(height, set);
        let kind = main(&parents.individuals[0]);
        for child in breed(&space, &kinds, &[], &parents, 1).individuals {
            let is_relative = main(&child) == kind;
            seen += usize::from(is_relative);
            assert!(!is_relative || child.genome.code(height) == set, "seed {seed}: {}", child.descent);
        }
    }
    assert!(seen > 20, "{seen}");
}

/// How many different chromosomes of a category there are in a generation.
fn different(population: &Population, category: Category) -> usize {
    let mut all = population.individuals.each_ref().map(|one| one.genome.chromosome(category)).to_vec();
    all.sort_unstable();
    all.dedup();
    all.len()
}

/// Pairs of landscapes that differ in two categories at least.
fn pairs_of_places(population: &Population) -> usize {
    let genomes = population.individuals.each_ref().map(|one| &one.genome);
    let differ_in = |a: usize, b: usize| {
        let differs =
            |category: &Category| genomes[a].chromosome(*category) != genomes[b].chromosome(*category);
        Category::ALL.iter().filter(|category| differs(category)).count()
    };
    (0..INDIVIDUALS).flat_map(|a| (0..a).map(move |b| (a, b))).filter(|(a, b)| differ_in(*a, *b) > 1).count()
}

fn has_two_alike(population: &Population) -> bool {
    let genomes = population.individuals.each_ref().map(|one| &one.genome);
    (0..INDIVIDUALS).any(|number| genomes[..number].contains(&genomes[number]))
}

#[test]
fn whatever_is_locked_no_two_are_alike() {
    let space = Space::builtin();
    let (kinds, _) = Kinds::shipped(&space);
    for (seed, locked) in [(60, &["tree"][..]), (61, &["terrain"]), (62, &["sky"]), (63, &["tree", "sky"])] {
        let mut first = voted(&space, &kinds, seed, 0, [Some(0); 3]);
        first.locked = locked.iter().map(|one| (*one).to_owned()).collect();
        let mut history = vec![first];
        for next in 1..12 {
            let (now, past) = history.split_last().expect("a first one");
            let mut children = breed(&space, &kinds, past, now, next);
            assert!(!has_two_alike(&children), "{locked:?} are locked, generation {next}");
            children.votes = Some(Votes { tree: Some(0), terrain: Some(0), sky: Some(0) });
            history.push(children);
        }
    }
}

#[test]
fn who_has_settled_sees_what_is_known_beside_what_is_new_and_never_two_alike() {
    const ROUNDS: u32 = 16;
    let space = Space::builtin();
    let (kinds, _) = Kinds::shipped(&space);
    let (mut early, mut late, mut places) = (0, 0, 0);
    for seed in 40..43 {
        let target = drawn(&space, &kinds, seed + 1000, 0).individuals[0].genome.clone();
        let mut person = Person::new(&space, &target, Taste::Separable, 0.0, seed);
        let mut history = vec![drawn(&space, &kinds, seed, 0)];
        for next in 1..=ROUNDS {
            let (now, past) = history.split_last_mut().expect("a first one");
            now.votes = Some(person.vote(now));
            let children = breed(&space, &kinds, past, now, next);
            assert!(!has_two_alike(&children), "seed {seed}, generation {next}");
            let all = Category::ALL.map(|category| different(&children, category));
            assert!(all.iter().all(|count| *count > 1), "there is a choice of each: {all:?}");
            match next {
                ..5 => early += all.iter().sum::<usize>(),
                12.. => {
                    late += all.iter().sum::<usize>();
                    places += pairs_of_places(&children);
                }
                _ => {}
            }
            history.push(children);
        }
    }
    // Of 12 chromosomes each: 4 and 5 generations of three persons.
    assert!(early > 11 * 12, "{early} of 144");
    assert!(late < 9 * 15, "{late} of 180");
    // Of 6 pairs each; with what is known shown as often as can be it would be half of them.
    assert!(places > 5 * 15, "{places} of 90 pairs are different places");
}

/// Votes by chance agree now and then. What they agree on must not become all there is to choose from.
#[test]
fn whatever_was_voted_four_landscapes_look_like_four_places() {
    let space = Space::builtin();
    let (kinds, _) = Kinds::shipped(&space);
    for seed in 70..73 {
        let mut history = vec![drawn(&space, &kinds, seed, 0)];
        for next in 1..=10 {
            let (now, past) = history.split_last_mut().expect("a first one");
            now.votes = Some(random_votes(seed, next));
            let children = breed(&space, &kinds, past, now, next);
            if next > 2 {
                let seen = children.individuals.each_ref().map(|one| Phenotype::of(&space, &one.genome));
                let seen = seen.map(|one| one.expect("complete"));
                for (number, a) in seen.iter().enumerate() {
                    for b in &seen[..number] {
                        // Measured with 16 seeds: 0.47 at least; 0 is alike, 1 as different as two drawn by chance.
                        assert!(a.distance(b) > 0.4, "seed {seed}, generation {next}: {}", a.distance(b));
                    }
                }
            }
            history.push(children);
        }
    }
}

#[test]
fn an_account_names_the_kind_that_was_always_chosen() {
    let space = Space::builtin();
    let (kinds, _) = Kinds::shipped(&space);
    let mut history = vec![voted(&space, &kinds, 5, 0, [Some(1); 3])];
    let kind =
        |one: &Individual| home(&space, &kinds, Category::Tree, one).main().map(|kind| kind.name.clone());
    let wanted = kind(&history[0].individuals[1]);
    let called = wanted.as_ref().map(|name| name.to_lowercase());
    for generation in 1..6 {
        let (parents, past) = history.split_last().expect("a first one");
        let mut children = breed(&space, &kinds, past, parents, generation);
        let like = children.individuals.iter().position(|one| kind(one) == wanted);
        children.votes = Some(Votes { tree: like, terrain: Some(0), sky: None });
        history.push(children);
    }
    let (parents, past) = history.split_last().expect("a first one");
    let accounts = Breeder::new(&space, &kinds, Strategy::Learned, past, parents).expect("votes").accounts();
    let [trees, land, sky] = &accounts[..] else { panic!("{accounts:?}") };
    assert_eq!((trees.votes, land.votes, sky.votes), (6, 6, 6));
    assert_eq!(trees.kinds[0].0, called, "{trees}");
    assert!(!trees.genes.is_empty() && trees.to_string().starts_with("tree      6 votes: "), "{trees}");
}

#[test]
fn threads_change_nothing() {
    let space = Space::builtin();
    let kinds = kinds(&space);
    let first = voted(&space, &kinds, 3, 0, [Some(0), Some(1), None]);
    let mut second = breed(&space, &kinds, &[], &first, 1);
    second.votes = Some(random_votes(3, 1));
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| breed(&space, &kinds, std::slice::from_ref(&first), &second, 2))
    };
    assert_eq!(with(1), with(4));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn children_are_four_locks_hold_and_a_seed_gives_them_again(
        seed: u64, generation in 0..99u32, later in 1..9u32, tree in prop::option::of(0..4usize), sky in 0..4usize, is_wild: bool,
    ) {
        let space = Space::builtin();
        let kinds = if is_wild { Kinds::default() } else { kinds(&space) };
        let votes = [tree, Some(1), Some(sky)];
        let mut parents = match is_wild {
            true => wild(&space, seed, generation, votes),
            false => voted(&space, &kinds, seed, generation, votes),
        };
        parents.locked = ["height_m", "sky"].map(str::to_owned).into();
        let next = generation + later;
        let children = breed(&space, &kinds, &[], &parents, next);
        prop_assert_eq!(&breed(&space, &kinds, &[], &parents, next), &children);
        prop_assert_eq!((children.generation, children.votes, children.seed), (next, None, seed));
        prop_assert_eq!(children.parent, parents.votes.map(|votes| Parent { generation, votes, variety: None }));
        prop_assert_eq!(&children.locked, &parents.locked);
        let height = space.find("height_m").expect("a gene");
        for (place, child) in children.individuals.iter().enumerate() {
            let kept = &parents.individuals[tree.unwrap_or(place)].genome;
            prop_assert_eq!(child.genome.code(height), kept.code(height));
            let liked = &parents.individuals[sky].genome;
            prop_assert_eq!(child.genome.chromosome(Category::Sky), liked.chromosome(Category::Sky));
        }
        for category in [Category::Tree, Category::Terrain] {
            prop_assert_eq!(different(&children, category), INDIVIDUALS, "{} repeats", category);
        }
        // What it wrote, it can read.
        let text = children.to_ron(&space);
        prop_assert_eq!(Population::load(&space, "p.ron", &text).expect("valid").population, children);
    }
}
