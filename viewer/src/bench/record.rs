//! What the processor does to have a picture drawn must not grow with the number of trees: they are chosen on the
//! device.

use anyhow::Result;

use super::Bench;
use super::report::Aim;
use crate::measure::{Cost, camera_path, forest, median};
use crate::options::FrameInput;

/// Trees of the two forests.
const TREES: [usize; 2] = [100, 100_000];
/// Pictures that are recorded but not drawn, each a few metres on from the last as for someone who flies: as many as give
/// a steady median.
const RECORDED: u32 = 400;
/// Pictures that are drawn, too.
const DRAWN: usize = 8;
/// What recording costs does not depend on the size, but drawing does.
const SIZE_PX: [u32; 2] = [64, 48];

pub(super) fn measure(bench: &mut Bench) -> Result<()> {
    let [few, many] = TREES;
    bench.report.section(format!(
        "Recording a picture of {few} and of {many} trees: milliseconds of this thread, median"
    ));
    let scene = bench.first_scene()?;
    let cameras = camera_path(&scene, RECORDED);
    let mut views = Vec::new();
    for count in TREES {
        views.push([bench.view(&forest(&scene, count), SIZE_PX)?]);
    }
    let (headless, frame) = (&bench.headless, FrameInput::default());
    let mut draws = 0;
    let (mut recorded, mut drawn) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
    for camera in &cameras {
        for (view, times) in views.iter_mut().zip(&mut recorded) {
            let (ms, (commands, one)) = Cost::of_thread(|| headless.record(view, &frame, camera, camera));
            drop(commands);
            // Flushes what was written to buffers, which would pile up otherwise.
            headless.gpu.queue.submit([]);
            times.push(ms);
            draws = draws.max(one.draws);
        }
        headless.gpu.wait();
    }
    for camera in &cameras[..DRAWN] {
        for (view, times) in views.iter_mut().zip(&mut drawn) {
            let submit = || headless.gpu.queue.submit([headless.record(view, &frame, camera, camera).0]);
            times.push(Cost::of_thread(submit).0);
            headless.gpu.wait();
        }
    }
    let ([few_ms, many_ms], report) = (recorded.map(|times| median(&times)), &mut bench.report);
    report.figure(format!("{few} trees"), few_ms, "ms");
    report.figure(format!("{many} trees"), many_ms, "ms");
    report.aimed("ratio", many_ms / few_ms, "×", Aim::AtMost(1.1));
    let [few_ms, many_ms] = drawn.map(|times| median(&times));
    report.figure(format!("{few} trees, recorded and submitted"), few_ms, "ms");
    report.figure(format!("{many} trees, recorded and submitted"), many_ms, "ms");
    report.figure("ratio, submission included", many_ms / few_ms, "×");
    report.aimed("draws a view", f64::from(draws), "", Aim::AtMost(10.0));
    Ok(())
}
