//! `bake lineage`: a world's family as a page.

use std::fs;

use crate::world::World;

#[test]
fn a_world_becomes_a_page_whatever_lies_in_it() {
    let world = World::starters();
    let bred = fs::read_to_string(world.population(0)).expect("a population");
    let parent =
        "parent: Some((generation: 0, votes: (tree: Some(0), terrain: None, sky: None))), votes: None";
    fs::write(world.population(1), bred.replacen("votes: None", parent, 1)).expect("written");
    fs::write(world.population(2), "Population(generation: 2, <b>").expect("written");
    fs::write(world.file("baked/g0000/scene-0/thumbnail.jpg"), [0xff, 0xd8, 0xff, 0xe0]).expect("written");
    fs::write(world.file("baked/g0000/scene-1/thumbnail.jpg"), "no picture").expect("written");

    let told = world.run(&["lineage"]);
    assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
    let page = fs::read_to_string(world.file("lineage.html")).expect("a page");
    assert_eq!(page.matches("class=\"landscape\"").count(), 8);
    assert_eq!(page.matches("data:image/jpeg;base64,/9j/4A==").count(), 1);
    assert!(page.contains("g0002.ron") && !page.contains("<b>\n"), "what is left out is told");
    assert!(String::from_utf8_lossy(&told.stderr).contains("g0002.ron"));

    let lines = String::from_utf8(world.run(&["lineage", "--json"]).stdout).expect("text");
    let lines: Vec<serde_json::Value> =
        lines.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    assert_eq!(lines.len(), 2);
    assert_eq!(
        (&lines[1]["parent"]["generation"], &lines[1]["parent"]["votes"]["tree"]),
        (&0.into(), &1.into())
    );
}

#[test]
fn an_earlier_page_is_replaced_and_nobody_elses() {
    let world = World::starters();
    let path = world.file("tree.html");
    let out = path.to_str().expect("text");
    assert!(world.run(&["lineage", out]).status.success());
    assert!(world.run(&["lineage", out]).status.success(), "its own page");
    fs::write(&path, "<!doctype html>\nmine").expect("written");
    let told = world.run(&["lineage", out]);
    assert_eq!(told.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&told.stderr).contains("tree.html is there"));
    assert_eq!(fs::read_to_string(&path).expect("there"), "<!doctype html>\nmine");
    assert_eq!(world.run(&["lineage", "tree.txt"]).status.code(), Some(2), "another ending");
}

#[test]
fn parents_from_several_generations_and_the_thesiss_breeding_are_told() {
    let world = World::starters();
    let votes = "votes: Some((tree: Some(1), terrain: Some(2), sky: None))";
    let start = fs::read_to_string(world.population(0)).expect("a population");
    fs::write(world.population(0), start.replacen("votes: None", votes, 1)).expect("written");
    world.bake(&["next", "--strategy", "classic"]).ok();
    let explained = world.run(&["explain"]).stdout;
    assert!(String::from_utf8_lossy(&explained).starts_with("bred as in the thesis"));
    world.bake(&["breed", "--tree", "0.2", "--terrain", "1.3", "--sky", "1.1"]).ok();

    let told = world.run(&["lineage", "--json"]).stdout;
    let lines: Vec<serde_json::Value> =
        serde_json::Deserializer::from_slice(&told).into_iter().map(|line| line.expect("JSON")).collect();
    let strategies: Vec<&serde_json::Value> = lines.iter().map(|line| &line["strategy"]).collect();
    assert_eq!(strategies, ["learned", "classic", "learned"]);
    assert!(world.run(&["lineage"]).status.success());
    let page = fs::read_to_string(world.file("lineage.html")).expect("a page");
    assert_eq!(page.matches("as in the thesis").count(), 1);
    for link in ["<a href=\"#g0-2\">0.2</a>", "<a href=\"#g1-3\">1.3</a>", "<a href=\"#g1-1\">1.1</a>"] {
        assert!(page.contains(link), "{link}");
    }
    // A line arrives at each generation that was bred, also at that of parents from two.
    assert_eq!(page.matches(" y2=\"14\"/>").count(), 2);
}
