//! Names of the files of a world folder, relative to it, with `/` between folders.

use std::path::Path;

use genescape_schema::Category;

/// This world's copy of the parameter space.
pub const SPACE: &str = "space.ron";
/// Folder of what the person made.
pub const POPULATIONS: &str = "population";
/// Folder of what can be made again.
pub const BAKED: &str = "baked";
/// Folder of a person's own kinds.
pub const KINDS: &str = "kinds";
/// Landscapes that the person marked with a star.
pub const FAVOURITES: &str = "favourites.ron";
/// Folder of answers to the questionnaire.
pub const ANSWERS: &str = "answers";
/// Which scenes are ready.
pub const CURRENT: &str = "baked/current.ron";

/// The population file of a generation: `population/g0012.ron`.
pub fn population(generation: u32) -> String {
    format!("{POPULATIONS}/g{generation:04}.ron")
}

/// The file of a kind: `kinds/tree/oak.ron`.
pub fn kind(category: Category, id: &str) -> String {
    format!("{KINDS}/{category}/{id}.ron")
}

/// The generation of a population file, from its name with or without folders; `None` for other files.
pub fn generation(file: &str) -> Option<u32> {
    let name = file.rsplit(['/', '\\']).next()?;
    baked_generation(name.strip_suffix(".ron")?)
}

/// The generation of a population file, from its path.
pub fn generation_of(path: &Path) -> Option<u32> {
    generation(path.file_name()?.to_str()?)
}

/// The generation of a folder of scenes, `g0012`; `None` for other names.
pub(crate) fn baked_generation(folder: &str) -> Option<u32> {
    let generation = folder.strip_prefix('g')?.parse().ok()?;
    (format!("g{generation:04}") == folder).then_some(generation)
}

/// A generation's scene, as the cache's history calls it: `g0003-scene-0`.
pub fn scene_id(generation: u32, scene: usize) -> String {
    format!("g{generation:04}-scene-{scene}")
}

/// The glTF file of a generation's scene: `baked/g0003/scene-0/scene.gltf`.
pub fn scene(generation: u32, scene: usize) -> String {
    format!("{BAKED}/{}/scene.gltf", scene_id(generation, scene).replacen('-', "/", 1))
}

/// The picture of a generation's landscape, small, as it is first seen: `baked/g0003/scene-0/thumbnail.jpg`.
pub fn thumbnail(generation: u32, scene: usize) -> String {
    format!("{BAKED}/{}/thumbnail.jpg", scene_id(generation, scene).replacen('-', "/", 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn names_are_read_back(number: u32) {
            prop_assert_eq!(generation(&population(number)), Some(number));
            prop_assert_eq!(generation(&format!("g{number}x.ron")), None);
            prop_assert_eq!(baked_generation(scene(number, 2).split('/').nth(1).unwrap_or_default()), Some(number));
        }
    }

    #[test]
    fn names_are_those_of_the_design() {
        assert_eq!(population(12), "population/g0012.ron");
        assert_eq!(generation("g0012.ron"), Some(12));
        assert_eq!(generation("C:\\w\\population\\g0012.ron"), Some(12));
        for other in
            ["g12.ron", "g0012.ron~", "g0012.RON", "notes.ron", "g-012.ron", "g+012.ron", "g.ron", ""]
        {
            assert_eq!(generation(other), None, "{other}");
        }
        assert_eq!(scene(3, 0), "baked/g0003/scene-0/scene.gltf");
        assert_eq!(scene_id(12345, 3), "g12345-scene-3");
    }
}
