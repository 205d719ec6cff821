//! .obj → primitives by material; .mtl materials as glTF writes them. Polygons become triangles.

use std::cell::RefCell;
use std::io::{BufReader, Cursor};
use std::path::Path;

use serde_json::json;

use super::gltf_file::mime_of;
use super::{ImportError, Imported, ImportedImage, ImportedMaterial, Primitive, Raw, Repair, Resolve};

/// Reads the text of an .obj file.
pub fn read(bytes: &[u8], resolve: &Resolve<'_>) -> Result<Raw, ImportError> {
    let malformed = |reason: String| ImportError::Malformed { format: "OBJ", reason };
    let options =
        tobj::LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, single_index: true };
    let missing = RefCell::new(Vec::new());
    let material_file = |path: &Path| {
        let name = path.to_string_lossy().into_owned();
        let found = resolve(&name).map_err(|_| tobj::LoadError::OpenFileFailed);
        let loaded = found.and_then(|bytes| tobj::load_mtl_buf(&mut BufReader::new(Cursor::new(bytes))));
        loaded.or_else(|_| {
            missing.borrow_mut().push(Repair::MissingFile(name));
            Ok((Vec::new(), Default::default()))
        })
    };
    // Text in other encodings only shows in names.
    let text = String::from_utf8_lossy(bytes);
    let loaded = tobj::load_obj_buf(&mut Cursor::new(text.as_bytes()), &options, material_file);
    let (models, materials) = loaded.map_err(|error| malformed(error.to_string()))?;
    let mut raw = Raw::default();
    for material in materials.unwrap_or_default() {
        let json = material_json(&material, resolve, &mut raw.rest);
        raw.rest.materials.push(ImportedMaterial { json });
    }
    raw.rest.repairs.extend(missing.into_inner());
    for model in models {
        let found = primitive(model.mesh, &mut raw.rest);
        raw.primitives.push(found);
    }
    Ok(raw)
}

fn primitive(mesh: tobj::Mesh, rest: &mut Imported) -> Primitive {
    let positions: Vec<[f32; 3]> = mesh.positions.as_chunks().0.to_vec();
    let count = positions.len();
    let (normals, uvs) = (mesh.normals.as_chunks::<3>().0, mesh.texcoords.as_chunks::<2>().0);
    let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    let colors = mesh.vertex_color.as_chunks::<3>().0;
    let material = mesh.material_id.filter(|&id| id < rest.materials.len()).unwrap_or_else(|| {
        let json = json!({ "name": "default" });
        let place = rest.materials.iter().position(|material| material.json == json);
        place.unwrap_or_else(|| {
            rest.materials.push(ImportedMaterial { json });
            rest.materials.len() - 1
        })
    });
    Primitive {
        material,
        normals: (normals.len() == count && count > 0).then(|| normals.to_vec()),
        // OBJ counts v from below.
        uvs: (uvs.len() == count && count > 0).then(|| uvs.iter().map(|&[u, v]| [u, 1.0 - v]).collect()),
        colors: (colors.len() == count && count > 0)
            .then(|| colors.iter().map(|&[r, g, b]| [byte(r), byte(g), byte(b), 255]).collect()),
        triangles: mesh.indices.as_chunks().0.to_vec(),
        positions,
    }
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
