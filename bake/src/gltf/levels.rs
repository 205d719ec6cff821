//! A levelled mesh → one self-contained .glb: scene 0 is D_0, with the others as its MSFT_lod, scene 1 every
//! distinguished mesh side by side, each D_i with a core morph target that is its geomorph to D_{i+1}, and everything
//! in `GSC_progressive_mesh` besides. Of a tree, pictures from four sides come last.

use genescape_schema::scene::{
    GSC_PROGRESSIVE_MESH, ProgressiveLevel, ProgressiveMeshExtension, error_weight,
};
use serde_json::json;

use super::ExportError;
use super::document::{ARRAY_BUFFER, Document, FLOAT};
use super::glb::write_glb;
use super::impostor::Cards;
use super::level_scenes::{Rung, add_scenes};
use super::materials::MaterialSet;
use super::vertices::{Primitive, add_vertices, set_bounds};
use crate::model::{Level, LevelledMesh, Material};

/// One .glb with all levels of `mesh`, named after `name`. `cards` take the place of its last levels.
///
/// Primitives are the parts that have triangles, in their order. Where the parts' vertices are disjoint runs of the
/// vertex lists, as they are in everything that the bake makes, each primitive has accessors of its own run.
///
/// # Errors
/// When D_0 has no triangles, or any list is inconsistent or not finite.
pub fn levelled_glb(
    name: &str,
    mesh: &LevelledMesh,
    materials: &MaterialSet<'_>,
    cards: Option<&Cards<'_>>,
) -> Result<Vec<u8>, ExportError> {
    let mut document = Document::default();
    let levels: Vec<_> = mesh.levels.iter().take_while(|level| level.mesh.triangle_count() > 0).collect();
    if levels.is_empty() {
        return Err(ExportError::Empty(name.into()));
    }
    materials.add_to(&mut document);
    let surface_of = |material| materials.surface_of(material);

    let mut records = Vec::new();
    for (i, level) in levels.iter().enumerate() {
        let what = format!("{name}.D{i}");
        let primitives = add_vertices(&mut document, &what, &level.mesh, &surface_of)?;
        let next = (i + 1 < levels.len()).then_some(level.morph.as_ref()).flatten();
        let mut json = json!({ "name": what, "primitives": [],
            "extras": { "level": i, "error_m": level.error_m } });
        let mut record = ProgressiveLevel {
            mesh: i,
            error_m: level.error_m,
            vertices: primitives.iter().map(|p| p.count).sum(),
            triangles: level.mesh.triangle_count(),
            texcoord_deltas: Vec::new(),
            strips: Vec::new(),
        };
        for primitive in primitives {
            let Primitive { part, first, count, json: mut object } = primitive;
            if let Some(morph) = next {
                if morph.positions.len() != level.mesh.positions.len() {
                    return Err(ExportError::Inconsistent(what, "its morph is not as long as its vertices"));
                }
                let run = first..first + count;
                let mut target = json!({});
                let positions = &morph.positions[run.clone()];
                target["POSITION"] = add_deltas(&mut document, positions, true).into();
                let normals = morph.normals.get(run.clone()).unwrap_or_default();
                if normals.iter().any(|n| *n != [0.0; 3]) {
                    target["NORMAL"] = add_deltas(&mut document, normals, false).into();
                }
                object["targets"] = json!([target]);
                record.texcoord_deltas.push(add_uv_deltas(&mut document, morph.uvs.get(run), count));
            }
            if let Some(strip) = level.strips.get(part) {
                record.strips.push(add_strip(&mut document, &what, strip, first, count)?);
            }
            json["primitives"].as_array_mut().expect("made above").push(object);
        }
        if next.is_some() {
            json["weights"] = json!([0]);
            json["extras"]["targetNames"] = json!([format!("geomorph to D{}", i + 1)]);
        }
        records.push(record);
        document.meshes.push(json);
    }
    if !mesh.progressive.is_empty() {
        let buffer_view = document.view(&mesh.progressive, None, None);
        let has_clusters = |level: &Level| level.mesh.parts.iter().any(|p| p.material == Material::Cluster);
        let clusters = levels.iter().position(|level| has_clusters(level));
        let extension =
            ProgressiveMeshExtension { buffer_view, levels: records, clusters, coverage: mesh.coverage };
        document.meshes[0]["extensions"] = json!({ GSC_PROGRESSIVE_MESH: extension });
        document.extensions_used.insert(GSC_PROGRESSIVE_MESH.into());
    }
    let weight = error_weight(mesh.coverage);
    let mut rungs: Vec<_> =
        levels.iter().enumerate().map(|(i, level)| Rung::level(i, level, weight)).collect();
    if let Some(cards) = cards {
        rungs.push(Rung::cards(cards.add_mesh(&mut document, name)?, cards.impostor));
    }
    add_scenes(&mut document, name, &rungs);
    materials.add_images_to(&mut document);
    if let Some(cards) = cards {
        // Their mesh comes after all levels.
        cards.add_extension(&mut document, levels.len());
    }
    let json = document.json();
    Ok(write_glb(json, document.bin))
}

/// Morph deltas, sparse where that is smaller.
fn add_deltas(document: &mut Document, deltas: &[[f32; 3]], bounds: bool) -> usize {
    let mut moved: Vec<u32> = (0..deltas.len() as u32).filter(|&i| deltas[i as usize] != [0.0; 3]).collect();
    if moved.is_empty() {
        moved.push(0); // a sparse accessor has at least one entry
    }
    let sparse_bytes = moved.len() * if deltas.len() <= 65536 { 14 } else { 16 };
    let accessor = if sparse_bytes < deltas.len() * 12 {
        let values: Vec<[f32; 3]> = moved.iter().map(|&i| deltas[i as usize]).collect();
        document.sparse_accessor(deltas.len(), "VEC3", &moved, bytemuck::cast_slice(&values))
    } else {
        let view = document.view(bytemuck::cast_slice(deltas), Some(ARRAY_BUFFER), None);
        document.accessor(view, 0, FLOAT, deltas.len(), "VEC3")
    };
    if bounds {
        set_bounds(&mut document.accessors[accessor], deltas);
    }
    accessor
}

/// Deltas of texture coordinates; where all are 0, a sparse accessor with one entry, since the gltf crate refuses
/// those without any bytes.
fn add_uv_deltas(document: &mut Document, deltas: Option<&[[f32; 2]]>, count: usize) -> usize {
    if let Some(deltas) = deltas.filter(|deltas| deltas.iter().any(|d| *d != [0.0; 2])) {
        let view = document.view(bytemuck::cast_slice(deltas), None, None);
        return document.accessor(view, 0, FLOAT, deltas.len(), "VEC2");
    }
    document.sparse_accessor(count, "VEC2", &[0], &[0; 8])
}

fn add_strip(
    document: &mut Document,
    what: &str,
    strip: &[u32],
    first: usize,
    count: usize,
) -> Result<usize, ExportError> {
    let run = first as u32..(first + count) as u32;
    if strip.iter().any(|i| !run.contains(i)) {
        return Err(ExportError::Inconsistent(what.into(), "a strip uses another part's vertices"));
    }
    let own: Vec<u32> = strip.iter().map(|&i| i - first as u32).collect();
    Ok(document.indices(&own, count, None))
}
