//! The whole check, step by step, each with its time; later steps run even if earlier ones failed.

use std::path::PathBuf;
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use clap::ValueEnum;

use crate::setup;
use crate::tools::{
    cargo, files, fresh, in_a_session, is_installed, program, python, release, root, run as execute, script,
};

/// A step by its name.
type Step<'a> = (&'a str, &'a dyn Fn() -> Result<()>);

/// The most crates that the bake may be made of, our own included.
const MAX_CRATES: usize = 110;

/// How much to check.
#[derive(Clone, Copy, clap::Args)]
pub struct Extent {
    /// Also open a bake's files with Blender, three.js and F3D (first time: installs about 1 GB in .interop/).
    #[arg(long)]
    interop: bool,
    /// Only formatting, lints and tests.
    #[arg(long, conflicts_with = "interop")]
    quick: bool,
    /// Try other random cases than the last time, and ten times as many where there are most of them.
    #[arg(long)]
    long: bool,
}

/// The check; whether all passed.
pub fn run(extent: Extent) -> bool {
    let tests = || tests(extent.long);
    let mut steps: Vec<Step<'_>> = vec![
        ("formatting", &formatting),
        ("what the bake is made of", &dependencies),
        ("lints", &lints),
        ("what the viewer's tests need", &setup::window),
        ("tests", &tests),
    ];
    if !extent.quick {
        steps.extend::<[Step<'_>; 4]>([
            ("documentation", &documentation),
            ("release build", &release_build),
            ("the release build's bytes", &release_bytes),
            ("Khronos validator", &validator),
        ]);
    }
    if extent.interop {
        steps.extend::<[Step<'_>; 3]>([("Blender", &blender), ("three.js", &three), ("F3D", &f3d)]);
    }
    run_steps(&steps)
}

fn run_steps(steps: &[Step<'_>]) -> bool {
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

/// What a test compares with, and which the test itself can write.
#[derive(Clone, Copy, ValueEnum)]
pub enum Blessing {
    /// What each stage computes: bake/tests/stage_digests.txt.
    Digests,
    /// What the viewer draws: viewer/tests/golden/*.png. Look at them before they are kept.
    Pictures,
}

/// Writes the files anew.
pub fn bless(what: Blessing) -> Result<()> {
    let mut test = match what {
        Blessing::Digests => one_test("bake", "stage_digests::one_thread_gives_the_bytes_of_the_table"),
        Blessing::Pictures => {
            setup::window()?;
            one_test("viewer", "golden::pictures_are_as_they_were")
        }
    };
    execute(test.env("GENESCAPE_BLESS", "1"))
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
    let crates: std::collections::BTreeSet<&str> =
        tree.lines().map(|line| line.trim_end_matches(" (*)")).filter(|line| !line.is_empty()).collect();
    ensure!(crates.len() > 1, "cargo tree lists no dependencies of the bake");
    let of_window = ["wgpu", "egui", "winit", "naga"];
    let found: Vec<_> =
        crates.iter().filter(|name| of_window.iter().any(|one| name.starts_with(one))).collect();
    ensure!(found.is_empty(), "genescape-bake depends on {found:?}");
    println!("{} crates", crates.len());
    ensure!(crates.len() <= MAX_CRATES, "more than {MAX_CRATES} crates");
    Ok(())
}

/// With the gamepad, where its library can be compiled against.
fn lints() -> Result<()> {
    let mut clippy = cargo(&["clippy", "--quiet", "--workspace", "--all-targets"]);
    let udev = Command::new("pkg-config").args(["--exists", "libudev"]).status();
    if cfg!(target_os = "linux") && !udev.is_ok_and(|status| status.success()) {
        println!("left out: the viewer's feature gamepad, for want of libudev-dev or pkg-config");
    } else {
        clippy.args(["--features", "genescape-viewer/gamepad"]);
    }
    execute(clippy.args(["--", "-D", "warnings"]))
}

/// The cases that proptest draws. With the same ones each time a commit passes or fails for everybody;
/// `--long` and a plain `cargo test` look for new ones.
const PROPTEST_SEED: &str = "20261122";

/// Tests of the workspace. Of one package alone, dependencies would have other features and be compiled again.
fn test(arguments: &[&str]) -> Command {
    let mut command = cargo(&["test", "--quiet", "--workspace", "--no-fail-fast"]);
    // Debug builds would draw everything under Vulkan's validation layer, slowly; one test does, and says what it heard.
    command.env("WGPU_VALIDATION", "0");
    in_a_session(command.args(arguments));
    command
}

fn one_test(target: &str, name: &str) -> Command {
    test(&["--test", target, "--", "--include-ignored", "--exact", name])
}

/// All of them. A plain `cargo test` ignores those that need a device, a display, a right or other people's files.
fn tests(long: bool) -> Result<()> {
    let mut command = test(&["--", "--include-ignored"]);
    let meshes =
        std::env::var_os("GENESCAPE_DATA").map_or_else(|| root().join("../shared/data"), PathBuf::from);
    if !meshes.join("spot.obj").is_file() {
        println!("left out: real_meshes_keep_their_shape, for GENESCAPE_DATA names no folder with spot.obj");
        command.args(["--skip", "real_meshes_keep_their_shape"]);
    }
    if long {
        command.env("GENESCAPE_LONG", "1");
    } else {
        command.env("PROPTEST_RNG_SEED", PROPTEST_SEED);
    }
    execute(&mut command)
}

fn documentation() -> Result<()> {
    let arguments = ["doc", "--quiet", "--workspace", "--no-deps", "--document-private-items"];
    execute(cargo(&arguments).env("RUSTDOCFLAGS", "-D warnings -A rustdoc::private-intra-doc-links"))?;
    if !is_installed("mdbook") {
        println!("left out: the book, for want of mdbook (cargo install mdbook)");
        return Ok(());
    }
    execute(program("mdbook").args(["build", "docs"]))
}

/// Where the checked bake is.
fn world() -> PathBuf {
    root().join("target/interop/world")
}

/// Where its exports are: a folder for viewers, one for Blender, and a file with instances.
fn exports() -> PathBuf {
    root().join("target/interop/exports")
}

/// What a newcomer does first: the starters, from nothing, and exports of one.
fn release_build() -> Result<()> {
    let bake = release("genescape-bake", "bake")?;
    execute(program(&bake).arg("--world").arg(fresh(world())?))?;
    fresh(exports())?;
    let (scene, folder) = (small_scene()?, exports());
    for (out, options) in
        [("plain", &[][..]), ("blender", &["--for", "blender"]), ("instanced.glb", &["--instancing"])]
    {
        execute(program(&bake).arg("export").arg(&scene).arg(folder.join(out)).args(options))?;
    }
    Ok(())
}

/// The only file in a folder of the exports that ends so.
fn exported(folder: &str, ending: &str) -> Result<PathBuf> {
    let folder = exports().join(folder);
    let found = files(&folder, &[ending])?.into_iter().find(|file| file.parent() == Some(&folder));
    found.with_context(|| format!("no {ending} in {}", folder.display()))
}

/// The same starters at the size of the table of digests: a test of the debug build compares them with it.
fn release_bytes() -> Result<()> {
    let world = fresh(root().join("target/interop/world-65"))?;
    let bake = release("genescape-bake", "bake")?;
    execute(program(&bake).args(["--size", "65", "--world"]).arg(&world))?;
    let mut test = one_test("bake", "stage_digests::the_program_gives_the_bytes_of_the_table");
    execute(test.env("GENESCAPE_BAKED", world))
}

fn baked_files(endings: &[&str]) -> Result<Vec<PathBuf>> {
    files(&world().join("baked"), endings)
}

fn first_scene() -> Result<PathBuf> {
    baked_files(&["scene.gltf"])?.into_iter().next().context("the bake made no scene")
}

/// The scene of the fewest trees, which others' programs, that draw each by itself, show in little time.
fn small_scene() -> Result<PathBuf> {
    let size = |path: &PathBuf| std::fs::metadata(path).map_or(u64::MAX, |metadata| metadata.len());
    baked_files(&["scene.gltf"])?.into_iter().min_by_key(size).context("the bake made no scene")
}

/// A tree: the first .glb with levels in it.
fn tree_file() -> Result<PathBuf> {
    let has_levels = |path: &PathBuf| {
        std::fs::read(path).is_ok_and(|b| {
            let name = b"GSC_progressive_mesh";
            b[..b.len().min(65536)].windows(name.len()).any(|window| window == name)
        })
    };
    baked_files(&[".glb"])?.into_iter().find(has_levels).context("no .glb of the bake is a tree")
}

fn validator() -> Result<()> {
    setup::node()?;
    let all = baked_files(&["scene.gltf", ".glb"])?;
    execute(program("node").arg(script("validate.mjs")).args(all).args(files(&exports(), &[".glb"])?))
}

fn blender() -> Result<()> {
    setup::blender()?;
    for file in [first_scene()?, tree_file()?] {
        execute(program(python()).arg(script("blender_check.py")).arg(file))?;
    }
    let (set_up, plain) = (exported("blender", ".py")?, exported("plain", ".glb")?);
    execute(program(python()).arg(script("blender_export.py")).arg(set_up).arg(plain))
}

fn three() -> Result<()> {
    setup::node()?;
    let scenes = baked_files(&["scene.gltf"])?;
    let exports = files(&exports(), &[".glb"])?;
    execute(program("node").arg(script("three_check.mjs")).args(scenes).arg(tree_file()?).args(exports))
}

fn f3d() -> Result<()> {
    setup::blender()?;
    for (file, picture) in [
        (small_scene()?, "f3d-scene.png"),
        (tree_file()?, "f3d-tree.png"),
        (exported("plain", ".glb")?, "f3d-export.png"),
    ] {
        let picture = root().join("target/interop").join(picture);
        execute(program(python()).arg(script("f3d_render.py")).arg(file).arg(&picture))?;
        ensure!(picture.is_file(), "F3D wrote no picture");
    }
    Ok(())
}
