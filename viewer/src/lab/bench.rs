//! What measurements work with: a device, the scenes, and one picture measured.

use anyhow::Result;
use indicatif::{ProgressBar, ProgressStyle};

use super::experiment::{Experiment, Scheme};
use super::scenes::{TestScene, TestScenes};
use crate::camera::Camera;
use crate::headless::Headless;
use crate::image_file;
use crate::measure::{Cost, Counted, Counters, tree_triangles};
use crate::options::FrameInput;
use crate::scene::Scene;
use crate::view::View;

/// Recording is repeated so often, for it is short; the least counts.
const RECORDED: usize = 3;

/// A device with all that measures on it.
pub struct Bench {
    pub headless: Headless,
    pub scenes: TestScenes,
    pub size_px: [u32; 2],
    pub counters: Counters,
    pub bar: ProgressBar,
}

/// A scheme with the view that it is drawn in, which goes on from frame to frame.
pub struct Run {
    pub scheme: Scheme,
    pub view: [View; 1],
    pub frame: FrameInput,
}

/// What one picture took.
#[derive(Clone, Copy, Debug, Default)]
pub struct Picture {
    pub cost: Cost,
    /// Milliseconds of the thread that records, without drawing.
    pub recording_ms: f64,
    pub counted: Counted,
    /// Triangles that were chosen.
    pub land_triangles: u64,
    pub tree_triangles: u64,
}

impl Bench {
    pub fn new(headless: Headless, scenes: TestScenes, size_px: [u32; 2]) -> Self {
        let counters = Counters::new(&headless.gpu);
        let style =
            ProgressStyle::with_template("{bar:32.green/dim} {pos}/{len} {elapsed:.dim}  {wide_msg:.dim}");
        let bar = ProgressBar::new(0);
        if let Ok(style) = style {
            bar.set_style(style.progress_chars("━━─"));
        }
        Self { headless, scenes, size_px, counters, bar }
    }

    pub fn read(&self, scene: TestScene) -> Result<Scene> {
        Ok(self.headless.read(self.scenes.path(scene))?.without_far_trees())
    }

    /// A run for each scheme of an experiment, all of one scene on the device.
    pub fn runs(&self, scene: &Scene, experiment: &Experiment) -> Result<Vec<Run>> {
        let uploaded = self.headless.upload(scene)?;
        let run = |scheme: &Scheme| {
            let mut view = self.headless.view(uploaded.clone(), self.size_px);
            self.counters.watch(&mut view);
            let options = scheme.options(experiment.objects);
            let frame = FrameInput { options, ..FrameInput::default() };
            Run { scheme: scheme.clone(), view: [view], frame }
        };
        Ok(experiment.schemes.iter().map(run).collect())
    }

    /// Draws one picture, waits for it, and tells what it took.
    pub fn measure(&self, run: &mut Run, camera: &Camera) -> Result<Picture> {
        let (headless, counters) = (&self.headless, &self.counters);
        let Run { view: [view], frame, .. } = run;
        let (cost, drawn) = Cost::of(|| {
            let mut encoder = headless.gpu.device.create_command_encoder(&Default::default());
            counters.begin(&mut encoder);
            let drawn = headless.record_into(&mut encoder, view, frame, camera, camera);
            counters.end(&mut encoder);
            headless.gpu.queue.submit([encoder.finish()]);
            headless.gpu.wait();
            drawn
        });
        let (counted, tree_triangles) = (counters.read(&headless.gpu)?, tree_triangles(&headless.gpu, view)?);
        let recorded = (0..RECORDED).map(|_| {
            let (ms, commands) =
                Cost::of_thread(|| headless.record(std::slice::from_mut(view), frame, camera, camera));
            drop(commands);
            // Flushes what was written to buffers, which would pile up otherwise.
            headless.gpu.queue.submit([]);
            ms
        });
        let recording_ms = recorded.fold(f64::MAX, f64::min);
        headless.gpu.wait();
        let land_triangles = if frame.options.draw_terrain { u64::from(drawn.triangles) } else { 0 };
        let tree_triangles = if frame.options.draw_trees { tree_triangles } else { 0 };
        Ok(Picture { cost, recording_ms, counted, land_triangles, tree_triangles })
    }

    /// The last picture of a run.
    pub fn fetch(&self, run: &Run) -> Result<Vec<u8>> {
        Ok(image_file::read(&self.headless.gpu, &run.view[0].targets().display)?.into_raw())
    }

    /// Draws what `camera` sees of the levels that `lod_camera` calls for, and fetches it.
    pub fn shoot(&self, run: &mut Run, camera: &Camera, lod_camera: &Camera) -> Result<Vec<u8>> {
        let Run { view: [view], frame, .. } = run;
        Ok(self.headless.shoot(view, frame, camera, lod_camera)?.into_raw())
    }
}
