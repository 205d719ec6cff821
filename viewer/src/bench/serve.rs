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
use serde_json::json;

use super::BenchArgs;
use super::lab::{Lab, frame_with, way};
use crate::camera::{Camera, NEAR_M};
use crate::frame::{TerrainScheme, TreeScheme};
use crate::picture_file;
use crate::say;
use crate::view::View;

pub(super) fn run(lab: &Lab, path: &Path, args: &BenchArgs) -> Result<()> {
    let scene = lab.load(path)?;
    let cameras = way(&scene, args.steps);
    let uploaded = lab.upload(&scene)?;
    let sky = &scene.sky;
    let told = |camera: &Camera| {
        json!({ "position_m": camera.position_m.to_array(), "yaw_rad": camera.yaw_rad,
                "pitch_rad": camera.pitch_rad, "fov_y_rad": camera.fov_y_rad })
    };
    let hello = json!({
        "device": lab.gpu.name, "software": lab.gpu.software, "size_px": args.size, "near_m": NEAR_M,
        "trees": scene.trees.instances.len(), "cameras": cameras.iter().map(told).collect::<Vec<_>>(),
        "sun_direction": sky.sun_direction, "sun_irradiance_linear": sky.sun_irradiance_linear,
        "sky_irradiance_linear": sky.sky_irradiance_linear, "haze_linear": sky.haze_linear,
        "haze_extinction_per_m": sky.haze_extinction_per_m, "exposure": sky.exposure,
    });
    say!("{hello}");
    // A view for each scheme: some go on from their last picture.
    let mut views: BTreeMap<String, [View; 1]> = BTreeMap::new();
    for line in std::io::stdin().lock().lines() {
        let line = line.context("standard input broke")?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let (verb, trees, land, place, file) = match words[..] {
            [verb, trees, land, place] => (verb, trees, land, place, None),
            [verb, trees, land, place, file] => (verb, trees, land, place, Some(file)),
            _ => bail!("{line:?} is none of `frame TREES LAND PLACE`, `picture TREES LAND PLACE FILE`"),
        };
        let frame = frame_with(tree_scheme(trees)?, terrain_scheme(land)?);
        let camera = place.parse().ok().and_then(|place: usize| cameras.get(place));
        let camera = camera.ok_or_else(|| anyhow!("there is no place {place}"))?;
        let view = views.entry(format!("{trees} {land}")).or_insert_with(|| [lab.view(&uploaded, args.size)]);
        let cost = lab.frame(view, &frame, camera);
        match (verb, file) {
            ("frame", None) => {}
            ("picture", Some(file)) => {
                let picture = picture_file::read(&lab.gpu, &view[0].targets().display)?;
                picture_file::write_png(Path::new(file), &picture)?;
            }
            _ => bail!("{line:?} asks for nothing that is known"),
        }
        say!("{}", json!({ "wall_ms": cost.wall_ms, "cpu_ms": cost.cpu_ms }));
    }
    Ok(())
}

fn tree_scheme(word: &str) -> Result<TreeScheme> {
    Ok(match word {
        "off" => TreeScheme::Off,
        "quality" => TreeScheme::Quality,
        "simple" => TreeScheme::Simple,
        "discrete" => TreeScheme::Discrete,
        _ => bail!("{word:?} is no scheme for trees"),
    })
}

fn terrain_scheme(word: &str) -> Result<TerrainScheme> {
    Ok(match word {
        "off" => TerrainScheme::Off,
        "morph" => TerrainScheme::Morph,
        "roam" => TerrainScheme::Roam,
        _ => bail!("{word:?} is no scheme for the land"),
    })
}
