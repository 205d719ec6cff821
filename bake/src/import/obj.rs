//! .obj → primitives by material; .mtl materials as glTF writes them. Polygons become triangles.

use std::cell::RefCell;
use std::io::Cursor;
use std::path::Path;

use serde_json::json;

use super::gltf_file::mime_of;
use super::{ImportError, Imported, ImportedImage, Primitive, Raw, Repair, Resolve, color_byte, mtl};
use crate::model::Mesh;

/// Reads the text of an .obj file.
pub fn read(bytes: &[u8], resolve: &Resolve<'_>) -> Result<Raw, ImportError> {
    let malformed = |reason: String| ImportError::Malformed { format: "OBJ", reason };
    let options =
        tobj::LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, single_index: true };
    let missing = RefCell::new(Vec::new());
    let material_file = |path: &Path| {
        let name = path.to_string_lossy().into_owned();
        let found = resolve(&name).map(|bytes| mtl::read(&String::from_utf8_lossy(&bytes)));
        Ok(found.unwrap_or_else(|_| {
            missing.borrow_mut().push(Repair::MissingFile(name));
            Default::default()
        }))
    };
    // Text in other encodings only shows in names.
    let text = String::from_utf8_lossy(bytes);
    let loaded = tobj::load_obj_buf(&mut Cursor::new(text.as_bytes()), &options, material_file);
    let (models, materials) = loaded.map_err(|error| malformed(error.to_string()))?;
    let mut raw = Raw::default();
    for material in materials.unwrap_or_default() {
        let material = material_json(&material, resolve, &mut raw.rest);
        raw.rest.materials.push(material);
    }
    raw.rest.repairs.extend(missing.into_inner());
    for model in models {
        let found = primitive(model.mesh, &mut raw.rest);
        raw.primitives.push(found);
    }
    Ok(raw)
}

fn primitive(mesh: tobj::Mesh, rest: &mut Imported) -> Primitive {
    let known = mesh.material_id.filter(|&id| id < rest.materials.len());
    let material = known.unwrap_or_else(|| rest.default_material());
    let positions: Vec<[f32; 3]> = mesh.positions.as_chunks().0.to_vec();
    let fits = |rows: usize| rows == positions.len();
    let normals = Some(mesh.normals.as_chunks().0).filter(|rows| fits(rows.len()));
    let uvs = Some(mesh.texcoords.as_chunks::<2>().0).filter(|rows| fits(rows.len()));
    let colors = Some(mesh.vertex_color.as_chunks::<3>().0).filter(|rows| fits(rows.len()));
    let mesh_read = Mesh {
        normals: normals.unwrap_or_default().to_vec(),
        // OBJ counts v from below.
        uvs: uvs.unwrap_or_default().iter().map(|&[u, v]| [u, 1.0 - v]).collect(),
        colors: colors.unwrap_or_default().iter().map(|&[r, g, b]| [r, g, b, 1.0].map(color_byte)).collect(),
        positions,
        parts: Vec::new(),
    };
    Primitive { material, mesh: mesh_read, triangles: mesh.indices.as_chunks().0.to_vec() }
}

fn material_json(material: &tobj::Material, resolve: &Resolve<'_>, rest: &mut Imported) -> serde_json::Value {
    let [r, g, b] = material.diffuse.unwrap_or([1.0; 3]);
    let mut surface = json!({
        "baseColorFactor": [r, g, b, material.dissolve.unwrap_or(1.0)],
        "metallicFactor": 0.0,
        "roughnessFactor": 0.9,
    });
    if let Some(name) = &material.diffuse_texture {
        match resolve(name) {
            Ok(bytes) => {
                let mime_type = mime_of(name).to_owned();
                rest.images.push(ImportedImage { name: name.clone(), mime_type, bytes });
                rest.textures.push(json!({ "source": rest.images.len() - 1 }));
                surface["baseColorTexture"] = json!({ "index": rest.textures.len() - 1 });
            }
            Err(_) => rest.repairs.push(Repair::MissingFile(name.clone())),
        }
    }
    json!({ "name": material.name, "pbrMetallicRoughness": surface })
}
