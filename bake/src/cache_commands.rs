//! `bake cache …`: what is kept, whether it is whole, and what may go.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use genescape_cache::{Cache, Digest};
use genescape_world::{World, names};
use serde_json::Value;

use crate::cli::CacheCommand;
use crate::gltf::for_each_object;
use crate::say;
use crate::say::size;
use crate::stages::scene::SCENE_EXT;

/// The person no longer waited until nothing was in use.
#[derive(Debug, thiserror::Error)]
#[error("interrupted while waiting for a bake to end; nothing was removed")]
pub struct GaveUp;

/// A world that exists, with its cache.
pub fn open(world: &Path) -> Result<(World, Cache)> {
    let world = World::open(world)?;
    let cache = Cache::open(world.baked())?;
    Ok((world, cache))
}

/// Carries out the command; `stopped` is asked while it waits.
pub fn look_after(world: &Path, action: &CacheCommand, stopped: &dyn Fn() -> bool) -> Result<()> {
    let (world, cache) = open(world)?;
    match action {
        CacheCommand::Stats => stats(&cache),
        CacheCommand::Verify => verify(&cache),
        CacheCommand::Gc { max_size } => gc(&world, &cache, *max_size, stopped),
    }
}

fn stats(cache: &Cache) -> Result<()> {
    let stats = cache.stats()?;
    say!("{} blobs, {}; {} actions", stats.blobs, size(stats.blob_bytes), stats.actions);
    say!("{:<18} {:>8} {:>12} {:>12}", "stage", "actions", "size", "cost");
    for (name, stage) in &stats.stages {
        let cost = format!("{:.0} ms", stage.cost_ms);
        say!("{name:<18} {:>8} {:>12} {cost:>12}", stage.actions, size(stage.bytes));
    }
    Ok(())
}

fn verify(cache: &Cache) -> Result<()> {
    let report = cache.verify()?;
    say!("read {} blobs ({}) and {} actions", report.blobs, size(report.bytes), report.actions);
    for fault in &report.faults {
        say!("  {fault}");
    }
    for foreign in &report.foreign {
        say!("  {foreign}: none of ours, left alone");
    }
    match report.faults.len() {
        0 => {
            say!("all is well");
            Ok(())
        }
        n => bail!("{n} damaged or missing; `bake` makes them again"),
    }
}

fn gc(world: &World, cache: &Cache, max_size: u64, stopped: &dyn Fn() -> bool) -> Result<()> {
    let mut waits = false;
    let gc = cache.begin_gc(|| {
        if !std::mem::replace(&mut waits, true) {
            eprintln!("note: waiting until no bake of this world is running; Ctrl-C gives up");
        }
        !stopped()
    })?;
    let gc = gc.ok_or(GaveUp)?;
    let (current, roots) = in_use(world, cache).context(
        "nothing was removed, for it cannot be told what is in use; `bake` puts that right, then try again",
    )?;
    let report = gc.evict(max_size, &roots)?;
    say!(
        "removed {} blobs and {} actions; {} → {} ({} of it in use by the current scenes)",
        report.blobs_removed,
        report.actions_removed,
        size(report.bytes_before),
        size(report.bytes_left),
        size(report.bytes_in_use),
    );
    if report.bytes_left > max_size {
        say!("more is left than asked for: what the current scenes use stays");
    }
    let drafts = world.sweep_drafts()? + report.abandoned_removed;
    if drafts > 0 {
        say!("removed {drafts} half-written files that killed programs left");
    }
    remove_scenes_with_holes(world, &current)
}

/// The current scene files, and the digests of all blobs that they name or are copies of.
fn in_use(world: &World, cache: &Cache) -> Result<(BTreeSet<PathBuf>, BTreeSet<Digest>)> {
    let (mut scenes, mut roots) = (BTreeSet::new(), BTreeSet::new());
    match world.current()? {
        Some(current) => {
            for path in current.scenes.iter().map(|scene| world.root().join(scene)) {
                let json = read_scene(&path, cache)?;
                roots.insert(Digest::of(&json));
                roots.extend(uris(&json)?.iter().filter_map(|uri| digest(uri)));
                scenes.insert(path);
            }
        }
        None if !world.scenes()?.is_empty() => bail!("{} is missing", names::CURRENT),
        None => {}
    }
    Ok((scenes, roots))
}

/// A scene file as it was baked, which is a copy of a blob.
///
/// # Errors
/// If it is missing or has been changed since.
pub fn read_scene(path: &Path, cache: &Cache) -> Result<Vec<u8>> {
    if !path.is_file() {
        bail!("{} is missing", path.display());
    }
    let json = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    if !cache.has_copied(&json, SCENE_EXT)? {
        bail!("{} is not as it was baked, or the blob that vouches for it is gone", path.display());
    }
    Ok(json)
}

/// A scene with holes is worse than none, and its population file makes it again.
fn remove_scenes_with_holes(world: &World, current: &BTreeSet<PathBuf>) -> Result<()> {
    for (.., path) in world.scenes()?.into_iter().filter(|(.., path)| !current.contains(path)) {
        let folder = path.parent().unwrap_or(Path::new("."));
        // What is no scene of ours is left alone.
        let Some(uris) = fs::read(&path).ok().and_then(|json| uris(&json).ok()) else { continue };
        if uris.iter().any(|uri| digest(uri).is_some() && !folder.join(uri).is_file()) {
            fs::remove_file(&path).with_context(|| format!("cannot remove {}", path.display()))?;
            say!("removed {}: parts of it are gone; bake its population to have it again", path.display());
        }
    }
    Ok(())
}

/// The files that a scene names.
fn uris(scene: &[u8]) -> Result<Vec<String>> {
    let (mut json, mut uris) = (serde_json::from_slice(scene)?, Vec::new());
    for_each_object(&mut json, &mut |object| -> Result<()> {
        uris.extend(object.get("uri").and_then(Value::as_str).map(str::to_owned));
        Ok(())
    })?;
    Ok(uris)
}

/// The digest of the blob that a scene names by this URI; `None` for other files.
fn digest(uri: &str) -> Option<Digest> {
    Path::new(uri).file_stem()?.to_str()?.parse().ok()
}
