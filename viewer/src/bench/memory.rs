//! Whether drawing takes ever more memory: that of the process after many frames of a walk against after few.

use anyhow::Result;

use super::Bench;
use super::report::Aim;
use crate::measure::camera_path;
use crate::options::FrameInput;

/// Frames after which memory is looked at.
const FRAMES: [usize; 2] = [100, 2000];
/// Of the four views together: memory that grows does so in small pictures, too.
const SIZE_PX: [u32; 2] = [320, 200];

pub(super) fn measure(bench: &mut Bench) -> Result<()> {
    let [few, many] = FRAMES;
    bench.report.section(format!("Memory of the process after {few} and after {many} frames of four views"));
    let cameras = camera_path(&bench.first_scene()?, bench.steps);
    let mut views = bench.four_views(SIZE_PX, |scene| scene)?;
    let mut resident_mib = Vec::new();
    for (number, camera) in (1..=many).zip(cameras.iter().cycle()) {
        // Clouds drift and waves run, as in a walk: every picture is drawn from other numbers.
        let frame = FrameInput { time_s: number as f32 * 0.1, ..FrameInput::default() };
        bench.frame(&mut views, &frame, camera);
        if FRAMES.contains(&number) {
            resident_mib.extend(resident_memory_mib());
        }
    }
    let [before, after] = resident_mib[..] else {
        bench.report.note("not measured: this system does not tell in /proc/self/status");
        return Ok(());
    };
    bench.report.figure(format!("after {few} frames"), before, "MiB");
    bench.report.figure(format!("after {many} frames"), after, "MiB");
    bench.report.aimed("ratio", after / before, "×", Aim::AtMost(1.05));
    Ok(())
}

/// What of this process is in memory.
fn resident_memory_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib / 1024.0)
}
