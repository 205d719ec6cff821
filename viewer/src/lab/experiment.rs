//! What is measured: scenes, what of them is drawn, and by which schemes of levels of detail.

use crate::lod_mode::{TerrainLodMode, TreeLodMode};
use crate::options::Options;

use super::scenes::TestScene;

/// What of a scene is drawn (thesis section 7: "objects").
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Objects {
    All,
    Land,
    Trees,
}

/// A way to choose levels of detail.
#[derive(Clone, Debug, PartialEq)]
pub struct Scheme {
    /// As tables and plots call it.
    pub name: &'static str,
    pub trees: TreeLodMode,
    pub land: TerrainLodMode,
    /// Error that trees may have, in pixels.
    pub tree_error_px: f32,
    /// Bark as strips.
    pub bark_strips: bool,
}

/// No levels of detail: what others are compared with.
pub const NONE: &str = "none";
pub const ROAM: &str = "ROAM";
/// By distance alone, as the thesis has it.
pub const MORPH: &str = "vertex morph";
/// By roughness as well.
pub const ROUGHNESS: &str = "vertex morph by roughness";
pub const DISCRETE: &str = "discrete";
/// Continuous, by quality.
pub const CONTINUOUS: &str = "continuous";
pub const SIMPLE: &str = "simple";
/// As the window draws.
pub const USUAL: &str = "as in the window";
/// Bark as lists of triangles, as strips; its finest level.
pub const LISTS: &str = "lists";
pub const STRIPS: &str = "strips";

impl Scheme {
    fn new(name: &'static str, trees: TreeLodMode, land: TerrainLodMode) -> Self {
        Self { name, trees, land, tree_error_px: Options::default().tree_error_px, bark_strips: false }
    }

    /// What a frame is drawn from.
    pub fn options(&self, objects: Objects) -> Options {
        Options {
            tree_lod: self.trees,
            terrain_lod: self.land,
            tree_error_px: self.tree_error_px,
            bark_strips: self.bark_strips,
            draw_trees: objects != Objects::Land,
            draw_terrain: objects != Objects::Trees,
            grass: objects == Objects::All,
            ..Options::default()
        }
    }
}

/// A scene with objects under several schemes, the first of which is the reference.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// Of its files.
    pub name: &'static str,
    pub scene: TestScene,
    pub objects: Objects,
    pub schemes: Vec<Scheme>,
}

impl Experiment {
    /// All of them.
    pub fn all() -> Vec<Self> {
        let few = [Self::of_land().to_vec(), Self::of_trees().to_vec(), vec![Self::of_bark()]];
        [few.concat(), Self::of_all().to_vec()].concat()
    }

    /// Figures 21 to 24.
    pub fn of_land() -> [Self; 2] {
        use TerrainLodMode::{Distance, Morph, Off, Roam};
        let land = |name, land| Scheme::new(name, TreeLodMode::Off, land);
        let schemes =
            || vec![land(NONE, Off), land(ROAM, Roam), land(MORPH, Distance), land(ROUGHNESS, Morph)];
        [("land-gentle-hills", TestScene::FlatTerrain), ("land-big-hills", TestScene::BigHills)]
            .map(|(name, scene)| Self { name, scene, objects: Objects::Land, schemes: schemes() })
    }

    /// Figures 25 to 27, before the errors are chosen that make the schemes cost the same.
    pub fn of_trees() -> [Self; 2] {
        use TreeLodMode::{Discrete, Off, Quality, Simple};
        let trees = |name, trees| Scheme::new(name, trees, TerrainLodMode::Off);
        let schemes = || {
            vec![
                trees(NONE, Off),
                trees(DISCRETE, Discrete),
                trees(CONTINUOUS, Quality),
                trees(SIMPLE, Simple),
            ]
        };
        [("trees-few", TestScene::FewTrees), ("trees-many", TestScene::ManyTrees)].map(|(name, scene)| Self {
            name,
            scene,
            objects: Objects::Trees,
            schemes: schemes(),
        })
    }

    /// Section 4.4.1: trees at their finest, whose bark is lists or strips.
    pub fn of_bark() -> Self {
        let lists = Scheme::new(LISTS, TreeLodMode::Off, TerrainLodMode::Off);
        let strips = Scheme { name: STRIPS, bark_strips: true, ..lists.clone() };
        let schemes = vec![lists, strips];
        Self { name: "bark", scene: TestScene::FewTrees, objects: Objects::Trees, schemes }
    }

    /// Figure 28.
    pub fn of_all() -> [Self; 4] {
        let (trees, land) = <(TreeLodMode, TerrainLodMode)>::default();
        let schemes = || {
            vec![Scheme::new(NONE, TreeLodMode::Off, TerrainLodMode::Off), Scheme::new(USUAL, trees, land)]
        };
        [
            ("all-gentle-hills", TestScene::FlatTerrain),
            ("all-few-trees", TestScene::FewTrees),
            ("all-medium-trees", TestScene::MediumTrees),
            ("all-many-trees", TestScene::ManyTrees),
        ]
        .map(|(name, scene)| Self { name, scene, objects: Objects::All, schemes: schemes() })
    }
}
