//! What levels of detail save, and what they cost in likeness: along the thesis's path (section 7), the same pictures
//! in every LOD mode. Error: root of the mean square difference over all pixels and channels, of 8-bit values taken as
//! [0, 1], from the picture without levels of detail. On a graphics card the clock counts, for it draws while processors
//! wait; where they draw themselves, their time does, which other programs disturb less.

use anyhow::Result;
use strum::VariantArray;

use super::report::{Aim, Report};
use super::{Bench, frame_with};
use crate::camera::Camera;
use crate::image_file;
use crate::lod_mode::{LodMode, TerrainLodMode, TreeLodMode};
use crate::measure::{Cost, camera_path, forest, square_error};
use crate::view::View;

/// Trees of the forest.
const TREES: usize = 1500;

/// LOD modes of trees and terrain that are compared.
type Modes = (TreeLodMode, TerrainLodMode);

const OFF: Modes = (TreeLodMode::Off, TerrainLodMode::Off);

/// First the reference, which has no levels of detail; then the defaults; then every other mode of the one with the
/// other's default.
fn cases() -> Vec<Modes> {
    let (trees, terrain) = Modes::default();
    let with_terrain = TreeLodMode::VARIANTS.iter().map(|&trees| (trees, terrain));
    let with_trees = TerrainLodMode::VARIANTS.iter().map(|&terrain| (trees, terrain));
    let others = with_terrain.chain(with_trees).filter(|&modes| modes != Modes::default());
    [OFF, Modes::default()].into_iter().chain(others).collect()
}

/// A case under way.
struct Run {
    modes: Modes,
    view: [View; 1],
    /// For each place the cheaper of there and back.
    costs: Vec<Cost>,
    errors: Vec<f64>,
}

impl Run {
    fn draw(&mut self, bench: &Bench, camera: &Camera) -> Cost {
        bench.frame(&mut self.view, &frame_with(self.modes.0, self.modes.1), camera)
    }

    fn mean_cost(&self) -> Cost {
        let (sum, places): (Cost, _) = (self.costs.iter().copied().sum(), self.costs.len() as f64);
        Cost { wall_ms: sum.wall_ms / places, cpu_ms: sum.cpu_ms / places }
    }
}

pub(super) fn measure(bench: &mut Bench) -> Result<()> {
    let [width, height] = bench.size_px;
    let mut ratios = Vec::new();
    for path in bench.paths.clone() {
        let scene = forest(&bench.headless.read(&path)?, TREES);
        let (name, trees) = (&scene.name, scene.trees.instances.len());
        bench.report.section(format!(
            "Levels of detail: {name}, {trees} trees, {width} × {height}, {} places there and back",
            bench.steps
        ));
        let uploaded = bench.headless.upload(&scene)?;
        let start = |modes| {
            let view = [bench.headless.view(uploaded.clone(), bench.size_px)];
            Run { modes, view, costs: Vec::new(), errors: Vec::new() }
        };
        let mut runs: Vec<Run> = cases().into_iter().map(start).collect();
        walk(bench, &mut runs, &camera_path(&scene, bench.steps))?;
        ratios.push(tell(&runs, bench.headless.gpu.software, &mut bench.report));
    }
    let report = &mut bench.report;
    report.section("Levels of detail pay, over all landscapes");
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    let by = told_by(bench.headless.gpu.software);
    report.aimed(format!("none at all / best, {by}, mean"), mean, "×", Aim::AtLeast(6.0));
    let least = ratios.iter().copied().fold(f64::MAX, f64::min);
    report.figure(format!("none at all / best, {by}, least"), least, "×");
    Ok(())
}

/// All cases in turn at each place, there and back.
fn walk(bench: &Bench, runs: &mut [Run], cameras: &[Camera]) -> Result<()> {
    for run in runs.iter_mut() {
        // Drivers finish pipelines at the first use.
        run.draw(bench, &cameras[0]);
    }
    for camera in cameras {
        let mut reference = Vec::new();
        for run in runs.iter_mut() {
            let cost = run.draw(bench, camera);
            run.costs.push(cost);
            let picture = image_file::read(&bench.headless.gpu, &run.view[0].targets().display)?.into_raw();
            if reference.is_empty() {
                reference = picture.clone();
            }
            run.errors.push(square_error(&picture, &reference));
        }
    }
    for (place, camera) in cameras.iter().enumerate().rev() {
        for run in runs.iter_mut() {
            run.costs[place] = run.costs[place].least(run.draw(bench, camera));
        }
    }
    Ok(())
}

/// What ratios are of, where a device draws in software and where not.
fn told_by(software: bool) -> &'static str {
    if software { "processor" } else { "clock" }
}

/// Reports the figures; what the default modes save.
fn tell(runs: &[Run], software: bool, report: &mut Report) -> f64 {
    let name = |(trees, terrain): Modes| {
        format!("trees {}, land {}", trees.label().to_lowercase(), terrain.label().to_lowercase())
    };
    for run in runs {
        let (name, cost) = (name(run.modes), run.mean_cost());
        report.figure(format!("{name}: processor"), cost.cpu_ms, "ms a frame");
        report.figure(format!("{name}: clock"), cost.wall_ms, "ms a frame");
    }
    for run in &runs[1..] {
        let (name, errors) = (name(run.modes), &run.errors);
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        report.figure(format!("{name}: L2 error"), mean.sqrt(), "of 1");
        let worst = errors.iter().copied().fold(0.0, f64::max);
        report.figure(format!("{name}: L2 error, worst place"), worst.sqrt(), "of 1");
    }
    let (trees, terrain) = Modes::default();
    let ms = |modes: Modes| {
        let cost = runs.iter().find(|run| run.modes == modes).map(Run::mean_cost);
        cost.map_or(f64::NAN, |cost| if software { cost.cpu_ms } else { cost.wall_ms })
    };
    let (pays, by) = (|without: Modes| ms(without) / ms((trees, terrain)), told_by(software));
    report.figure(format!("trees alone: none / default, {by}"), pays((TreeLodMode::Off, terrain)), "×");
    report.figure(format!("land alone: none / default, {by}"), pays((trees, TerrainLodMode::Off)), "×");
    report.aimed(format!("none at all / best, {by}"), pays(OFF), "×", Aim::AtLeast(6.0));
    pays(OFF)
}
