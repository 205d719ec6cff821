//! Frame times, triangles and quality along the thesis's path (figures 21 to 23, 25, 26, 28).

use anyhow::Result;
use serde::{Deserialize, Serialize};

use super::bench::{Bench, Picture, Run};
use super::experiment::Experiment;
use crate::camera::Camera;
use crate::measure::{Cost, camera_path, flip, l2};
use crate::options::FrameInput;

/// One frame of one scheme.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    pub scheme: String,
    /// From 0; the second half leads back.
    pub frame: u32,
    /// Metres along the path from its middle.
    pub place_m: f64,
    /// On the clock, waited for.
    pub frame_ms: f64,
    /// Of processors, all threads together.
    pub processor_ms: f64,
    /// Of the thread that records, without drawing: the thesis's "CPU only".
    pub recording_ms: f64,
    pub gpu_ms: Option<f64>,
    pub land_triangles: u64,
    pub tree_triangles: u64,
    /// As the device counted them in all of the picture.
    pub drawn_triangles: Option<u64>,
    pub vertices: Option<u64>,
    pub fragments: Option<u64>,
    /// How far from the reference's picture, on the way there.
    pub l2: Option<f64>,
    pub flip: Option<f64>,
}

impl Frame {
    /// All triangles that were chosen.
    pub fn triangles(&self) -> f64 {
        (self.land_triangles + self.tree_triangles) as f64
    }
}

/// Walks there and back, all schemes in turn at each place. `reference_back`: whether the reference, too, is timed on the
/// way back.
pub fn measure(
    bench: &Bench,
    experiment: &Experiment,
    steps: u32,
    reference_back: bool,
) -> Result<Vec<Frame>> {
    let scene = bench.read(experiment.scene)?;
    let cameras = camera_path(&scene, steps);
    let half_m = 0.25 * f64::from(scene.ground.field.extent_m());
    let mut runs = bench.runs(&scene, experiment)?;
    for run in &mut runs {
        // Drivers finish pipelines at the first use.
        bench.measure(run, &cameras[0])?;
    }
    let mut frames = Vec::new();
    let back = (0..steps as usize).rev();
    for (frame, place) in (0..steps as usize).chain(back).enumerate() {
        let is_there = frame < steps as usize;
        let place_m = half_m * (2.0 * place as f64 / f64::from(steps - 1).max(1.0) - 1.0);
        let mut reference = Vec::new();
        for (number, run) in runs.iter_mut().enumerate() {
            if number == 0 && !is_there && !reference_back {
                continue;
            }
            let picture = bench.measure(run, &cameras[place])?;
            let mut measured = row(run, frame as u32, place_m, picture);
            if is_there {
                let picture = bench.fetch(run)?;
                if number == 0 {
                    reference = picture;
                } else {
                    measured.l2 = Some(l2(&reference, &picture));
                    measured.flip = Some(flip(&reference, &picture, bench.size_px[0]));
                }
            }
            frames.push(measured);
        }
        bench.bar.inc(1);
    }
    Ok(frames)
}

fn row(run: &Run, frame: u32, place_m: f64, picture: Picture) -> Frame {
    let Picture { cost, recording_ms, counted, land_triangles, tree_triangles } = picture;
    Frame {
        scheme: run.scheme.name.to_owned(),
        frame,
        place_m,
        frame_ms: cost.wall_ms,
        processor_ms: cost.cpu_ms,
        recording_ms,
        gpu_ms: counted.gpu_ms,
        land_triangles,
        tree_triangles,
        drawn_triangles: counted.triangles,
        vertices: counted.vertices,
        fragments: counted.fragments,
        l2: None,
        flip: None,
    }
}

/// What one picture of all four views together takes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FourViews {
    /// From 0; the second half leads back.
    pub frame: u32,
    pub frame_ms: f64,
    pub processor_ms: f64,
}

/// Walks through the scenes of figure 28 at once, as the window does, there and back.
pub fn four_views(bench: &Bench, steps: u32) -> Result<Vec<FourViews>> {
    let experiments = Experiment::of_all();
    let (mut views, mut cameras) = (Vec::new(), Vec::<Camera>::new());
    for experiment in &experiments {
        let scene = bench.read(experiment.scene)?;
        if cameras.is_empty() {
            cameras = camera_path(&scene, steps);
        }
        views.push(bench.headless.view(bench.headless.upload(&scene)?, bench.size_px));
    }
    let frame = FrameInput::default();
    Cost::of_frame(&bench.headless, &mut views, &frame, &cameras[0]);
    let both_ways = cameras.iter().chain(cameras.iter().rev());
    let row = |(number, camera): (u32, &Camera)| {
        let taken = Cost::of_frame(&bench.headless, &mut views, &frame, camera);
        bench.bar.inc(1);
        FourViews { frame: number, frame_ms: taken.wall_ms, processor_ms: taken.cpu_ms }
    };
    Ok((0..).zip(both_ways).map(row).collect())
}
