//! The README's picture: the four starters, each through its own camera, on one sheet.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};

use crate::setup;
use crate::tools::{files, fresh, program, python, release, root, run as run_program, script};

const SIZE: &str = "640x400";

/// Bakes in release, renders each scene, and puts the four together.
pub fn run(samples: u32) -> Result<()> {
    setup::blender()?;
    let folder = root().join("target/interop/pictures");
    let world = fresh(folder.join("world"))?;
    run_program(program(release("genescape-bake", "bake")?).arg("--world").arg(&world))?;
    let scenes = files(&world.join("baked"), &["scene.gltf"])?;
    ensure!(scenes.len() >= 4, "the bake made {} scenes instead of four", scenes.len());
    let mut pictures: Vec<PathBuf> = Vec::new();
    for (i, scene) in scenes.iter().take(4).enumerate() {
        let picture = folder.join(format!("{i}.png"));
        let samples = samples.to_string();
        let mut render = program(python());
        render.arg(script("blender_render.py")).arg(scene).arg(&picture).args([SIZE, &samples]);
        run_program(&mut render)?;
        pictures.push(picture);
    }
    let sheet = root().join("docs/pictures/starters.jpg");
    std::fs::create_dir_all(sheet.parent().context("a path in the workspace has a parent")?)?;
    run_program(program(python()).arg(script("sheet.py")).arg(&sheet).args(&pictures))?;
    println!("{}", sheet.display());
    Ok(())
}
