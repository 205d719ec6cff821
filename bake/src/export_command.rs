//! `bake export`: a landscape by its number or file → files for other programs, and what to do with them.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use genescape_schema::Current;
use genescape_world::World;

use crate::cache_commands;
use crate::cli::{ExportArgs, RunArgs};
use crate::events::Listener;
use crate::export::{self, Audience, Exported};
use crate::landscape::SceneArg;
use crate::progress::{JsonLines, ProgressBar};
use crate::say;

/// Writes a landscape into a folder or, for a name with an ending, as one file.
pub fn run(scene: &SceneArg, out: &Path, args: ExportArgs, run: &RunArgs) -> Result<()> {
    let options = args.options()?;
    let scene = find(scene, &run.world)?;
    let listener: &dyn Listener = if run.json { &JsonLines } else { &ProgressBar::new() };
    let exported = match is_file(out) {
        true => export::to_file(&scene, out, options, listener),
        false => export::to_folder(&scene, out, options, listener),
    };
    // The bar must not stand between the person and a message.
    listener.end();
    let exported = exported?;
    if !run.json {
        report(&exported, options.audience);
    }
    Ok(())
}

/// Whether a person means a file by that: whatever has an ending, unless it is a folder already or ends in a slash.
fn is_file(out: &Path) -> bool {
    let text = out.as_os_str().as_encoded_bytes();
    out.extension().is_some() && !out.is_dir() && !text.ends_with(b"/") && !text.ends_with(b"\\")
}

fn find(scene: &SceneArg, world: &Path) -> Result<PathBuf> {
    match scene {
        SceneArg::File(path) => Ok(path.clone()),
        SceneArg::Current(landscape) => {
            let (world, cache) = cache_commands::open(world)?;
            let path = world.root().join(&current(&world)?.scenes[landscape.index()]);
            cache_commands::read_scene(&path, &cache).context("it cannot be exported; bake again")?;
            Ok(path)
        }
    }
}

/// Which scenes the world's last bake made.
///
/// # Errors
/// A world that nothing has been baked in, or a wrong `current.ron`.
pub fn current(world: &World) -> Result<Current> {
    world.current()?.with_context(|| format!("nothing has been baked in {} yet", world.root().display()))
}

fn report(exported: &Exported, audience: Audience) {
    for (path, length) in &exported.files {
        say!("wrote {} ({})", path.display(), say::size(*length));
    }
    if let Some(lost_m) = exported.shear_lost_m {
        say!("note: instances cannot lean as trees do; none is off by more than {lost_m:.2} m");
    }
    let (glb, script) = (exported.files.first(), exported.files.last());
    let (Some((glb, _)), Some((script, _))) = (glb, script) else { return };
    match audience {
        Audience::Blender => say!(
            "In Blender: `blender --python {}`, or open that script in the text editor and press Run Script.\n\
             It imports the .glb, and sets camera, sun, sky, haze and collections.",
            script.display()
        ),
        Audience::Viewers => say!(
            "Look at it: drop {glb} on any glTF viewer; `f3d --camera-index 0 {glb}` looks from where a walk begins.\n\
             For Blender, `--for blender` writes a script that sets up the whole scene. This file in Blender: make \"start\" \
             the\nactive camera, the sun as strong as you like, and the sky the world's environment texture, turned by −90° \
             about z.",
            glb = glb.display()
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ending_makes_a_file_of_it() {
        for (out, expected) in [
            ("valley.glb", true),
            ("a.b/valley.GLB", true),
            ("valley", false),
            ("valley.d/", false),
            (".", false),
            ("..", false),
        ] {
            assert_eq!(is_file(Path::new(out)), expected, "{out}");
        }
        assert!(!is_file(&std::env::temp_dir()));
    }
}
