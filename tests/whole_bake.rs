//! A whole world, as a person bakes it: once, again, and after changing a gene.

mod common;

use std::fs;

use common::World;

/// What each stage depends on, said again by hand: its own categories of genes, and the stages it reads. The test
/// works out from it what a change must rebuild, independently of `plan.rs`.
const STAGES: &[(&str, &[&str], &[&str])] = &[
    ("landform", &["terrain"], &[]),
    ("terrain", &[], &["landform"]),
    ("ground maps", &[], &["landform"]),
    ("ground textures", &[], &[]),
    ("tree textures", &["tree"], &[]),
    ("tree 0", &["tree"], &["tree textures"]),
    ("tree 1", &["tree"], &["tree textures"]),
    ("tree 2", &["tree"], &["tree textures"]),
    ("tree 3", &["tree"], &["tree textures"]),
    ("tree 4", &["tree"], &["tree textures"]),
    ("sky light", &["sky"], &[]),
    ("sky pictures", &["sky"], &["sky light"]),
    ("placement", &["tree"], &["landform", "tree 0"]),
    ("light map", &[], &["sky light", "landform", "placement"]),
    ("start", &[], &["sky light", "landform", "placement"]),
    ("foreground", &[], &["terrain", "start"]),
    ("scene", &[], &["light map", "sky pictures", "foreground", "ground maps"]),
];

fn depends_on(stage: &str, category: &str) -> bool {
    let (_, own, reads) = STAGES.iter().find(|(name, ..)| *name == stage).expect("a stage");
    own.contains(&category) || reads.iter().any(|read| depends_on(read, category))
}

fn expected(category: &str, scene: u64) -> Vec<(String, u64)> {
    let mut stages: Vec<_> = STAGES
        .iter()
        .filter(|(stage, ..)| depends_on(stage, category))
        .map(|(stage, ..)| ((*stage).to_owned(), scene))
        .collect();
    stages.sort();
    stages
}

/// Replaces the line of a gene in the chromosome of scene `scene`.
fn set_gene(text: &str, scene: usize, gene: &str, value: &str) -> String {
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
    let world = World::new();
    let first = world.bake(&[]).ok();
    assert_eq!(first.of("scene_ready").count(), 4);
    // Five trees, twelve other stages a scene; the ground textures are shared by all.
    assert_eq!(first.built().len(), 4 * 16 + 1, "{:?}", first.built());
    for scene in 0..4 {
        let path = world.file(&format!("baked/g0000/scene-{scene}/scene.gltf"));
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
    let world = World::new();
    world.bake(&[]).ok();
    let scenes: Vec<_> = (0..4)
        .map(|s| fs::read(world.file(&format!("baked/g0000/scene-{s}/scene.gltf"))).expect("a scene"))
        .collect();
    for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
        assert_ne!(scenes[a], scenes[b]);
    }
}

#[test]
fn a_changed_gene_rebuilds_what_depends_on_it_and_nothing_else() {
    let world = World::new();
    world.bake(&[]).ok();
    for (scene, category, gene, value) in [
        (1, "terrain", "terrain_seed", "77"),
        (2, "sky", "sun_elevation_deg", "45"),
        (3, "tree", "height_m", "11"),
        (0, "tree", "tree_seed", "3"),
    ] {
        world.edit(0, |text| set_gene(&text, scene, gene, value));
        let (mut built, mut expected) = (world.bake(&[]).ok().built(), expected(category, scene as u64));
        if category != "terrain" {
            // It need not be made again if the best place to stand is where it was.
            for stages in [&mut built, &mut expected] {
                stages.retain(|(stage, _)| stage != "foreground");
            }
        }
        assert_eq!(built, expected, "{gene} of scene {scene}");
    }
}

#[test]
fn a_gene_changed_back_costs_nothing() {
    let world = World::new();
    world.bake(&[]).ok();
    let original = fs::read_to_string(world.population(0)).expect("a population");
    world.edit(0, |text| set_gene(&text, 0, "cloud_cover", "0.9"));
    assert_ne!(world.bake(&[]).ok().built(), []);
    world.edit(0, |_| original);
    assert_eq!(world.bake(&[]).ok().built(), []);
}

#[test]
fn comments_and_layout_of_a_population_do_not_matter() {
    let world = World::new();
    world.bake(&[]).ok();
    world.edit(0, |text| format!("// mine\n\n{}\n", text.replace(": ", ":   ")));
    assert_eq!(world.bake(&[]).ok().built(), []);
}

#[test]
fn a_scene_becomes_one_file_that_needs_no_other() {
    let world = World::new();
    world.bake(&[]).ok();
    let out = world.file("valley.glb");
    let output = world.run(&["export", "0", out.to_str().expect("a path")]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let (document, buffers, _) = {
        let gltf = gltf::Gltf::from_slice(&fs::read(&out).expect("written")).expect("glTF");
        let blob = gltf.blob.clone().expect("a binary chunk");
        (gltf.document, blob, ())
    };
    assert_eq!(document.buffers().count(), 1);
    assert!(document.images().all(|image| matches!(image.source(), gltf::image::Source::View { .. })));
    assert!(document.views().all(|view| view.offset() + view.length() <= buffers.len()));
}

#[test]
fn next_breeds_from_votes() {
    let world = World::new();
    world.bake(&[]).ok();
    world.edit(0, |text| {
        assert!(text.contains("votes: None"));
        text.replace("votes: None", "votes: Some((tree: Some(0), terrain: Some(1), sky: Some(2)))")
    });
    let next = world.bake(&["next"]).ok();
    assert_eq!(next.of("scene_ready").count(), 4);
    assert!(next.built().len() < 65, "chromosomes that live on are not baked again");
    assert!(world.population(1).is_file());
    assert!(world.file("baked/g0000/scene-0/scene.gltf").is_file(), "older generations stay");
}

#[test]
fn explain_names_the_gene() {
    let world = World::new();
    world.bake(&[]).ok();
    world.edit(0, |text| set_gene(&text, 1, "turbidity", "6"));
    world.bake(&[]).ok();
    let output = world.run(&["explain", "1"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success());
    assert!(text.contains("turbidity"), "{text}");
    assert!(text.contains("reused"), "{text}");
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
    let world = World::new();
    world.bake(&[]).ok();
    let output = world.run(&["cache", "gc", "--max-size", "0"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for scene in 0..4 {
        let path = world.file(&format!("baked/g0000/scene-{scene}/scene.gltf"));
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

/// `bake --watch`, with its events as they come.
struct Watching {
    child: std::process::Child,
    lines: std::io::Lines<std::io::BufReader<std::process::ChildStdout>>,
}

impl Watching {
    fn new(world: &World) -> Self {
        let mut command = world.command(&["--watch", "--size", "65", "--json", "--threads", "1"]);
        let mut child = command.stdout(std::process::Stdio::piped()).spawn().expect("bake runs");
        let lines = std::io::BufRead::lines(std::io::BufReader::new(child.stdout.take().expect("piped")));
        Self { child, lines }
    }

    /// The next event of one of the kinds.
    fn next(&mut self, kinds: &[&str]) -> serde_json::Value {
        loop {
            let line = self.lines.next().expect("it goes on watching").expect("text");
            let event: serde_json::Value = serde_json::from_str(&line).expect("JSON");
            if kinds.iter().any(|kind| event["event"] == *kind) {
                return event;
            }
        }
    }
}

impl Watching {
    /// Stages built by the next bake that builds any: a save may be seen as more than one event, and the first bake
    /// after it does the work.
    fn work(&mut self) -> u64 {
        let built = (0..5).map(|_| self.next(&["done"])["built"].as_u64().expect("a number"));
        built.into_iter().find(|built| *built != 0).expect("a bake that does something")
    }
}

impl Drop for Watching {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn watch_bakes_what_is_saved_and_outlives_mistakes() {
    let world = World::new();
    let mut watching = Watching::new(&world);
    assert_eq!(watching.next(&["done", "failed"])["built"], 65);
    world.edit(0, |text| set_gene(&text, 1, "cloud_cover", "0.6"));
    let most = expected("sky", 1).len() as u64;
    assert!(watching.work() <= most);
    let good = fs::read_to_string(world.population(0)).expect("a population");
    fs::write(world.population(0), &good[..good.len() / 2]).expect("written");
    assert_eq!(watching.next(&["failed"])["event"], "failed");
    fs::write(world.population(0), good.replacen("cloud_cover: 0.6", "cloud_cover: 0.8", 1))
        .expect("written");
    assert!(watching.work() <= most);
}

fn vote(world: &World, generation: u32, votes: &str) {
    world.edit(generation, |text| {
        let (before, after) = text.split_once("    votes: ").expect("votes");
        let (_, after) = after.split_once(",\n").expect("the end of the line");
        format!("{before}    votes: {votes},\n{after}")
    });
}

/// `current.ron` shows this generation, as its file is now.
fn is_shown(world: &World, generation: u32) -> bool {
    let text = fs::read_to_string(world.file("baked/current.ron")).expect("something was baked");
    let current = genescape_schema::Current::load("current.ron", &text).expect("valid");
    let bytes = fs::read(world.population(generation)).expect("a population");
    (current.generation, current.population) == (generation, blake3::hash(&bytes).to_hex().to_string())
}

#[test]
fn watch_answers_votes_once_and_on_old_generations_too() {
    let world = World::new();
    let mut watching = Watching::new(&world);
    watching.next(&["done"]);
    let ballots = [
        (0, "Some((tree: Some(0), terrain: Some(1), sky: Some(2)))"),
        (1, "Some((tree: None, terrain: Some(3), sky: Some(0)))"),
        // Another choice on an old generation: nothing that came of it is overwritten.
        (0, "Some((tree: Some(3), terrain: Some(1), sky: Some(2)))"),
    ];
    let mut before = Vec::new();
    for (child, (parent, votes)) in (1..).zip(ballots) {
        vote(&world, parent, votes);
        assert_eq!(watching.next(&["bred"])["parent"], parent);
        assert_eq!(watching.next(&["planned"])["generation"], child, "the child comes first");
        watching.next(&["done"]);
        assert!(is_shown(&world, child));
        let text = fs::read_to_string(world.population(child)).expect("a new file");
        assert!(text.contains(&format!("parent: Some((generation: {parent},")), "{text}");
        for (generation, text) in &before {
            assert_eq!(&fs::read_to_string(world.population(*generation)).expect("kept"), text);
        }
        before.push((child, text));
        before.retain(|(generation, _)| ballots.get(child as usize).is_none_or(|next| next.0 != *generation));
    }
    // The same votes again, in other words; and somebody who comes later: no child is missing.
    vote(&world, 0, "Some((sky: Some(2), terrain: Some(1), tree: Some(3)))");
    watching.next(&["done"]);
    drop(watching);
    let mut late = Watching::new(&world);
    assert_eq!(late.next(&["bred", "planned"])["generation"], 3);
    late.next(&["done"]);
    assert!(!world.population(4).exists());
}

#[test]
fn a_child_that_is_half_saved_is_not_bred_again() {
    let world = World::new();
    let mut watching = Watching::new(&world);
    watching.next(&["done"]);
    vote(&world, 0, "Some((tree: Some(0), terrain: Some(1), sky: Some(2)))");
    assert_eq!(watching.next(&["bred"])["parent"], 0);
    watching.next(&["done"]);
    let child = fs::read_to_string(world.population(1)).expect("a child");
    for half in ["", &child[..child.len() / 2]] {
        fs::write(world.population(1), half).expect("written");
        assert_eq!(watching.next(&["failed", "bred"])["event"], "failed");
    }
    fs::write(world.population(1), &child).expect("written");
    assert_eq!(watching.next(&["done", "bred"])["event"], "done");
    assert!(!world.population(2).exists());
}

#[test]
fn a_save_during_a_bake_ends_it_and_what_was_saved_last_is_shown() {
    let world = World::new();
    let mut watching = Watching::new(&world);
    watching.next(&["started"]);
    world.edit(0, |text| set_gene(&text, 1, "turbidity", "6"));
    assert_eq!(watching.next(&["superseded", "done"])["event"], "superseded");
    assert_eq!(watching.next(&["superseded", "done", "failed"])["event"], "done");
    assert!(is_shown(&world, 0));
}

#[test]
fn to_save_a_file_is_to_ask_for_its_scenes() {
    let world = World::new();
    world.bake(&[]).ok();
    world.bake(&["random", "--seed", "5"]).ok();
    let mut watching = Watching::new(&world);
    assert_eq!(watching.next(&["done"])["built"], 0);
    assert!(is_shown(&world, 1));
    fs::remove_dir_all(world.file("baked/g0000")).expect("evicted");
    world.edit(0, |text| text);
    assert_eq!(watching.next(&["planned"])["generation"], 0);
    watching.next(&["done"]);
    assert!(is_shown(&world, 0));
    assert!(world.file("baked/g0000/scene-3/scene.gltf").is_file());
}
