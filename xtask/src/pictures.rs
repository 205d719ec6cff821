//! The README's picture: the four starters, each through its own camera, on one sheet.

use std::path::PathBuf;

use anyhow::{Context, Result};

use crate::setup;
use crate::tools::{files, fresh, program, python, release, root, run as run_program, script};

const SIZE: &str = "640x400";

/// Bakes in release, exports each for Blender, renders it as the export's script sets it up, and puts the four together.
pub fn run(samples: u32) -> Result<()> {
    setup::blender()?;
    let folder = root().join("target/interop/pictures");
    let world = fresh(folder.join("world"))?;
    let bake = release("genescape-bake", "bake")?;
    run_program(program(&bake).arg("--world").arg(&world))?;
    let mut pictures: Vec<PathBuf> = Vec::new();
    for landscape in ["1", "2", "3", "4"] {
        let (exported, picture) = (fresh(folder.join(landscape))?, folder.join(format!("{landscape}.png")));
        let mut export = program(&bake);
        export.args(["export", landscape]).arg(&exported).args(["--for", "blender", "--world"]).arg(&world);
        run_program(&mut export)?;
        let scripts = files(&exported, &["py"])?;
        let set_up = scripts.first().context("an export for Blender has a script")?;
        let samples = samples.to_string();
        let mut render = program(python());
        render.arg(script("blender_render.py")).arg(set_up).arg(&picture).args([SIZE, &samples]);
        run_program(&mut render)?;
        pictures.push(picture);
    }
    let sheet = root().join("docs/pictures/starters.jpg");
    std::fs::create_dir_all(sheet.parent().context("a path in the workspace has a parent")?)?;
    run_program(program(python()).arg(script("sheet.py")).arg(&sheet).args(&pictures))?;
    println!("{}", sheet.display());
    Ok(())
}
