//! Files as people write them: nothing is lost, every fault is told with its place, nothing panics.

use genescape_schema::edit::{set_gene, set_locked, set_variety, set_votes};
use genescape_schema::{
    Category, Current, Individual, Lineage, Parent, Population, Report, Space, Strategy as BredBy,
    TreePreset, Variety, Votes,
};
use proptest::prelude::*;

const STARTER: &str = include_str!("../../../configs/starter.ron");

fn faults(text: &str) -> Report {
    Population::load(&Space::builtin(), "p.ron", text).expect_err("a faulty file was accepted")
}

/// The one fault of a file, without the picture of its line.
fn fault(text: &str) -> String {
    let report = faults(text);
    assert_eq!(report.diagnostics.len(), 1, "{report}");
    report.to_string().lines().next().unwrap_or_default().to_owned()
}

/// A file with `old` in it, once or more, replaced by `new` the first time.
fn with(old: &str, new: &str) -> String {
    let text = Population::random(&Space::builtin(), 1, 0).to_ron(&Space::builtin());
    assert!(text.contains(old), "{old} is not in the file");
    text.replacen(old, new, 1)
}

/// The file with the value of the first gene of that name replaced, and where it now stands.
fn with_gene(name: &str, value: &str) -> (String, usize, usize) {
    let text = Population::random(&Space::builtin(), 1, 0).to_ron(&Space::builtin());
    let at = text.find(&format!(" {name}: ")).expect("the gene is in the file") + name.len() + 3;
    let end = at + text[at..].find(',').expect("a comma follows");
    let line = text[..at].matches('\n').count() + 1;
    let column = at - text[..at].rfind('\n').expect("not the first line");
    (format!("{}{value}{}", &text[..at], &text[end..]), line, column)
}

#[test]
fn the_space_that_comes_along_is_valid() {
    let space = Space::builtin();
    assert!(space.parameters().len() >= 61);
    for category in Category::ALL {
        let bits: u32 = space.category(category).map(|gene| gene.bits).sum();
        assert_eq!(bits, space.bits(category));
    }
}

#[test]
fn every_fault_is_told_at_once_with_its_place() {
    let text =
        "Population(\n  generation: -1,\n  sed: 4,\n  individuals: [],\n  votes: Some((tree: Some(4))),\n)\n";
    let report = faults(text);
    let told = report.to_string();
    for line in [
        "p.ron:1:1: Population lacks seed",
        "p.ron:2:15: generation: expected a whole number from 0 to 4294967295, found a number: -1",
        "p.ron:3:3: Population has no sed; did you mean seed?",
        "p.ron:4:16: individuals: the population is empty; there must be 4",
        "p.ron:5:27: votes: tree: 4 is none of the four: Some(0) is landscape 1, Some(3) landscape 4",
    ] {
        assert!(told.contains(line), "{line}\nis not in\n{told}");
    }
    assert_eq!(report.diagnostics.len(), 5, "{told}");
    let lines: Vec<_> = report.diagnostics.iter().map(|fault| fault.line).collect();
    assert!(lines.is_sorted());
}

#[test]
fn a_fault_is_shown_under_its_line() {
    let (text, line, column) = with_gene("height_m", "74");
    let told = faults(&text).to_string();
    assert!(
        told.starts_with(&format!("p.ron:{line}:{column}: height_m: 74 is outside 3 … 30 m\n")),
        "{told}"
    );
    let lines: Vec<&str> = told.lines().collect();
    assert!(lines[1].contains("| ") && lines[1].contains("height_m: 74,"), "{told}");
    assert_eq!(lines[1].find("74"), lines[2].find("^^"), "{told}");
}

#[test]
fn of_a_long_line_the_part_that_matters_is_shown() {
    let line: String =
        with_gene("height_m", "74").0.lines().map(|l| l.split("//").next().unwrap_or_default()).collect();
    let told = faults(&line).to_string();
    let lines: Vec<&str> = told.lines().collect();
    let column = |text: &str, part: &str| text.find(part).map(|at| text[..at].chars().count());
    assert!(lines[1].chars().count() < 140 && lines[1].contains("height_m: 74,"), "{told}");
    assert_eq!(column(lines[1], "74,"), column(lines[2], "^^"), "{told}");
}

#[test]
fn wrong_genes_say_what_would_be_right() {
    let cases = [
        (
            with_gene("height_m", "\"tall\"").0,
            "height_m: expected a number, 3 … 30 m, found a text: \"tall\"",
        ),
        (with_gene("height_m", "NaN").0, "height_m: NaN is outside 3 … 30 m"),
        (with_gene("height_m", "-inf").0, "height_m: -inf is outside 3 … 30 m"),
        (with_gene("levels", "5").0, "levels: 5 is outside 1 … 4"),
        (with_gene("taper", "None").0, "taper: expected a number, 0.7 … 1.2, found None: None"),
        (with("seed: 1", "seed: 1.5"), "seed: expected a whole number from 0 to"),
        (with("votes: None", "votes: Some(true)"), "votes: expected named values in brackets"),
        (
            with("votes: None", "votes: Some((sky: Some(1.5)))"),
            "votes: sky: 1.5 is none of the four: Some(0) is landscape 1, Some(3) landscape 4",
        ),
        (with("votes: None", "votes: Some((sun: Some(1)))"), "votes has no sun"),
        (with("Population(", "Populatoin("), "expected Population(…), found Populatoin"),
        (with("votes: None", "variety: 1.2"), "variety: 1.2 is outside 0, close variations, … 1, anything"),
        (with("votes: None", "variety: \"much\""), "variety: expected a number, found a text"),
        (with("votes: None", "bred_from: (tree: \"oak\", sky: \"fog\")"), "bred_from lacks terrain"),
        (
            with("votes: None", "strategy: \"lerned\""),
            "strategy: \"lerned\" is none; there is \"learned\" or \"classic\"",
        ),
        (with("generation: 0", "generation: 0, generation: 0"), "generation is given twice; first in line"),
    ];
    for (text, message) in cases {
        let told = fault(&text);
        assert!(told.contains(message), "{told}\nshould say\n{message}");
    }
}

#[test]
fn a_misspelt_gene_is_recognised_and_the_missing_one_named() {
    let told = faults(&with("height_m:", "heigth_m:")).to_string();
    assert!(told.contains("tree has no heigth_m; did you mean height_m?"), "{told}");
    assert!(told.contains("tree: 1 gene is missing: height_m (3 … 30 m)"), "{told}");
    let told = faults(&with("terrain: (", "terrain: (height_m: 4, ")).to_string();
    assert!(told.contains("terrain has no height_m; it belongs into tree"), "{told}");
    let told = faults("Population(generation: 0, seed: 0, individuals: [(tree: (), terrain: (), sky: ())])")
        .to_string();
    assert!(
        told.contains("found 1; there must be 4") && told.contains("sky: 11 genes are missing"),
        "{told}"
    );
}

/// A population as it was before `lean_deg` was invented, and the space of afterwards.
fn before_lean_deg() -> (Space, String) {
    let gene = "(name: \"lean_deg\", category: tree, bits: 4, range: (0.0, 30.0), scale: linear, unit: \"deg\", \
                help: \"\", default: 2.0)";
    let text = Space::BUILTIN.replacen("parameters: [", &format!("parameters: [{gene},"), 1);
    let space = Space::parse("space.ron", &text).unwrap_or_else(|report| panic!("{report}"));
    (space, with("height_m", "/* mine */ height_m"))
}

#[test]
fn genes_that_a_file_lacks_are_filled_in_and_told() {
    let (space, text) = before_lean_deg();
    let loaded = Population::load(&space, "p.ron", &text).unwrap_or_else(|report| panic!("{report}"));
    let places = text.lines().enumerate().filter(|(_, line)| line.contains(" tree: ("));
    let told = places.map(|(line, _)| {
        format!("p.ron:{}:19: tree: 1 gene is missing; defaults are used: lean_deg 2 deg", line + 1)
    });
    assert_eq!(loaded.notices, told.collect::<Vec<_>>());
    for individual in &loaded.population.individuals {
        assert_eq!(individual.genome.value(&space, "lean_deg"), Some(2.0));
    }
    // Without a default it stays a fault, and so does an unknown gene.
    let told = faults(&text.replacen("taper:", "tapper:", 1)).to_string();
    assert!(told.contains("tree has no tapper") && told.contains("1 gene is missing: taper (0.7"), "{told}");
}

#[test]
fn a_gene_that_a_file_lacks_can_be_edited() {
    let (space, text) = before_lean_deg();
    let edited = set_gene(&space, "p.ron", &text, 2, "lean_deg", 9.9).expect("a gene");
    assert!(edited.contains("/* mine */") && edited.lines().count() == text.lines().count() + 1);
    let loaded = Population::load(&space, "p.ron", &edited).unwrap_or_else(|report| panic!("{report}"));
    let values = loaded.population.individuals.each_ref().map(|one| one.genome.value(&space, "lean_deg"));
    assert_eq!(values, [Some(2.0), Some(2.0), Some(10.0), Some(2.0)]);
    assert_eq!(loaded.notices.len(), 3, "{:?}", loaded.notices);
    // The line that was added is edited like any other.
    let again = set_gene(&space, "p.ron", &edited, 2, "lean_deg", 0.0).expect("a gene");
    assert_eq!(again, edited.replace("lean_deg: 10,", "lean_deg: 0,"));
}

#[test]
fn values_between_two_codes_are_reported() {
    let space = Space::builtin();
    let (text, line, column) = with_gene("height_m", "7.4");
    let loaded = Population::load(&space, "p.ron", &text).expect("valid");
    let told = format!("p.ron:{line}:{column}: height_m: for 7.4 the nearest value 7.3 m is used");
    assert_eq!(loaded.notices, [told]);
    let same = |value| Population::load(&space, "p.ron", &with_gene("height_m", value).0).expect("valid");
    assert_eq!(same("7.3"), same("7.29"));
    assert!(same("7.29").notices.is_empty());
    assert_eq!(same("7.3").population, loaded.population);
}

#[test]
fn unusual_but_valid_ron_is_read() {
    let space = Space::builtin();
    let text = with("votes: None,", "/* yes, /* really */ */ votes: (tree: 1, sky: None), // short")
        .replace('\n', "\r\n");
    let text = format!("\u{feff}{}// the end", text.replace("Population(", "#![enable(implicit_some)]\r\n("));
    let loaded = Population::load(&space, "p.ron", &text).expect("valid");
    assert_eq!(loaded.population.votes, Some(Votes { tree: Some(1), terrain: None, sky: None }));
    let voted = set_votes("p.ron", &text, None).expect("a population");
    assert_eq!(voted, text.replace("(tree: 1, sky: None)", "None"));
}

#[test]
fn configs_load_without_rounding() {
    let space = Space::builtin();
    let loaded = Population::load(&space, "starter.ron", STARTER).unwrap_or_else(|report| panic!("{report}"));
    assert!(loaded.notices.is_empty(), "{:?}", loaded.notices);
    let genomes = loaded.population.individuals.map(|individual| individual.genome);
    for (index, genome) in genomes.iter().enumerate() {
        for other in &genomes[index + 1..] {
            assert!(
                Category::ALL
                    .iter()
                    .all(|&category| genome.chromosome(category) != other.chromosome(category))
            );
        }
    }
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/presets");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("presets") {
        let text = std::fs::read_to_string(entry.expect("an entry").path()).expect("a file");
        let loaded = TreePreset::load(&space, "preset", &text).unwrap_or_else(|report| panic!("{report}"));
        assert!(loaded.notices.is_empty(), "{:?}", loaded.notices);
        count += 1;
    }
    assert!(count >= 6);
}

#[test]
fn no_truncation_is_accepted_or_panics() {
    let space = Space::builtin();
    let text = Population::random(&space, 3, 0).to_ron(&space);
    let end = text.rfind(')').expect("a bracket");
    // Each cut costs a parse: take one in 37, and all near the end.
    for cut in (0..=end).filter(|cut| cut % 37 == 0 || end - cut < 100) {
        let Some(part) = text.get(..cut) else { continue };
        let report = Population::load(&space, "p.ron", part).expect_err("a part was accepted");
        let (lines, fault) = (part.lines().count().max(1), &report.diagnostics[0]);
        assert_eq!(report.diagnostics.len(), 1);
        assert!(fault.line <= lines, "line {} of {lines}", fault.line);
        assert!(set_votes("p.ron", part, None).is_err());
    }
}

#[test]
fn a_missing_votes_line_is_added_on_its_own() {
    let space = Space::builtin();
    let text = with("    votes: None,\n", "");
    let votes = Votes { tree: Some(0), terrain: None, sky: Some(3) };
    let voted = set_votes("p.ron", &text, Some(votes)).expect("a population");
    assert_eq!(voted.lines().count(), text.lines().count() + 1);
    let loaded = Population::load(&space, "p.ron", &voted).unwrap_or_else(|report| panic!("{report}"));
    assert_eq!(loaded.population.votes, Some(votes));
}

#[test]
fn current_survives_its_file() {
    let current = Current {
        generation: 3,
        population: "abc".into(),
        scenes: std::array::from_fn(|scene| format!("baked/g0003/scene-{scene}/scene.gltf")),
    };
    let text = current.to_ron();
    assert_eq!(Current::load("current.ron", &text), Ok(current));
    for outside in ["/etc/passwd", "../other/scene.gltf", "baked/../../scene.gltf", "C:scene.gltf", ""] {
        let text = text.replacen("baked/g0003/scene-2/scene.gltf", outside, 1);
        let told = Current::load("current.ron", &text).expect_err(outside).to_string();
        assert!(told.contains("does not lie in the world"), "{told}");
    }
    let told =
        Current::load("current.ron", "Current(generation: 3, scenes: [1])").expect_err("faulty").to_string();
    assert!(told.contains("Current lacks population") && told.contains("scenes: expected a text"), "{told}");
}

fn population() -> impl Strategy<Value = Population> {
    let votes = (prop::option::of(0..4usize), prop::option::of(0..4usize), prop::option::of(0..4usize))
        .prop_map(|(tree, terrain, sky)| Votes { tree, terrain, sky });
    let variety = || prop::option::of((0.0..=1.0f64).prop_map(|part| Variety::of(part).expect("0 to 1")));
    let parent = prop::option::of((any::<u32>(), votes.clone(), variety()));
    let bred_from = prop::option::of(prop::array::uniform3("\\PC{0,40}"));
    let names = prop::array::uniform4("\\PC{0,40}");
    let votes = (prop::option::of(votes), variety(), bred_from);
    (any::<u64>(), any::<u32>(), names, parent, votes).prop_map(
        |(seed, generation, names, parent, (votes, variety, bred_from))| {
            let random = Population::random(&Space::builtin(), seed, generation);
            let mut named = names.into_iter().zip(random.individuals);
            let individuals = std::array::from_fn(|_| {
                let (name, individual) = named.next().expect("four");
                let descent = if seed % 2 == 0 { String::new() } else { format!("trees of 2 · {name}") };
                Individual { name, descent, ..individual }
            });
            let parent = parent.map(|(generation, votes, variety)| Parent { generation, votes, variety });
            let locked = ["height_m", "sky", "terrain_seed", "tree"];
            let locked = locked.into_iter().take((seed % 5) as usize).map(str::to_owned).collect();
            let strategy = BredBy::ALL[(seed / 2 % 2) as usize];
            Population { parent, strategy, bred_from, individuals, votes, variety, locked, ..random }
        },
    )
}

fn votes() -> impl Strategy<Value = Option<Votes>> {
    population().prop_map(|population| population.votes)
}

#[test]
fn names_are_one_short_line() {
    let named = |name: &str| {
        let text = with("name: ", "name: ");
        let at = text.find("name: \"").expect("a name") + 7;
        let end = at + text[at..].find('"').expect("its end");
        format!("{}{name}{}", &text[..at], &text[end..])
    };
    for fine in ["", "Thüringen 𝕏", &"x".repeat(200)] {
        Population::load(&Space::builtin(), "p.ron", &named(fine))
            .unwrap_or_else(|report| panic!("{report}"));
    }
    for (name, message) in [
        ("x".repeat(201), "name: 201 characters; at most 200 are allowed"),
        ("y".repeat(100_000), "name: 100000 characters; at most 200 are allowed"),
        ("a\\u{1b}[31m".into(), "name: character 2 is a control character (U+001B)"),
        ("\\n".into(), "name: character 1 is a control character (U+000A)"),
        ("ab\u{7}".into(), "name: character 3 is a control character (U+0007)"),
        ("\u{202e}evil".into(), "name: character 1 is a control character (U+202E)"),
    ] {
        let told = faults(&named(&name)).to_string();
        assert!(told.contains(message), "{told}");
        assert!(!told.contains(['\u{1b}', '\u{7}', '\u{202e}']) && told.len() < 1000, "{told}");
    }
}

#[test]
fn very_many_faults_are_counted_and_not_all_told() {
    let fields: String = (0..20_000).map(|n| format!("f{n}: 1, ")).collect();
    let report = faults(&with("individuals:", &format!("{fields}individuals:")));
    assert_eq!((report.diagnostics.len(), report.more), (100, 19_900));
    let told = report.to_string();
    assert!(told.ends_with("100 errors, and 19900 more") && told.len() < 60_000, "{} bytes", told.len());
    let kept: usize = report.diagnostics.iter().map(|fault| fault.excerpt.len() + fault.message.len()).sum();
    assert!(kept < 30_000, "{kept} bytes are kept");
    let locked = format!("locked: [{}], individuals:", "\"x\", ".repeat(20_000));
    let report = faults(&with("individuals:", &locked));
    assert_eq!(report.diagnostics.len() + report.more, 20_000);
}

#[test]
fn a_huge_name_is_quoted_in_part() {
    for text in [
        with("individuals:", &format!("{}: 1, individuals:", "f".repeat(50_000))),
        with("Population(", &format!("{}(", "P".repeat(50_000))),
        with("individuals:", &format!("locked: [\"{}\"], individuals:", "x".repeat(50_000))),
        with("seed: 1", &format!("seed: {}", "9".repeat(50_000))),
        with("seed: 1", &format!("seed: {}", "x".repeat(50_000))),
    ] {
        let told = faults(&text).to_string();
        assert!(told.len() < 1500, "{} bytes: {}", told.len(), &told[..300]);
    }
}

#[test]
fn ten_thousand_individuals_are_counted_and_not_checked() {
    let crowd = "(tree: (), terrain: (), sky: ()), ".repeat(10_000);
    let report = faults(&format!("Population(generation: 0, seed: 0, individuals: [{crowd}])"));
    assert!(report.to_string().contains("individuals: found 10000; there must be 4"), "{report}");
    assert_eq!(report.diagnostics.len() + report.more, 1 + 3 * 4, "of four each category is checked");
}

#[test]
fn nesting_too_deep_is_told_in_words_for_people() {
    for (open, close) in [("[", "]"), ("(", ")"), ("Some(", ")"), ("a(b: ", ")")] {
        for depth in [40, 1_000_000] {
            let nested = format!("{}{}", open.repeat(depth), close.repeat(depth));
            let told = fault(&with("individuals:", &format!("x: {nested}, individuals:")));
            assert!(told.contains("brackets stand within brackets") && !told.contains("recursion"), "{told}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn saving_and_loading_change_nothing(population in population()) {
        let space = Space::builtin();
        let text = population.to_ron(&space);
        let loaded = Population::load(&space, "p.ron", &text).map_err(|report| TestCaseError::fail(report.to_string()))?;
        prop_assert!(loaded.notices.is_empty());
        prop_assert_eq!(&loaded.population, &population);
        prop_assert_eq!(loaded.population.to_ron(&space), &text[..]);
        let Population { generation, parent, votes, variety, .. } = population;
        prop_assert_eq!(Lineage::read("p.ron", &text), Ok(Lineage { generation, parent, votes, variety }));
    }

    #[test]
    fn votes_change_nothing_else(population in population(), votes in votes()) {
        let space = Space::builtin();
        // A person's file: comments in and around the value that is replaced.
        let text = population.to_ron(&space).replacen("    votes: ", "    votes: /* mine */ ", 1);
        let voted = set_votes("p.ron", &text, votes).expect("a population");
        let old = text.find("votes: /* mine */ ").expect("votes") + 18;
        let tail = &text[old + text[old..].find(",\n").expect("a line")..];
        prop_assert_eq!(&voted[..old], &text[..old]);
        prop_assert!(voted.ends_with(tail));
        let loaded = Population::load(&space, "p.ron", &voted).expect("valid");
        prop_assert_eq!(loaded.population, Population { votes, ..population });
        prop_assert_eq!(set_votes("p.ron", &voted, votes).expect("a population"), voted);
    }

    #[test]
    fn variety_changes_nothing_else(population in population(), part in prop::option::of(0.0..=1.0f64)) {
        let space = Space::builtin();
        let variety = part.and_then(Variety::of);
        let text = population.to_ron(&space);
        let edited = set_variety("p.ron", &text, variety).expect("a population");
        let loaded = Population::load(&space, "p.ron", &edited).expect("valid").population;
        prop_assert_eq!(&loaded, &Population { variety, ..population });
        prop_assert_eq!(set_variety("p.ron", &edited, variety).expect("a population"), edited);
    }

    #[test]
    fn locks_change_nothing_else(population in population(), names in prop::collection::btree_set(prop::sample::select(vec!["height_m", "sky", "tree"]), 0..3)) {
        let space = Space::builtin();
        let locked: std::collections::BTreeSet<String> = names.into_iter().map(str::to_owned).collect();
        let text = population.to_ron(&space);
        let edited = set_locked(&space, "p.ron", &text, &locked).expect("a population");
        let loaded = Population::load(&space, "p.ron", &edited).expect("valid").population;
        prop_assert_eq!(&loaded, &Population { locked: locked.clone(), ..population });
        prop_assert_eq!(set_locked(&space, "p.ron", &edited, &locked).expect("a population"), edited);
    }

    #[test]
    fn a_gene_changes_nothing_else(population in population(), who in 0..4usize, gene in 0..61usize, part in 0.0..=1.0) {
        let space = Space::builtin();
        let gene = &space.parameters()[gene];
        let value = gene.range.0 + (gene.range.1 - gene.range.0) * part;
        let text = population.to_ron(&space);
        let edited = set_gene(&space, "p.ron", &text, who, &gene.name, value).expect("a gene");
        let differing = text.lines().zip(edited.lines()).filter(|(old, new)| old != new).count();
        prop_assert!(differing <= 1 && text.lines().count() == edited.lines().count());
        let mut expected = population;
        expected.individuals[who].genome.set_code(gene, gene.snap(value));
        prop_assert_eq!(Population::load(&space, "p.ron", &edited).expect("valid").population, expected);
        prop_assert!(set_gene(&space, "p.ron", &text, who, &gene.name, gene.range.1 + 1.0).is_err());
        prop_assert!(set_gene(&space, "p.ron", &text, 4, &gene.name, value).is_err());
    }

    #[test]
    fn garbage_in_a_gene_is_told_with_its_place(gene in 0..61usize, garbage in "[^,\\s/][^,/]{0,20}") {
        let space = Space::builtin();
        let (text, line, column) = with_gene(&space.parameters()[gene].name, &garbage);
        match Population::load(&space, "p.ron", &text) {
            // By chance a number.
            Ok(_) => prop_assert!(garbage.trim().chars().next().is_some_and(|c| !c.is_alphabetic())),
            Err(report) => {
                let fault = &report.diagnostics[0];
                prop_assert!(fault.line >= line, "{}", report);
                prop_assert!(fault.line > line || fault.column >= column || fault.message.contains("missing"), "{}", report);
            }
        }
    }

    #[test]
    fn no_text_panics(text in "\\PC{0,80}", cut in any::<prop::sample::Index>(), insert in "[\\[(){}\\]\"#/*:,a-z0-9.-]{1,4}") {
        let space = Space::builtin();
        prop_assert!(Population::load(&space, "p.ron", &text).is_err());
        let mut broken = STARTER.to_owned();
        let at = broken.floor_char_boundary(cut.index(broken.len()));
        broken.insert_str(at, &insert);
        if let Err(report) = Population::load(&space, "p.ron", &broken) {
            prop_assert!(!report.diagnostics.is_empty() && !report.to_string().is_empty());
        }
        let _ = set_votes("p.ron", &broken, None);
        let _ = Space::parse("space.ron", &text);
    }
}
