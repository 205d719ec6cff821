//! The slowest frames of four large forests on a graphics card.

use anyhow::Result;

use super::Bench;
use super::report::Aim;
use crate::measure::{camera_path, forest, median, quantile};
use crate::options::FrameInput;

/// Trees of each landscape.
pub(super) const TREES: usize = 10_000;
/// Of the four views together.
pub(super) const SIZE_PX: [u32; 2] = [1920, 1080];
/// Places of the camera there, and as many back.
pub(super) const PLACES: u32 = 600;
/// Frames before that, at its first places.
const WARMING: usize = 60;

pub(super) fn measure(bench: &mut Bench) -> Result<()> {
    let [width, height] = SIZE_PX;
    bench.report.section(format!(
        "Four views of {TREES} trees each, {width} × {height} together, on a graphics card"
    ));
    if bench.headless.gpu.software {
        bench.report.note("not measured: this device draws in software");
        return Ok(());
    }
    let cameras = camera_path(&forest(&bench.first_scene()?, TREES), PLACES);
    let mut views = bench.four_views(SIZE_PX, |scene| forest(&scene, TREES))?;
    let frame = FrameInput::default();
    // Clocks rise and pipelines are finished first.
    for camera in &cameras[..WARMING] {
        bench.frame(&mut views, &frame, camera);
    }
    let both_ways = cameras.iter().chain(cameras.iter().rev());
    let times: Vec<f64> = both_ways.map(|camera| bench.frame(&mut views, &frame, camera).wall_ms).collect();
    bench.report.figure("median frame, waited for", median(&times), "ms");
    bench.report.aimed("99th of 100 frames, waited for", quantile(&times, 0.99), "ms", Aim::AtMost(8.3));
    Ok(())
}
