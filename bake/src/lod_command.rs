//! `bake lod`: a mesh file → a .glb with its progressive mesh, distinguished meshes and geomorphs.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use bytesize::ByteSize;
use genescape_world::atomic_write;

use crate::cli::BadInput;
use crate::gltf::{self, MaterialSet, Picture};
use crate::import::{self, Imported, ImportedImage};
use crate::model::Material;
use crate::say;
use crate::stages::{lod, tree};

/// Reads `input`, prints what had to be repaired, makes all levels and writes them to `out`. Where the file brings no
/// normals, faces that meet at less than `crease_deg` are smoothed over.
pub fn convert(input: &Path, out: &Path, crease_deg: f32) -> Result<()> {
    if !(0.0..=180.0).contains(&crease_deg) {
        return Err(BadInput(format!("--crease-deg {crease_deg}: an angle from 0 to 180 degrees")).into());
    }
    let bytes = fs::read(input).with_context(|| format!("cannot read {}", input.display()))?;
    let folder = input.parent().unwrap_or(Path::new("."));
    let extension = input.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let mut imported = import::read_mesh(&bytes, extension, &|name| fs::read(folder.join(name)))
        .map_err(|error| BadInput(format!("{}: {error}", input.display())))?;
    for repair in &imported.repairs {
        say!("repair: {repair}");
    }
    if imported.mesh.normals.is_empty() {
        imported.mesh = tree::crease_normals(&imported.mesh, crease_deg.to_radians());
    }
    let levels = lod::levels(&imported.mesh, &lod::LodOptions::default());
    let name = input.file_stem().map_or("mesh".into(), |stem| stem.to_string_lossy());
    let glb = gltf::levelled_glb(&name, &levels, &materials(&imported))
        .with_context(|| format!("{}: cannot be written as glTF", input.display()))?;
    atomic_write::replace(out, &glb).with_context(|| format!("cannot write {}", out.display()))?;

    say!("{:<6} {:>10} {:>10} {:>12}", "level", "vertices", "triangles", "error (m)");
    for (index, level) in levels.levels.iter().enumerate() {
        let (vertices, triangles) = (level.mesh.positions.len(), level.mesh.triangle_count());
        say!("D_{index:<4} {vertices:>10} {triangles:>10} {:>12.6}", level.error_m);
    }
    say!("wrote {} ({})", out.display(), ByteSize(glb.len() as u64).display().si());
    Ok(())
}

fn materials(imported: &Imported) -> MaterialSet<'_> {
    MaterialSet {
        slots: (0..imported.materials.len() as u32).map(Material::Foreign).collect(),
        materials: imported.materials.clone(),
        textures: imported.textures.clone(),
        samplers: imported.samplers.clone(),
        images: imported.images.iter().map(|image| (image.name.clone(), embedded(image))).collect(),
    }
}

fn embedded(image: &ImportedImage) -> Picture<'_> {
    Picture::Embedded { bytes: &image.bytes, mime_type: &image.mime_type }
}
