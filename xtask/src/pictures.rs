//! The README's picture: the four starters, each through its own camera, on one sheet.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};

use crate::tools::{cargo, files, program, python, root, script};
use crate::{setup, tools};

const SIZE: &str = "640x400";

/// Bakes in release, renders each scene, and puts the four together.
pub fn run(samples: u32) -> Result<()> {
    setup::blender()?;
    let folder = root().join("target/interop/pictures");
    let world = folder.join("world");
    if world.exists() {
        // The starters may have changed since.
        std::fs::remove_dir_all(&world).context("cannot remove the last pictures' world")?;
    }
    let mut bake = cargo(&[
        "run",
        "--quiet",
        "--release",
        "--package",
        "genescape-bake",
        "--bin",
        "bake",
        "--",
        "--world",
    ]);
    tools::run(bake.arg(&world))?;
    let scenes = files(&world.join("baked"), &["scene.gltf"])?;
    ensure!(scenes.len() >= 4, "the bake made {} scenes instead of four", scenes.len());
    let mut pictures: Vec<PathBuf> = Vec::new();
    for (i, scene) in scenes.iter().take(4).enumerate() {
        let picture = folder.join(format!("{i}.png"));
        let samples = samples.to_string();
        let mut render = program(python());
        render.arg(script("blender_render.py")).arg(scene).arg(&picture).args([SIZE, &samples]);
        tools::run(&mut render)?;
        pictures.push(picture);
    }
    let sheet = root().join("docs/pictures/starters.jpg");
    std::fs::create_dir_all(sheet.parent().context("a path in the workspace has a parent")?)?;
    tools::run(program(python()).arg(script("sheet.py")).arg(&sheet).args(&pictures))?;
    println!("{}", sheet.display());
    Ok(())
}
