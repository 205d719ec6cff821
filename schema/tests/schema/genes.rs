//! Genes: every code has a value, every value a text, and both lead back to the code.

use genescape_schema::{Category, Genome, Population, Scale, Space};
use proptest::prelude::*;
use serde::Deserialize;

/// A space of one gene for each category.
fn space_of(bits: u32, low: f64, high: f64, scale: Scale) -> Result<Space, genescape_schema::Report> {
    let gene = |name: &str, category: &str, bits: u32, low: f64, high: f64, scale: &str| {
        format!(
            "(name: \"{name}\", category: {category}, bits: {bits}, range: ({low:?}, {high:?}), scale: {scale}, unit: \"m\", help: \"\"),"
        )
    };
    let text = [
        gene("x", "tree", bits, low, high, scale.name()),
        gene("y", "terrain", 1, 0.0, 1.0, "linear"),
        gene("z", "sky", 1, 0.0, 1.0, "linear"),
    ];
    Space::parse("space.ron", &format!("Space(version: 1, parameters: [{}])", text.concat()))
}

fn check_all_codes(space: &Space) {
    for gene in space.parameters() {
        let mut before = f64::MIN;
        for code in 0..=gene.last_code() {
            let (value, text) = (gene.value(code), gene.text(code));
            assert!(gene.contains(value) && value > before, "{} {code}", gene.name);
            assert_eq!(gene.snap(value), code, "{} {code}", gene.name);
            assert_eq!(gene.snap(f64::from(value as f32)), code, "{} {code}", gene.name);
            let written: f64 = text.parse().expect("a number");
            assert_eq!(gene.snap(written), code, "{} {text}", gene.name);
            assert_eq!(gene.text(gene.snap(written)), text);
            assert!(gene.contains(written), "{} {text}", gene.name);
            before = value;
        }
        assert_eq!((gene.value(0), gene.value(gene.last_code())), gene.range);
        assert_eq!(gene.value(u32::MAX), gene.range.1);
    }
}

#[test]
fn all_codes_of_the_builtin_space_go_round() {
    check_all_codes(&Space::builtin());
}

#[test]
fn texts_are_short() {
    let space = Space::builtin();
    let text = |name: &str, code| space.find(name).expect("a gene").text(code);
    assert_eq!(text("height_m", 10), "7.3");
    assert_eq!(text("cloud_cover", 1), "0.07");
    assert_eq!(text("cloud_cover", 0), "0");
    assert_eq!(text("tree_seed", 120), "120");
    assert_eq!(text("sun_azimuth_deg", 63), "354");
    let longest =
        space.parameters().iter().flat_map(|gene| (0..=gene.last_code()).map(|code| gene.text(code).len()));
    assert!(longest.max() <= Some(7));
}

#[test]
fn snapping_takes_the_nearest_on_the_genes_own_scale() {
    let space = space_of(1, 1.0, 100.0, Scale::Logarithmic).expect("valid");
    let gene = &space.parameters()[0];
    assert_eq!((gene.snap(9.9), gene.snap(10.1)), (0, 1));
    let space = space_of(1, 0.0, 100.0, Scale::Linear).expect("valid");
    let gene = &space.parameters()[0];
    assert_eq!((gene.snap(49.0), gene.snap(51.0), gene.snap(f64::NAN), gene.snap(1e300)), (0, 1, 0, 1));
}

#[test]
fn faults_of_a_space_are_told_at_once() {
    let text = "Space(version: 2, parameters: [
        (name: \"a\", category: tree, bits: 17, range: (0.0, 1.0), scale: linear, unit: \"\", help: \"\"),
        (name: \"b\", category: tee, bits: 4, range: (0.0, 1.0), scale: linear, unit: \"\", help: \"\"),
        (name: \"c\", category: tree, bits: 4, range: (1.0, 1.0), scale: linear, unit: \"\", help: \"\"),
        (name: \"d\", category: tree, bits: 4, range: (0.0, 1.0), scale: logarithmic, unit: \"\", help: \"\"),
        (name: \"e\", category: tree, bits: 4, range: (0.0, 16.0), scale: integer, unit: \"\", help: \"\"),
        (name: \"f\", category: tree, bits: 4, range: (0.0, 1.0), scale: linear, units: \"\", help: \"\"),
        (name: \"g\", category: sky, bits: 4, range: (0.0, 1.0), scale: linear, unit: \"\", help: \"\"),
        (name: \"g\", category: sky, bits: 4, range: (0.0, 1.0), scale: linear, unit: \"\", help: \"\"),
        (name: \"9 h\", category: sky, bits: 4, range: (0.0, 1.0), scale: linear, unit: \"\", help: \"\"),
        (name: \"i\", category: sky, bits: 16, range: (1e6, 1000001.0), scale: linear, unit: \"\", help: \"\"),
        (name: \"j\", category: sky, bits: 4, range: (0.0, inf), scale: linear, unit: \"\", help: \"\"),
        (name: \"k\", category: sky, bits: 4, range: 1.0, scale: linear, unit: \"\", help: \"\"),
        (name: \"l\", category: tree, bits: 4, range: (0.0, 1.0), scale: linear, unit: \"\", help: \"\", default: 2),
    ])";
    let told = Space::parse("space.ron", text).expect_err("faulty").to_string();
    for message in [
        "space.ron:1:16: version: 2 is unknown",
        "space.ron:2:43: bits: 17 is outside 1 … 16",
        "space.ron:3:31: category: tee is none of tree, terrain, sky; did you mean tree?",
        "space.ron:4:53: c: the range must rise, but 1 is not below 1",
        "space.ron:5:53: d: a logarithmic range must be above 0, but begins at 0",
        "space.ron:6:53: e: 0 … 16 are 17 whole numbers, but 4 bits hold 16: 0 … 15",
        "space.ron:7:9: the parameter lacks unit",
        "space.ron:7:80: a parameter has no units; did you mean unit?",
        "space.ron:9:9: g is declared twice",
        "space.ron:10:16: name: \"9 h\" must be lower_case",
        "space.ron:11:53: i: 16 bits are finer than single precision",
        "space.ron:12:52: j: the range must be finite",
        "space.ron:13:52: range: expected two numbers",
        "space.ron:14:109: l: the default 2 is outside 0 … 1",
    ] {
        assert!(told.contains(message), "{message}\nis not in\n{told}");
    }
    let one = "Space(version: 1, parameters: [(name: \"a\", category: tree, bits: 1, range: (0.0, 1.0), \
               scale: linear, unit: \"\", help: \"\")])";
    let told = Space::parse("space.ron", one).expect_err("faulty").to_string();
    assert!(told.contains("no parameter has category terrain") && told.contains("category sky"), "{told}");
}

#[test]
fn an_older_space_gets_the_genes_that_it_lacks() {
    let builtin = Space::builtin();
    let without = |name: &str| {
        let lines = Space::BUILTIN.lines().filter(|line| !line.contains(&format!("\"{name}\"")));
        lines.collect::<Vec<_>>().join("\n")
    };
    let (space, notices) = Space::load("w/space.ron", &without("blossom")).expect("valid");
    assert_eq!(notices, ["w/space.ron lacks blossom; the built-in declaration is used: 0 … 0.4, default 0"]);
    let order = |space: &Space| -> Vec<String> {
        space.category(Category::Tree).map(|gene| gene.name.clone()).collect()
    };
    assert_eq!(order(&space).last().map(String::as_str), Some("blossom"));
    assert_eq!(order(&space).len(), order(&builtin).len());
    assert_eq!(space.bits(Category::Tree), builtin.bits(Category::Tree));
    // Text is the same in whichever order the codes lie, but for the order of lines.
    let text = Population::random(&builtin, 1, 0).to_ron(&builtin);
    let there = Population::load(&space, "p.ron", &text).expect("valid").population.to_ron(&space);
    let back = Population::load(&builtin, "p.ron", &there).expect("valid").population.to_ron(&builtin);
    assert_eq!(back, text);
    // A gene that no default stands for is declared, too, so that a population that has it is read.
    let (space, notices) = Space::load("space.ron", &without("height_m")).expect("valid");
    assert_eq!(notices, ["space.ron lacks height_m; the built-in declaration is used: 3 … 30 m"]);
    assert!(Population::load(&space, "p.ron", &text).expect("valid").notices.is_empty());
    assert_eq!(Space::load("space.ron", Space::BUILTIN), Ok((builtin, Vec::new())));
}

#[test]
fn a_stage_reads_its_genes_into_a_struct() {
    #[derive(Debug, PartialEq, Deserialize)]
    struct Params {
        height_m: f32,
        levels: u32,
        sky_seed: u32,
    }
    #[derive(Debug, Deserialize)]
    struct Wrong {
        #[expect(dead_code, reason = "reading fails")]
        hight_m: f32,
    }
    let space = Space::builtin();
    let mut genome = Genome::zero(&space);
    genome.set_code(space.find("height_m").expect("a gene"), 10);
    genome.set_code(space.find("levels").expect("a gene"), 2);
    let params: Params = genome.read(&space).expect("all are genes");
    assert_eq!(params, Params { height_m: (3.0 + 27.0 * 10.0 / 63.0) as f32, levels: 3, sky_seed: 0 });
    assert_eq!(genome.value(&space, "height_m"), Some(params.height_m));
    let told = genome.read::<Wrong>(&space).expect_err("no such gene").to_string();
    assert!(told.contains("hight_m"), "{told}");
}

#[test]
fn chance_depends_on_seed_and_generation_alone() {
    let space = Space::builtin();
    let random = |seed, generation| Population::random(&space, seed, generation);
    assert_eq!(random(1, 0), random(1, 0));
    assert_ne!(random(1, 0).individuals, random(2, 0).individuals);
    assert_ne!(random(1, 0).individuals, random(1, 1).individuals);
    // Every gene takes both halves of its codes.
    for gene in space.parameters() {
        let high = (0..64)
            .flat_map(|seed| random(seed, 0).individuals)
            .filter(|x| x.genome.code(gene) > gene.last_code() / 2);
        assert!((64..192).contains(&high.count()), "{}", gene.name);
    }
}

#[test]
fn tables_show_every_gene() {
    let space = Space::builtin();
    let (table, markdown) = (space.to_table(), space.to_markdown());
    for gene in space.parameters() {
        assert!(
            table.contains(&gene.help) && markdown.contains(&format!("| `{}` |", gene.name)),
            "{}",
            gene.name
        );
    }
    // Columns are aligned: every line of a block has its help at the same place.
    let starts = space.category(Category::Sky).map(|gene| {
        let line = table.lines().find(|line| line.trim_start().starts_with(&format!("{} ", gene.name)));
        line.and_then(|line| line.find(&gene.help)).expect("its line")
    });
    assert_eq!(starts.collect::<std::collections::BTreeSet<_>>().len(), 1);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn any_valid_space_goes_round(bits in 1..=9u32, low in -1e4..1e4f64, span in 1e-1..1e5f64, kind in 0..4usize) {
        let (scale, low, high) = match Scale::ALL[kind] {
            Scale::Linear => (Scale::Linear, low, low + span),
            Scale::Logarithmic => (Scale::Logarithmic, span / 10.0, span * (1.5 + low.abs())),
            whole => (whole, low.round(), low.round() + f64::from((1u32 << bits) - 1)),
        };
        // Ranges too narrow for single precision are refused, which another test checks.
        if let Ok(space) = space_of(bits, low, high, scale) {
            check_all_codes(&space);
        }
    }

    #[test]
    fn genes_do_not_touch_each_other(codes in prop::collection::vec(any::<u16>(), 61)) {
        let space = Space::builtin();
        let mut genome = Genome::zero(&space);
        for (gene, &code) in space.parameters().iter().zip(&codes) {
            genome.set_code(gene, u32::from(code) & gene.last_code());
        }
        for (gene, &code) in space.parameters().iter().zip(&codes) {
            prop_assert_eq!(genome.code(gene), u32::from(code) & gene.last_code());
        }
    }
}

#[test]
fn a_world_says_which_of_its_genes_cannot_be_what_they_are() {
    let changed = |gene: &str, old: &str, new: &str| {
        let line = Space::BUILTIN.lines().find(|line| line.contains(&format!("\"{gene}\""))).expect("a gene");
        assert!(line.contains(old), "{line}");
        let text = Space::BUILTIN.replacen(line, &line.replacen(old, new, 1), 1);
        Space::load("space.ron", &text)
    };
    for (gene, old, new, message) in [
        ("levels", "integer", "linear", "levels: landscapes are made from whole numbers here"),
        ("levels", "(1.0, 4.0)", "(-2.0, 1.0)", "levels: what is counted cannot be negative"),
        ("base_splits", "integer", "logarithmic", "the range must be above 0"),
        ("height_m", "(3.0, 30.0)", "(-1e30, 1e30)", "height_m: the range must lie within ±1e9"),
    ] {
        let told = changed(gene, old, new).expect_err(gene).to_string();
        let line =
            Space::BUILTIN.lines().position(|line| line.contains(&format!("\"{gene}\""))).expect("there");
        assert!(told.starts_with(&format!("space.ron:{}:", line + 1)), "{told}");
        assert!(told.contains(message) || message.contains("above 0"), "{told}");
    }
    // A gene of another name: the space is blamed, and files that lack it are read.
    let (space, notices) = changed("height_m", "height_m", "hight_m").expect("valid");
    let is_told =
        |part: &str| notices.iter().any(|notice| notice.starts_with("space.ron") && notice.contains(part));
    assert!(is_told("hight_m is a gene that nothing reads; did you mean height_m?"), "{notices:?}");
    assert!(is_told("lacks height_m; the built-in declaration is used"), "{notices:?}");
    let text = Population::random(&Space::builtin(), 1, 0).to_ron(&Space::builtin());
    let loaded = Population::load(&space, "p.ron", &text).unwrap_or_else(|report| panic!("{report}"));
    assert!(loaded.notices.is_empty(), "{:?}", loaded.notices);
}
