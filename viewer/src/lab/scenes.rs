//! The thesis's test scenes (figure 29), which the laboratory bakes into a world of its own.

use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};

use crate::baker::laboratory;

/// Files of four landscapes each.
pub const POPULATIONS: [(&str, &str); 2] = [
    ("configs/thesis/figure-29a-d.ron", include_str!("../../../configs/thesis/figure-29a-d.ron")),
    ("configs/thesis/figure-29e-f.ron", include_str!("../../../configs/thesis/figure-29e-f.ron")),
];

/// A scene of figure 29 that is walked through, by its place in the populations. The close-up is one for `viewer lab trees`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum TestScene {
    FlatTerrain,
    BigHills,
    FewTrees,
    ManyTrees,
    MediumTrees,
}

impl TestScene {
    pub const ALL: [Self; 5] =
        [Self::FlatTerrain, Self::BigHills, Self::FewTrees, Self::ManyTrees, Self::MediumTrees];

    /// As the thesis calls it.
    pub fn title(self) -> &'static str {
        match self {
            Self::FlatTerrain => "Gentle hills",
            Self::BigHills => "Big hills",
            Self::FewTrees => "Few trees, gentle hills, cumulus",
            Self::ManyTrees => "Many trees, big hills",
            Self::MediumTrees => "Medium trees, small hills, stratus",
        }
    }
}

/// Where the scenes are.
pub struct TestScenes(Vec<PathBuf>);

impl TestScenes {
    /// Bakes what is missing into the world `root`.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn bake(root: &Path) -> Result<Self> {
        let scenes = laboratory::bake(root, &POPULATIONS)?;
        ensure!(scenes.len() == 8, "two populations have eight scenes");
        Ok(Self(scenes))
    }

    /// The scene's file.
    pub fn path(&self, scene: TestScene) -> &Path {
        &self.0[scene as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use genescape_schema::{Population, Space};

    #[test]
    fn the_files_hold_what_figure_29_shows() {
        let space = Space::builtin();
        let mut names = Vec::new();
        for (number, (name, text)) in (0..).zip(POPULATIONS) {
            let population = Population::load(&space, name, text).expect(name).population;
            assert_eq!(population.generation, number, "{name} has a number of its own");
            names.extend(population.individuals.map(|one| one.name));
        }
        use TestScene::*;
        let expected = [
            (FlatTerrain, "Flat terrain"),
            (BigHills, "Big hills"),
            (FewTrees, "Few trees and flat terrain"),
            (ManyTrees, "Many trees and big hills"),
            (MediumTrees, "Medium trees and small hills"),
        ];
        for (scene, name) in expected {
            assert_eq!(names[scene as usize], name);
        }
    }
}
