//! The kinds that ship, what is drawn and bred from them, and what a person does with kinds of their own.

use std::collections::BTreeSet;
use std::fs;

use genescape_bake::breed::Breeder;
use genescape_bake::kinds::{Company, Home};
use genescape_bake::random;
use genescape_bake::seed::Dice;
use genescape_schema::{Category, INDIVIDUALS, Individual, Kind, Kinds, Population, Space, Strategy, Votes};

use crate::world::World;

fn shipped() -> (Space, Kinds) {
    let space = Space::builtin();
    let (kinds, faults) = Kinds::shipped(&space);
    let told: Vec<String> = faults.iter().map(ToString::to_string).collect();
    assert!(told.is_empty(), "{}", told.join("\n"));
    (space, kinds)
}

fn homes<'a>(space: &Space, kinds: &'a Kinds, one: &Individual) -> [Home<'a>; 3] {
    Category::ALL.map(|category| Home::of(space, kinds, category, one.genome.chromosome(category)))
}

#[test]
fn kinds_that_ship_are_many_and_short_of_name() {
    let (_, kinds) = shipped();
    for (category, count) in Category::ALL.into_iter().zip([30, 20, 20]) {
        assert!(kinds.of(category).count() >= count, "{category}");
    }
    for kind in kinds.iter() {
        assert!(kind.name.chars().count() <= 28, "{} is too long for a picture", kind.name);
        assert!(!kind.mixes.is_empty(), "{} is in no group", kind.id);
    }
}

/// The mildest and the hardest places that a land may be.
fn corners(space: &Space, land: &Kind) -> Vec<genescape_schema::Chromosome> {
    let ends = |name: &str| land.bounds.gene(space, name).expect("a gene of lands").ends();
    let gene = |name: &str| space.find(name).expect("a gene of lands");
    let climates = [("temperature_c", "rain_mm"), ("relief_m", "snow_line")];
    let mut dice = Dice::new(1u32, "corners", 0);
    let mut corners = Vec::new();
    for (x, y) in climates {
        for place in 0..4 {
            let mut corner = genescape_bake::kinds::draw::member(space, &land.bounds, &mut dice);
            for (name, low) in [(x, place % 2 == 0), (y, place / 2 == 0)] {
                let (min, max) = ends(name);
                corner.set_code(gene(name), if low { min } else { max });
            }
            corners.push(corner);
        }
    }
    corners
}

#[test]
fn in_every_corner_of_every_land_several_trees_grow_under_several_skies() {
    let (space, kinds) = shipped();
    let mut poor = Vec::new();
    for land in kinds.of(Category::Terrain) {
        for corner in corners(&space, land) {
            let mut company = Company::new(&space);
            company.add(Category::Terrain, corner.clone(), Home::Of(land));
            for category in [Category::Tree, Category::Sky] {
                let suitable = kinds.of(category).filter(|kind| company.suits(kind)).count();
                let value = |name: &str| {
                    let gene = space.find(name).expect("a gene");
                    gene.value_text(corner.code(gene))
                };
                if suitable < 3 {
                    let place = ["temperature_c", "rain_mm", "relief_m", "snow_line"].map(value).join(", ");
                    poor.push(format!("{}: {suitable} {category} kinds at {place}", land.id));
                }
            }
        }
    }
    poor.sort();
    poor.dedup();
    assert!(poor.is_empty(), "\n{}", poor.join("\n"));
}

#[test]
fn random_landscapes_are_of_different_kinds_that_go_together() {
    let (space, kinds) = shipped();
    for seed in 0..24 {
        let drawn = random::population(&space, &kinds, &[], seed, 0).expect("kinds of all categories");
        assert_eq!(drawn.notices, [""; 0]);
        let all = drawn.population.individuals.each_ref().map(|one| homes(&space, &kinds, one));
        for category in Category::ALL {
            let of =
                |homes: &[Home<'_>; 3]| homes[category as usize].main().expect("drawn of a kind").id.clone();
            assert_eq!(
                all.iter().map(of).collect::<BTreeSet<_>>().len(),
                INDIVIDUALS,
                "seed {seed}: {category}"
            );
        }
        for (one, homes) in drawn.population.individuals.iter().zip(all) {
            for demand in homes.into_iter().flat_map(Home::demands) {
                let met = demand.is_met(&space, demand.category, one.genome.chromosome(demand.category));
                assert!(met, "{}: {} is not what its kinds ask for", one.name, demand.gene);
            }
        }
    }
}

/// Votes as a person might cast them who likes now this, now that, and sometimes nothing.
fn random_votes(seed: u64, generation: u32) -> Votes {
    let mut dice = Dice::new(seed, "votes", u64::from(generation));
    let mut vote = || Some(dice.below(5) as usize).filter(|vote| *vote < INDIVIDUALS);
    Votes { tree: vote(), terrain: vote(), sky: vote() }
}

#[test]
fn ten_generations_on_every_part_is_still_of_a_kind() {
    let (space, kinds) = shipped();
    for seed in 0..12 {
        let strategy = if seed % 2 == 0 { Strategy::Learned } else { Strategy::Classic };
        let drawn = random::population(&space, &kinds, &[], seed, 0).expect("kinds of all categories");
        let mut past = Vec::new();
        let mut population = drawn.population;
        for generation in 0..10 {
            population.votes = Some(random_votes(seed, generation));
            let child = Breeder::new(&space, &kinds, strategy, &past, &population).expect("votes");
            let child = child.bred(generation + 1, seed);
            past.push(std::mem::replace(&mut population, child));
            for one in &population.individuals {
                for (home, category) in homes(&space, &kinds, one).into_iter().zip(Category::ALL) {
                    let genes = one.genome.chromosome(category);
                    let is_in = home.bounds().is_some_and(|bounds| bounds.contains(&space, genes));
                    assert!(is_in, "{} of generation {generation}: {category} is like {home:?}", one.name);
                }
            }
        }
    }
}

#[test]
fn the_thesiss_flat_space_is_still_there() {
    let world = World::starters();
    world.bake(&["random", "--seed", "7", "--uniform"]).ok();
    let text = Population::random(&Space::builtin(), 7, 1).to_ron(&Space::builtin());
    assert_eq!(fs::read_to_string(world.population(1)).expect("a population"), text);
}

#[test]
fn a_person_draws_from_a_kind_of_their_own_and_hears_of_broken_ones() {
    let world = World::starters();
    let run = |words: &[&str]| {
        let output = world.run(words);
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
        (output.status.code(), text(output.stdout), text(output.stderr))
    };
    let (code, told, _) = run(&["kinds", "copy", "birch", "my_birch"]);
    assert!(code == Some(0) && told.contains("my_birch.ron"), "{told}");
    let path = world.file("kinds/tree/my_birch.ron");
    let text = fs::read_to_string(&path).expect("copied");
    assert_eq!(text.trim_end(), run(&["kinds", "show", "birch"]).1.trim_end());
    let name = text.split('"').nth(1).expect("a name");
    fs::write(&path, text.replacen(name, "My birches", 1)).expect("written");
    assert!(run(&["kinds", "copy", "birch", "my_birch"]).2.contains("my_birch.ron"), "it is there already");
    let (code, listed, _) = run(&["kinds"]);
    assert!(code == Some(0) && listed.contains("My birches") && listed.contains("(your own)"), "{listed}");
    // A mistake in one file stops neither the list nor a bake.
    fs::write(world.file("kinds/tree/broken.ron"), text.replacen("genes: (", "genes: (hight_m: 3, ", 1))
        .expect("written");
    let (code, listed, told) = run(&["kinds"]);
    assert!(code == Some(2) && listed.contains("My birches"), "{listed}");
    assert!(told.contains("broken.ron:") && told.contains("did you mean height_m?"), "{told}");
    let baked = world.bake(&["random", "--seed", "1", "--kind", "my_birch"]).ok();
    let names: Vec<&str> = baked.of("scene_ready").filter_map(|event| event["name"].as_str()).collect();
    assert!(names.iter().all(|name| name.starts_with("My birches ")) && names.len() == 4, "{names:?}");
    let told = |event: &serde_json::Value| {
        event["message"].as_str().is_some_and(|text| text.contains("broken.ron:"))
    };
    assert!(baked.of("notice").any(told));
    let (code, _, told) = run(&["random", "--kind", "my_brich"]);
    assert!(code == Some(2) && told.contains("did you mean my_birch?"), "{told}");
}
