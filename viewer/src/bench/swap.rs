//! Frames while a landscape is read and brought to the device by the window's own loader, and swapped in.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::{Result, anyhow};

use super::BenchArgs;
use super::lab::{Cost, Lab, way};
use super::report::{Aim, Report, median, quantile};
use super::views::four_views;
use crate::app::loader::{Loader, Request};
use crate::frame::FrameInput;
use crate::load;
use crate::upload::Uploader;

/// Frames before a landscape is asked for, and after it is shown.
const AROUND: usize = 15;
/// Frames on each side that a frame is compared with.
const NEIGHBOURS: usize = 10;
/// Swaps.
const SWAPS: usize = 4;

pub(super) fn measure(lab: &Lab, paths: &[PathBuf], args: &BenchArgs, report: &mut Report) -> Result<()> {
    report.section(format!(
        "Swap of a landscape in one of four views: {SWAPS} swaps, milliseconds of the clock"
    ));
    let camera = way(&lab.load(&paths[0])?, 3)[1];
    let mut views = four_views(lab, paths, args.size)?;
    let frame = FrameInput::default();
    parts(lab, &paths[0], report)?;
    let loader = Loader::start(&lab.gpu, || {})?;
    let (mut all, mut quiet, mut loading, mut shown) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    lab.frame(&mut views, &frame, &camera);
    for swap in 0..SWAPS {
        for _ in 0..AROUND {
            quiet.push(lab.frame(&mut views, &frame, &camera).wall_ms);
            all.push(quiet[quiet.len() - 1]);
        }
        // Each view gets the landscape of the next, by a loader that knows nothing of it yet.
        let path = paths[(swap + 1) % paths.len()].clone();
        loader.ask(Request { view: swap, generation: 0, path, passes: Arc::clone(&lab.passes) });
        loop {
            let reply = loader.replies().next();
            let start = std::time::Instant::now();
            let arrived = reply.is_some();
            if let Some(reply) = reply {
                let ready = reply.result.map_err(|text| anyhow!(text))?;
                views[reply.view % 4].show(&lab.passes, ready.buffers);
            }
            lab.frame(&mut views, &frame, &camera);
            let ms = start.elapsed().as_secs_f64() * 1e3;
            all.push(ms);
            if arrived {
                shown.push(ms);
                break;
            }
            loading.push(ms);
        }
        for _ in 0..AROUND {
            quiet.push(lab.frame(&mut views, &frame, &camera).wall_ms);
            all.push(quiet[quiet.len() - 1]);
        }
    }
    report.figure("quiet frames, median", median(&quiet), "ms");
    report.figure("quiet frames, worst against those around", worst(&quiet), "×");
    report.figure(format!("{} frames while one is loaded, median", loading.len()), median(&loading), "ms");
    report.figure("frames while one is loaded, worst", quantile(&loading, 1.0), "ms");
    report.figure("frame that shows it first, worst", quantile(&shown, 1.0), "ms");
    report.aimed("worst frame against those around", worst(&all), "×", Aim::AtMost(1.5));
    Ok(())
}

/// What the loader does for a landscape of which nothing is known yet, piece by piece. The device does one thing after
/// the other: a frame waits for what of this was submitted before it.
fn parts(lab: &Lab, path: &std::path::Path, report: &mut Report) -> Result<()> {
    let (reading, scene) = Cost::of(|| load::load(path, &load::Store::default()));
    let scene = scene?;
    let (bringing, uploaded) = Cost::of(|| {
        let uploaded = Uploader::new(&lab.gpu).upload(&scene);
        lab.gpu.queue.submit([]);
        lab.gpu.wait();
        uploaded
    });
    let uploaded = uploaded.map_err(|text| anyhow!(text))?;
    let (shading, ()) = Cost::of(|| {
        lab.passes.shadow.bake(&lab.gpu, &lab.passes.layouts, &lab.passes.cull, &uploaded);
        lab.gpu.wait();
    });
    report.figure("alone: reading a landscape", reading.wall_ms, "ms");
    report.figure("alone: bringing it to the device", bringing.wall_ms, "ms");
    report.figure("alone: drawing its shadows", shading.wall_ms, "ms");
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
