//! A few kinds for tests, made of the tree presets and of the starters' lands and skies.

use genescape_schema::{Category, Chromosome, Kind, Kinds, Population, Scale, Space, TreePreset};

/// How far genes of these kinds stray, in parts of all codes.
const STRAY: u32 = 16;

const TREES: [(&str, &str, &str, &str); 5] = [
    ("oak", "Oaks", "broadleaf", include_str!("../../../configs/presets/broadleaf.ron")),
    ("birch", "Birches", "broadleaf", include_str!("../../../configs/presets/birch.ron")),
    ("maple", "Maples", "broadleaf", include_str!("../../../configs/presets/maple.ron")),
    ("spruce", "Spruces", "conifer", include_str!("../../../configs/presets/conifer.ron")),
    ("palm", "Palms", "palm", include_str!("../../../configs/presets/palm.ron")),
];
const LANDS: [(&str, &str, &str); 4] = [
    ("downs", "on downs", "hills"),
    ("lake", "by a lake", "hills"),
    ("coast", "by the sea", "coast"),
    ("heath", "on a heath", "heath"),
];
const SKIES: [(&str, &str, &str); 4] = [
    ("fair", "fair weather", "fair"),
    ("haze", "haze", "fair"),
    ("evening", "evening light", "low"),
    ("grey", "grey sky", "grey"),
];

/// The kinds; palms go with little relief alone, and downs with few trees.
pub fn kinds(space: &Space) -> Kinds {
    let text = include_str!("../../../configs/starter.ron");
    let starters = Population::load(space, "starter.ron", text).expect("tested").population;
    let mut kinds = Kinds::default();
    for (id, name, group, text) in TREES {
        let preset = TreePreset::load(space, id, text).expect("tested").preset;
        let goes_with = if id == "palm" { "relief_m: (15, 60)" } else { "" };
        kinds.insert(kind(space, Category::Tree, (id, name, group), &preset.tree, goes_with));
    }
    for (category, all) in [(Category::Terrain, LANDS), (Category::Sky, SKIES)] {
        for (one, starter) in all.into_iter().zip(&starters.individuals) {
            let goes_with = if one.0 == "downs" { "density_per_ha: (5, 150)" } else { "" };
            kinds.insert(kind(space, category, one, starter.genome.chromosome(category), goes_with));
        }
    }
    kinds
}

fn kind(
    space: &Space,
    category: Category,
    (id, name, group): (&str, &str, &str),
    typical: &Chromosome,
    goes_with: &str,
) -> Kind {
    let genes = space.category(category).filter(|gene| !gene.is_seed()).map(|gene| {
        let (code, stray) = (typical.code(gene), (gene.last_code() + 1) / STRAY);
        let ends = [code.saturating_sub(stray), code, (code + stray).min(gene.last_code())];
        let [min, typical, max] = ends.map(|code| gene.text(code));
        match gene.scale {
            Scale::Choice => format!("{}: [{typical}],", gene.name),
            _ => format!("{}: ({min}, {typical}, {max}),", gene.name),
        }
    });
    let genes: String = genes.collect();
    let text = format!(
        "Kind(name: {name:?}, source: \"a test\", mixes: [{group:?}], genes: ({genes}), goes_with: ({goes_with}))"
    );
    Kind::load(space, category, id, id, &text).expect("valid")
}

/// Four landscapes of these kinds.
pub fn drawn(space: &Space, kinds: &Kinds, seed: u64, generation: u32) -> Population {
    crate::random::population(space, kinds, &[], seed, generation)
        .expect("kinds of all categories")
        .population
}
