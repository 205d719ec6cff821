//! Four views in one frame against four frames of one view.

use anyhow::Result;

use super::Bench;
use super::report::Aim;
use crate::measure::{Cost, camera_path, median};
use crate::options::FrameInput;

/// Each picture is drawn so often; the cheapest counts.
const ROUNDS: usize = 3;

pub(super) fn measure(bench: &mut Bench) -> Result<()> {
    let [width, height] = bench.size_px;
    bench.report.section(format!(
        "Four views, {width} × {height} together, against four single ones of the same size"
    ));
    let cameras = camera_path(&bench.first_scene()?, bench.steps);
    let mut views = bench.four_views(bench.size_px, |scene| scene)?;
    let frame = FrameInput::default();
    bench.frame(&mut views, &frame, &cameras[0]);
    let (mut cpu, mut wall, mut together) = (Vec::new(), Vec::new(), [Vec::new(), Vec::new()]);
    for camera in &cameras {
        let (mut four, mut single) = (Cost::MAX, [Cost::MAX; 4]);
        for _ in 0..ROUNDS {
            four = four.least(bench.frame(&mut views, &frame, camera));
            for (view, least) in views.chunks_mut(1).zip(&mut single) {
                *least = least.least(bench.frame(view, &frame, camera));
            }
        }
        let sum: Cost = single.into_iter().sum();
        cpu.push(four.cpu_ms / sum.cpu_ms);
        wall.push(four.wall_ms / sum.wall_ms);
        together[0].push(four.cpu_ms);
        together[1].push(four.wall_ms);
    }
    let report = &mut bench.report;
    report.figure("four views, processor, median of all places", median(&together[0]), "ms a frame");
    report.figure("four views, clock, median of all places", median(&together[1]), "ms a frame");
    report.aimed("four views / sum of four, processor, median", median(&cpu), "×", Aim::AtMost(1.05));
    report.aimed("four views / sum of four, clock, median", median(&wall), "×", Aim::AtMost(1.05));
    Ok(())
}
