//! `bake lod`: a mesh file → a .glb with its progressive mesh, distinguished meshes and geomorphs.

use std::path::Path;

use anyhow::{Context, Result};
use genescape_world::{MAX_MODEL_BYTES, NamedFiles, atomic_write, output, regular_file};

use crate::bad_input::BadInput;
use crate::gltf::{self, MaterialSet, Picture};
use crate::import::{self, Imported, ImportedImage, Repair};
use crate::model::Material;
use crate::stages::{lod, tree};
use crate::{progress, say};

/// Reads `input`, prints what had to be repaired, makes all levels and writes them to `out`. Where the file brings no
/// normals, faces that meet at less than `crease_deg` are smoothed over.
pub fn convert(input: &Path, out: &Path, crease_deg: f32, placement: lod::Placement) -> Result<()> {
    if !(0.0..=180.0).contains(&crease_deg) {
        return Err(BadInput(format!("--crease-deg {crease_deg}: an angle from 0 to 180 degrees")).into());
    }
    // Before the work, and once more after it, when all files that the model names are known.
    output::check(out, "glb", &[input.to_owned()])?;
    let bytes =
        regular_file::read(input, MAX_MODEL_BYTES).map_err(|error| BadInput::unread(input, &error))?;
    let files = NamedFiles::of(input);
    let extension = input.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let mut imported = import::read_mesh(&bytes, extension, &|name| files.read(name))
        .map_err(|error| BadInput(format!("{}: {error}", input.display())))?;
    output::check(out, "glb", &files.files())?;
    tell(&imported.repairs);
    if imported.mesh.normals.is_empty() {
        imported.mesh = tree::crease_normals(&imported.mesh, crease_deg.to_radians());
    }
    let working = progress::spinner(format!("simplifying {} triangles", imported.mesh.triangle_count()));
    let options = lod::LodOptions { placement, ..lod::LodOptions::default() };
    let levels = lod::levels(&imported.mesh, &options);
    working.set_message("writing");
    let name = input.file_stem().map_or("mesh".into(), |stem| stem.to_string_lossy());
    let glb = gltf::levelled_glb(&name, &levels, &materials(&imported), None)
        .with_context(|| format!("{}: cannot be written as glTF", input.display()))?;
    atomic_write::replace(out, &glb).with_context(|| format!("cannot write {}", out.display()))?;

    working.finish_and_clear();
    say!("{:<6} {:>10} {:>10} {:>12}", "level", "vertices", "triangles", "error (m)");
    for (index, level) in levels.levels.iter().enumerate() {
        let (vertices, triangles) = (level.mesh.positions.len(), level.mesh.triangle_count());
        say!("D_{index:<4} {vertices:>10} {triangles:>10} {:>12.6}", level.error_m);
    }
    say!("wrote {} ({})", out.display(), say::size(glb.len() as u64));
    Ok(())
}

/// The repairs, a line each, as far as anyone reads on.
fn tell(repairs: &[Repair]) {
    const MAX_LINES: usize = 100;
    for repair in repairs.iter().take(MAX_LINES) {
        say!("repair: {repair}");
    }
    if let Some(more @ 1..) = repairs.len().checked_sub(MAX_LINES) {
        say!("… and {more} more repairs");
    }
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
