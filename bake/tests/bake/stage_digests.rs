//! What every stage computes is pinned by a table, `stage_digests.txt`: the same bytes for any number of threads, build
//! profile and CPU, until the stage's version is raised. `cargo xtask bless digests` writes the table anew.
//!
//! Of each stage it holds the version, a digest of its action keys and one of its outputs, over all its nodes in the plan
//! of the starters at 65 samples a side. Other outputs for the same keys are the mistake that must not happen: a cache
//! that was filled before would go on giving the old ones. So they cannot be blessed.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use genescape_cache::Digest;
use genescape_schema::{Population, Space};
use genescape_world::STARTER_RON;

use crate::library::{NodeOutputs, run};
use crate::world::World;

const HEADER: &str =
    "# stage, version, digest of its action keys, digest of its outputs: see stage_digests.rs\n";
const BLESS: &str = "`cargo xtask bless digests` writes the table anew";

#[derive(Clone, Debug, PartialEq)]
struct Row {
    version: u32,
    keys: String,
    outputs: String,
}

/// Rows by stage.
type Table = BTreeMap<String, Row>;

fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/stage_digests.txt")
}

fn starters(baked: &Path, threads: usize) -> Vec<NodeOutputs> {
    let population =
        Population::load(&Space::builtin(), "starter.ron", STARTER_RON).expect("valid").population;
    run(&population, baked, threads).expect("the starters bake")
}

/// 128 bits of the digest of digests.
fn digest<'a>(digests: impl Iterator<Item = &'a Digest>) -> String {
    let text: String = digests.map(Digest::to_string).collect();
    blake3::hash(text.as_bytes()).to_hex()[..32].to_owned()
}

fn table(nodes: &[NodeOutputs]) -> Table {
    let mut stages = BTreeMap::<&str, Vec<&NodeOutputs>>::new();
    nodes.iter().for_each(|node| stages.entry(&*node.key.fields().stage).or_default().push(node));
    let row = |nodes: Vec<&NodeOutputs>| Row {
        version: nodes[0].key.fields().version,
        keys: digest(nodes.iter().map(|node| node.key.digest()).collect::<Vec<_>>().iter()),
        outputs: digest(nodes.iter().flat_map(|node| &node.outputs)),
    };
    stages.into_iter().map(|(stage, nodes)| (stage.to_owned(), row(nodes))).collect()
}

fn to_text(table: &Table) -> String {
    table.iter().fold(HEADER.to_owned(), |mut text, (stage, Row { version, keys, outputs })| {
        writeln!(text, "{stage:<16}{version:>4}  {keys}  {outputs}").expect("a string takes everything");
        text
    })
}

fn from_text(text: &str) -> Option<Table> {
    let row = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [stage @ .., version, keys, outputs] = &words[..] else { return None };
        let row =
            Row { version: version.parse().ok()?, keys: keys.to_string(), outputs: outputs.to_string() };
        Some((stage.join(" "), row))
    };
    text.lines().filter(|line| !line.starts_with('#')).map(row).collect()
}

/// Stages that give other outputs than the table says for the same keys.
fn changed_in_secret(known: &Table, now: &Table) -> Vec<String> {
    let secret = |(stage, row): &(&String, &Row)| {
        known.get(*stage).is_some_and(|old| old.keys == row.keys && old.outputs != row.outputs)
    };
    let told = |(stage, Row { version, .. }): (&String, &Row)| {
        format!(
            "stage \"{stage}\" computes other bytes than version {version} did: raise its VERSION; then {BLESS}"
        )
    };
    now.iter().filter(secret).map(told).collect()
}

/// Stages whose row is not as it is now, for a good reason.
fn out_of_date(known: &Table, now: &Table) -> Vec<String> {
    let fresh = |stage: &&String| match (known.get(*stage), now.get(*stage)) {
        (Some(old), Some(row)) => old.keys == row.keys,
        _ => false,
    };
    let stages: std::collections::BTreeSet<_> = known.keys().chain(now.keys()).collect();
    let old = stages.into_iter().filter(|stage| !fresh(stage));
    old.map(|stage| {
        format!("stage \"{stage}\" is new, gone, or has another version or other inputs: {BLESS}")
    })
    .collect()
}

fn known() -> Table {
    let text = std::fs::read_to_string(path()).unwrap_or_default();
    from_text(&text).expect("rows of stage, version, keys, outputs")
}

fn check(nodes: &[NodeOutputs]) {
    let (known, now) = (known(), table(nodes));
    let faults = [changed_in_secret(&known, &now), out_of_date(&known, &now)].concat();
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

/// With GENESCAPE_BLESS, writes the table first.
#[test]
fn one_thread_gives_the_bytes_of_the_table() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let nodes = starters(folder.path(), 1);
    let now = table(&nodes);
    if std::env::var_os("GENESCAPE_BLESS").is_some() && changed_in_secret(&known(), &now).is_empty() {
        std::fs::write(path(), to_text(&now)).expect("written");
    }
    check(&nodes);
}

/// What the program baked with eight threads; or in the world that GENESCAPE_BAKED names: `cargo xtask test` has a release
/// build bake one.
#[test]
fn the_program_gives_the_bytes_of_the_table() {
    let other = std::env::var_os("GENESCAPE_BAKED").map(PathBuf::from);
    let nodes = match &other {
        Some(world) => starters(&world.join("baked"), 1),
        None => starters(&World::starters().file("baked"), 1),
    };
    let built: Vec<_> = nodes.iter().filter(|node| !node.reused).map(|node| &node.label).collect();
    assert!(built.is_empty(), "the program's cache lacks {built:?}");
    check(&nodes);
}

#[test]
fn only_other_bytes_for_the_same_keys_ask_for_a_version() {
    let table = |text: &str| from_text(text).expect("a table");
    let known = table("land 1 a a\nold  2 b  b\nsky light  3  c c\n# a comment\ntrees 1  d  d");
    assert_eq!(from_text(&to_text(&known)), Some(known.clone()));
    assert!(changed_in_secret(&known, &known).is_empty() && out_of_date(&known, &known).is_empty());
    let now = table("land 1 a z\nnew 1 e e\nsky light 4 y z\ntrees 1 x d");
    let [land] = &changed_in_secret(&known, &now)[..] else { panic!("one stage") };
    assert!(land.contains("\"land\"") && land.contains("version 1") && land.contains("raise"), "{land}");
    let old = out_of_date(&known, &now).join("\n");
    assert!(
        ["new", "old", "sky light", "trees"].iter().all(|stage| old.contains(&format!("\"{stage}\""))),
        "{old}"
    );
    assert!(!old.contains("\"land\""), "{old}");
}
