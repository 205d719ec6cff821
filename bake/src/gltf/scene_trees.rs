//! Where trees stand → nodes that share meshes: two nodes an instance, since one may not shear.

use genescape_schema::scene::{
    FAR_TREES_NODE, GSC_INSTANCES, GSC_PROGRESSIVE_MESH, Instance, InstancesExtension, InstancesTemplate,
    ProgressiveLevel, ProgressiveMeshExtension, StartView, instance_count, svd,
};
use glam::Vec3;
use serde::Deserialize;
use serde_json::json;

use super::ExportError;
use super::document::{Document, Node, push};
use super::impostor::{self, IMPOSTOR};
use super::materials::{MaterialSet, Picture};
use super::scene_import::{FileMaterial, GlbImport};
use super::scene_parts::{Blob, SceneParts};
use super::tree::{CLUSTER_NORMALS, CLUSTERS, THROUGH_LEAVES, add_clusters, tree_materials};
use crate::model::Material;

/// Triangles that any viewer opens quickly.
pub const TRIANGLE_BUDGET: usize = 3_000_000;

/// One level of a template.
#[derive(Clone, Copy, Debug)]
struct Level {
    /// i of D_i.
    number: usize,
    mesh: usize,
    error_m: f32,
    triangles: usize,
}

/// Adds the templates' meshes, a `trees` node with all instances of the field below it, and one for those beyond, which are too
/// many for nodes of their own; gives both.
pub fn add_trees(
    document: &mut Document,
    parts: &SceneParts<'_>,
    view: &StartView,
) -> Result<[usize; 2], ExportError> {
    let mut files = Vec::new();
    for template in &parts.templates {
        files.push(GlbImport::open(document, template)?);
    }
    let has = |name: &str| files.iter().any(|file| file.material_names().any(|other| other == name));
    let mut set = tree_materials(&parts.tree_images, |slot| match slot {
        Material::Leaf => has("leaf"),
        Material::Blossom => has("blossom"),
        _ => true,
    });
    // What each template has of its own.
    let mut own = Vec::new();
    for file in &files {
        let mut picture = |name: &str| {
            let view = file.import_image(document, name)?;
            Ok::<_, ExportError>(view.map(|buffer_view| Picture::View { buffer_view }))
        };
        let (impostor, clusters) = (picture(IMPOSTOR)?, picture(CLUSTERS)?.zip(picture(CLUSTER_NORMALS)?));
        let cutoff = parts.tree_images.alpha_cutoff;
        own.push([
            (IMPOSTOR, impostor.map(|picture| impostor::add_material(&mut set, picture))),
            (CLUSTERS, clusters.map(|pictures| add_lit_clusters(&mut set, pictures.into(), cutoff))),
        ]);
    }
    let first_material = set.add_to(document);
    set.add_images_to(document);
    let (mut templates, mut levels) = (Vec::new(), Vec::new());
    for (index, (file, own)) in files.iter().zip(own).enumerate() {
        let material_of = |material: FileMaterial<'_>| {
            // All else is shared by the templates.
            let shared = || set.materials.iter().position(|m| m["name"] == material.name);
            let found = own.iter().find(|own| own.0 == material.name).map_or_else(shared, |own| own.1);
            found.map(|i| first_material + i)
        };
        let mesh = file.import_meshes(document, &material_of)?;
        levels.push(levels_of(document, mesh));
        templates.push(InstancesTemplate { name: format!("tree-{index}"), mesh });
    }
    let instances = parts.trees;
    let chosen = choose_levels(instances, &levels, view.position_m)?;
    let mut children = Vec::with_capacity(chosen.len());
    for (i, (instance, level)) in instances.iter().zip(chosen).enumerate() {
        children.push(add_instance(document, format!("tree.{i:04}"), instance, level)?);
    }
    document.extensions_used.insert(GSC_INSTANCES.into());
    let mut add_node = |name: &str, records: &Blob, children: Vec<usize>| {
        let extension = InstancesExtension {
            buffer_view: add_buffer(document, records),
            count: instance_count(records.byte_length),
            templates: templates.clone(),
        };
        document.node(Node {
            name: name.into(),
            children,
            extensions: Some(json!({ GSC_INSTANCES: extension })),
            ..Node::default()
        })
    };
    Ok([
        add_node("trees", &parts.instances, children),
        add_node(FAR_TREES_NODE, &parts.far_trees, Vec::new()),
    ])
}

/// Clusters that let light through, as single leaves do.
fn add_lit_clusters<'a>(set: &mut MaterialSet<'a>, pictures: [Picture<'a>; 2], cutoff: f32) -> usize {
    let number = add_clusters(set, pictures, cutoff);
    set.add_transmission(number, THROUGH_LEAVES);
    number
}

/// A view of a whole file as a buffer.
fn add_buffer(document: &mut Document, blob: &Blob) -> usize {
    let Blob { uri, byte_length } = blob;
    let buffer = push(&mut document.buffers, json!({ "uri": uri, "byteLength": byte_length }));
    push(&mut document.buffer_views, json!({ "buffer": buffer, "byteOffset": 0, "byteLength": byte_length }))
}

/// The levels of an imported mesh; a mesh without our extension is its own only level.
fn levels_of(document: &Document, mesh: usize) -> Vec<Level> {
    let extension = document.meshes[mesh].pointer(&format!("/extensions/{GSC_PROGRESSIVE_MESH}"));
    let typed = extension.and_then(|e| ProgressiveMeshExtension::deserialize(e).ok());
    match typed {
        Some(typed) => {
            let level = |(i, l): (usize, &ProgressiveLevel)| Level {
                number: i,
                mesh: l.mesh,
                error_m: l.error_m,
                triangles: l.triangles,
            };
            typed.levels.iter().enumerate().map(level).collect()
        }
        None => vec![Level { number: 0, mesh, error_m: 0.0, triangles: 0 }],
    }
}

/// For each instance the coarsest level whose error looks smaller than one angle, the same for all: the smallest
/// angle (of a fixed list) with which all trees together keep to the budget.
fn choose_levels(
    instances: &[Instance],
    templates: &[Vec<Level>],
    eye_m: Vec3,
) -> Result<Vec<Level>, ExportError> {
    let mut seen = Vec::with_capacity(instances.len());
    for (i, instance) in instances.iter().enumerate() {
        let levels = templates.get(instance.template as usize).ok_or_else(|| {
            ExportError::Template(format!("tree.{i:04}"), instance.template, templates.len())
        })?;
        seen.push((levels, distance_in_tree_sizes(instance, eye_m)));
    }
    let mut angle_rad = 0.0005;
    loop {
        let choose = |(levels, distance): &(&Vec<Level>, f32)| {
            let enough = levels.iter().rfind(|level| level.error_m <= angle_rad * distance);
            *enough.unwrap_or(&levels[0])
        };
        let chosen: Vec<Level> = seen.iter().map(choose).collect();
        let triangles: usize = chosen.iter().map(|level| level.triangles).sum();
        if triangles <= TRIANGLE_BUDGET || angle_rad > 1.0 {
            return Ok(chosen);
        }
        angle_rad *= 1.1;
    }
}

/// Distance from the eye in metres of the template's space: a tree twice as large is seen as if half as far.
fn distance_in_tree_sizes(instance: &Instance, eye_m: Vec3) -> f32 {
    let a = &instance.world_from_tree;
    let foot = Vec3::new(a[0][3], a[1][3], a[2][3]);
    let column = |c: usize| Vec3::new(a[0][c], a[1][c], a[2][c]).length();
    let size = column(0).max(column(1)).max(column(2)).max(1e-6);
    foot.distance(eye_m) / size
}

/// Parent T·R(U)·S(Σ), child R(Vᵀ) with the mesh; gives the parent.
fn add_instance(
    document: &mut Document,
    name: String,
    instance: &Instance,
    level: Level,
) -> Result<usize, ExportError> {
    let a = &instance.world_from_tree;
    let linear = instance.linear();
    let Some(split) = svd::decompose(linear) else {
        return Err(ExportError::Transform(name, svd::determinant(linear)));
    };
    let child = document.node(Node {
        name: format!("{name}.mesh"),
        mesh: Some(level.mesh),
        rotation: Some(split.right.map(|x| x as f32)),
        ..Node::default()
    });
    Ok(document.node(Node {
        name,
        translation: Some([a[0][3], a[1][3], a[2][3]]),
        rotation: Some(split.left.map(|x| x as f32)),
        scale: Some(split.scale.map(|x| x as f32)),
        children: vec![child],
        extras: Some(json!({ "template": instance.template, "level": level.number })),
        ..Node::default()
    }))
}
