//! The nodes of the scene → which meshes stand where, suns and cameras.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use genescape_schema::scene::StartView;
use glam::{Affine3A, DAffine3, DMat4, DQuat, DVec3, Vec3};
use gltf::json::Index;
use gltf::json::accessor::Accessor;
use gltf::json::scene::Node;
use serde::Deserialize;
use serde_json::Value;

use super::file::AssetFile;
use super::levels::{self, LevelPlan};
use super::notes::{Notes, quoted};
use super::places::{children, local, rotation};
use crate::load::Result;
use crate::scene::DirectionalLight;

/// Copies of all shapes together.
const MAX_COPIES: usize = 1 << 20;
const LIGHTS: &str = "KHR_lights_punctual";
const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// What the scene is made of.
#[derive(Debug, Default)]
pub(super) struct Arrangement {
    pub shapes: Vec<ShapePlan>,
    /// Numbers of shapes by what makes them the same.
    known: HashMap<Vec<u64>, usize>,
    /// Where nodes are, by their numbers.
    pub worlds: BTreeMap<usize, DAffine3>,
    pub lights: Vec<DirectionalLight>,
    pub camera: Option<StartView>,
}

/// Copies of the same levels of the same meshes.
#[derive(Debug)]
pub(super) struct ShapePlan {
    pub name: String,
    pub levels: Vec<LevelPlan>,
    /// The standard or extension that the levels come from, if there are several.
    pub source: Option<&'static str>,
    /// The skeleton whose pose gives it its places.
    pub skin: Option<usize>,
    /// All copies are mirrored, or none.
    pub mirrored: bool,
    pub copies: Vec<DAffine3>,
}

/// Reads the default scene, or the first; of a file without scenes, everything.
pub(super) fn arrange(file: &AssetFile, notes: &mut Notes) -> Result<Arrangement> {
    let root = &file.root;
    let scene = root.scene.map_or(0, |scene| scene.value());
    let mut open: Vec<(usize, DAffine3)> = match root.scenes.get(scene).or(root.scenes.first()) {
        Some(scene) => scene.nodes.iter().map(|node| (node.value(), DAffine3::IDENTITY)).collect(),
        None => roots(file).map(|node| (node, DAffine3::IDENTITY)).collect(),
    };
    open.reverse();
    if root.scenes.len() > 1 {
        notes.add(other_scenes(file, scene));
    }
    let (stand_ins, mut seen) = (levels::stand_ins(file), BTreeSet::new());
    let (mut arrangement, mut copies, mut left) = (Arrangement::default(), 0, levels::MAX_NODES);
    while let Some((index, world_from_parent)) = open.pop() {
        let Some(node) = root.nodes.get(index).filter(|_| !stand_ins.contains(&index)) else { continue };
        if !seen.insert(index) {
            notes.add("A node that stands below itself, or twice, is drawn once");
            continue;
        }
        let world_from_node = world_from_parent * local(node);
        arrangement.worlds.insert(index, world_from_node);
        arrangement.light(file, node, &world_from_node, notes);
        arrangement.look(node, &world_from_node);
        let (plan, is_whole) = plan(file, index, node, &mut left, notes);
        if let Some(plan) = plan {
            // Joints alone say where a mesh with a skeleton is.
            let origin = if plan.skin.is_some() { DAffine3::IDENTITY } else { world_from_node };
            let places = instances(file, node, notes);
            copies += places.len();
            if copies > MAX_COPIES {
                return Err(file.wrong(format!("more than {MAX_COPIES} meshes stand in its scene")));
            }
            let mut numbers = [None; 2];
            for place in places {
                arrangement.add(&plan, origin * place, &mut numbers, notes);
            }
        }
        if !is_whole {
            let first = open.len();
            open.extend(children(node).map(|child| (child, world_from_node)));
            open[first..].reverse();
        }
    }
    Ok(arrangement)
}

/// A sentence on which of several scenes is drawn.
fn other_scenes(file: &AssetFile, scene: usize) -> String {
    let scenes = &file.root.scenes;
    let name = scenes.get(scene).or(scenes.first()).and_then(|scene| scene.name.as_deref());
    let shown = name.map_or("the one".to_owned(), quoted);
    format!("Of its {} scenes only {shown}, with which it opens, is drawn", scenes.len())
}

/// Nodes that are no other's child.
fn roots(file: &AssetFile) -> impl Iterator<Item = usize> + use<> {
    let below: BTreeSet<usize> = file.root.nodes.iter().flat_map(children).collect();
    (0..file.root.nodes.len()).filter(move |node| !below.contains(node))
}

/// What stands at a node, and whether that includes what is below it.
fn plan(
    file: &AssetFile,
    index: usize,
    node: &Node,
    left: &mut usize,
    notes: &mut Notes,
) -> (Option<ShapePlan>, bool) {
    let mesh = node.mesh.and_then(|mesh| file.root.meshes.get(mesh.value()));
    let ours = mesh.and_then(|mesh| levels::progressive(file, mesh, notes));
    let is_ours = ours.is_some();
    let theirs = if is_ours { None } else { levels::by_node(file, index, left) };
    let is_whole = theirs.is_some();
    let source = if is_ours { genescape_schema::scene::GSC_PROGRESSIVE_MESH } else { levels::MSFT_LOD };
    let single = || {
        let mesh = node.mesh.filter(|_| mesh.is_some())?.value();
        Some(vec![LevelPlan::single(mesh)])
    };
    let Some(levels) = ours.or(theirs).or_else(single) else { return (None, false) };
    let name = node.name.clone().or_else(|| mesh.and_then(|mesh| mesh.name.clone())).unwrap_or_default();
    let source = (levels.len() > 1).then_some(source);
    let skin = node.skin.map(|skin| skin.value()).filter(|skin| *skin < file.root.skins.len());
    (Some(ShapePlan { name, levels, source, skin, mirrored: false, copies: Vec::new() }), is_whole)
}

/// The places of a node's copies, relative to it: one, but for `EXT_mesh_gpu_instancing`.
fn instances(file: &AssetFile, node: &Node, notes: &mut Notes) -> Vec<DAffine3> {
    let extension = node.extensions.as_ref().and_then(|extensions| extensions.others.get(INSTANCING));
    let Some(attributes) = extension.and_then(|value| value.get("attributes")) else {
        return vec![DAffine3::IDENTITY];
    };
    let index = |name: &str| {
        let index = attributes.get(name)?.as_u64()?;
        u32::try_from(index).ok().map(Index::<Accessor>::new)
    };
    let shifts = index("TRANSLATION").and_then(|index| file.rows::<3>(index));
    let turns = index("ROTATION").and_then(|index| file.rows::<4>(index));
    let scales = index("SCALE").and_then(|index| file.rows::<3>(index));
    let lengths =
        [shifts.as_ref().map(Vec::len), turns.as_ref().map(Vec::len), scales.as_ref().map(Vec::len)];
    let Some(count) = lengths.into_iter().flatten().min() else {
        notes.add("Copies by EXT_mesh_gpu_instancing cannot be read, and are drawn once");
        return vec![DAffine3::IDENTITY];
    };
    let place = |k: usize| {
        let vector = |all: &Option<Vec<[f32; 3]>>, usual: f32| {
            Vec3::from(all.as_ref().map_or([usual; 3], |all| all[k])).as_dvec3()
        };
        let turn = turns.as_ref().map_or(DQuat::IDENTITY, |all| rotation(all[k]));
        DAffine3::from_scale_rotation_translation(vector(&scales, 1.0), turn, vector(&shifts, 0.0))
    };
    // One more tells that there are too many.
    (0..count.min(MAX_COPIES + 1)).map(place).collect()
}

impl Arrangement {
    /// What each joint of a skeleton does to a mesh as it was modelled, in the pose that the file's nodes have.
    pub fn pose(&self, file: &AssetFile, skin: usize) -> Vec<Affine3A> {
        let skin = &file.root.skins[skin];
        let inverse = skin.inverse_bind_matrices.and_then(|index| file.rows::<16>(index)).unwrap_or_default();
        let joint = |(number, joint): (usize, &Index<Node>)| {
            let bind = inverse
                .get(number)
                .map_or(DMat4::IDENTITY, |numbers| DMat4::from_cols_array(&numbers.map(f64::from)));
            let world = self.worlds.get(&joint.value()).copied().unwrap_or_default();
            (world * DAffine3::from_mat4(bind)).as_affine3a()
        };
        skin.joints.iter().enumerate().map(joint).collect()
    }

    /// Another copy of a shape. `numbers`: those of the plan's shapes, plain and mirrored, if they are known.
    fn add(
        &mut self,
        plan: &ShapePlan,
        place: DAffine3,
        numbers: &mut [Option<usize>; 2],
        notes: &mut Notes,
    ) {
        if !place.is_finite() {
            return notes.add("A copy whose place is no number is left out");
        }
        let mirrored = place.matrix3.determinant() < 0.0;
        let number = numbers[usize::from(mirrored)].get_or_insert_with(|| self.number(plan, mirrored));
        self.shapes[*number].copies.push(place);
    }

    /// The shape of a plan, made if there is none like it.
    fn number(&mut self, plan: &ShapePlan, mirrored: bool) -> usize {
        let skin = plan.skin.map_or(0, |skin| skin as u64 + 1);
        let levels = plan.levels.iter().flat_map(LevelPlan::key);
        let key: Vec<u64> = [u64::from(mirrored), skin].into_iter().chain(levels).collect();
        *self.known.entry(key).or_insert_with(|| {
            let (name, levels) = (plan.name.clone(), plan.levels.clone());
            let (source, skin) = (plan.source, plan.skin);
            self.shapes.push(ShapePlan { name, levels, source, skin, mirrored, copies: Vec::new() });
            self.shapes.len() - 1
        })
    }

    /// The first camera is the one to look through.
    fn look(&mut self, node: &Node, world_from_node: &DAffine3) {
        let direction = world_from_node.transform_vector3(DVec3::NEG_Z).normalize_or_zero().as_vec3();
        if node.camera.is_some() && self.camera.is_none() && direction != Vec3::ZERO {
            self.camera = Some(StartView { position_m: world_from_node.translation.as_vec3(), direction });
        }
    }

    fn light(&mut self, file: &AssetFile, node: &Node, world_from_node: &DAffine3, notes: &mut Notes) {
        #[derive(Deserialize)]
        struct Light {
            #[serde(rename = "type")]
            kind: String,
            color: Option<[f32; 3]>,
            intensity: Option<f32>,
        }
        let number = |node: &Node| node.extensions.as_ref()?.others.get(LIGHTS)?.get("light")?.as_u64();
        let Some(number) = number(node) else { return };
        let all = file.root.extensions.as_ref().and_then(|extensions| extensions.others.get(LIGHTS));
        let light: Option<&Value> = all.and_then(|all| all.get("lights")?.get(number as usize));
        let Some(light) = light.and_then(|light| Light::deserialize(light).ok()) else { return };
        if light.kind != "directional" {
            return notes.add("Lamps (point and spot lights) are not drawn");
        }
        let direction = world_from_node.transform_vector3(DVec3::Z).normalize_or_zero().as_vec3();
        let irradiance = Vec3::from(light.color.unwrap_or([1.0; 3])) * light.intensity.unwrap_or(1.0);
        if direction != Vec3::ZERO && irradiance.is_finite() && irradiance.max_element() > 0.0 {
            self.lights.push(DirectionalLight { direction, irradiance: irradiance.max(Vec3::ZERO) });
        }
    }
}
