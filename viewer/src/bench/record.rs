//! What the processor does to have a picture drawn must not grow with the number of trees: they are chosen on the
//! device.

use std::path::PathBuf;

use anyhow::Result;

use super::BenchArgs;
use super::lab::{Cost, Lab, forest, way};
use super::report::{Aim, Report, median};
use crate::frame::FrameInput;

/// Trees of the two forests.
const TREES: [usize; 2] = [100, 100_000];
/// Pictures that are recorded but not drawn: as many as give a steady median.
const RECORDED: usize = 400;
/// Pictures that are drawn, too.
const DRAWN: usize = 8;
/// What recording costs does not depend on the size, but drawing does.
const SIZE_PX: [u32; 2] = [64, 48];

pub(super) fn measure(lab: &Lab, paths: &[PathBuf], args: &BenchArgs, report: &mut Report) -> Result<()> {
    report.section(format!(
        "Recording a picture of {} and of {} trees: milliseconds of this thread, median",
        TREES[0], TREES[1]
    ));
    let scene = lab.load(&paths[0])?;
    let cameras = way(&scene, args.steps);
    let mut views = Vec::new();
    for count in TREES {
        views.push([lab.view(&lab.upload(&forest(&scene, count))?, SIZE_PX)]);
    }
    let frame = FrameInput::default();
    let mut draws = 0;
    let (mut recorded, mut drawn) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
    for round in 0..RECORDED {
        let camera = &cameras[round % cameras.len()];
        for (view, times) in views.iter_mut().zip(&mut recorded) {
            let (ms, (commands, one)) = Cost::of_thread(|| lab.record(view, &frame, camera));
            drop(commands);
            // Takes along what was written to buffers, lest it pile up.
            lab.gpu.queue.submit([]);
            times.push(ms);
            draws = draws.max(one.draws);
        }
        lab.gpu.wait();
    }
    for round in 0..DRAWN {
        let camera = &cameras[round % cameras.len()];
        for (view, times) in views.iter_mut().zip(&mut drawn) {
            let submit = || lab.gpu.queue.submit([lab.record(view, &frame, camera).0]);
            times.push(Cost::of_thread(submit).0);
            lab.gpu.wait();
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
