//! Trees as pairs of nodes → one node for each mesh, by EXT_mesh_gpu_instancing.
//!
//! An instance of that extension has a translation, a rotation and a scale along the mesh's own axes, so it cannot shear
//! or stretch along other axes as our trees do. The nearest that it can do is kept, and how far off that is is measured.

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use genescape_schema::scene::{Instance, svd};
use glam::{DMat3, DQuat, DVec3};
use serde_json::{Value, json};

use super::source::{self, far_trees_node, list, number, text, trees_node};

const EXTENSION: &str = "EXT_mesh_gpu_instancing";
/// The URI by which the scene names [`Instanced::bytes`].
pub const BUFFER: &str = "instances";
/// Floats of an instance: translation, rotation, scale.
const FLOATS: usize = 3 + 4 + 3;
/// Steps of the fit; the tenth moves nothing by a micrometre.
const STEPS: usize = 10;

/// A buffer of instances.
#[derive(Clone, Debug, Default)]
pub struct Instanced {
    pub bytes: Vec<u8>,
    /// The greatest distance in metres by which a corner of a tree's box is off.
    pub lost_m: f64,
}

/// Replaces the nodes of all trees, and gives those beyond the field nodes. `sizes_m` says for each template how far it reaches
/// along each axis.
///
/// # Errors
/// A scene whose nodes are not its instances, in their order.
pub fn instance(
    root: &mut Value,
    [trees, far_trees]: [&[Instance]; 2],
    sizes_m: &[[f64; 3]],
) -> Result<Instanced> {
    let mut groups = Groups {
        sizes_m,
        buffer: push(root, "buffers", json!({ "uri": BUFFER })),
        made: Instanced::default(),
    };
    let node = trees_node(root)?;
    let pairs = list(&root["nodes"][node], "children").iter().map(|pair| {
        let pair = &root["nodes"][pair.as_u64().unwrap_or(0) as usize];
        number(&root["nodes"][first(pair)], "mesh")
    });
    let meshes: Vec<usize> = pairs.collect();
    groups.add(root, node, trees.iter().zip(meshes))?;
    if let Some(node) = far_trees_node(root).filter(|_| !far_trees.is_empty()) {
        // Nobody comes near them.
        let templates = source::instances(root)?.templates;
        let coarsest = templates.iter().map(|template| {
            Ok(source::levels(root, template.mesh)?.levels.last().map_or(template.mesh, |level| level.mesh))
        });
        let coarsest = coarsest.collect::<Result<Vec<usize>>>()?;
        let mesh = |tree: &Instance| coarsest.get(tree.template as usize).copied().unwrap_or_default();
        groups.add(root, node, far_trees.iter().map(|tree| (tree, mesh(tree))))?;
    }
    let Groups { buffer, made, .. } = groups;
    root["buffers"][buffer]["byteLength"] = made.bytes.len().into();
    if let Some(used) = root["extensionsUsed"].as_array_mut() {
        used.insert(0, EXTENSION.into());
    }
    Ok(made)
}

/// Nodes of instances, while they are made.
struct Groups<'a> {
    sizes_m: &'a [[f64; 3]],
    /// The buffer that the bytes are to be.
    buffer: usize,
    made: Instanced,
}

impl Groups<'_> {
    /// Puts one node for each mesh below a node, in the place of its children.
    fn add<'t>(
        &mut self,
        root: &mut Value,
        parent: usize,
        trees: impl Iterator<Item = (&'t Instance, usize)>,
    ) -> Result<()> {
        let mut groups = BTreeMap::<usize, Vec<[f32; FLOATS]>>::new();
        for (instance, mesh) in trees {
            let size_m =
                self.sizes_m.get(instance.template as usize).context("an instance of an unknown tree")?;
            let (placed, off_m) = fit(instance, DVec3::from_array(*size_m)).context("a tree is flattened")?;
            self.made.lost_m = self.made.lost_m.max(off_m);
            groups.entry(mesh).or_default().push(placed);
        }
        let mut children = Vec::new();
        for (mesh, group) in &groups {
            let still = without_morphs(&root["meshes"][*mesh]);
            let name = text(&still, "name").to_owned();
            let mesh = push(root, "meshes", still);
            let attributes = add_attributes(root, self.buffer, group, &mut self.made.bytes);
            let node = json!({ "name": format!("{name} ×{}", group.len()), "mesh": mesh,
                "extensions": { EXTENSION: { "attributes": attributes } } });
            children.push(push(root, "nodes", node));
        }
        root["nodes"][parent]["children"] = json!(children);
        Ok(())
    }
}

/// A node's only child.
fn first(node: &Value) -> usize {
    node["children"][0].as_u64().unwrap_or(0) as usize
}

/// The same vertices without morph targets: instances have no weights, and three.js (r187) fails on such meshes.
fn without_morphs(mesh: &Value) -> Value {
    let mut primitives = mesh["primitives"].clone();
    for primitive in primitives.as_array_mut().into_iter().flatten() {
        primitive.as_object_mut().map(|primitive| primitive.shift_remove("targets"));
    }
    json!({ "name": mesh["name"], "primitives": primitives })
}

/// The accessors of a node's instances.
fn add_attributes(root: &mut Value, buffer: usize, group: &[[f32; FLOATS]], bytes: &mut Vec<u8>) -> Value {
    let mut attributes = json!({});
    for (name, kind, part) in
        [("TRANSLATION", "VEC3", 0..3), ("ROTATION", "VEC4", 3..7), ("SCALE", "VEC3", 7..10)]
    {
        let start = bytes.len();
        for placed in group {
            bytes.extend_from_slice(bytemuck::cast_slice(&placed[part.clone()]));
        }
        let view = json!({ "buffer": buffer, "byteOffset": start, "byteLength": bytes.len() - start });
        let view = push(root, "bufferViews", view);
        let accessor =
            json!({ "bufferView": view, "componentType": 5126, "count": group.len(), "type": kind });
        attributes[name] = push(root, "accessors", accessor).into();
    }
    attributes
}

fn push(root: &mut Value, list: &str, item: Value) -> usize {
    let items = root[list].as_array_mut().map(|items| {
        items.push(item);
        items.len() - 1
    });
    items.unwrap_or(0)
}

/// Translation, rotation and scale nearest to an affine transform for a tree that reaches so far along each axis, and by
/// how many metres a corner of its box is off. The foot stays where it is.
fn fit(instance: &Instance, size_m: DVec3) -> Option<([f32; FLOATS], f64)> {
    let exact = DMat3::from_cols_array_2d(&instance.linear());
    // Rotation and scale by turns, each the best for the other: minimal Σ |size·(exact − rotation·scale)|².
    let mut scale = DVec3::ONE;
    let mut rotation = DQuat::IDENTITY;
    for _ in 0..STEPS {
        let weighed = exact * DMat3::from_diagonal(scale * size_m * size_m);
        let split = svd::decompose(weighed.to_cols_array_2d())?;
        rotation = DQuat::from_array(split.left) * DQuat::from_array(split.right);
        let axes = DMat3::from_quat(rotation);
        scale = DVec3::new(
            exact.x_axis.dot(axes.x_axis),
            exact.y_axis.dot(axes.y_axis),
            exact.z_axis.dot(axes.z_axis),
        );
    }
    let off = exact - DMat3::from_quat(rotation) * DMat3::from_diagonal(scale);
    let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]];
    let off_m = corners
        .map(|[x, z]| (off * (size_m * DVec3::new(x, 1.0, z))).length())
        .into_iter()
        .fold(0.0, f64::max);
    let [tx, ty, tz] = [0, 1, 2].map(|row| instance.world_from_tree[row][3]);
    let ([x, y, z, w], s) = (rotation.normalize().to_array().map(|part| part as f32), scale.as_vec3());
    Some(([tx, ty, tz, x, y, z, w, s.x, s.y, s.z], off_m))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn stand(linear: DMat3) -> Instance {
        let rows = [0, 1, 2].map(|row| linear.row(row).as_vec3().extend(row as f32).to_array());
        Instance { world_from_tree: rows, template: 0, trunk_cylinder_m: [0.0; 3] }
    }

    proptest! {
        #[test]
        fn what_an_instance_can_be_it_is(turn: [i8; 4], scale in prop::array::uniform3(0.5f64..2.0)) {
            let turn = DQuat::from_array(turn.map(f64::from));
            prop_assume!(turn.length() > 1.0);
            let exact = DMat3::from_quat(turn.normalize()) * DMat3::from_diagonal(DVec3::from_array(scale));
            let (placed, off_m) = fit(&stand(exact), DVec3::new(4.0, 12.0, 4.0)).expect("a proper map");
            prop_assert!(off_m < 0.05, "{off_m} m off");
            prop_assert_eq!(placed[..3].to_vec(), vec![0.0, 1.0, 2.0]);
        }

        #[test]
        fn no_small_turn_or_stretch_is_nearer(lean in -0.07f64..0.07, turn in 0.0f64..3.0, stretch in 0.9f64..1.1) {
            let size_m = DVec3::new(4.0, 12.0, 4.0);
            let shear = DMat3::from_cols(DVec3::X, DVec3::new(lean, 1.0, 0.5 * lean), DVec3::Z);
            let exact = shear * DMat3::from_diagonal(DVec3::new(1.0, 1.05, stretch)) * DMat3::from_rotation_y(turn);
            let (placed, _) = fit(&stand(exact), size_m).expect("a proper map");
            let cost = |rotation: DQuat, scale: DVec3| {
                let off = exact - DMat3::from_quat(rotation) * DMat3::from_diagonal(scale);
                (off * DMat3::from_diagonal(size_m)).to_cols_array().iter().map(|x| x * x).sum::<f64>()
            };
            let [.., x, y, z, w, a, b, c] = placed.map(f64::from);
            let (rotation, scale) = (DQuat::from_xyzw(x, y, z, w), DVec3::new(a, b, c));
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                for step in [-0.01, 0.01] {
                    let turned = DQuat::from_axis_angle(axis, step) * rotation;
                    prop_assert!(cost(turned, scale) > cost(rotation, scale));
                    prop_assert!(cost(rotation, scale + axis * step) > cost(rotation, scale));
                }
            }
        }
    }
}
