//! A world made by Genescape 0.1 opens, with what was invented since filled in and told. The fixture is what the first
//! bake that wrote a world (54ae208) made from its configs/.

use std::fs;
use std::path::Path;

use genescape_schema::Space;
use genescape_schema::edit::set_gene;
use genescape_world::{World, names};

/// A copy of the world of 0.1, changed text by text.
fn world(change: impl Fn(&str) -> String) -> (tempfile::TempDir, World) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let old = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/fixtures/world-0.1");
    fs::create_dir(folder.path().join(names::POPULATIONS)).expect("made");
    for file in [names::SPACE, &names::population(0)] {
        let text = fs::read_to_string(old.join(file)).expect("in the fixture");
        fs::write(folder.path().join(file), change(&text)).expect("written");
    }
    let world = World::open(folder.path()).expect("a world");
    (folder, world)
}

/// A text without the lines of a gene, as both files were before there was that gene.
fn without(gene: &str) -> impl Fn(&str) -> String {
    move |text| {
        let is_of_gene =
            |line: &&str| line.contains(&format!("\"{gene}\"")) || line.contains(&format!(" {gene}: "));
        text.lines().filter(|line| !is_of_gene(line)).collect::<Vec<_>>().join("\n")
    }
}

#[test]
fn a_world_of_0_1_opens_with_every_gene_of_today() {
    let (_folder, world) = world(str::to_owned);
    let (space, _) = world.space().expect("valid");
    for gene in Space::builtin().parameters() {
        assert!(space.find(&gene.name).is_some(), "{} is not filled in", gene.name);
    }
    let file = world.population(&space, 0).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(file.population.individuals[0].name, "Oak valley in June");
}

#[test]
fn a_gene_that_was_invented_later_is_filled_in_and_told() {
    let (_folder, world) = world(without("snow_line"));
    let (space, notices) = world.space().expect("valid");
    let told = "space.ron lacks snow_line; the built-in declaration is used: 0.2 … 1, default 1";
    assert!(notices.iter().any(|notice| notice.ends_with(told)), "{notices:?}");
    let file = world.population(&space, 0).unwrap_or_else(|error| panic!("{error}"));
    let told = |notice: &&String| notice.contains("g0000.ron:") && notice.contains("snow_line 1");
    assert_eq!(file.notices.iter().filter(told).count(), 4, "{:?}", file.notices);
    for individual in &file.population.individuals {
        assert_eq!(individual.genome.value(&space, "snow_line"), Some(1.0));
    }
    // Edited, it stands in the file; nothing is told of it any more, and nothing else has changed.
    let before = world.population_text(0).expect("there");
    let after = set_gene(&space, "g0000.ron", &before, 3, "snow_line", 0.2).expect("a gene");
    world.replace_population(0, &before, &after).expect("written");
    let file = world.population(&space, 0).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(file.population.individuals[3].genome.value(&space, "snow_line"), Some(0.2));
    assert_eq!(file.notices.iter().filter(told).count(), 3, "{:?}", file.notices);
    assert_eq!(before.lines().count() + 1, after.lines().count());
    assert!(before.lines().all(|line| after.contains(line)), "comments are kept");
}

#[test]
fn a_gene_without_a_default_cannot_be_lacking() {
    let (_folder, world) = world(without("height_m"));
    let (space, notices) = world.space().expect("valid");
    assert!(notices.iter().any(|notice| notice.contains("lacks height_m")), "{notices:?}");
    let error = world.population(&space, 0).expect_err("no height").to_string();
    assert!(error.contains("tree: 1 gene is missing: height_m (3 … 30 m)"), "{error}");
}
