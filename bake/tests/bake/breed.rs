//! `bake breed`: parents from anywhere.

use std::fs;

use genescape_schema::{Category, Population, Space};

use crate::world::World;

fn load(path: &std::path::Path) -> Population {
    let text = fs::read_to_string(path).expect("a population");
    Population::load(&Space::builtin(), "p.ron", &text).expect("valid").population
}

#[test]
fn a_landscape_a_kind_and_a_file_become_parents() {
    let world = World::starters();
    let old = world.file("old.ron");
    let (start, seed) = (load(&world.population(0)), Population::random(&Space::builtin(), 5, 7));
    fs::write(&old, seed.to_ron(&Space::builtin())).expect("written");
    let sky = format!("{}:2", old.display());
    world.bake(&["breed", "--tree", "0.3", "--terrain", "fjord", "--sky", &sky, "--variety", "0.2"]).ok();
    let bred = load(&world.population(1));
    let first = &bred.individuals[0];
    let of = |category, one: &Population, landscape: usize| {
        first.genome.chromosome(category) == one.individuals[landscape].genome.chromosome(category)
    };
    assert!(of(Category::Tree, &start, 2) && of(Category::Sky, &seed, 1), "{}", first.descent);
    assert_eq!(bred.bred_from, Some(["0.3".to_owned(), "fjord".to_owned(), sky.clone()]));
    assert_eq!(bred.parent, None, "they are of no single generation");
    assert!(first.descent.starts_with("trees of 0.3 · land of fjord"), "{}", first.descent);
    let told = world.run(&["explain", "1"]);
    assert!(String::from_utf8_lossy(&told.stdout).contains("land of fjord"));
    let told = world.run(&["explain", "1", "--json"]).stdout;
    let told: serde_json::Value = serde_json::from_slice(&told).expect("JSON");
    assert_eq!((&told["generation"], &told["origin"]["bred_from"][1]), (&1.into(), &"fjord".into()));
    assert!(told["landscapes"][0]["stages"].as_array().is_some_and(|stages| stages.len() > 10));
    // The same again, by the same seed; what is not named is the favourite's.
    let again = ["breed", "--tree", "1", "--seed", "4"];
    world.bake(&again).ok();
    let second = load(&world.population(2));
    assert_eq!(second.individuals[0].genome, bred.individuals[0].genome, "all of landscape 1");
    assert_eq!(second.parent.map(|parent| parent.generation), Some(1));
}

#[test]
fn parents_that_are_not_there_are_told_and_nothing_is_made() {
    let world = World::starters();
    for (words, told) in [
        (["--tree", "fjord"], "fjord is a kind of terrain, not of tree"),
        (["--sky", "afterglo"], "did you mean afterglow?"),
        (["--tree", "7.1"], "g0007.ron"),
        (["--tree", "0.5"], "1 to 4"),
        (["--terrain", "nowhere.ron:1"], "nowhere.ron"),
        (["--variety", "2"], "from 0, close variations, to 1"),
    ] {
        let output = world.run(&["breed", words[0], words[1]]);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{words:?}: {error}");
        assert!(error.contains(told), "{words:?}: {error}");
    }
    assert!(!world.population(1).exists());
}
