//! The whole check, step by step, each with its time; later steps run even if earlier ones failed.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result, ensure};

use crate::setup;
use crate::tools::{cargo, files, program, python, root, run as execute, script};

/// A step by its name.
type Step = (&'static str, fn() -> Result<()>);

const QUICK: [Step; 5] = [
    ("formatting", formatting),
    ("the bake knows no window", dependencies),
    ("lints", lints),
    ("what the viewer's tests need", setup::window),
    ("tests", tests),
];
const WHOLE: [Step; 4] = [
    ("documentation", documentation),
    ("bake", bake),
    ("debug and release give the same bytes", profiles),
    ("Khronos validator", validator),
];
const INTEROP: [Step; 3] = [("Blender", blender), ("three.js", three), ("F3D", f3d)];

/// Runs the steps; whether all passed.
pub fn run_steps(steps: &[Step]) -> bool {
    let mut failed = Vec::new();
    for (name, step) in steps {
        println!("── {name}");
        let start = Instant::now();
        let result = step();
        let seconds = start.elapsed().as_secs_f32();
        match result {
            Ok(()) => println!("── {name}: passed in {seconds:.1} s"),
            Err(error) => {
                println!("── {name}: FAILED in {seconds:.1} s: {error:#}");
                failed.push(*name);
            }
        }
    }
    if !failed.is_empty() {
        println!("failed: {}", failed.join(", "));
    }
    println!("{} passed, {} failed", steps.len() - failed.len(), failed.len());
    failed.is_empty()
}

/// The check; whether all passed.
pub fn run(interop: bool, quick: bool) -> Result<bool> {
    let mut steps = QUICK.to_vec();
    if !quick {
        steps.extend(WHOLE);
    }
    if interop {
        steps.extend(INTEROP);
    }
    Ok(run_steps(&steps))
}

fn formatting() -> Result<()> {
    execute(&mut cargo(&["fmt", "--all", "--check"]))
}

/// The bake runs where nothing can be drawn, and compiles in a fraction of the viewer's time.
fn dependencies() -> Result<()> {
    let arguments = ["tree", "--package", "genescape-bake", "--edges", "normal,build", "--prefix", "none"];
    let tree = cargo(&arguments).output().context("cannot start cargo tree")?;
    ensure!(tree.status.success(), "cargo tree: {}", String::from_utf8_lossy(&tree.stderr));
    let tree = String::from_utf8_lossy(&tree.stdout).into_owned();
    let names: Vec<&str> = tree.lines().filter_map(|line| line.split(' ').next()).collect();
    ensure!(names.contains(&"genescape-schema"), "cargo tree tells nothing of the bake");
    let is_of_window =
        |name: &&&str| ["wgpu", "egui", "winit", "naga"].iter().any(|one| name.starts_with(one));
    let found: Vec<_> = names.iter().filter(is_of_window).collect();
    ensure!(found.is_empty(), "genescape-bake depends on {found:?}");
    Ok(())
}

/// With the gamepad, too, where its library can be compiled against.
fn lints() -> Result<()> {
    execute(&mut cargo(&["clippy", "--quiet", "--workspace", "--all-targets", "--", "-D", "warnings"]))?;
    let udev = Command::new("pkg-config").args(["--exists", "libudev"]).status();
    if cfg!(target_os = "linux") && !udev.is_ok_and(|status| status.success()) {
        println!(
            "the viewer's feature gamepad is not looked at: libudev-dev and pkg-config are not installed"
        );
        return Ok(());
    }
    let gamepad = ["clippy", "--quiet", "--package", "genescape-viewer", "--features", "gamepad"];
    execute(cargo(&gamepad).args(["--all-targets", "--", "-D", "warnings"]))
}

/// All of them: no test may leave itself out for want of a device or a display.
fn tests() -> Result<()> {
    let runtime = root().join("target/runtime");
    std::fs::create_dir_all(&runtime).context("cannot make a folder in target/")?;
    let mut command = cargo(&["test", "--quiet", "--workspace"]);
    command.env("GENESCAPE_NEEDS_GPU", "1");
    if cfg!(target_os = "linux") {
        command.env("GENESCAPE_NEEDS_WINDOW", "1");
        if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
            // Otherwise each window complains.
            command.env("XDG_RUNTIME_DIR", runtime);
        }
    }
    execute(&mut command)
}

fn documentation() -> Result<()> {
    let arguments = ["doc", "--quiet", "--workspace", "--no-deps", "--document-private-items"];
    execute(cargo(&arguments).env("RUSTDOCFLAGS", "-D warnings -A rustdoc::private-intra-doc-links"))
}

/// Where the checked bake goes.
fn world() -> PathBuf {
    root().join("target/interop/world")
}

fn baked() -> PathBuf {
    world().join("baked")
}

/// The starters, from nothing, and one scene as a single file.
fn bake() -> Result<()> {
    if world().exists() {
        std::fs::remove_dir_all(world()).context("cannot remove the last check's world")?;
    }
    let bake = |arguments: &[&str]| {
        let mut command = cargo(&["run", "--quiet", "--package", "genescape-bake", "--bin", "bake", "--"]);
        command.args(arguments).arg("--world").arg(world());
        command
    };
    execute(&mut bake(&[]))?;
    let first = first_scene()?;
    let first = first.to_str().context("the workspace's path is not UTF-8")?;
    let single = single_file();
    let single = single.to_str().context("the workspace's path is not UTF-8")?;
    execute(&mut bake(&["export", first, single]))
}

/// The same starters by a release build: every file must be the one that the debug build made.
fn profiles() -> Result<()> {
    let release = root().join("target/interop/world-release");
    if release.exists() {
        std::fs::remove_dir_all(&release).context("cannot remove the last check's world")?;
    }
    let arguments =
        ["run", "--quiet", "--release", "--package", "genescape-bake", "--bin", "bake", "--", "--world"];
    execute(cargo(&arguments).arg(&release))?;
    let contents = |world: &Path| -> Result<Vec<(PathBuf, Vec<u8>)>> {
        let baked = world.join("baked");
        let kinds = [".gltf", ".glb", ".bin", ".png", ".exr", ".json"];
        files(&baked, &kinds)?
            .into_iter()
            .map(|path| Ok((path.strip_prefix(&baked)?.to_owned(), std::fs::read(&path)?)))
            .collect()
    };
    let (debug, release) = (contents(&world())?, contents(&release)?);
    ensure!(debug.len() > 100, "only {} files were baked", debug.len());
    let differing = debug.iter().filter(|file| !release.contains(file)).map(|(path, _)| path);
    let differing: Vec<_> = differing.collect();
    ensure!(
        debug.len() == release.len() && differing.is_empty(),
        "{} files differ: {differing:?}",
        differing.len()
    );
    println!("{} files are the same", debug.len());
    Ok(())
}

fn single_file() -> PathBuf {
    root().join("target/interop/single.glb")
}

fn scenes() -> Result<Vec<PathBuf>> {
    files(&baked(), &["scene.gltf"])
}

fn first_scene() -> Result<PathBuf> {
    scenes()?.into_iter().next().context("the bake made no scene")
}

/// A tree: the first .glb with levels in it.
fn tree_file() -> Result<PathBuf> {
    let has_levels = |path: &PathBuf| {
        std::fs::read(path).is_ok_and(|b| {
            let name = b"GSC_progressive_mesh";
            b[..b.len().min(65536)].windows(name.len()).any(|window| window == name)
        })
    };
    files(&baked(), &[".glb"])?.into_iter().find(has_levels).context("no .glb of the bake is a tree")
}

fn validator() -> Result<()> {
    setup::node()?;
    let mut all = files(&baked(), &["scene.gltf", ".glb"])?;
    all.push(single_file());
    execute(program("node").arg(script("validate.mjs")).args(all))
}

fn blender() -> Result<()> {
    setup::blender()?;
    for file in [first_scene()?, tree_file()?] {
        execute(program(python()).arg(script("blender_check.py")).arg(file))?;
    }
    Ok(())
}

fn three() -> Result<()> {
    setup::node()?;
    execute(
        program("node").arg(script("three_check.mjs")).args(scenes()?).arg(tree_file()?).arg(single_file()),
    )
}

fn f3d() -> Result<()> {
    setup::blender()?;
    // It draws each tree by itself, so a scene of few trees is enough of its time.
    let size = |path: &PathBuf| std::fs::metadata(path).map_or(u64::MAX, |metadata| metadata.len());
    let scene = scenes()?.into_iter().min_by_key(size).context("the bake made no scene")?;
    for (file, picture) in [(scene, "f3d-scene.png"), (tree_file()?, "f3d-tree.png")] {
        let picture = root().join("target/interop").join(picture);
        execute(program(python()).arg(script("f3d_render.py")).arg(file).arg(&picture))?;
        ensure!(Path::new(&picture).is_file(), "F3D wrote no picture");
    }
    Ok(())
}
