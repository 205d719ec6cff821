//! The genetic algorithm: favourites live on, the rest is new, and what varies stays what it is.

use genescape_schema::{Chromosome, Kind, Parent, Strategy};
use proptest::prelude::*;

use super::*;
use crate::breed::cross;
use crate::kinds::testing::kinds;

/// As the thesis does.
fn breed(space: &Space, kinds: &Kinds, parents: &Population, next: u32) -> Result<Population, NoVotes> {
    let breeder = Breeder::new(space, kinds, Strategy::Classic, &[], parents)?;
    Ok(breeder.bred(next, parents.seed))
}

#[test]
fn without_votes_there_is_a_helpful_error() {
    let space = Space::builtin();
    let error =
        breed(&space, &Kinds::default(), &Population::random(&space, 1, 3), 4).expect_err("nobody voted");
    assert_eq!(error, NoVotes { generation: 3 });
    assert!(error.to_string().contains("votes: Some((tree: Some(0)"));
}

#[test]
fn children_are_called_what_they_are_and_keep_what_a_person_called_a_landscape() {
    let space = Space::builtin();
    let kinds = kinds(&space);
    let mut parents = voted(&space, &kinds, 1, 0, [Some(1), Some(1), Some(3)]);
    let called = |parents: &Population| {
        breed(&space, &kinds, parents, 1).expect("votes").individuals.map(|child| (child.name, child.descent))
    };
    let [trees, land, sky] =
        [(Category::Tree, 1), (Category::Terrain, 1), (Category::Sky, 3)].map(|(category, parent)| {
            home(&space, &kinds, category, &parents.individuals[parent])
                .main()
                .expect("drawn of a kind")
                .name
                .clone()
        });
    let (name, descent) = called(&parents)[0].clone();
    assert_eq!(name, format!("{trees} {land}, {sky}"));
    assert_eq!(descent, "trees of 2 · land of 2 · sky of 4");
    parents.individuals[1].name = "Spruces by a lake".into();
    assert_eq!(called(&parents)[0].0, format!("Spruces by a lake · {sky}"));
    assert!(called(&parents).iter().all(|(name, _)| name.starts_with("Spruces by a lake · ")));
    // Without kinds, by where they come from; and such names are no person's.
    let mut parents = wild(&space, 1, 0, [Some(1), Some(0), None]);
    let none = Kinds::default();
    let name =
        |parents: &Population| breed(&space, &none, parents, 1).expect("votes").individuals[0].name.clone();
    assert_eq!(name(&parents), "trees of 2 · land of 1 · new sky");
    for machine in
        ["trees of 2 · land of 1 · new sky", "1.0: tree of 0.1, terrain like 0.2, sky new", "new trees"]
    {
        parents.individuals[1].name = machine.into();
        parents.votes = Some(Votes { tree: Some(1), terrain: Some(1), sky: Some(1) });
        assert_eq!(name(&parents), "trees of 2 · land of 2 · sky of 2", "{machine}");
    }
}

#[test]
fn what_is_locked_stays_and_the_rest_still_changes() {
    let space = Space::builtin();
    let kinds = kinds(&space);
    for (seed, favourite) in (0..40).map(|seed| (seed, if seed % 2 == 0 { Some(2) } else { None })) {
        let mut parents = voted(&space, &kinds, seed, 0, [favourite, Some(1), None]);
        parents.locked = ["height_m", "tree_seed", "sky"].map(str::to_owned).into();
        let children = breed(&space, &kinds, &parents, 1).expect("votes");
        assert_eq!(children.locked, parents.locked);
        for (place, child) in children.individuals.iter().enumerate() {
            let kept = &parents.individuals[favourite.unwrap_or(place)].genome;
            for gene in ["height_m", "tree_seed"].map(|name| space.find(name).expect("a gene")) {
                assert_eq!(child.genome.code(gene), kept.code(gene));
            }
            let sky = |one: &Individual| one.genome.chromosome(Category::Sky).clone();
            assert_eq!(sky(child), sky(&parents.individuals[place]));
        }
        let trees = |one: &Individual| one.genome.chromosome(Category::Tree).clone();
        let fresh =
            |child: &Individual| !parents.individuals.iter().any(|parent| trees(parent) == trees(child));
        assert!(children.individuals.iter().any(fresh), "only what is locked stays");
    }
}

#[test]
fn small_steps_are_likelier_than_leaps() {
    let space = Space::builtin();
    let gene = space.find("height_m").expect("a gene");
    let mut distances = [0; 64];
    for seed in 0..200 {
        let parents = wild(&space, seed, 0, [Some(0); 3]);
        let code = parents.individuals[0].genome.code(gene);
        let child =
            breed(&space, &Kinds::default(), &parents, 1).expect("votes").individuals[2].genome.code(gene);
        distances[code.abs_diff(child) as usize] += 1;
    }
    let (near, far): (u32, u32) = (distances[1..=7].iter().sum(), distances[8..].iter().sum());
    assert!(distances[0] > 120 && near > 3 * far && far > 0, "{distances:?}");
}

#[test]
fn however_long_one_votes_every_child_is_of_a_kind_or_between_two_that_mix() {
    let space = Space::builtin();
    let kinds = kinds(&space);
    let (mut with, mut without) = (0, 0);
    for seed in 0..8 {
        with += strays(Strategy::Classic, &space, (&kinds, &kinds), seed, 16);
        without += strays(Strategy::Classic, &space, (&kinds, &Kinds::default()), seed, 16);
    }
    assert_eq!(with, 0);
    assert!(without > 500, "bred without kinds, {without} of 1536 stray");
}

#[test]
fn a_child_of_a_palm_and_an_oak_is_one_of_them() {
    let space = Space::builtin();
    let kinds = kinds(&space);
    let of = |id: &str, seed: u64| {
        let wanted: Vec<&Kind> = kinds.called(id).collect();
        crate::random::population(&space, &kinds, &wanted, seed, 0).expect("kinds").population
    };
    for seed in 0..40 {
        let mut parents = of("palm", seed);
        let oaks = of("oak", seed);
        for place in 1..INDIVIDUALS {
            parents.individuals[place] = oaks.individuals[place].clone();
        }
        parents.votes = Some(Votes { tree: Some(0), terrain: Some(1), sky: Some(1) });
        let crossed = &breed(&space, &kinds, &parents, 1).expect("votes").individuals[3];
        let crosses = ["trees of 1 × 2", "trees of 1 × 3", "trees of 1 × 4"];
        assert!(crosses.iter().any(|cross| crossed.descent.starts_with(cross)), "{}", crossed.descent);
        let home = home(&space, &kinds, Category::Tree, crossed);
        assert!(matches!(home, Home::Of(kind) if kind.id == "palm"), "{home:?}");
        let genes = crossed.genome.chromosome(Category::Tree);
        assert!(home.bounds().expect("of a kind").contains(&space, genes));
    }
}

#[test]
fn of_one_that_does_not_mix_come_the_traits_that_fit() {
    let space = Space::builtin();
    let kinds = kinds(&space);
    let typical = |id: &'static str| {
        let kind = kinds.called(id).next().expect("a kind");
        let mut genes = Chromosome::zero(&space, Category::Tree);
        kind.bounds.genes(&space).for_each(|(gene, allowed)| genes.set_code(gene, allowed.typical()));
        (genes, kind)
    };
    let ((palm, kind), (mut oak, _)) = (typical("palm"), typical("oak"));
    let density = space.find("density_per_ha").expect("a gene");
    let (_, dense) = kind.bounds.gene(&space, "density_per_ha").expect("a gene").ends();
    oak.set_code(density, dense);
    let home = |genes| Home::of(&space, &kinds, Category::Tree, genes);
    let (mut dice, mut fitted) = (Dice::new(1u32, "test", 0), 0);
    for _ in 0..50 {
        let (child, _) =
            cross::crossed(&space, Category::Tree, (&palm, home(&palm)), (&oak, home(&oak)), &mut dice);
        assert!(kind.bounds.contains(&space, &child));
        fitted += u32::from(child.code(density) == dense);
    }
    assert!((10..50).contains(&fitted), "{fitted} of 50");
}

#[test]
fn crossing_two_that_mix_takes_groups_of_genes_whole() {
    let space = Space::builtin();
    let kinds = kinds(&space);
    let chromosome = |id: &str| {
        let wanted: Vec<&Kind> = kinds.called(id).collect();
        let population = crate::random::population(&space, &kinds, &wanted, 5, 0).expect("kinds").population;
        population.individuals[0].genome.chromosome(Category::Tree).clone()
    };
    let (oak, birch) = (chromosome("oak"), chromosome("birch"));
    let home = |genes| Home::of(&space, &kinds, Category::Tree, genes);
    let (mut dice, mut both) = (Dice::new(1u32, "test", 0), 0);
    for _ in 0..50 {
        let (child, bounds) =
            cross::crossed(&space, Category::Tree, (&oak, home(&oak)), (&birch, home(&birch)), &mut dice);
        assert!(bounds.contains(&space, &child));
        let of = |group: &str, parent: &Chromosome| {
            let mut genes = space.category(Category::Tree).filter(|gene| gene.group == group);
            genes.all(|gene| child.code(gene) == parent.code(gene))
        };
        for group in ["form", "foliage", "placement"] {
            assert!(of(group, &oak) || of(group, &birch), "{group} is mixed");
        }
        assert!(of("", &oak), "the seed stays");
        both += u32::from(of("form", &oak) && of("foliage", &birch));
    }
    assert!(both > 5, "{both}");
}

#[test]
fn what_a_person_set_outside_its_kind_stays() {
    let space = Space::builtin();
    let kinds = kinds(&space);
    let (height, shape) =
        (space.find("height_m").expect("a gene"), space.find("leaf_shape").expect("a gene"));
    for seed in 0..40 {
        let mut parents = voted(&space, &kinds, seed, 0, [Some(0); 3]);
        let bounds =
            home(&space, &kinds, Category::Tree, &parents.individuals[0]).bounds().expect("of a kind");
        let (_, max) = bounds.gene(&space, "height_m").expect("a gene").ends();
        if max + 12 > height.last_code() {
            continue;
        }
        let genome = &mut parents.individuals[0].genome;
        let (set, other_shape) = (max + 12, (genome.code(shape) + 3) % 8);
        genome.set_code(height, set);
        genome.set_code(shape, other_shape);
        let children = breed(&space, &kinds, &parents, 1).expect("votes");
        for (place, child) in children.individuals.iter().enumerate() {
            let (code, leaf) = (child.genome.code(height), child.genome.code(shape));
            // A crossing may take the other's form or foliage.
            assert!(place == 3 || (code, leaf) == (set, other_shape), "child {place} of seed {seed}");
        }
        assert_eq!(children.individuals[0].genome.code(height), set);
    }
}

#[test]
fn seeds_stay_unless_a_new_individual_is_wanted() {
    let space = Space::builtin();
    let kinds = kinds(&space);
    for seed in 0..60 {
        let parents = voted(&space, &kinds, seed, 0, [Some(0), Some(1), Some(2)]);
        for child in breed(&space, &kinds, &parents, 1).expect("votes").individuals {
            for (part, (category, favourite)) in
                child.descent.split(" · ").zip(Category::ALL.into_iter().zip([0, 1, 2]))
            {
                let gene = space.category(category).find(|gene| gene.is_seed()).expect("a seed");
                let kept = parents.individuals[favourite].genome.code(gene) == child.genome.code(gene);
                let is_new = part.contains('×') || part.ends_with("drawn anew");
                assert_eq!(kept, !is_new, "{}", child.descent);
            }
        }
    }
}

#[test]
fn newcomers_are_of_kinds_that_nobody_has_seen_and_go_with_the_rest() {
    let space = Space::builtin();
    let kinds = kinds(&space);
    let of = |population: &Population, category| -> Vec<String> {
        let homes = population.individuals.iter().map(|one| home(&space, &kinds, category, one));
        homes.filter_map(Home::main).map(|kind| kind.id.clone()).collect()
    };
    let mut different = 0;
    for seed in 0..30 {
        let wanted: Vec<&Kind> = ["oak", "birch"].into_iter().flat_map(|id| kinds.called(id)).collect();
        let parents = crate::random::population(&space, &kinds, &wanted, seed, 0).expect("kinds").population;
        let parents =
            Population { votes: Some(Votes { tree: None, terrain: Some(0), sky: Some(1) }), ..parents };
        let children = breed(&space, &kinds, &parents, 1).expect("votes");
        let trees = of(&children, Category::Tree);
        assert!(!trees[..2].iter().any(|id| id == "oak" || id == "birch"), "{trees:?}");
        different += usize::from(trees[0] != trees[1]);
        let relief = children.individuals[0].genome.value(&space, "relief_m").expect("a gene");
        assert!(relief <= 61.0 || trees[0] != "palm", "{relief}");
    }
    // Of some lands only one of the three that were not seen is left.
    assert!(different > 15, "{different} of 30");
}

#[test]
fn a_newcomer_is_nobody_that_the_person_has_seen() {
    let space = Space::builtin();
    let kinds = kinds(&space);
    // Here the third child's land was the fourth parent's, to the seed.
    let parents = voted(&space, &kinds, 464_094_117_190_367_132, 67, [Some(0), None, Some(0)]);
    let children = breed(&space, &kinds, &parents, 68).expect("votes");
    let land = |one: &Individual| one.genome.chromosome(Category::Terrain).clone();
    assert!(!parents.individuals.iter().any(|one| land(one) == land(&children.individuals[2])));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, ..ProptestConfig::default() })]

    #[test]
    fn favourites_live_on_and_everything_else_is_new(
        seed: u64, generation in 0..99u32, later in 1..9u32, tree in 0..4usize, terrain in prop::option::of(0..4usize), sky in 0..4usize, is_wild: bool,
    ) {
        let space = Space::builtin();
        let kinds = if is_wild { Kinds::default() } else { kinds(&space) };
        let votes = [Some(tree), terrain, Some(sky)];
        let parents = match is_wild {
            true => wild(&space, seed, generation, votes),
            false => voted(&space, &kinds, seed, generation, votes),
        };
        let next = generation + later;
        let children = breed(&space, &kinds, &parents, next).expect("votes");
        prop_assert_eq!(&breed(&space, &kinds, &parents, next).expect("votes"), &children);
        prop_assert_eq!((children.generation, children.votes, children.seed), (next, None, seed));
        prop_assert_eq!(children.parent, parents.votes.map(|votes| Parent { generation, votes, variety: None }));
        for (category, vote) in Category::ALL.into_iter().zip([Some(tree), terrain, Some(sky)]) {
            let kept: Vec<bool> = children.individuals.iter().map(|child| {
                let genes = child.genome.chromosome(category);
                vote.is_some_and(|vote| genes == parents.individuals[vote].genome.chromosome(category))
            }).collect();
            let expected = [0, 1, 2, 3].map(|child| vote.is_some() && (child == 0 || child == category as usize + 1));
            prop_assert_eq!(kept, expected);
            for (index, child) in children.individuals.iter().enumerate() {
                let same = |other: &Individual| other.genome.chromosome(category) == child.genome.chromosome(category);
                prop_assert!(expected[index] || !parents.individuals.iter().any(same));
            }
        }
        // What it wrote, it can read.
        let text = children.to_ron(&space);
        prop_assert_eq!(Population::load(&space, "p.ron", &text).expect("valid").population, children);
    }
}
