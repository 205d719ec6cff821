//! The slowest frames of four large forests on a graphics card.

use std::path::PathBuf;

use anyhow::Result;

use super::BenchArgs;
use super::lab::{Lab, forest, way};
use super::report::{Aim, Report, median, quantile};
use crate::frame::FrameInput;

/// Trees of each landscape.
const TREES: usize = 10_000;
/// Of the four views together.
const SIZE_PX: [u32; 2] = [1920, 1080];
/// Places of the camera there, and as many back.
const PLACES: u32 = 600;

pub(super) fn measure(lab: &Lab, paths: &[PathBuf], _: &BenchArgs, report: &mut Report) -> Result<()> {
    let [width, height] = SIZE_PX;
    report.section(format!(
        "Four views of {TREES} trees each, {width} × {height} together, on a graphics card"
    ));
    if lab.gpu.software {
        report.note("not measured: this device draws in software");
        return Ok(());
    }
    let mut views = Vec::new();
    let mut cameras = Vec::new();
    for path in paths.iter().cycle().take(4) {
        let scene = forest(&lab.load(path)?, TREES);
        if cameras.is_empty() {
            cameras = way(&scene, PLACES);
        }
        views.push(lab.view(&lab.upload(&scene)?, SIZE_PX.map(|side| side / 2)));
    }
    let frame = FrameInput::default();
    // Clocks rise and pipelines are finished first.
    for camera in &cameras {
        lab.frame(&mut views, &frame, camera);
    }
    let both_ways = cameras.iter().chain(cameras.iter().rev());
    let times: Vec<f64> = both_ways.map(|camera| lab.frame(&mut views, &frame, camera).wall_ms).collect();
    report.figure("median frame, waited for", median(&times), "ms");
    report.aimed("99th of 100 frames, waited for", quantile(&times, 0.99), "ms", Aim::AtMost(8.3));
    Ok(())
}
