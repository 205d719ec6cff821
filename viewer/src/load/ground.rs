//! The land of a scene file: heightfield, surface, and the coarse land around it.

use std::sync::Arc;

use genescape_schema::scene::{GroundDetail, HeightfieldError, HeightfieldExtension, Resource, TerrainLod};

use super::document::Document;
use super::{LoadError, pictures};
use crate::scene::{Apron, Detail, Ground, Heightfield, Surface};

pub(super) fn read(document: &Document) -> Result<Ground, LoadError> {
    let has = |node: &gltf::Node<'_>| node.extension_value("GSC_heightfield").is_some();
    let node = document.gltf.nodes().find(has).ok_or_else(|| document.wrong("it has no GSC_heightfield"))?;
    let extension: HeightfieldExtension =
        document.extension(node.extension_value("GSC_heightfield"), "GSC_heightfield")?;
    let name = document.name_of(&extension.lod);
    let field = document.store.get(&name, || {
        let bytes = document.bytes(&extension.lod)?;
        heightfield(&bytes).map_err(|what| document.wrong(format!("its heightfield {name} is wrong: {what}")))
    })?;
    Ok(Ground {
        name,
        field,
        water_level_m: extension.water_level_m,
        surface: surface(document, &extension)?,
        apron: Arc::new(apron(document)?),
    })
}

fn heightfield(bytes: &[u8]) -> Result<Heightfield, HeightfieldError> {
    let lod = TerrainLod::from_bytes(bytes)?;
    Ok(Heightfield {
        side: lod.field.side,
        spacing_m: lod.field.spacing_m,
        heights_m: lod.field.heights_m,
        wedgies_m: lod.wedgies_m,
        block_ranges_m: lod.block_ranges_m,
    })
}

fn surface(document: &Document, extension: &HeightfieldExtension) -> Result<Surface, LoadError> {
    let surface = &extension.surface;
    let detail = |detail: &GroundDetail<Resource>| -> Result<Detail, LoadError> {
        Ok(Detail {
            name: detail.name.clone(),
            detail: pictures::png(document, &detail.detail)?,
            normal: pictures::png(document, &detail.normal)?,
            tile_m: detail.tile_m,
        })
    };
    Ok(Surface {
        color: pictures::png(document, &surface.color)?,
        weights: pictures::png(document, &surface.weights)?,
        light: pictures::png(document, &surface.light)?,
        details: surface.details.iter().map(detail).collect::<Result<_, _>>()?,
    })
}

/// The mesh of the node "apron"; empty if the scene has none.
fn apron(document: &Document) -> Result<Apron, LoadError> {
    let mut apron = Apron::default();
    let Some(mesh) = document.node("apron").and_then(|node| node.mesh()) else { return Ok(apron) };
    for primitive in mesh.primitives() {
        let get = |semantic: gltf::Semantic| primitive.get(&semantic);
        let missing = || document.wrong("its apron lacks positions or normals");
        let base = apron.positions_m.len() as u32;
        let positions = get(gltf::Semantic::Positions).ok_or_else(missing)?;
        apron.positions_m.extend(document.values::<[f32; 3]>(positions)?);
        let normals = get(gltf::Semantic::Normals).ok_or_else(missing)?;
        apron.normals.extend(document.values::<[f32; 3]>(normals)?);
        match get(gltf::Semantic::Colors(0)) {
            Some(colors) => apron.colors.extend(document.values::<[u8; 4]>(colors)?),
            None => apron.colors.resize(apron.positions_m.len(), [128; 4]),
        }
        let indices = document.indices(&primitive)?;
        apron.triangles.extend(indices.chunks_exact(3).map(|t| [t[0] + base, t[1] + base, t[2] + base]));
    }
    let count = apron.positions_m.len();
    let sound = apron.normals.len() == count
        && apron.colors.len() == count
        && apron.triangles.as_flattened().iter().all(|&vertex| (vertex as usize) < count);
    if sound { Ok(apron) } else { Err(document.wrong("its apron's arrays do not match")) }
}
