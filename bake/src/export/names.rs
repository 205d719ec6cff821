//! A scene → the names of its files, such as a person would give: by the landscape's name and the kind of its trees.

use serde_json::Value;

/// Names that Windows keeps for devices, with whatever ending.
const RESERVED: [&str; 22] = [
    "con", "prn", "aux", "nul", "com1", "com2", "com3", "com4", "com5", "com6", "com7", "com8", "com9",
    "lpt1", "lpt2", "lpt3", "lpt4", "lpt5", "lpt6", "lpt7", "lpt8", "lpt9",
];
/// Characters of a name, so that paths stay short enough for every system.
const MAX_LENGTH: usize = 60;
/// Metres below which whatever grows is a bush.
const BUSH_M: f64 = 4.0;
/// Part of the leaf cards in blossom from which that is what one sees.
const IN_BLOSSOM: f64 = 0.1;
/// Tone of bark from which it is white.
const WHITE_BARK: f64 = 0.85;
/// What grows leaves of each `leaf_shape`.
const BY_LEAF: [&str; 8] = ["broadleaf", "ash", "willow", "oak", "maple", "linden", "conifer", "palm"];

/// What the files of an export are called.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names {
    /// What names of files begin with.
    pub stem: String,
    /// What kind of tree grows there: "oak".
    pub plant: &'static str,
}

impl Names {
    pub fn of(scene: &Value) -> Self {
        let scene = &scene["scenes"][0];
        let stem = slug(scene["name"].as_str().unwrap_or_default());
        Self { stem, plant: plant(&scene["extras"]["genome"]) }
    }

    pub fn scene(&self) -> String {
        format!("{}.glb", self.stem)
    }

    pub fn sky(&self) -> String {
        format!("{}-sky.exr", self.stem)
    }

    pub fn sky_preview(&self) -> String {
        format!("{}-sky.jpg", self.stem)
    }

    pub fn script(&self) -> String {
        format!("{}-blender.py", self.stem)
    }

    /// The kind of tree with the number of its template, which counts from 0: "oak-1".
    pub fn kind(&self, template: usize) -> String {
        format!("{}-{}", self.plant, template + 1)
    }

    pub fn tree(&self, template: usize) -> String {
        format!("trees/{}.glb", self.kind(template))
    }
}

/// A name in lower-case ASCII letters, digits and single dashes, which any system takes for a file.
fn slug(name: &str) -> String {
    let mut slug = String::new();
    for c in deunicode::deunicode(name).chars() {
        match c {
            'a'..='z' | '0'..='9' => slug.push(c),
            'A'..='Z' => slug.push(c.to_ascii_lowercase()),
            '\'' => {}
            _ if slug.ends_with('-') || slug.is_empty() => {}
            _ => slug.push('-'),
        }
    }
    slug.truncate(MAX_LENGTH);
    match slug.trim_end_matches('-') {
        "" => "landscape".into(),
        name if RESERVED.contains(&name) => format!("{name}-landscape"),
        name => name.into(),
    }
}

/// What a tree of these genes would be called at a glance.
fn plant(genome: &Value) -> &'static str {
    let gene = |name: &str| genome[name].as_f64();
    if gene("leaves_per_stem") == Some(0.0) {
        "bare-tree"
    } else if gene("height_m").is_some_and(|height_m| height_m < BUSH_M) {
        "bush"
    } else if gene("blossom").is_some_and(|part| part > IN_BLOSSOM) {
        "cherry"
    } else if gene("bark_tone").is_some_and(|tone| tone > WHITE_BARK) && gene("leaf_shape") < Some(6.0) {
        "birch"
    } else {
        let shape = gene("leaf_shape").and_then(|shape| BY_LEAF.get(shape as usize));
        shape.copied().unwrap_or("tree")
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use serde_json::json;

    use super::*;

    #[test]
    fn names_are_those_a_person_would_give() {
        for (name, expected) in [
            ("Oak valley in June", "oak-valley-in-june"),
            ("1.0: tree of 0.1 and 2", "1-0-tree-of-0-1-and-2"),
            ("Tal der Füchse (grün)", "tal-der-fuchse-grun"),
            ("Долина", "dolina"),
            ("Nobody's land", "nobodys-land"),
            ("../../etc/passwd", "etc-passwd"),
            ("Con", "con-landscape"),
            ("…", "landscape"),
            ("", "landscape"),
        ] {
            assert_eq!(slug(name), expected, "{name}");
        }
    }

    proptest! {
        #[test]
        fn any_name_becomes_a_file_of_its_own_folder(name: String) {
            let slug = slug(&name);
            prop_assert!((1..=MAX_LENGTH + 10).contains(&slug.len()));
            prop_assert!(slug.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-'));
            prop_assert!(!slug.starts_with('-') && !slug.ends_with('-') && !RESERVED.contains(&slug.as_str()));
        }
    }

    #[test]
    fn presets_are_recognised() {
        let space = genescape_schema::Space::builtin();
        for (file, expected) in [
            ("birch", "birch"),
            ("broadleaf", "oak"),
            ("bush", "bush"),
            ("cherry", "cherry"),
            ("conifer", "conifer"),
            ("maple", "maple"),
            ("palm", "palm"),
            ("willow", "willow"),
            ("winter", "bare-tree"),
        ] {
            let path = format!("{}/../configs/presets/{file}.ron", env!("CARGO_MANIFEST_DIR"));
            let text = std::fs::read_to_string(&path).expect("a preset");
            let preset = genescape_schema::TreePreset::load(&space, &path, &text).expect("sound").preset;
            let genes = space.category(genescape_schema::Category::Tree);
            let genome: Value =
                genes.map(|gene| (gene.name.clone(), json!(gene.value(preset.tree.code(gene))))).collect();
            assert_eq!(plant(&genome), expected, "{file}");
        }
        assert_eq!(plant(&Value::Null), "tree");
    }
}
