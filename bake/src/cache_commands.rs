//! `bake cache …`: what is kept, whether it is whole, and what may go.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};
use genescape_cache::{Cache, GcOptions};
use genescape_schema::{Current, INDIVIDUALS};
use genescape_world::{World, names};
use serde_json::Value;

use crate::cli::CacheCommand;
use crate::gltf::for_each_object;
use crate::say;
use crate::say::size;

/// A world that exists, with its cache.
pub fn open(world: &Path) -> Result<(World, Cache)> {
    let world = World::open(world)?;
    let cache = Cache::open(world.baked())?;
    Ok((world, cache))
}

pub fn look_after(world: &Path, action: &CacheCommand) -> Result<()> {
    let (world, cache) = open(world)?;
    match action {
        CacheCommand::Stats => stats(&cache),
        CacheCommand::Verify => verify(&cache),
        CacheCommand::Gc { max_size } => gc(&world, &cache, max_size.0),
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

fn gc(world: &World, cache: &Cache, max_size: u64) -> Result<()> {
    let current = world.current().ok().flatten();
    let mut roots = BTreeSet::new();
    if let Some(Current { generation, .. }) = current {
        for scene in 0..INDIVIDUALS {
            roots.extend(cache.roots_of(&names::scene_id(generation, scene))?);
        }
    }
    let options = GcOptions::to(max_size);
    let grace_min = options.grace.as_secs() / 60;
    let report = cache.gc(options, &roots)?;
    say!(
        "removed {} blobs and {} actions; {} → {} ({} of it in use by the current scenes)",
        report.blobs_removed,
        report.actions_removed,
        size(report.bytes_before),
        size(report.bytes_left),
        size(report.bytes_of_roots),
    );
    if report.bytes_left > max_size {
        say!(
            "more is left than asked for: what current scenes use stays, and what was used within {grace_min} min"
        );
    }
    let is_current = |generation| current.as_ref().is_some_and(|current| current.generation == generation);
    for (generation, _, file) in world.scenes()? {
        if !is_current(generation) && !is_whole(&file)? {
            // A scene with holes is worse than none; its population file makes it again.
            fs::remove_file(&file).with_context(|| format!("cannot remove {}", file.display()))?;
            say!("removed {}: parts of it are gone; bake its population to have it again", file.display());
        }
    }
    Ok(())
}

/// Whether all files that a scene names exist.
fn is_whole(scene: &Path) -> Result<bool> {
    let text = fs::read_to_string(scene).with_context(|| format!("cannot read {}", scene.display()))?;
    let folder = scene.parent().unwrap_or(Path::new("."));
    let Ok(mut json) = serde_json::from_str(&text) else { return Ok(false) };
    let found = for_each_object(&mut json, &mut |object| match object.get("uri").and_then(Value::as_str) {
        Some(uri) if !folder.join(uri).is_file() => Err(()),
        _ => Ok(()),
    });
    Ok(found.is_ok())
}
