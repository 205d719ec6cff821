//! Names of the files of a world folder, relative to it, with `/` between folders; and `current.ron`, which says
//! which scenes are ready.

use crate::check::Checker;
use crate::population::INDIVIDUALS;
use crate::report::Report;
use crate::ron_tree::{Node, prepare};
use crate::write::quoted;

/// This world's copy of the parameter space.
pub const SPACE: &str = "space.ron";
/// Folder of what the person made.
pub const POPULATIONS: &str = "population";
/// Folder of what can be made again.
pub const BAKED: &str = "baked";
/// Folder of the immutable blobs, by digest.
pub const BLOBS: &str = "baked/blobs";
/// Folder of action keys and what they produced.
pub const ACTIONS: &str = "baked/actions";
/// Which scenes are ready.
pub const CURRENT: &str = "baked/current.ron";

/// The population file of a generation: `population/g0012.ron`.
pub fn population(generation: u32) -> String {
    format!("{POPULATIONS}/{}", population_file(generation))
}

/// Its name within that folder: `g0012.ron`.
pub fn population_file(generation: u32) -> String {
    format!("g{generation:04}.ron")
}

/// The generation of a population file, from its name with or without folders; `None` for other files.
pub fn generation(file: &str) -> Option<u32> {
    let name = file.rsplit(['/', '\\']).next()?;
    let generation = name.strip_prefix('g')?.strip_suffix(".ron")?.parse().ok()?;
    (population_file(generation) == name).then_some(generation)
}

/// A blob by the hexadecimal digest of its bytes: `baked/blobs/ab/abcdef….png`.
pub fn blob(digest: &str, extension: &str) -> String {
    let shelf = digest.get(..2).unwrap_or(digest);
    format!("{BLOBS}/{shelf}/{digest}.{extension}")
}

/// The folder of a generation's scene: `baked/g0003/scene-0`.
pub fn scene_folder(generation: u32, scene: usize) -> String {
    format!("{BAKED}/g{generation:04}/scene-{scene}")
}

/// The glTF file of a generation's scene: `baked/g0003/scene-0/scene.gltf`.
pub fn scene(generation: u32, scene: usize) -> String {
    format!("{}/scene.gltf", scene_folder(generation, scene))
}

/// How a file in a scene's folder names a blob: `../../blobs/ab/abcdef….png`.
pub fn blob_from_scene(digest: &str, extension: &str) -> String {
    format!("../..{}", &blob(digest, extension)[BAKED.len()..])
}

/// The content of `current.ron`: renamed into place when all four scenes are ready.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Current {
    /// Which generation is shown.
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
        let text = prepare(text);
        let mut checker = Checker::new(file, &text);
        let root = checker.parse()?;
        let current = read_current(&mut checker, &root);
        checker.finish(current)
    }
}

fn read_current(checker: &mut Checker<'_>, root: &Node<'_>) -> Option<Current> {
    const FIELDS: [&str; 3] = ["generation", "population", "scenes"];
    let fields = checker.root(root, "Current", &FIELDS)?;
    let [generation, population, scenes] = FIELDS.map(|name| checker.need(&fields, root, "Current", name));
    let generation = generation.and_then(|node| checker.whole(node, "generation", u32::MAX));
    let population = population.and_then(|node| checker.text(node, "population"));
    let list = scenes?;
    let mut paths = Vec::new();
    for node in checker.list(list, "scenes")? {
        paths.push(checker.text(node, "scenes")?.to_owned());
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
