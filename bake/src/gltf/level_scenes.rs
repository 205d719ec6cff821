//! Which of a file's meshes stand where: scene 0 holds the finished one, with the others as its MSFT_lod, and scene 1 all
//! of them in a row.

use serde_json::json;

use super::document::{Document, Node};
use crate::model::{Impostor, Level};

/// Levels of detail that Babylon.js reads.
const MSFT_LOD: &str = "MSFT_lod";
/// Pixels by which a level may be off, and the rows of the picture that these are pixels of, where programs choose levels
/// by `MSFT_screencoverage`.
const ERROR_PX: f32 = 1.5;
const SCREEN_PX: f32 = 1080.0;

/// What shows the model from some distance on.
pub struct Rung {
    /// "D0", "D1", …, "impostor".
    name: String,
    mesh: usize,
    /// Along x.
    width_m: f32,
    /// The diagonal of its bounds.
    size_m: f32,
    error_m: f32,
}

impl Rung {
    /// Of D_i, which is mesh i of the file, and whose error counts `weight` times.
    pub fn level(i: usize, level: &Level, weight: f32) -> Self {
        let bounds = level.mesh.bounds();
        Self {
            name: format!("D{i}"),
            mesh: i,
            width_m: bounds.max.x - bounds.min.x,
            size_m: bounds.max.distance(bounds.min),
            error_m: weight * level.error_m,
        }
    }

    /// Of the cards, which are mesh `mesh`.
    pub fn cards(mesh: usize, impostor: &Impostor) -> Self {
        let [width_m, height_m] = impostor.size_m;
        let size_m = (width_m * width_m + height_m * height_m).sqrt();
        Self { name: "impostor".into(), mesh, width_m, size_m, error_m: impostor.error_m }
    }
}

/// Scene 0: the finished mesh, which is the first rung. Scene 1: all rungs in a row along x. Each stands on a node of its
/// own there, so that the nodes of its meshes, which stand in no one's way, serve scene 0 as levels: Blender shows nodes
/// that are in no scene.
pub fn add_scenes(document: &mut Document, name: &str, rungs: &[Rung]) {
    let finished = document.node(Node { name: name.into(), mesh: Some(0), ..Node::default() });
    let (mut places, mut meshes) = (Vec::new(), Vec::new());
    let (mut at_m, mut before_m) = (0.0, None);
    for rung in rungs {
        at_m += before_m.replace(rung.width_m).map_or(0.0, |before_m| 0.55 * (before_m + rung.width_m));
        let name = format!("{name} {}", rung.name);
        let mesh = document.node(Node { name: name.clone(), mesh: Some(rung.mesh), ..Node::default() });
        meshes.push(mesh);
        places.push(document.node(Node {
            name: format!("{name} place"),
            translation: Some([at_m, 0.0, 0.0]),
            children: vec![mesh],
            ..Node::default()
        }));
    }
    let row = document.node(Node { name: format!("{name} levels"), children: places, ..Node::default() });
    document.scenes.push(json!({ "name": name, "nodes": [finished] }));
    document.scenes.push(json!({ "name": format!("{name} levels"), "nodes": [row] }));
    let coarser: Vec<usize> = (1..rungs.len()).filter(|&i| is_ever_shown(rungs, i)).collect();
    if !coarser.is_empty() {
        let ids: Vec<usize> = coarser.iter().map(|&i| meshes[i]).collect();
        let errors_m = coarser.iter().map(|&i| rungs[i].error_m);
        let node = &mut document.nodes[finished];
        node.extensions = Some(json!({ MSFT_LOD: { "ids": ids } }));
        node.extras = Some(json!({ "MSFT_screencoverage": screen_coverage(rungs[0].size_m, errors_m) }));
        document.extensions_used.insert(MSFT_LOD.into());
    }
}

/// Whether no later rung is nearer to the original: the pictures are nearer than the coarsest meshes.
fn is_ever_shown(rungs: &[Rung], i: usize) -> bool {
    rungs[i + 1..].iter().all(|later| later.error_m >= rungs[i].error_m)
}

/// For each level the part of the picture's height that the mesh must fill for it to be needed: less, and the next one's
/// error is too small to see. The last is never let go.
fn screen_coverage(size_m: f32, errors_m: impl Iterator<Item = f32>) -> Vec<f32> {
    let mut above = 1.0f32;
    let needed = errors_m.map(|error_m| {
        above = above.min(ERROR_PX / SCREEN_PX * size_m / error_m.max(f32::MIN_POSITIVE));
        above
    });
    needed.chain([0.0]).collect()
}
