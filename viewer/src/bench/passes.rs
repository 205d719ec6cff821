//! Where the device's time goes: that of each pass in the frames of a walk in four views, by timestamps. Beside the median
//! the worst: shade of near trees is drawn only every few metres.

use std::collections::BTreeMap;

use anyhow::Result;
use wgpu_profiler::{GpuProfiler, GpuProfilerSettings};

use super::Bench;
use super::card::{PLACES, SIZE_PX, TREES};
use crate::camera::Camera;
use crate::measure::{Cost, camera_path, forest, median, quantile, timed};
use crate::options::FrameInput;
use crate::scene::Scene;
use crate::view::View;

/// Frames for each step that is asked for: in the middle of the way that [`super::card`] goes.
const FRAMES: u32 = 8;

/// Milliseconds by name of the pass, all views together.
type Times = BTreeMap<String, f64>;

pub(super) fn measure(bench: &mut Bench) -> Result<()> {
    walk(bench, "as they are", |scene| scene)?;
    walk(bench, &format!("of {TREES} trees"), |scene| forest(&scene, TREES))
}

fn walk(bench: &mut Bench, what: &str, of: impl Fn(Scene) -> Scene) -> Result<()> {
    let ([width, height], frames) = (SIZE_PX, FRAMES * bench.steps);
    bench.report.section(format!(
        "The device's time by pass: {frames} frames of a walk, four landscapes {what}, {width} × {height} together"
    ));
    let mut profiler = GpuProfiler::new(&bench.headless.gpu.device, GpuProfilerSettings::default())?;
    let cameras = camera_path(&of(bench.first_scene()?), PLACES);
    let middle = &cameras[(PLACES.saturating_sub(frames) / 2) as usize..][..frames.min(PLACES) as usize];
    let mut views = bench.four_views(SIZE_PX, of)?;
    // Pipelines are finished first.
    frame(bench, &mut views, &mut profiler, &middle[0])?;
    let (mut costs, mut passes) = (Vec::new(), BTreeMap::<String, Vec<f64>>::new());
    for (number, camera) in middle.iter().enumerate() {
        let (cost, times) = frame(bench, &mut views, &mut profiler, camera)?;
        costs.push(cost);
        let all = times.values().sum();
        for (name, ms) in times.into_iter().chain([("all of them".to_owned(), all)]) {
            // In frames that it was not needed in it took no time.
            let known = passes.entry(name).or_default();
            known.resize(number, 0.0);
            known.push(ms);
        }
    }
    let report = &mut bench.report;
    for (name, mut times) in passes {
        times.resize(middle.len(), 0.0);
        report.figure(format!("{name}: median"), median(&times), "ms");
        report.figure(format!("{name}: worst"), quantile(&times, 1.0), "ms");
    }
    for (name, of) in [
        ("clock", (|cost: &Cost| cost.wall_ms) as fn(&Cost) -> f64),
        ("processor", |cost: &Cost| cost.cpu_ms),
    ] {
        let times: Vec<f64> = costs.iter().map(of).collect();
        report.figure(format!("frame, {name}: median"), median(&times), "ms");
        report.figure(format!("frame, {name}: worst"), quantile(&times, 1.0), "ms");
    }
    Ok(())
}

/// One picture of each view, waited for; no times where the device has no timestamps.
fn frame(
    bench: &Bench,
    views: &mut [View],
    profiler: &mut GpuProfiler,
    camera: &Camera,
) -> Result<(Cost, Times)> {
    let gpu = &bench.headless.gpu;
    let input = FrameInput::default();
    let (cost, ended) = Cost::of(|| {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for view in views {
            view.record(&mut encoder, &bench.headless.passes, &input, camera, camera, profiler);
        }
        profiler.resolve_queries(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        let ended = profiler.end_frame();
        gpu.wait();
        ended
    });
    ended?;
    let mut times = Times::new();
    while let Some(views) = profiler.process_finished_frame(gpu.queue.get_timestamp_period()) {
        for (name, ms) in views.iter().flat_map(|view| timed(&view.nested_queries)) {
            *times.entry(name).or_default() += f64::from(ms);
        }
    }
    Ok((cost, times))
}
