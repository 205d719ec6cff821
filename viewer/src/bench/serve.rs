//! Lines on standard input → pictures, and what each took as a line of JSON on standard output, so that a script can
//! measure another viewer in between. The first line of output tells device and cameras. Then, place by place:
//!
//! - `frame TREES LAND PLACE` → `{"wall_ms":…,"cpu_ms":…}`
//! - `picture TREES LAND PLACE FILE` → the same, after the picture was written as PNG
//!
//! TREES: `off`, `quality`, `simple`, `discrete`; LAND: `off`, `morph`, `roam`; PLACE counts from 0.

use std::collections::BTreeMap;
use std::io::BufRead;
use std::path::Path;

use anyhow::{Context, Result, anyhow, bail};
use clap::ValueEnum;
use serde_json::json;

use super::{BenchArgs, frame_with};
use crate::camera::{Camera, NEAR_M};
use crate::headless::Headless;
use crate::image_file;
use crate::measure::{Cost, camera_path};
use crate::say;
use crate::view::View;

pub(super) fn run(headless: &Headless, path: &Path, args: &BenchArgs) -> Result<()> {
    let scene = headless.read(path)?.without_far_trees();
    let cameras = camera_path(&scene, args.steps);
    let uploaded = headless.upload(&scene)?;
    let sky = &scene.sky.light;
    let told = |camera: &Camera| {
        json!({ "position_m": camera.position_m.to_array(), "yaw_rad": camera.yaw_rad,
                "pitch_rad": camera.pitch_rad, "fov_y_rad": camera.fov_y_rad })
    };
    let hello = json!({
        "device": headless.gpu.name, "software": headless.gpu.software, "size_px": args.size, "near_m": NEAR_M,
        "trees": scene.trees.instances.len(), "cameras": cameras.iter().map(told).collect::<Vec<_>>(),
        "sun_direction": sky.sun_direction.to_array(), "sun_irradiance_linear": sky.sun_irradiance_linear,
        "sky_irradiance_linear": sky.sky_irradiance_linear, "haze_linear": sky.haze_linear,
        "haze_extinction_per_m": sky.haze_extinction_per_m, "exposure": sky.exposure,
    });
    say!("{hello}");
    // A view for each pair of modes: some go on from their last picture.
    let mut views: BTreeMap<String, [View; 1]> = BTreeMap::new();
    for line in std::io::stdin().lock().lines() {
        let line = line.context("standard input broke")?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let (verb, trees, land, place, file) = match words[..] {
            [verb, trees, land, place] => (verb, trees, land, place, None),
            [verb, trees, land, place, file] => (verb, trees, land, place, Some(file)),
            _ => bail!("{line:?} is none of `frame TREES LAND PLACE`, `picture TREES LAND PLACE FILE`"),
        };
        let frame = frame_with(mode(trees)?, mode(land)?);
        let camera = place.parse().ok().and_then(|place: usize| cameras.get(place));
        let camera = camera.ok_or_else(|| anyhow!("there is no place {place}"))?;
        let view = views
            .entry(format!("{trees} {land}"))
            .or_insert_with(|| [headless.view(uploaded.clone(), args.size)]);
        let cost = Cost::of_frame(headless, view, &frame, camera);
        match (verb, file) {
            ("frame", None) => {}
            ("picture", Some(file)) => {
                let picture = image_file::read(&headless.gpu, &view[0].targets().display)?;
                image_file::write_png(Path::new(file), &picture)?;
            }
            _ => bail!("{line:?} asks for nothing that is known"),
        }
        say!("{}", json!({ "wall_ms": cost.wall_ms, "cpu_ms": cost.cpu_ms }));
    }
    Ok(())
}

/// An LOD mode by its name on the command line.
fn mode<M: ValueEnum>(word: &str) -> Result<M> {
    M::from_str(word, false).map_err(|error| anyhow!("{word:?} is no LOD mode: {error}"))
}
