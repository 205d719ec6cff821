//! A whole world, as a person bakes it: once, again, and after changing a gene.

use std::fs;

use genescape_bake::audition;
use genescape_schema::{Kinds, Space};

use crate::world::World;

/// Replaces the line of a gene in the chromosome of scene `scene`.
pub fn set_gene(text: &str, scene: usize, gene: &str, value: &str) -> String {
    let mut seen = 0;
    let lines = text.lines().map(|line| {
        if line.trim_start().starts_with(&format!("{gene}:")) {
            seen += 1;
            if seen == scene + 1 {
                return format!("                {gene}: {value},");
            }
        }
        line.to_owned()
    });
    let changed = lines.collect::<Vec<_>>().join("\n");
    assert_ne!(changed, text, "{gene} of scene {scene} was found");
    changed
}

#[test]
fn first_bake_makes_everything_and_the_second_nothing() {
    let (world, first) = (World::starters(), World::first_bake());
    assert_eq!(first.of("scene_ready").count(), 4);
    assert_eq!(first.built().len(), first.planned());
    let stages = |name: &str| first.built().iter().filter(|(stage, _)| stage == name).count();
    assert_eq!([stages("tree 4"), stages("tree 5"), stages("scene")], [4, 0, 4]);
    assert_eq!(stages("ground texture 0"), 1, "all scenes share it");
    for scene in 0..4 {
        let path = world.scene(scene);
        let json: serde_json::Value =
            serde_json::from_slice(&fs::read(&path).expect("a scene")).expect("JSON");
        assert!(json.get("extensionsRequired").is_none());
        for buffer in json["buffers"].as_array().expect("buffers") {
            let uri = buffer["uri"].as_str().expect("a file");
            let file = fs::read(path.parent().expect("a folder").join(uri)).expect("the blob exists");
            assert_eq!(file.len() as u64, buffer["byteLength"].as_u64().expect("a length"));
            assert!(uri.contains(&blake3::hash(&file).to_hex().to_string()), "{uri} is named by its bytes");
        }
    }
    assert!(world.file("baked/current.ron").is_file());

    let before = world.files();
    let second = world.bake(&[]).ok();
    assert_eq!(second.built(), []);
    assert_eq!(world.files(), before);
}

#[test]
fn the_four_landscapes_differ() {
    let world = World::starters();
    let scenes: Vec<_> = (0..4).map(|s| fs::read(world.scene(s)).expect("a scene")).collect();
    for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
        assert_ne!(scenes[a], scenes[b]);
    }
}

/// Stages that read no genes but those of the land.
const LAND: [&str; 2] = ["landform", "terrain"];
/// Stages that read no genes but those of trees.
const TREES: [&str; 6] = ["tree textures", "tree 0", "tree 1", "tree 2", "tree 3", "tree 4"];
/// Stages that read no genes but those of the sky.
const SKY: [&str; 2] = ["sky light", "sky pictures"];
/// The stage that reads genes of the land and of trees: what lies on the ground lies under trees.
const GROUND: &str = "ground maps";
/// Stages to which every gene matters.
const ALL: [&str; 3] = ["light map", "start", "scene"];

/// What a change must rebuild and what it must not, said again by hand. Stages that are in neither list may do either:
/// the foreground is only made again where the best place to stand has moved.
#[test]
fn a_changed_gene_rebuilds_what_depends_on_it_and_nothing_else() {
    let world = World::starters();
    let of_land = [&LAND[..], &ALL, &["placement", "foreground", GROUND]].concat();
    let of_trees = [&TREES[..], &ALL, &["placement", GROUND]].concat();
    let of_sky = [&SKY[..], &ALL].concat();
    for (scene, gene, value, rebuilt, kept) in [
        (1, "terrain_seed", "77", &of_land, [&TREES[..], &SKY, &["ground texture 0"]].concat()),
        (
            2,
            "sun_elevation_deg",
            "45",
            &of_sky,
            [&LAND[..], &TREES, &["ground texture 0", "placement", GROUND]].concat(),
        ),
        (3, "height_m", "11", &of_trees, [&LAND[..], &SKY, &["ground texture 0"]].concat()),
        (0, "tree_seed", "3", &of_trees, [&LAND[..], &SKY, &["ground texture 0"]].concat()),
    ] {
        world.edit(0, |text| set_gene(&text, scene, gene, value));
        let built = world.bake(&[]).ok().built();
        assert!(built.iter().all(|(_, user)| *user == scene as u64), "{gene} of scene {scene}: {built:?}");
        let is_built = |stage: &&str| built.iter().any(|(name, _)| name == stage);
        let missing: Vec<_> = rebuilt.iter().filter(|stage| !is_built(stage)).collect();
        let needless: Vec<_> = kept.iter().filter(|stage| is_built(stage)).collect();
        assert!(missing.is_empty() && needless.is_empty(), "{gene}: not {missing:?}, but {needless:?}");
    }
}

#[test]
fn a_gene_changed_back_costs_nothing() {
    let world = World::starters();
    let original = fs::read_to_string(world.population(0)).expect("a population");
    world.edit(0, |text| set_gene(&text, 0, "cloud_cover", "0.9"));
    assert_ne!(world.bake(&[]).ok().built(), []);
    world.edit(0, |_| original);
    assert_eq!(world.bake(&[]).ok().built(), []);
}

#[test]
fn comments_and_layout_of_a_population_do_not_matter() {
    let world = World::starters();
    world.edit(0, |text| format!("// mine\n\n{}\n", text.replace(": ", ":   ")));
    assert_eq!(world.bake(&[]).ok().built(), []);
}

#[test]
fn next_breeds_from_votes() {
    let world = World::starters();
    world.edit(0, |text| {
        assert!(text.contains("votes: None"));
        text.replace("votes: None", "votes: Some((tree: Some(0), terrain: Some(1), sky: Some(2)))")
    });
    let next = world.bake(&["next"]).ok();
    let bred = next.of("bred").next().expect("told");
    assert!(bred["parent"] == 0 && bred["path"].as_str().is_some_and(|path| path.ends_with("g0001.ron")));
    assert_eq!(next.of("scene_ready").count(), 4);
    assert!(next.built().len() < next.planned(), "chromosomes that live on are not baked again");
    assert!(world.population(1).is_file());
    assert!(world.file("baked/g0000/scene-0/scene.gltf").is_file(), "older generations stay");
}

#[test]
fn explain_names_the_gene() {
    let world = World::starters();
    world.edit(0, |text| set_gene(&text, 1, "turbidity", "6"));
    world.bake(&[]).ok();
    let output = world.run(&["explain", "2"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success());
    assert!(text.contains("turbidity"), "{text}");
    assert!(text.contains("reused"), "{text}");
    // A value that no decimal of a few digits is exactly, in the words of the file.
    world.edit(0, |text| set_gene(&text, 1, "height_m", "12.86"));
    world.bake(&[]).ok();
    let text = String::from_utf8(world.run(&["explain", "2"]).stdout).expect("text");
    assert!(text.contains("→ 12.86"), "{text}");
}

#[test]
fn a_copy_of_a_population_leaves_the_scenes_of_the_first_alone() {
    let world = World::starters();
    let before = fs::read(world.scene(1)).expect("a scene");
    let text = fs::read_to_string(world.population(0)).expect("there");
    fs::write(world.population(4), set_gene(&text, 1, "cloud_cover", "0.6")).expect("copied");
    let baked = world.bake(&[]).ok();
    assert_eq!(baked.of("planned").next().expect("a plan")["generation"], 4);
    let told = |event: &serde_json::Value| {
        event["message"].as_str().is_some_and(|text| text.contains("by its name"))
    };
    assert!(baked.of("notice").any(told), "{:?}", baked.events);
    assert!(fs::read(world.scene(1)).expect("a scene") == before);
    assert!(world.file("baked/g0004/scene-1/scene.gltf").is_file());
}

#[test]
fn random_without_a_seed_draws_one_and_tells_it() {
    let world = World::starters();
    let output = world.run(&["random", "--size", "65"]);
    let said = String::from_utf8(output.stdout).expect("text");
    let seed = said.lines().find_map(|line| line.strip_prefix("seed ")).expect("a seed is told");
    let again = World::starters();
    again.bake(&["random", "--seed", seed]).ok();
    let text = |world: &World| fs::read_to_string(world.population(1)).expect("a population");
    assert_eq!(text(&world), text(&again));
}

#[test]
fn params_prints_every_gene() {
    let world = World::new();
    let text = String::from_utf8(world.run(&["params"]).stdout).expect("text");
    for parameter in genescape_schema::Space::builtin().parameters() {
        assert!(text.contains(&parameter.name));
    }
}

#[test]
fn gc_keeps_what_scenes_use() {
    let world = World::starters();
    let output = world.run(&["cache", "gc", "--max-size", "0"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for scene in 0..4 {
        let path = world.scene(scene);
        let json: serde_json::Value =
            serde_json::from_slice(&fs::read(&path).expect("a scene")).expect("JSON");
        for buffer in json["buffers"].as_array().expect("buffers") {
            let uri = buffer["uri"].as_str().expect("a file");
            assert!(path.parent().expect("a folder").join(uri).is_file(), "{uri} is in use");
        }
    }
    world.bake(&[]).ok();
}

#[test]
fn a_seed_makes_the_same_world_on_every_machine() {
    const SEED: u64 = 8;
    let world = World::starters();
    let baked = world.bake(&["random", "--seed", &SEED.to_string()]).ok();
    assert_eq!(baked.of("scene_ready").count(), 4);
    let space = Space::builtin();
    let (kinds, _) = Kinds::shipped(&space);
    let text = |seed: u64| {
        let draw = |attempt| audition::drawn(&space, &kinds, &[], seed, 1, attempt).population;
        audition::audition(&space, draw).population.to_ron(&space)
    };
    assert_eq!(fs::read_to_string(world.population(1)).expect("a population"), text(SEED));
    assert_ne!(text(SEED), text(SEED + 1));
}

#[test]
fn a_world_of_an_early_version_bakes_and_says_what_was_filled_in() {
    let (world, old) = (World::new(), concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/fixtures/world-0.1"));
    fs::create_dir_all(world.file("population")).expect("a folder");
    // As if there had not been this gene yet: in neither file a line of it.
    for (file, sign) in [("space.ron", "\"snow_line\""), ("population/g0000.ron", " snow_line: ")] {
        let text = fs::read_to_string(format!("{old}/{file}")).expect("in the fixture");
        let older: Vec<&str> = text.lines().filter(|line| !line.contains(sign)).collect();
        fs::write(world.file(file), older.join("\n")).expect("written");
    }
    let before = fs::read_to_string(world.file("space.ron")).expect("there");
    let baked = world.bake(&[]).ok();
    let notices: Vec<&str> = baked.of("notice").filter_map(|event| event["message"].as_str()).collect();
    let of_space = "space.ron lacks snow_line; the built-in declaration is used: 0.2 … 1, default 1";
    assert!(notices.iter().any(|notice| notice.ends_with(of_space)), "{notices:?}");
    let of_file = |notice: &&&str| notice.contains("g0000.ron:") && notice.contains("snow_line 1");
    assert_eq!(notices.iter().filter(of_file).count(), 4, "{notices:?}");
    assert_eq!(baked.of("scene_ready").count(), 4);
    assert_eq!(fs::read_to_string(world.file("space.ron")).expect("there"), before, "it is the person's");
    let params = String::from_utf8(world.run(&["params"]).stdout).expect("text");
    assert!(params.contains("  snow_line "), "{params}");
}
