//! What the processor does to have a picture drawn must not grow with the number of trees: they are chosen on the
//! device.

use std::path::PathBuf;

use anyhow::Result;

use super::BenchArgs;
use super::cost::Cost;
use super::forest::{camera_path, forest};
use super::report::{Aim, Report, median};
use crate::frame::FrameInput;
use crate::headless::Headless;

/// Trees of the two forests.
const TREES: [usize; 2] = [100, 100_000];
/// Pictures that are recorded but not drawn: as many as give a steady median.
const RECORDED: usize = 400;
/// Pictures that are drawn, too.
const DRAWN: usize = 8;
/// What recording costs does not depend on the size, but drawing does.
const SIZE_PX: [u32; 2] = [64, 48];

pub(super) fn measure(
    headless: &Headless,
    paths: &[PathBuf],
    args: &BenchArgs,
    report: &mut Report,
) -> Result<()> {
    report.section(format!(
        "Recording a picture of {} and of {} trees: milliseconds of this thread, median",
        TREES[0], TREES[1]
    ));
    let scene = headless.read(&paths[0])?;
    let cameras = camera_path(&scene, args.steps);
    let mut views = Vec::new();
    for count in TREES {
        views.push([headless.view(headless.upload(&forest(&scene, count))?, SIZE_PX)]);
    }
    let frame = FrameInput::default();
    let mut draws = 0;
    let (mut recorded, mut drawn) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
    for round in 0..RECORDED {
        let camera = &cameras[round % cameras.len()];
        for (view, times) in views.iter_mut().zip(&mut recorded) {
            let (ms, (commands, one)) = Cost::of_thread(|| headless.record(view, &frame, camera, camera));
            drop(commands);
            // Takes along what was written to buffers, lest it pile up.
            headless.gpu.queue.submit([]);
            times.push(ms);
            draws = draws.max(one.draws);
        }
        headless.gpu.wait();
    }
    for round in 0..DRAWN {
        let camera = &cameras[round % cameras.len()];
        for (view, times) in views.iter_mut().zip(&mut drawn) {
            let submit = || headless.gpu.queue.submit([headless.record(view, &frame, camera, camera).0]);
            times.push(Cost::of_thread(submit).0);
            headless.gpu.wait();
        }
    }
    let [few, many] = recorded.map(|times| median(&times));
    report.figure(format!("{} trees", TREES[0]), few, "ms");
    report.figure(format!("{} trees", TREES[1]), many, "ms");
    report.aimed("ratio", many / few, "×", Aim::AtMost(1.1));
    let [few, many] = drawn.map(|times| median(&times));
    report.figure(format!("{} trees, recorded and submitted", TREES[0]), few, "ms");
    report.figure(format!("{} trees, recorded and submitted", TREES[1]), many, "ms");
    report.figure("ratio, submission included", many / few, "×");
    report.aimed("draws a view", f64::from(draws), "", Aim::AtMost(10.0));
    Ok(())
}
