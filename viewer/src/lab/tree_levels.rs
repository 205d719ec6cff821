//! The levels of detail of a tree of each of many landscapes, all as large on the screen and in one light: what the targets for
//! trees are about.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::Result;
use serde::{Deserialize, Serialize};

use super::bench::Bench;
use super::chain::chain;
use super::scenes::{POPULATIONS, TestScene};
use crate::baker::laboratory;
use crate::headless::Headless;
use crate::passes::Shaders;
use crate::scene::Scene;

/// One level of one template.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TreeLevel {
    pub landscape: String,
    /// 0 is the finest.
    pub level: u32,
    pub triangles: u32,
    pub vertices: u32,
    /// As the file has it, over the radius of the tree: what it comes to at equal size.
    pub relative_error: f64,
    /// Over that of the full tree.
    pub coverage: f64,
    pub flip: f64,
}

/// The first template of each test scene, and of four random landscapes, as they come, for each of some seeds. All stand in
/// the weather of the first: in fog no level differs by much from any other. `root` is the laboratory's world.
pub fn measure(bench: &Bench, root: &Path, seeds: u64) -> Result<Vec<TreeLevel>> {
    // Smooth edges, as in the window: a tree is looked at.
    let headless = Headless::open(&Shaders::from(None), 4)?;
    let tests = TestScene::ALL.map(|scene| bench.scenes.path(scene).to_owned());
    let random = laboratory::bake_random(root, 1..seeds + 1, POPULATIONS.len() as u32)?;
    let (mut rows, mut known) = (Vec::new(), BTreeSet::new());
    let weather = headless.read(bench.scenes.path(TestScene::FlatTerrain))?.sky;
    for path in tests.into_iter().chain(random) {
        bench.bar.inc(1);
        let scene = Scene { sky: weather.clone(), ..headless.read(&path)? };
        // Bare land has no trees.
        let Some(&tree) = scene.trees.instances.first() else { continue };
        let template = &scene.trees.templates[tree.template as usize];
        if !known.insert(template.blob.clone()) {
            continue;
        }
        let levels = chain(&headless, &scene, tree, template)?;
        rows.extend((0..).zip(levels).map(|(level, shown)| TreeLevel {
            landscape: scene.name.clone(),
            level,
            triangles: shown.triangles,
            vertices: shown.vertices,
            relative_error: f64::from(shown.error_m / template.error_weight / template.radius_m),
            coverage: shown.coverage,
            flip: shown.flip,
        }));
    }
    Ok(rows)
}
