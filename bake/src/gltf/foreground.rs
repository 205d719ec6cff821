//! The ground around the start → a .glb that opens alone, and its place in a scene: further primitives of the terrain
//! mesh, so that a program that draws the terrain from `GSC_heightfield` replaces all of it.

use serde_json::{Value, json};

use super::ExportError;
use super::document::{ARRAY_BUFFER, Document, ELEMENT_ARRAY_BUFFER, FLOAT, Node, UNSIGNED_INT};
use super::glb::write_glb;
use super::materials::matte;
use super::vertices::{Primitive, Surface, add_vertices};
use crate::model::{Foreground, Material, Tiled};

/// Name of the material of all that grows on the ground around the start.
pub const GRASS_MATERIAL: &str = "grass blades";

/// Mesh 0: the ground and the stones on it with a material for each of `kinds` of ground, `TEXCOORD_1` on the maps of the whole
/// field. Mesh 1, if grass grows there: its blades; `white` is the albedo of a vertex colour of 1. The last accessor:
/// indices of the rest of the near mesh.
///
/// # Errors
/// When a list is inconsistent or not finite, or there are no triangles.
pub fn foreground_glb(foreground: &Foreground, kinds: &[&str], white: f32) -> Result<Vec<u8>, ExportError> {
    if foreground.ground.mesh.triangle_count() == 0 {
        return Err(ExportError::Empty("the foreground".into()));
    }
    let material = |kind| json!({ "name": kind, "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0.95 } });
    let mut document = Document { materials: kinds.iter().map(material).collect(), ..Document::default() };
    let mut list = tiled(&mut document, "the foreground", &foreground.ground)?;
    list.extend(tiled(&mut document, "stones", &foreground.stones)?);
    document.meshes.push(json!({ "name": "foreground", "primitives": list }));
    let node = document.node(Node { name: "foreground".into(), mesh: Some(0), ..Node::default() });
    document.scenes.push(json!({ "name": "foreground", "nodes": [node] }));
    if foreground.grass.triangle_count() > 0 {
        let surface = Surface { material: Some(document.materials.len()), normal_map: false };
        let blades = add_vertices(&mut document, "grass", &foreground.grass, &|_| surface)?;
        let blades: Vec<Value> = blades.into_iter().map(|primitive| primitive.json).collect();
        document.materials.push(blade_material(white));
        document.meshes.push(json!({ "name": "grass", "primitives": blades }));
        let node = document.node(Node { name: "grass".into(), mesh: Some(1), ..Node::default() });
        document.scenes[0]["nodes"].as_array_mut().expect("made above").push(node.into());
    }
    let rest = foreground.rest.as_flattened();
    let view = document.view(bytemuck::cast_slice(rest), Some(ELEMENT_ARRAY_BUFFER), None);
    document.accessor(view, 0, UNSIGNED_INT, rest.len(), "SCALAR");
    let json = document.json();
    Ok(write_glb(json, document.bin))
}

/// Primitives with the material of the kind of ground whose texture they have.
fn tiled(document: &mut Document, what: &str, tiled: &Tiled) -> Result<Vec<Value>, ExportError> {
    let Tiled { mesh, map_uvs } = tiled;
    if map_uvs.len() != mesh.positions.len() {
        return Err(ExportError::Inconsistent(what.into(), "its attribute lists differ in length"));
    }
    if mesh.triangle_count() == 0 {
        return Ok(Vec::new());
    }
    let surface_of = |material| match material {
        Material::Foreign(k) => Surface { material: Some(k as usize), normal_map: true },
        _ => Surface::default(),
    };
    let primitives = add_vertices(document, what, mesh, &surface_of)?;
    let view = document.view(bytemuck::cast_slice(map_uvs), Some(ARRAY_BUFFER), Some(8));
    let with_map = |primitive: Primitive| {
        let mut json = primitive.json;
        let uvs = document.accessor(view, primitive.first * 8, FLOAT, primitive.count, "VEC2");
        json["attributes"]["TEXCOORD_1"] = uvs.into();
        json
    };
    Ok(primitives.into_iter().map(with_map).collect())
}

/// Blades of grass, coloured by their vertices.
pub fn blade_material(white: f32) -> Value {
    matte(json!({ "name": GRASS_MATERIAL, "doubleSided": true, "pbrMetallicRoughness": {
        "baseColorFactor": [white, white, white, 1], "metallicFactor": 0, "roughnessFactor": 0.8 } }))
}

/// A kind of ground from near: its tiling colour and normals, and the light map as occlusion.
pub fn tiled_material(name: &str, tile: usize, normal: usize, light: usize) -> Value {
    matte(json!({ "name": format!("near {name}"),
        "pbrMetallicRoughness": { "baseColorTexture": { "index": tile }, "metallicFactor": 0, "roughnessFactor": 0.95 },
        "normalTexture": { "index": normal },
        "occlusionTexture": { "index": light, "texCoord": 1 } }))
}
