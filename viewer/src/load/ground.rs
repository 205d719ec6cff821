//! The land of a scene file: heightfield, surface, and the coarse land around it.

use std::convert::Infallible;
use std::sync::Arc;

use genescape_schema::scene::{
    GROUND_WEIGHTS, GSC_HEIGHTFIELD, GroundSurface, HeightfieldExtension, Resource, TerrainLod,
};
use rayon::prelude::*;

use super::bounds::{MAX_LAND_M, is_plant, within};
use super::document::Document;
use super::{Result, images};
use crate::scene::{Apron, Ground, Image};

/// Kinds of small plants in a scene.
const MAX_KINDS: usize = 64;

pub(super) fn read(document: &Document) -> Result<Ground> {
    let object = document.gltf.nodes().find_map(|node| node.extension_value(GSC_HEIGHTFIELD).cloned());
    let extension: HeightfieldExtension = document.extension(object.as_ref(), GSC_HEIGHTFIELD)?;
    let name = document.name_of(&extension.lod);
    let lod = document.store.get(&name, || {
        let bytes = document.bytes(&extension.lod)?;
        TerrainLod::from_bytes(&bytes)
            .map_err(|what| document.wrong(format!("its heightfield {name} is wrong: {what}")))
    })?;
    let numbers = [&lod.field.heights_m[..], &lod.wedgies_m, lod.block_ranges_m.as_flattened()];
    if !numbers.into_iter().all(|numbers| within(numbers, MAX_LAND_M)) || lod.field.spacing_m > MAX_LAND_M {
        return Err(document.wrong(format!("its heightfield {name} holds numbers beyond {MAX_LAND_M:e} m")));
    }
    let (plants, details) = (&extension.surface.plants, extension.surface.details.len());
    let are_plants = plants.kinds.iter().all(|kind| is_plant(kind, plants.maps.len(), details));
    if plants.kinds.len() > MAX_KINDS || !are_plants {
        return Err(document.wrong("its small plants are too many, too large, or no plants"));
    }
    Ok(Ground {
        name,
        field: lod.field.clone(),
        lod,
        water_level_m: extension.water_level_m,
        surface: surface(document, &extension.surface)?,
        apron: Arc::new(apron(document)?),
    })
}

/// With its images decoded side by side.
fn surface(document: &Document, surface: &GroundSurface<Resource>) -> Result<GroundSurface<Image>> {
    let mut resources = Vec::new();
    let Ok(_) = surface.try_map(|image| {
        resources.push(image.clone());
        Ok::<_, Infallible>(())
    });
    let decoded = resources.par_iter().map(|image| images::png(document, image));
    let mut decoded = decoded.collect::<Vec<_>>().into_iter();
    surface.try_map(|image| decoded.next().unwrap_or_else(|| images::png(document, image)))
}

/// The mesh of the node "apron"; empty if the scene has none.
fn apron(document: &Document) -> Result<Apron> {
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
        match get(gltf::Semantic::Extras(GROUND_WEIGHTS.trim_start_matches('_').into())) {
            Some(weights) => apron.weights.extend(document.values::<[u8; 4]>(weights)?),
            None => apron.weights.resize(apron.positions_m.len(), [0; 4]),
        }
        let count = apron.positions_m.len() - base as usize;
        let indices = document.indices(&primitive, count)?;
        apron.triangles.extend(indices.chunks_exact(3).map(|t| [t[0] + base, t[1] + base, t[2] + base]));
    }
    let count = apron.positions_m.len();
    let sound = apron.normals.len() == count
        && apron.colors.len() == count
        && apron.weights.len() == count
        && within(apron.positions_m.as_flattened(), MAX_LAND_M);
    if sound {
        Ok(apron)
    } else {
        Err(document.wrong("its apron's arrays do not match, or it reaches too far"))
    }
}
