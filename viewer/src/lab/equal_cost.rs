//! Errors at which schemes for trees cost the same, so that what they differ in is how they change levels, and where.

use anyhow::Result;
use serde::{Deserialize, Serialize};

use super::bench::{Bench, Run};
use super::experiment::{Experiment, SIMPLE};
use crate::camera::Camera;
use crate::lod_mode::TreeLodMode;
use crate::measure::{camera_path, tree_triangles};

/// Places of the path where triangles are counted.
const PLACES: u32 = 12;
/// Halvings of the range of errors.
const ROUNDS: u32 = 12;
/// Range of errors, in pixels.
const ERRORS_PX: [f32; 2] = [0.02, 60.0];

/// What a scheme was allowed, and what it then cost.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Allowed {
    pub scheme: String,
    pub error_px: f32,
    /// Of all trees in a picture, on average over some places of the path.
    pub triangles: f64,
}

/// For each scheme with levels, the error at which it draws as many triangles as the simple one at its usual error.
pub fn measure(bench: &Bench, experiment: &Experiment) -> Result<Vec<Allowed>> {
    let scene = bench.read(experiment.scene)?;
    let cameras = camera_path(&scene, PLACES);
    let mut runs = bench.runs(&scene, experiment)?;
    let mut wanted = 0.0;
    for run in runs.iter_mut().filter(|run| run.scheme.name == SIMPLE) {
        wanted = triangles(bench, run, &cameras)?;
    }
    let mut found = Vec::new();
    for run in runs.iter_mut().filter(|run| run.scheme.trees != TreeLodMode::Off) {
        if run.scheme.name != SIMPLE {
            let error_px = crossing(ERRORS_PX, ROUNDS, |error_px| {
                run.frame.options.tree_error_px = error_px;
                Ok(triangles(bench, run, &cameras)? > wanted)
            })?;
            run.frame.options.tree_error_px = error_px;
        }
        let triangles = triangles(bench, run, &cameras)?;
        let (scheme, error_px) = (run.scheme.name.to_owned(), run.frame.options.tree_error_px);
        found.push(Allowed { scheme, error_px, triangles });
        bench.bar.inc(1);
    }
    Ok(found)
}

/// Gives the schemes of an experiment the errors that were found.
pub fn apply(experiment: &mut Experiment, allowed: &[Allowed]) {
    for scheme in &mut experiment.schemes {
        if let Some(one) = allowed.iter().find(|one| one.scheme == scheme.name) {
            scheme.tree_error_px = one.error_px;
        }
    }
}

/// Where what is true at the lower end of a range ceases to be, by halving it by ratios.
fn crossing(
    [mut low, mut high]: [f32; 2],
    rounds: u32,
    mut holds: impl FnMut(f32) -> Result<bool>,
) -> Result<f32> {
    for _ in 0..rounds {
        let middle = (low * high).sqrt();
        if holds(middle)? { low = middle } else { high = middle }
    }
    Ok((low * high).sqrt())
}

/// Mean over some places.
fn triangles(bench: &Bench, run: &mut Run, cameras: &[Camera]) -> Result<f64> {
    let gpu = &bench.headless.gpu;
    let mut sum = 0;
    for camera in cameras {
        gpu.queue.submit([bench.headless.record(&mut run.view, &run.frame, camera, camera).0]);
        sum += tree_triangles(gpu, &run.view[0])?;
    }
    Ok(sum as f64 / cameras.len().max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_is_found_where_the_cost_falls_to_what_is_wanted() {
        for wanted in [0.03_f32, 0.7, 1.5, 44.0] {
            let found = crossing(ERRORS_PX, 30, |error| Ok(error < wanted)).expect("no device");
            assert!((found / wanted - 1.0).abs() < 1e-3, "{found} for {wanted}");
        }
    }
}
