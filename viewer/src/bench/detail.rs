//! What levels of detail save, and what they cost in likeness: along the thesis's path (section 7), the same pictures
//! in every LOD mode. Error: root of the mean square difference over all pixels and channels, of 8-bit values taken as
//! [0, 1], from the picture without levels of detail.

use std::path::PathBuf;

use anyhow::Result;
use strum::VariantArray;

use super::BenchArgs;
use super::lab::{Cost, Lab, forest, frame_with, way};
use super::report::{Aim, Report};
use crate::frame::FrameInput;
use crate::lod_mode::{LodMode, TerrainLodMode, TreeLodMode};
use crate::picture_file;
use crate::view::View;

/// Trees of the forest.
const TREES: usize = 1500;

/// The LOD modes of trees and terrain that are compared, and what the report calls them.
struct Case {
    name: String,
    trees: TreeLodMode,
    terrain: TerrainLodMode,
}

/// The reference, which has no levels of detail; then the defaults; then every other mode of the one with the other's
/// default.
fn cases() -> Vec<Case> {
    let case = |trees: TreeLodMode, terrain: TerrainLodMode| {
        let name = format!("trees {}, land {}", trees.label().to_lowercase(), terrain.label().to_lowercase());
        Case { name, trees, terrain }
    };
    let (trees, terrain) = (TreeLodMode::default(), TerrainLodMode::default());
    let other_trees = TreeLodMode::VARIANTS.iter().filter(|&&other| other != trees);
    let other_terrain = TerrainLodMode::VARIANTS.iter().filter(|&&other| other != terrain);
    [case(TreeLodMode::Off, TerrainLodMode::Off), case(trees, terrain)]
        .into_iter()
        .chain(other_trees.map(|&other| case(other, terrain)))
        .chain(other_terrain.map(|&other| case(trees, other)))
        .collect()
}

/// A case under way.
struct Run {
    case: Case,
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
        let start = |case: Case| Run {
            view: [lab.view(&uploaded, args.size)],
            frame: frame_with(case.trees, case.terrain),
            costs: Vec::new(),
            errors: Vec::new(),
            case,
        };
        let mut runs: Vec<Run> = cases().into_iter().map(start).collect();
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

/// All cases in turn at each place, there and back.
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

/// Tells the figures; what the default modes save.
fn tell(runs: &[Run], report: &mut Report) -> f64 {
    let places = runs[0].costs.len() as f64;
    let means: Vec<Cost> = runs
        .iter()
        .map(|run| {
            let sum: Cost = run.costs.iter().copied().sum();
            Cost { wall_ms: sum.wall_ms / places, cpu_ms: sum.cpu_ms / places }
        })
        .collect();
    for (Run { case: Case { name, .. }, .. }, mean) in runs.iter().zip(&means) {
        report.figure(format!("{name}: processor"), mean.cpu_ms, "ms a frame");
        report.figure(format!("{name}: clock"), mean.wall_ms, "ms a frame");
    }
    for run in &runs[1..] {
        let name = &run.case.name;
        let mean = run.errors.iter().sum::<f64>() / places;
        report.figure(format!("{name}: L2 error"), mean.sqrt(), "of 1");
        let worst = run.errors.iter().copied().fold(0.0, f64::max);
        report.figure(format!("{name}: L2 error, worst place"), worst.sqrt(), "of 1");
    }
    let (trees, terrain) = (TreeLodMode::default(), TerrainLodMode::default());
    let cpu_ms = |trees: TreeLodMode, terrain: TerrainLodMode| {
        let at = runs.iter().position(|run| (run.case.trees, run.case.terrain) == (trees, terrain));
        at.map_or(f64::NAN, |at| means[at].cpu_ms)
    };
    let pays =
        |without_trees, without_terrain| cpu_ms(without_trees, without_terrain) / cpu_ms(trees, terrain);
    report.figure("trees alone: none / default, processor", pays(TreeLodMode::Off, terrain), "×");
    report.figure("land alone: none / default, processor", pays(trees, TerrainLodMode::Off), "×");
    let both = pays(TreeLodMode::Off, TerrainLodMode::Off);
    report.aimed("none at all / best, processor", both, "×", Aim::AtLeast(6.0));
    both
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
