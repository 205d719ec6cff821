//! What was named on the command line or dropped on the window → where landscapes come from.

use std::fs;
use std::path::{Path, PathBuf};

use genescape_schema::INDIVIDUALS;

use crate::near_name::near_world;
use crate::{WorldError, names};

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// A world folder, with populations and a bake.
    World(PathBuf),
    /// glTF files only: what was baked elsewhere, or one of anyone's.
    Scenes(Vec<PathBuf>),
}

impl Source {
    /// What a folder or file is, that was named or dropped. A folder that is empty or not there is a world to begin.
    ///
    /// # Errors
    /// A path to nothing of ours.
    pub fn of(path: &Path) -> Result<Self, WorldError> {
        let is_gltf = path
            .extension()
            .is_some_and(|ending| ["gltf", "glb"].iter().any(|known| ending.eq_ignore_ascii_case(known)));
        match (is_gltf, path.is_file()) {
            (true, true) => return Ok(Self::Scenes(vec![path.to_owned()])),
            (true, false) => return Err(WorldError::NoFile(path.to_owned())),
            (false, true) => return Err(WorldError::NoScene(path.to_owned())),
            (false, false) => {}
        }
        if let Some(near) = near_world(path) {
            return Err(WorldError::NearName { path: path.to_owned(), near });
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
        let is_empty = fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_none());
        is_empty.then(|| Self::World(path.to_owned())).ok_or_else(|| WorldError::NoSource(path.to_owned()))
    }
}
