//! `current.ron`: which scenes of a world are ready to be looked at.

use crate::check::{Checker, read};
use crate::population::INDIVIDUALS;
use crate::report::Report;
use crate::ron_tree::Node;
use crate::write::quoted;

/// The content of `current.ron`: renamed into place when all four scenes are ready.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Current {
    pub generation: u32,
    /// Hexadecimal digest of the population file's bytes.
    pub population: String,
    /// The four scene files, relative to the world folder.
    pub scenes: [String; INDIVIDUALS],
}

impl Current {
    /// The file's text.
    pub fn to_ron(&self) -> String {
        let scenes: String =
            self.scenes.iter().map(|scene| format!("        {},\n", quoted(scene))).collect();
        let (generation, population) = (self.generation, quoted(&self.population));
        format!(
            "// Written by `bake`; changes are lost.\n\
             Current(\n    generation: {generation},\n    population: {population},\n    scenes: [\n{scenes}    ],\n)\n"
        )
    }

    /// Reads the file's text; `file` is its name for messages.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn load(file: &str, text: &str) -> Result<Self, Report> {
        read(file, text, read_current)
    }
}

/// Characters of the path of a scene.
const MAX_PATH: usize = 200;

fn read_current(checker: &mut Checker<'_>, root: &Node<'_>) -> Option<Current> {
    const FIELDS: [&str; 3] = ["generation", "population", "scenes"];
    let fields = checker.root(root, "Current", &FIELDS)?;
    let [generation, population, scenes] = FIELDS.map(|name| checker.need(&fields, root, "Current", name));
    let generation = generation.and_then(|node| checker.whole(node, "generation", u32::MAX));
    let population = population.and_then(|node| checker.text(node, "population"));
    let list = scenes?;
    let mut paths = Vec::new();
    for node in checker.list(list, "scenes")? {
        let path = checker.line(node, "scenes", MAX_PATH)?;
        // It may be a stranger's world.
        if path.split(['/', '\\']).any(|part| ["", ".", ".."].contains(&part)) || path.contains(':') {
            return checker.refuse(node.span(), format!("scenes: {path} does not lie in the world"));
        }
        paths.push(path.to_owned());
    }
    let found = paths.len();
    if found != INDIVIDUALS {
        checker
            .error(list.start..list.start + 1, format!("scenes: found {found}; there must be {INDIVIDUALS}"));
    }
    Some(Current {
        generation: generation?,
        population: population?.to_owned(),
        scenes: paths.try_into().ok()?,
    })
}
