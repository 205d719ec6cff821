//! The terrain mesh → a .glb that opens alone, whose buffer scenes use by byte offset; and the materials that a
//! scene gives it.

use genescape_schema::scene::GROUND_WEIGHTS;
use serde_json::{Value, json};

use super::ExportError;
use super::document::{ARRAY_BUFFER, Document, Node, UNSIGNED_BYTE};
use super::glb::write_glb;
use super::materials::matte;
use super::vertices::{Surface, add_vertices};
use crate::model::{Mesh, TerrainMesh};

/// Names of the meshes and materials of [`terrain_glb`], in order.
pub const TERRAIN_MESHES: [&str; 3] = ["terrain", "apron", "water"];

/// The near mesh, the apron and the water (if any) with plain materials.
///
/// # Errors
/// When the near mesh has no triangles, or a list is inconsistent or not finite.
pub fn terrain_glb(terrain: &TerrainMesh) -> Result<Vec<u8>, ExportError> {
    let mut document = Document::default();
    let meshes: [&Mesh; 3] = [&terrain.near, &terrain.apron, &terrain.water];
    if terrain.near.triangle_count() == 0 {
        return Err(ExportError::Empty("the terrain".into()));
    }
    let mut roots = Vec::new();
    for (name, mesh) in TERRAIN_MESHES.into_iter().zip(meshes) {
        if mesh.triangle_count() == 0 {
            continue;
        }
        let material = document.materials.len();
        document.materials.push(plain_material(name));
        // Only the near mesh has textures.
        let near = name == TERRAIN_MESHES[0];
        let bare = Mesh { uvs: Vec::new(), ..mesh.clone() };
        let surface = Surface { material: Some(material), normal_map: near };
        let primitives = add_vertices(&mut document, name, if near { mesh } else { &bare }, &|_| surface)?;
        let mut primitives: Vec<Value> = primitives.into_iter().map(|p| p.json).collect();
        if name == TERRAIN_MESHES[1] {
            primitives.iter_mut().for_each(|apron| add_weights(&mut document, apron, &terrain.apron_weights));
        }
        let mut object = json!({ "name": name, "primitives": primitives });
        if near {
            object["extras"] = json!({ "error_m": terrain.error_m });
        }
        document.meshes.push(object);
        let mesh = Some(document.meshes.len() - 1);
        roots.push(document.node(Node { name: name.into(), mesh, ..Node::default() }));
    }
    document.scenes.push(json!({ "name": "terrain", "nodes": roots }));
    let json = document.json();
    Ok(write_glb(json, document.bin))
}

/// Blend weights of the kinds of ground as an attribute of a mesh's vertices, of all of them, if there are any.
fn add_weights(document: &mut Document, primitive: &mut Value, weights: &[[u8; 4]]) {
    if !weights.is_empty() {
        let view = document.view(weights.as_flattened(), Some(ARRAY_BUFFER), None);
        let all = document.accessor(view, 0, UNSIGNED_BYTE, weights.len(), "VEC4");
        document.accessors[all]["normalized"] = true.into();
        primitive["attributes"][GROUND_WEIGHTS] = all.into();
    }
}

/// A material without textures.
fn plain_material(name: &str) -> Value {
    match name {
        "water" => water_material(),
        "apron" => apron_material(),
        _ => matte(json!({ "name": name, "pbrMetallicRoughness": {
            "baseColorFactor": [0.12, 0.14, 0.06, 1], "metallicFactor": 0, "roughnessFactor": 0.95 } })),
    }
}

/// The land beyond the field, coloured by its vertices.
pub fn apron_material() -> Value {
    matte(json!({ "name": "apron", "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 1 } }))
}

/// Deep lake water. Opaque: a scene without volumes shows the bed under transparent water as under glass.
pub fn water_material() -> Value {
    json!({ "name": "water", "pbrMetallicRoughness": {
        "baseColorFactor": [0.008, 0.03, 0.035, 1], "metallicFactor": 0, "roughnessFactor": 0.08 } })
}

/// The land with its colour over the whole field, its light map as occlusion, and a tiling normal map for detail.
pub fn ground_material(color: usize, light: usize, normal: Option<(usize, f32)>) -> Value {
    let mut material = matte(json!({ "name": "ground",
        "pbrMetallicRoughness": { "baseColorTexture": { "index": color },
            "metallicFactor": 0, "roughnessFactor": 0.95 },
        "occlusionTexture": { "index": light, "strength": 1 } }));
    if let Some((texture, repeats)) = normal {
        material["normalTexture"] = json!({ "index": texture, "scale": 0.8,
            "extensions": { "KHR_texture_transform": { "scale": [repeats, repeats] } } });
    }
    material
}
