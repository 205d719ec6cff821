//! A scene → the names of its files, such as a person would give: by the landscape's name and the kind of its trees.

use std::path::Path;

use genescape_schema::{Category, Chromosome, Kinds, Space};
use genescape_world::World;
use serde_json::Value;

use super::source::SceneFile;
use crate::kinds::Home;

/// Names that Windows keeps for devices, with whatever ending.
const RESERVED: [&str; 22] = [
    "con", "prn", "aux", "nul", "com1", "com2", "com3", "com4", "com5", "com6", "com7", "com8", "com9",
    "lpt1", "lpt2", "lpt3", "lpt4", "lpt5", "lpt6", "lpt7", "lpt8", "lpt9",
];
/// Characters of a name, so that paths stay short enough for every system.
const MAX_LENGTH: usize = 60;
/// What a tree that is like no kind is called.
const WILD: &str = "tree";

/// What the files of an export are called.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names {
    /// What names of files begin with.
    pub stem: String,
    /// What kind of tree grows there: "oak".
    pub plant: String,
}

impl Names {
    pub fn of(scene: &SceneFile) -> Self {
        let (space, kinds) = nature(&scene.baked().join(".."));
        let genome = &scene.json["scenes"][0]["extras"]["genome"];
        Self { stem: stem(&scene.json), plant: plant(&space, &kinds, genome) }
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

/// What names of a scene's files begin with.
pub fn stem(scene: &Value) -> String {
    slug(scene["scenes"][0]["name"].as_str().unwrap_or_default())
}

/// The genes and kinds of the world in a folder; those that ship where there is none, or none that can be read.
fn nature(world: &Path) -> (Space, Kinds) {
    let read = || {
        let world = World::open(world).ok()?;
        let (space, _) = world.space().ok()?;
        let kinds = world.kinds(&space).kinds;
        Some((space, kinds))
    };
    read().unwrap_or_else(|| {
        let space = Space::builtin();
        let (kinds, _) = Kinds::shipped(&space);
        (space, kinds)
    })
}

/// The kind of a tree of these genes: a name for files.
fn plant(space: &Space, kinds: &Kinds, genome: &Value) -> String {
    let mut genes = Chromosome::zero(space, Category::Tree);
    for gene in space.category(Category::Tree) {
        // A scene that an older version baked lacks the newer genes.
        let code = genome[&gene.name].as_f64().map(|value| gene.snap(value));
        genes.set_code(gene, code.or(gene.default).unwrap_or_default());
    }
    let id = Home::of(space, kinds, Category::Tree, &genes).id();
    id.map_or_else(|| WILD.into(), slug)
}

#[cfg(test)]
mod tests {
    use genescape_schema::Allowed;
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
    fn trees_are_called_what_they_are() {
        let (space, kinds) = nature(Path::new("no world"));
        let mut all = 0;
        for kind in kinds.of(Category::Tree) {
            let typical = |allowed: &Allowed| match allowed {
                Allowed::Near { typical, .. } => *typical,
                other => other.ends().0,
            };
            let genes = kind.bounds.genes(&space);
            let typical: Value = genes
                .map(|(gene, allowed)| (gene.name.clone(), json!(gene.value(typical(allowed)))))
                .collect();
            assert_eq!(plant(&space, &kinds, &typical), kind.id.replace('_', "-"));
            all += 1;
        }
        assert!(all > 30, "{all} kinds");
        assert_eq!(plant(&space, &Kinds::default(), &Value::Null), WILD);
    }
}
