//! What is studied: a RON file.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow};
use genescape_world::{MAX_TEXT_BYTES, regular_file};
use serde::{Deserialize, Serialize};

use crate::lod_mode::{TerrainLodMode, TreeLodMode};
use crate::options::Options;

/// Errors that may be studied, in pixels.
const MAX_ERROR_PX: f32 = 1e4;

/// A study.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    /// The world whose landscapes, as they were baked last, everybody walks through; from the configuration's folder.
    pub world: PathBuf,
    /// The folder for results; from the configuration's folder.
    pub out: PathBuf,
    /// One walk of each participant under each.
    pub conditions: Vec<Condition>,
}

/// How one walk is drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Condition {
    /// As the table calls it; participants do not see it.
    pub name: String,
    #[serde(default)]
    pub tree_lod: TreeLodMode,
    #[serde(default)]
    pub terrain_lod: TerrainLodMode,
    #[serde(default = "usual_tree_error")]
    pub tree_error_px: f32,
    #[serde(default = "usual_terrain_error")]
    pub terrain_error_px: f32,
}

fn usual_tree_error() -> f32 {
    Options::default().tree_error_px
}

fn usual_terrain_error() -> f32 {
    Options::default().terrain_error_px
}

impl Study {
    /// Reads a configuration.
    ///
    /// # Errors
    /// What is wrong with it, where, and what would be right.
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = regular_file::read(path, MAX_TEXT_BYTES)
            .with_context(|| format!("cannot read {}", path.display()))?;
        let text = String::from_utf8(bytes).with_context(|| format!("{} is no text", path.display()))?;
        let mut study = Self::parse(&path.display().to_string(), &text)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        (study.world, study.out) = (folder.join(&study.world), folder.join(&study.out));
        Ok(study)
    }

    /// Reads a configuration's text; `file` is its name for messages.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(file: &str, text: &str) -> Result<Self> {
        let study: Self = ron::from_str(text).map_err(|fault| anyhow!("{file}:{fault}"))?;
        let names: Vec<&str> = study.conditions.iter().map(|one| &*one.name).collect();
        if names.len() < 2 {
            return Err(anyhow!(
                "{file}: a study compares at least two conditions; this has {}",
                names.len()
            ));
        }
        if let Some(twice) = (1..names.len()).find(|at| names[..*at].contains(&names[*at])) {
            return Err(anyhow!(
                "{file}: two conditions are called {:?}; each needs a name of its own",
                names[twice]
            ));
        }
        for one in &study.conditions {
            for error_px in [one.tree_error_px, one.terrain_error_px] {
                if !(0.0..=MAX_ERROR_PX).contains(&error_px) {
                    let name = &one.name;
                    return Err(anyhow!(
                        "{file}: {name} has an error of {error_px} px; 0 to {MAX_ERROR_PX} can be"
                    ));
                }
            }
        }
        Ok(study)
    }
}

/// For tests and the book.
#[cfg(test)]
pub const EXAMPLE: &str = include_str!("../../../configs/thesis/study.ron");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_example_is_a_study_and_mistakes_are_told() {
        let study = Study::parse("study.ron", EXAMPLE).expect("valid");
        assert_eq!(study.conditions.len(), 4);
        let told = |from: &str, to: &str| {
            let text = EXAMPLE.replacen(from, to, 1);
            assert_ne!(text, EXAMPLE);
            Study::parse("study.ron", &text).expect_err(to).to_string()
        };
        assert!(told("\"discrete\"", "\"quality\"").contains("two conditions are called \"quality\""));
        assert!(told("tree_lod: Discrete", "tree_lod: Discreet").contains("study.ron:"));
        assert!(told("tree_error_px: 9", "tree_error_px: -9").contains("0 to 10000"));
        assert!(told("conditions", "condition").contains("study.ron:"));
    }
}
