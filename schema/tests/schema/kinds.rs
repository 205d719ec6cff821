//! Kinds as people write them: four ways to say what a gene may be, and every fault told with its place.

use genescape_schema::{Allowed, Category, Chromosome, Kind, Kinds, SHIPPED, Scale, Space};

const DOWNS: &str = r#"Kind(
    name: "on downs",
    source: "a test",
    mixes: ["hills"],
    genes: (
        relief_m: (50, 90, 140),
        wavelength_m: 900,
        hurst: 1.1,
        lacunarity: 2,
        ridged: 0,
        offset: 0.5,
        stream_power_steps: (0, 6),
        droplets: 9000,
        talus_angle_deg: 32,
    ),
    goes_with: (density_per_ha: (5, 80), cloud_cover: (0, 0.6)),
)"#;

fn read(text: &str) -> Result<Kind, String> {
    Kind::load(&Space::builtin(), Category::Terrain, "downs", "downs.ron", text)
        .map_err(|report| report.to_string())
}

#[test]
fn a_kind_says_what_genes_may_be_and_what_it_goes_with() {
    let (space, kind) = (Space::builtin(), read(DOWNS).expect("valid"));
    let gene = |name: &str| space.find(name).expect("a gene");
    let allowed = |name: &str| kind.bounds.gene(&space, name).expect("a gene of lands").clone();
    let snap = |name: &str, value: f64| gene(name).snap(value);
    let [min, typical, max] = [50.0, 90.0, 140.0].map(|relief| snap("relief_m", relief));
    assert_eq!(allowed("relief_m"), Allowed::Near { min, typical, max });
    assert_eq!(allowed("stream_power_steps"), Allowed::Anywhere { min: 0, max: 6 });
    assert!(
        allowed("wavelength_m").is_fixed() && allowed("wavelength_m").contains(snap("wavelength_m", 900.0))
    );
    // A gene that the file lacks never strays from its default, and a seed may be anything.
    assert!(allowed("snow_line").is_fixed() && allowed("snow_line").contains(snap("snow_line", 1.0)));
    assert_eq!(allowed("terrain_seed"), Allowed::Anywhere { min: 0, max: 255 });
    let mut trees = Chromosome::zero(&space, Category::Tree);
    assert!(kind.goes_with(&space, Category::Tree, &trees));
    trees.set_code(gene("density_per_ha"), snap("density_per_ha", 200.0));
    assert!(!kind.goes_with(&space, Category::Tree, &trees));
    assert!(kind.is_called("downs") && !kind.is_called("down"));
}

#[test]
fn every_fault_of_a_kind_is_told_at_once_with_its_place() {
    let text = DOWNS
        .replace("name: \"on downs\"", "name: \"\"")
        .replace("(50, 90, 140)", "(50, 900, 140)")
        .replace("hurst: 1.1", "hurst: (1.2, 1.0)")
        .replace("lacunarity: 2,", "lacunarity: [2, 2.2], terrain_seed: 4,")
        .replace("offset: 0.5,", "height_m: 20,")
        .replace("droplets: 9000", "droplets: (1, 2, 3, 4)")
        .replace("density_per_ha: (5, 80)", "relief_m: (5, 80), sky_seed: (1, 2), temprature: (1, 2)")
        .replace("(0, 0.6)", "(0.6, 0)");
    let told = read(&text).expect_err("full of faults");
    for fault in [
        "downs.ron:2:11: name is empty",
        "downs.ron:5:12: genes: 1 gene is missing: offset (0 … 1)",
        "downs.ron:6:24: relief_m: 900 is outside 15 … 420 m",
        "downs.ron:8:16: hurst: (1.2, 1.0) must rise",
        "downs.ron:9:21: lacunarity: a range stands in round brackets, as (min, typical, max)",
        "downs.ron:9:31: genes has no terrain_seed; seeds are drawn for each individual",
        "downs.ron:11:9: genes has no height_m; it belongs into tree",
        "downs.ron:13:19: droplets: expected one of these forms: 20, (14, 28) or (14, 20, 28), found",
        "downs.ron:16:17: goes_with has no relief_m; it is a gene of terrain itself: say what it may be under genes",
        "goes_with has no sky_seed; a seed says nothing of what a place is like",
        "goes_with has no temprature",
        "goes_with: cloud_cover: (0.6, 0) must rise",
    ] {
        assert!(told.contains(fault), "{fault}\nis not in\n{told}");
    }
    for (text, fault) in
        [("Kind()", "lacks name"), ("Kind(", "ends too early"), ("Oak(name: 1)", "expected Kind(…)")]
    {
        assert!(read(text).expect_err(text).contains(fault), "{text}");
    }
}

#[test]
fn choices_are_listed_and_nothing_lies_between_them() {
    let (space, (kinds, _)) = (Space::builtin(), Kinds::shipped(&Space::builtin()));
    let tree = SHIPPED.iter().find(|kind| kind.category == Category::Tree).expect("a tree ships");
    let shape = space.category(Category::Tree).find(|gene| gene.scale == Scale::Choice).expect("a choice");
    let at = tree.text.find(&format!("{}:", shape.name)).expect("its line") + shape.name.len() + 1;
    let end = at + tree.text[at..].find('\n').expect("a line");
    let with = |value: &str| {
        let text = format!("{} {value},{}", &tree.text[..at], &tree.text[end..]);
        Kind::load(&space, Category::Tree, "x", "x.ron", &text)
    };
    let kind = with("[5, 1, 5]").expect("valid");
    assert_eq!(kind.bounds.gene(&space, &shape.name), Some(&Allowed::OneOf(vec![1, 5])));
    let told = with("(1, 5)").expect_err("a range").to_string();
    assert!(told.contains("values between two choices mean something else; list them, as [1, 4]"), "{told}");
    let other = kinds.of(Category::Tree).next().expect("a tree");
    let hull = kind.bounds.hull(&other.bounds);
    let Some(Allowed::OneOf(codes)) = hull.gene(&space, &shape.name) else { panic!("a choice stays one") };
    assert!(codes.contains(&1) && codes.contains(&5) && codes.len() <= 4);
}

#[test]
fn kinds_that_ship_fit_a_world_whose_genes_have_narrower_ranges() {
    let narrow = Space::BUILTIN.replace("range: (3.0, 30.0)", "range: (3.0, 12.0)");
    let (space, _) = Space::load("space.ron", &narrow).expect("valid");
    let (kinds, faults) = Kinds::shipped(&space);
    assert!(faults.is_empty() && kinds.iter().count() == SHIPPED.len());
    let tall = DOWNS.replace("relief_m: (50, 90, 140)", "relief_m: (50, 90, 1400)");
    assert!(read(&tall).is_err(), "a person hears of it");
}

#[test]
fn a_space_from_before_there_were_groups_and_choices_takes_them_over() {
    let older: String = Space::BUILTIN.replace("scale: choice", "scale: integer");
    let older: Vec<String> = older
        .lines()
        .map(|line| match line.split_once(" group: \"") {
            Some((before, rest)) => format!("{before}{}", rest.split_once("\",").expect("quoted").1),
            None => line.to_owned(),
        })
        .collect();
    assert!(!older.concat().contains("group: \""));
    assert_eq!(Space::load("space.ron", &older.join("\n")), Ok((Space::builtin(), Vec::new())));
}

#[test]
fn between_two_kinds_is_within_their_hull() {
    let space = Space::builtin();
    let (kinds, _) = Kinds::shipped(&space);
    for (a, b) in
        kinds.iter().flat_map(|a| kinds.iter().map(move |b| (a, b))).filter(|(a, b)| a.mixes_with(b))
    {
        let (hull, middle) = (a.bounds.hull(&b.bounds), a.bounds.blend(&b.bounds, 0.4));
        for ((gene, wide), (_, narrow)) in hull.genes(&space).zip(middle.genes(&space)) {
            let ((low, high), (min, max)) = (wide.ends(), narrow.ends());
            assert!(
                low <= min && min <= narrow.typical() && narrow.typical() <= max && max <= high,
                "{}",
                gene.name
            );
        }
    }
}
