//! What levels of detail save, and what they cost in likeness: along the thesis's path (section 7), the same pictures
//! by every scheme. Error: root of the mean square difference over all pixels and channels, of 8-bit values taken as
//! [0, 1], from the picture without levels of detail.

use std::path::PathBuf;

use anyhow::Result;

use super::BenchArgs;
use super::lab::{Cost, Lab, forest, frame_with, way};
use super::report::{Aim, Report};
use crate::frame::{FrameInput, TerrainScheme, TreeScheme};
use crate::picture_file;
use crate::view::View;

/// Trees of the forest.
const TREES: usize = 1500;

/// Schemes by name; the first is what the others are compared with.
const SCHEMES: [(&str, TreeScheme, TerrainScheme); 7] = [
    ("none at all", TreeScheme::Off, TerrainScheme::Off),
    ("trees simple, land morphs", TreeScheme::Simple, TerrainScheme::Morph),
    ("trees by quality, land morphs", TreeScheme::Quality, TerrainScheme::Morph),
    ("trees discrete, land morphs", TreeScheme::Discrete, TerrainScheme::Morph),
    ("trees none, land morphs", TreeScheme::Off, TerrainScheme::Morph),
    ("trees simple, land by ROAM", TreeScheme::Simple, TerrainScheme::Roam),
    ("trees simple, land none", TreeScheme::Simple, TerrainScheme::Off),
];
/// What the viewer does unless told otherwise.
const BEST: usize = 1;
const TREES_NONE: usize = 4;
const LAND_NONE: usize = 6;

/// A scheme under way.
struct Run {
    view: [View; 1],
    frame: FrameInput,
    /// For each place the cheaper of there and back.
    costs: Vec<Cost>,
    errors: Vec<f64>,
}

pub(super) fn measure(lab: &Lab, paths: &[PathBuf], args: &BenchArgs, report: &mut Report) -> Result<()> {
    let [width, height] = args.size;
    let mut ratios = Vec::new();
    for path in paths {
        let scene = forest(&lab.load(path)?, TREES);
        report.section(format!(
            "Levels of detail: {}, {} trees, {width} × {height}, {} places there and back",
            scene.name,
            scene.trees.instances.len(),
            args.steps
        ));
        let uploaded = lab.upload(&scene)?;
        let start = |(_, trees, land)| Run {
            view: [lab.view(&uploaded, args.size)],
            frame: frame_with(trees, land),
            costs: Vec::new(),
            errors: Vec::new(),
        };
        let mut runs = SCHEMES.map(start);
        walk(lab, &mut runs, &way(&scene, args.steps))?;
        ratios.push(tell(&runs, report));
    }
    report.section("Levels of detail pay, over all landscapes");
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    report.aimed("none at all / best, processor time, mean", mean, "×", Aim::AtLeast(6.0));
    let least = ratios.iter().copied().fold(f64::MAX, f64::min);
    report.figure("none at all / best, processor time, least", least, "×");
    Ok(())
}

/// All schemes in turn at each place, there and back.
fn walk(lab: &Lab, runs: &mut [Run], cameras: &[crate::camera::Camera]) -> Result<()> {
    for run in runs.iter_mut() {
        // Drivers finish pipelines at the first use.
        lab.frame(&mut run.view, &run.frame, &cameras[0]);
    }
    for camera in cameras {
        let mut reference = Vec::new();
        for run in runs.iter_mut() {
            run.costs.push(lab.frame(&mut run.view, &run.frame, camera));
            let picture = picture_file::read(&lab.gpu, &run.view[0].targets().display)?.rgba;
            if reference.is_empty() {
                reference = picture.clone();
            }
            run.errors.push(square_error(&picture, &reference));
        }
    }
    for (place, camera) in cameras.iter().enumerate().rev() {
        for run in runs.iter_mut() {
            run.costs[place] = run.costs[place].least(lab.frame(&mut run.view, &run.frame, camera));
        }
    }
    Ok(())
}

/// Tells the figures; what the best scheme saves.
fn tell(runs: &[Run], report: &mut Report) -> f64 {
    let places = runs[0].costs.len() as f64;
    let means: Vec<Cost> = runs
        .iter()
        .map(|run| {
            let sum: Cost = run.costs.iter().copied().sum();
            Cost { wall_ms: sum.wall_ms / places, cpu_ms: sum.cpu_ms / places }
        })
        .collect();
    for ((name, ..), mean) in SCHEMES.iter().zip(&means) {
        report.figure(format!("{name}: processor"), mean.cpu_ms, "ms a frame");
        report.figure(format!("{name}: clock"), mean.wall_ms, "ms a frame");
    }
    for ((name, ..), run) in SCHEMES.iter().zip(runs).skip(1) {
        let mean = run.errors.iter().sum::<f64>() / places;
        report.figure(format!("{name}: L2 error"), mean.sqrt(), "of 1");
        let worst = run.errors.iter().copied().fold(0.0, f64::max);
        report.figure(format!("{name}: L2 error, worst place"), worst.sqrt(), "of 1");
    }
    let pays = |without: usize| means[without].cpu_ms / means[BEST].cpu_ms;
    report.figure("trees alone: none / simple, processor", pays(TREES_NONE), "×");
    report.figure("land alone: none / morphs, processor", pays(LAND_NONE), "×");
    report.aimed("none at all / best, processor", pays(0), "×", Aim::AtLeast(6.0));
    pays(0)
}

/// Mean square difference of colours.
fn square_error(a: &[u8], b: &[u8]) -> f64 {
    let colors = |rgba: &[u8]| [rgba[0], rgba[1], rgba[2]].map(|value| f64::from(value) / 255.0);
    let pixels = a.chunks_exact(4).zip(b.chunks_exact(4));
    let count = 3.0 * pixels.len() as f64;
    let of_pixel =
        |(a, b): (&[u8], &[u8])| colors(a).iter().zip(colors(b)).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
    pixels.map(of_pixel).sum::<f64>() / count.max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_black_for_white_is_one_and_transparency_counts_not() {
        let (black, white) = ([0, 0, 0, 9].repeat(50), [255, 255, 255, 200].repeat(50));
        assert_eq!(square_error(&black, &white), 1.0);
        assert_eq!(square_error(&white, &[255, 255, 255, 0].repeat(50)), 0.0);
        let one_channel = [255, 0, 0, 0].repeat(50);
        assert!((square_error(&black, &one_channel) - 1.0 / 3.0).abs() < 1e-12);
    }
}
