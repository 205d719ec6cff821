//! Frames while a landscape is read and brought to the device by the window's own loader, and swapped in.

use std::sync::Arc;

use anyhow::{Result, anyhow};
use glam::Vec2;

use super::Bench;
use super::report::Aim;
use crate::load;
use crate::loader::{Loader, Request};
use crate::measure::{Cost, camera_path, median, quantile};
use crate::options::FrameInput;
use crate::upload::Uploader;

/// Frames before a landscape is asked for, and after it is shown.
const AROUND: usize = 15;
/// Frames on each side that a frame is compared with.
const NEIGHBOURS: usize = 10;
const SWAPS: usize = 4;

/// What a frame was drawn beside.
#[derive(Clone, Copy, PartialEq)]
enum Beside {
    Nothing,
    Loading,
    /// A landscape that it shows first.
    Swap,
}

pub(super) fn measure(bench: &mut Bench) -> Result<()> {
    bench.report.section(format!(
        "Swap of a landscape in one of four views: {SWAPS} swaps, milliseconds of the clock"
    ));
    parts(bench)?;
    let frames = swaps(bench)?;
    let all: Vec<f64> = frames.iter().map(|(_, ms)| *ms).collect();
    let times = |wanted| -> Vec<f64> {
        frames.iter().filter(|(beside, _)| *beside == wanted).map(|(_, ms)| *ms).collect()
    };
    let (quiet, loading) = (times(Beside::Nothing), times(Beside::Loading));
    let report = &mut bench.report;
    report.figure("quiet frames, median", median(&quiet), "ms");
    report.figure("quiet frames, worst against those around", worst(&quiet), "×");
    report.figure(format!("{} frames while one is loaded, median", loading.len()), median(&loading), "ms");
    report.figure("frames while one is loaded, worst", quantile(&loading, 1.0), "ms");
    report.figure("frame that shows it first, worst", quantile(&times(Beside::Swap), 1.0), "ms");
    report.aimed("worst frame against those around", worst(&all), "×", Aim::AtMost(1.5));
    Ok(())
}

/// All frames in their order, with their milliseconds.
fn swaps(bench: &Bench) -> Result<Vec<(Beside, f64)>> {
    let camera = camera_path(&bench.first_scene()?, 3)[1];
    let mut views = bench.four_views(bench.size_px, |scene| scene)?;
    let frame = FrameInput::default();
    let (loader, passes) = (Loader::start(&bench.headless.gpu, || {})?, &bench.headless.passes);
    let mut frames = Vec::new();
    bench.frame(&mut views, &frame, &camera);
    for swap in 0..SWAPS {
        for _ in 0..AROUND {
            frames.push((Beside::Nothing, bench.frame(&mut views, &frame, &camera).wall_ms));
        }
        // Each view gets the landscape of the next, by a loader that knows nothing of it yet.
        let path = bench.paths[(swap + 1) % bench.paths.len()].clone();
        let (eye_m, anchor) = (Vec2::ZERO, None);
        loader.ask(Request { view: swap, generation: 0, path, eye_m, anchor, passes: Arc::clone(passes) });
        let mut beside = Beside::Loading;
        while beside == Beside::Loading {
            let reply = loader.replies().next();
            let (cost, shown) = Cost::of(|| -> Result<()> {
                if let Some(reply) = reply {
                    let loaded = reply.result.map_err(|text| anyhow!(text))?;
                    views[reply.view % 4].show(passes, loaded.exhibit);
                    beside = Beside::Swap;
                }
                bench.frame(&mut views, &frame, &camera);
                Ok(())
            });
            shown?;
            frames.push((beside, cost.wall_ms));
        }
        for _ in 0..AROUND {
            frames.push((Beside::Nothing, bench.frame(&mut views, &frame, &camera).wall_ms));
        }
    }
    Ok(frames)
}

/// What the loader does for a landscape of which nothing is known yet, piece by piece. The device does one thing after
/// the other: a frame waits for what of this was submitted before it.
fn parts(bench: &mut Bench) -> Result<()> {
    let (gpu, passes) = (&bench.headless.gpu, &bench.headless.passes);
    let (reading, scene) = Cost::of(|| load::scene(&bench.paths[0], &load::Store::default()));
    let scene = scene?;
    let (uploading, buffers) = Cost::of(|| {
        let buffers = Uploader::new(gpu).upload(&scene);
        gpu.queue.submit([]);
        gpu.wait();
        buffers
    });
    let buffers = buffers.map_err(|text| anyhow!(text))?;
    let (shading, ()) = Cost::of(|| {
        passes.shadow.begin(gpu, passes, &buffers).all();
    });
    for (what, cost) in [
        ("alone: reading a landscape", reading),
        ("alone: bringing it to the device", uploading),
        ("alone: drawing its shadows", shading),
    ] {
        bench.report.figure(what, cost.wall_ms, "ms");
        bench.report.figure(format!("{what}, processors"), cost.cpu_ms, "ms");
    }
    Ok(())
}

/// The most that a frame takes as a multiple of the median of its neighbours.
fn worst(frames: &[f64]) -> f64 {
    let of_frame = |at: usize| {
        let from = at.saturating_sub(NEIGHBOURS);
        let to = (at + NEIGHBOURS + 1).min(frames.len());
        let around: Vec<f64> = frames[from..at].iter().chain(&frames[at + 1..to]).copied().collect();
        if around.is_empty() { 1.0 } else { frames[at] / median(&around) }
    };
    (0..frames.len()).map(of_frame).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_slow_frame_is_found_wherever_it_is_and_a_slow_stretch_is_none() {
        for slow in [0, 3, 29] {
            let mut frames = vec![10.0; 30];
            frames[slow] = 25.0;
            assert_eq!(worst(&frames), 2.5);
        }
        let stretch = [vec![10.0; 40], vec![14.0; 40]].concat();
        assert!(worst(&stretch) <= 1.4);
    }
}
