//! What was named on the command line or dropped on the window → where landscapes come from.

use std::path::{Path, PathBuf};

use genescape_schema::{INDIVIDUALS, names};

/// Where landscapes come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// A world folder, with populations and a bake.
    World(PathBuf),
    /// Scene files only: what was baked elsewhere.
    Scenes(Vec<PathBuf>),
}

impl Source {
    /// What a folder or file is, that was named or dropped. A text for people if it is nothing of ours.
    pub fn of(path: &Path) -> Result<Self, String> {
        let of_gltf = path.extension().is_some_and(|ending| ending == "gltf" || ending == "glb");
        if of_gltf || path.is_file() {
            return match (of_gltf, path.is_file()) {
                (true, true) => Ok(Self::Scenes(vec![path.to_owned()])),
                (true, false) => Err(format!("there is no file {}", path.display())),
                (false, _) => Err(format!("{} is no scene.gltf", path.display())),
            };
        }
        if path.join(names::POPULATIONS).is_dir() || !path.exists() {
            return Ok(Self::World(path.to_owned()));
        }
        let single = path.join("scene.gltf");
        if single.is_file() {
            return Ok(Self::Scenes(vec![single]));
        }
        let numbered = (0..INDIVIDUALS).map(|index| path.join(format!("scene-{index}/scene.gltf")));
        let scenes: Vec<PathBuf> = numbered.filter(|scene| scene.is_file()).collect();
        if !scenes.is_empty() {
            return Ok(Self::Scenes(scenes));
        }
        let empty = std::fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_none());
        if empty {
            return Ok(Self::World(path.to_owned()));
        }
        Err(format!(
            "{} is neither a world nor a baked folder: it has no population/ and no scene.gltf",
            path.display()
        ))
    }
}
