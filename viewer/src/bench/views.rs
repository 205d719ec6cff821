//! Four views in one frame against four frames of one view.

use std::path::PathBuf;

use anyhow::Result;

use super::BenchArgs;
use super::cost::Cost;
use super::forest::{camera_path, four_views};
use super::report::{Aim, Report, median};
use crate::frame::FrameInput;
use crate::headless::Headless;

/// Each picture is drawn so often; the cheapest counts.
const ROUNDS: usize = 3;

pub(super) fn measure(
    headless: &Headless,
    paths: &[PathBuf],
    args: &BenchArgs,
    report: &mut Report,
) -> Result<()> {
    let [width, height] = args.size;
    report.section(format!(
        "Four views, {width} × {height} together, against four single ones of the same size"
    ));
    let cameras = camera_path(&headless.read(&paths[0])?, args.steps);
    let mut views = four_views(headless, paths, args.size, None)?;
    let frame = FrameInput::default();
    Cost::of_frame(headless, &mut views, &frame, &cameras[0]);
    let (mut cpu, mut wall, mut together) = (Vec::new(), Vec::new(), Vec::new());
    for camera in &cameras {
        let infinite = Cost { wall_ms: f64::MAX, cpu_ms: f64::MAX };
        let (mut four, mut single) = (infinite, [infinite; 4]);
        for _ in 0..ROUNDS {
            four = four.least(Cost::of_frame(headless, &mut views, &frame, camera));
            for (view, least) in views.chunks_mut(1).zip(&mut single) {
                *least = least.least(Cost::of_frame(headless, view, &frame, camera));
            }
        }
        let sum: Cost = single.into_iter().sum();
        cpu.push(four.cpu_ms / sum.cpu_ms);
        wall.push(four.wall_ms / sum.wall_ms);
        together.push(four.cpu_ms);
    }
    report.figure("four views, processor, median of all places", median(&together), "ms a frame");
    report.aimed("four views / sum of four, processor, median", median(&cpu), "×", Aim::AtMost(1.05));
    report.aimed("four views / sum of four, clock, median", median(&wall), "×", Aim::AtMost(1.05));
    Ok(())
}
