//! `bake export`: a baked scene → files that other programs open.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use bytesize::ByteSize;
use genescape_schema::Current;
use genescape_world::{World, atomic_write};

use crate::cli::BadInput;
use crate::say;

/// Writes a scene as one self-contained file.
pub fn export(world: &Path, scene: &str, out: &Path) -> Result<()> {
    let path = match scene.parse::<usize>() {
        Ok(index) => {
            let world = World::open(world)?;
            let current = current(&world)?;
            let file = current.scenes.get(index);
            let file = file.ok_or_else(|| BadInput(format!("scene {index}: there are scenes 0 to 3")))?;
            world.root().join(file)
        }
        Err(_) => PathBuf::from(scene),
    };
    let json = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let folder = path.parent().unwrap_or(Path::new("."));
    let read = |uri: &str| fs::read(folder.join(uri)).map_err(|error| error.to_string());
    let glb = crate::gltf::single_glb(&json, read).with_context(|| {
        format!("{}: cannot be made one file; bake again if blobs are missing", path.display())
    })?;
    atomic_write::replace(out, &glb).with_context(|| format!("cannot write {}", out.display()))?;
    say!("wrote {} ({})", out.display(), ByteSize(glb.len() as u64).display().si());
    Ok(())
}

/// Which scenes the world's last bake made.
///
/// # Errors
/// A world that nothing has been baked in, or a wrong `current.ron`.
pub fn current(world: &World) -> Result<Current> {
    world.current()?.with_context(|| format!("nothing has been baked in {} yet", world.root().display()))
}
