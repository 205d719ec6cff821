//! Ours against peers on the same machine, in the same minute. The bake: the four starters, whole, against ez-tree making
//! twenty trees without levels of detail, textures, land, light or files. The viewer: its pictures with and without
//! levels of detail, then beside three.js drawing the same scene file.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result, ensure};

use crate::setup;
use crate::tools::{files, fresh, is_installed, program, release, root, run};

/// Trees in four scenes: five templates each.
const TREES: &str = "20";
/// Whole bakes; the fastest counts, as it does for the peer.
const BAKES: u32 = 3;
/// What a whole bake may take, in times of the peer's trees.
const MAX_RATIO: f64 = 6.0;

/// Prints `bake bench`, then what the peer takes, then the ratios and whether they are what they should be; then the
/// same of the viewer.
pub fn bench(runs: u32) -> Result<()> {
    setup::node()?;
    let bake = release("genescape-bake", "bake")?;
    run(program(&bake).args(["bench", "--runs", &runs.to_string()]))?;

    let world = root().join("target/bench-world");
    let mut ours_ms = f64::MAX;
    for _ in 0..BAKES {
        fresh(world.clone())?;
        let start = Instant::now();
        let output = program(&bake).arg("--world").arg(&world).output().context("cannot start bake")?;
        ensure!(output.status.success(), "bake failed: {}", String::from_utf8_lossy(&output.stderr));
        ours_ms = ours_ms.min(start.elapsed().as_secs_f64() * 1e3);
    }

    let peer = peer()?;
    let ratio = ours_ms / peer.ms;
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    println!("four fresh scenes, the whole command: {ours_ms:.0} ms on {cores} cores (fastest of {BAKES})");
    println!(
        "ez-tree: {TREES} trees of {:.0} triangles: {:.0} ms on one core, {:.1} ms a tree",
        peer.triangles,
        peer.ms,
        peer.ms / peer.trees
    );
    println!(
        "our four scenes take {ratio:.1} times as long as their {TREES} trees; at most {MAX_RATIO:.0} is the aim"
    );
    pictures(&world)?;
    fresh(world).map(drop)
}

/// The viewer's figures on the world that was just baked, then each of its scenes beside three.js where Chromium is
/// installed. An aim that is missed is reported; it is no error.
fn pictures(world: &Path) -> Result<()> {
    let viewer = release("genescape-viewer", "viewer")?;
    println!();
    run(program(&viewer).arg("bench").arg("--world").arg(world))?;
    if !BROWSERS.iter().any(|name| is_installed(name)) {
        println!("three.js is left out: Chromium is not installed (Debian: chromium)");
        return Ok(());
    }
    for scene in files(&world.join("baked"), &["scene.gltf"])? {
        println!("\n{}", scene.display());
        let script = root().join("tests/peers/three_viewer.mjs");
        let status = program("node").arg(script).arg(&scene).arg("--viewer").arg(&viewer).status()?;
        // 1 says that an aim was missed.
        ensure!(matches!(status.code(), Some(0 | 1)), "three.js could not be measured: {status}");
    }
    Ok(())
}

/// What Chromium is called.
const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

struct Peer {
    trees: f64,
    ms: f64,
    triangles: f64,
}

/// Runs the peer's script, which prints three numbers.
fn peer() -> Result<Peer> {
    let script = root().join("tests/peers/ez_tree.mjs");
    let mut node: Command = program("node");
    let output = node.arg(script).arg(TREES).output().context("cannot start node")?;
    ensure!(output.status.success(), "ez-tree failed: {}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout);
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let [trees, ms, triangles] = numbers[..] else {
        anyhow::bail!("ez-tree's script printed {text:?} instead of three numbers");
    };
    Ok(Peer { trees, ms, triangles })
}
