//! The slowest frames of four large forests on a graphics card.

use std::path::PathBuf;

use anyhow::Result;

use super::BenchArgs;
use super::cost::Cost;
use super::forest::{camera_path, forest, four_views};
use super::report::{Aim, Report, median, quantile};
use crate::frame::FrameInput;
use crate::headless::Headless;

/// Trees of each landscape.
const TREES: usize = 10_000;
/// Of the four views together.
const SIZE_PX: [u32; 2] = [1920, 1080];
/// Places of the camera there, and as many back.
const PLACES: u32 = 600;

pub(super) fn measure(
    headless: &Headless,
    paths: &[PathBuf],
    _: &BenchArgs,
    report: &mut Report,
) -> Result<()> {
    let [width, height] = SIZE_PX;
    report.section(format!(
        "Four views of {TREES} trees each, {width} × {height} together, on a graphics card"
    ));
    if headless.gpu.software {
        report.note("not measured: this device draws in software");
        return Ok(());
    }
    let cameras = camera_path(&forest(&headless.read(&paths[0])?, TREES), PLACES);
    let mut views = four_views(headless, paths, SIZE_PX, Some(TREES))?;
    let frame = FrameInput::default();
    // Clocks rise and pipelines are finished first.
    for camera in &cameras {
        Cost::of_frame(headless, &mut views, &frame, camera);
    }
    let both_ways = cameras.iter().chain(cameras.iter().rev());
    let times: Vec<f64> =
        both_ways.map(|camera| Cost::of_frame(headless, &mut views, &frame, camera).wall_ms).collect();
    report.figure("median frame, waited for", median(&times), "ms");
    report.aimed("99th of 100 frames, waited for", quantile(&times, 0.99), "ms", Aim::AtMost(8.3));
    Ok(())
}
