//! Which meshes stand for one shape from near and from far: as `GSC_progressive_mesh` says it of a mesh, or `MSFT_lod` of a
//! node; a mesh without either has one level.

use std::collections::BTreeSet;

use genescape_schema::scene::{
    GSC_PROGRESSIVE_MESH, ProgressiveLevel, ProgressiveMeshExtension, error_weight,
};
use glam::DAffine3;
use gltf::json::scene::Node;
use gltf::json::{Mesh, extensions};
use serde::Deserialize;

use super::file::AssetFile;
use super::notes::Notes;
use super::places::{children, local};

pub(super) const MSFT_LOD: &str = "MSFT_lod";
/// More levels than this tell no more apart.
pub(super) const MAX_LEVELS: usize = crate::lod::tree::MAX_LEVELS;
/// Nodes below those that have levels: a node may stand for many others.
pub(super) const MAX_NODES: usize = 1 << 20;

/// One level of a shape: which meshes, each in the shape's space.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LevelPlan {
    pub meshes: Vec<(usize, DAffine3)>,
    pub change: Change,
    /// See [`super::vertices::Treatment::morph`].
    pub morph: Option<Vec<usize>>,
}

impl LevelPlan {
    /// Equal for equal levels.
    pub fn key(&self) -> impl Iterator<Item = u64> {
        let places = self.meshes.iter().flat_map(|(mesh, place)| {
            std::iter::once(*mesh as u64).chain(place.to_cols_array().map(f64::to_bits))
        });
        let change = match self.change {
            Change::Error(error_m) => error_m.to_bits(),
            Change::Coverage(share) => share.to_bits(),
        };
        [self.meshes.len() as u64, change.into()].into_iter().chain(places)
    }

    /// A mesh as it is.
    pub fn single(mesh: usize) -> Self {
        Self { meshes: vec![(mesh, DAffine3::IDENTITY)], change: Change::Coverage(1.0), morph: None }
    }
}

/// When a level takes the place of the one before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Change {
    /// Where its error, in metres, is no longer seen.
    Error(f32),
    /// Where the shape covers no more than this part of the picture's height.
    Coverage(f32),
}

/// The levels of a mesh of ours.
pub(super) fn progressive(file: &AssetFile, mesh: &Mesh, notes: &mut Notes) -> Option<Vec<LevelPlan>> {
    let extensions::mesh::Mesh { others } = mesh.extensions.as_ref()?;
    let value = others.get(GSC_PROGRESSIVE_MESH)?;
    let extension = ProgressiveMeshExtension::deserialize(value).ok();
    let weight = error_weight(extension.as_ref().and_then(|extension| extension.coverage));
    let levels = extension.map(|extension| extension.levels);
    let is_sound = |levels: &Vec<ProgressiveLevel>| {
        !levels.is_empty()
            && levels.iter().all(|level| level.mesh < file.root.meshes.len())
            && levels.iter().all(|level| level.error_m.is_finite() && level.error_m > 0.0)
    };
    let Some(levels) = levels.filter(is_sound) else {
        notes.add("Levels of detail by GSC_progressive_mesh are damaged, and are not drawn");
        return None;
    };
    let last = levels.len() - 1;
    let plan = |(number, level): (usize, ProgressiveLevel)| LevelPlan {
        meshes: vec![(level.mesh, DAffine3::IDENTITY)],
        change: Change::Error(weight * level.error_m),
        morph: (number < last).then_some(level.texcoord_deltas),
    };
    Some(levels.into_iter().enumerate().map(plan).collect())
}

/// The nodes that stand for others from afar: they are no part of the scene by themselves.
pub(super) fn stand_ins(file: &AssetFile) -> BTreeSet<usize> {
    file.root.nodes.iter().flat_map(|node| lod_ids(node).unwrap_or_default()).collect()
}

fn lod_ids(node: &Node) -> Option<Vec<usize>> {
    let ids = node.extensions.as_ref()?.others.get(MSFT_LOD)?.get("ids")?.as_array()?;
    Some(ids.iter().filter_map(|id| usize::try_from(id.as_u64()?).ok()).collect())
}

/// The levels of a node that has `MSFT_lod`: it and all below it, then what stands for it. At most `left` nodes are
/// looked at, and taken from it.
pub(super) fn by_node(file: &AssetFile, node: usize, left: &mut usize) -> Option<Vec<LevelPlan>> {
    let ids = lod_ids(file.root.nodes.get(node)?)?;
    let coverages = coverages(&file.root.nodes[node]);
    let parent_from_node = local(&file.root.nodes[node]);
    let node_from_parent = parent_from_node.inverse();
    let sound = if node_from_parent.is_finite() { node_from_parent } else { DAffine3::IDENTITY };
    let stand_ins = ids.iter().filter(|id| **id < file.root.nodes.len() && **id != node);
    let mut levels = Vec::new();
    for id in [&node].into_iter().chain(stand_ins).take(MAX_LEVELS) {
        let place = if *id == node { DAffine3::IDENTITY } else { sound * local(&file.root.nodes[*id]) };
        let meshes = below(file, *id, place, left);
        let number = levels.len();
        // From which share of the picture the level before is the last that counts.
        let usual = libm::exp2f(-(number as f32));
        let before = number.checked_sub(1).and_then(|before| coverages.get(before).copied());
        let share = before.filter(|share| *share > 0.0 && *share <= 1.0).unwrap_or(usual);
        if !meshes.is_empty() {
            levels.push(LevelPlan { meshes, change: Change::Coverage(share), morph: None });
        }
    }
    (!levels.is_empty()).then_some(levels)
}

/// For each level the part of the picture down to which it is meant.
fn coverages(node: &Node) -> Vec<f32> {
    #[derive(Default, Deserialize)]
    struct Extras {
        #[serde(default, rename = "MSFT_screencoverage")]
        coverages: Vec<f32>,
    }
    let extras = node.extras.as_ref().and_then(|raw| serde_json::from_str::<Extras>(raw.get()).ok());
    extras.unwrap_or_default().coverages
}

/// The meshes of a node and of all nodes below it.
fn below(file: &AssetFile, node: usize, place: DAffine3, left: &mut usize) -> Vec<(usize, DAffine3)> {
    let (mut meshes, mut seen, mut open) = (Vec::new(), BTreeSet::new(), vec![(node, place)]);
    while let Some((index, place)) = open.pop() {
        let Some(node) = file.root.nodes.get(index).filter(|_| *left > 0 && seen.insert(index)) else {
            continue;
        };
        *left -= 1;
        let mesh = node.mesh.map(|mesh| mesh.value()).filter(|mesh| *mesh < file.root.meshes.len());
        meshes.extend(mesh.map(|mesh| (mesh, place)));
        let below =
            children(node).filter_map(|child| Some((child, place * local(file.root.nodes.get(child)?))));
        open.extend(below);
    }
    meshes
}
