//! The four pictures on the device: which landscape each shows, how large they are, how long they take.

use std::sync::Arc;
use std::time::Instant;

use anyhow::Result;
use egui::TextureId;
use egui_wgpu::Renderer;
use genescape_schema::INDIVIDUALS;
use image::RgbaImage;
use wgpu_profiler::{GpuProfiler, GpuProfilerSettings, GpuTimerQueryResult};

use super::camera_control::CameraControl;
use super::lod_readback::LodReadback;
use crate::gpu::Gpu;
use crate::image_file;
use crate::options::FrameInput;
use crate::passes::{Passes, ShaderError, Shaders};
use crate::scene_loader::Loaded;
use crate::ui::arrange::Slot;
use crate::ui::model::{PassTime, Stats};
use crate::upload::SceneBuffers;
use crate::view::View;
use crate::walk::Land;

/// Frames that statistics look back on.
const FRAMES: usize = 240;
/// Before the window has given a view its size.
const FIRST_SIZE_PX: [u32; 2] = [16, 16];
/// Names of the views for times on the device.
const LABELS: [&str; INDIVIDUALS] = ["view 1", "view 2", "view 3", "view 4"];

pub struct Viewports {
    gpu: Gpu,
    passes: Arc<Passes>,
    shaders: Shaders,
    views: [View; INDIVIDUALS],
    lands: [Option<Arc<Land>>; INDIVIDUALS],
    pictures: [Option<TextureId>; INDIVIDUALS],
    profiler: GpuProfiler,
    lod_readback: LodReadback,
    last_frame: Option<Instant>,
    stats: Stats,
}

impl Viewports {
    /// Compiles the passes; nothing is shown yet.
    pub fn new(gpu: &Gpu, shaders: Shaders, samples: u32) -> Result<Self> {
        let passes = Arc::new(Passes::new(gpu, &shaders, samples)?);
        let views = LABELS.map(|label| View::new(gpu, &passes, label, FIRST_SIZE_PX));
        Ok(Self {
            profiler: GpuProfiler::new(&gpu.device, GpuProfilerSettings::default())?,
            lod_readback: LodReadback::new(),
            stats: Stats { adapter: gpu.name.clone(), ..Stats::default() },
            gpu: gpu.clone(),
            passes,
            shaders,
            views,
            lands: Default::default(),
            pictures: Default::default(),
            last_frame: None,
        })
    }

    pub fn passes(&self) -> Arc<Passes> {
        self.passes.clone()
    }

    /// Times and counts.
    pub fn stats(&self) -> &Stats {
        &self.stats
    }

    /// What the user interface knows a picture by, if there is one.
    pub fn picture(&self, view: usize) -> Option<TextureId> {
        self.pictures[view].filter(|_| self.views[view].scene().is_some())
    }

    /// The landscape of a view.
    pub fn scene(&self, view: usize) -> Option<&Arc<SceneBuffers>> {
        self.views[view].scene()
    }

    /// The lands that a walker is in.
    pub fn lands(&self) -> Vec<&Land> {
        self.lands.iter().flatten().map(Arc::as_ref).collect()
    }

    /// What a walker meets in the landscape of a view.
    pub fn land(&self, view: usize) -> Option<&Land> {
        self.lands[view].as_deref()
    }

    /// Shows a landscape from the next frame on.
    pub fn show(&mut self, view: usize, loaded: Loaded) {
        self.views[view].show(&self.passes, loaded.buffers);
        self.lands[view] = Some(loaded.land);
    }

    /// Shows nothing any more.
    pub fn clear(&mut self) {
        self.views.iter_mut().for_each(View::clear);
        self.lands = Default::default();
    }

    /// The finished pictures of some views, copied from the device; views without a landscape are left out.
    pub fn pixels(&self, views: &[usize]) -> Result<Vec<RgbaImage>> {
        let shown = views.iter().filter(|view| self.views[**view].scene().is_some());
        shown.map(|&view| image_file::read(&self.gpu, &self.views[view].targets().display)).collect()
    }

    /// Compiles the shaders again; if one is wrong the last good ones go on.
    pub fn reload_shaders(&mut self, samples: u32) -> Result<(), ShaderError> {
        // What naga lets pass, a pipeline may still refuse: an entry point that is gone, say.
        let scope = self.gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let made = Passes::new(&self.gpu, &self.shaders, samples);
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(ShaderError::Refused { text: error.to_string() });
        }
        self.passes = Arc::new(made?);
        self.views.iter_mut().for_each(|view| view.adopt(&self.passes));
        Ok(())
    }

    /// Changes the number of samples a pixel, if it is another one.
    pub fn set_samples(&mut self, samples: u32) -> Result<(), ShaderError> {
        if samples == self.passes.samples { Ok(()) } else { self.reload_shaders(samples) }
    }

    /// Records the pictures that are on the screen.
    pub fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        painter: &mut Renderer,
        slots: &[Slot],
        frame: &FrameInput,
        control: &CameraControl,
    ) {
        let start = Instant::now();
        let fov_y_rad = frame.options.fov_y_deg.to_radians();
        self.stats.triangles = [0; INDIVIDUALS];
        self.stats.draws = [0; INDIVIDUALS];
        for slot in slots {
            let index = slot.view;
            let Some(land) = &self.lands[index] else { continue };
            let view = &mut self.views[index];
            if view.resize(&self.passes, slot.size_px) || self.pictures[index].is_none() {
                let picture = view.targets().display.create_view(&Default::default());
                register(&self.gpu, painter, &mut self.pictures[index], &picture);
            }
            let walker = control.rig.camera(land, fov_y_rad);
            let camera = if frame.options.overhead { land.overhead(fov_y_rad) } else { walker };
            let drawn = view.record(encoder, &self.passes, frame, &camera, &walker, &self.profiler);
            self.stats.draws[index] = drawn.draws;
            self.stats.triangles[index] = u64::from(drawn.land_triangles);
        }
        self.profiler.resolve_queries(encoder);
        self.stats.cpu_record_ms = start.elapsed().as_secs_f32() * 1e3;
    }

    /// After the frame was submitted: gathers what the device has measured of this and earlier ones.
    pub fn end_frame(&mut self) {
        let now = Instant::now();
        let frames_ms = &mut self.stats.frames_ms;
        frames_ms.extend(self.last_frame.replace(now).map(|last| (now - last).as_secs_f32() * 1e3));
        frames_ms.drain(..frames_ms.len().saturating_sub(FRAMES));
        for (index, view) in self.views.iter().enumerate().filter(|(view, _)| self.stats.draws[*view] > 0) {
            if let Some((set, counts)) = view.tree_counts() {
                self.lod_readback.request(&self.gpu, index, set, counts);
            }
        }
        // An error here means a lost device, which the next call reports.
        let _ = self.gpu.device.poll(wgpu::PollType::Poll);
        self.lod_readback.read(&mut self.stats);
        // A frame without queries is no fault.
        let _ = self.profiler.end_frame();
        while let Some(times) = self.profiler.process_finished_frame(self.gpu.queue.get_timestamp_period()) {
            self.stats.gpu = pass_times(&times);
        }
    }

    /// Time went by without pictures: the next frame's duration means nothing.
    pub fn pause(&mut self) {
        self.last_frame = None;
    }
}

fn register(gpu: &Gpu, painter: &mut Renderer, id: &mut Option<TextureId>, picture: &wgpu::TextureView) {
    let filter = wgpu::FilterMode::Nearest;
    match *id {
        Some(id) => painter.update_egui_texture_from_wgpu_texture(&gpu.device, picture, filter, id),
        None => *id = Some(painter.register_native_texture(&gpu.device, picture, filter)),
    }
}

/// Times by pass and view.
fn pass_times(views: &[GpuTimerQueryResult]) -> Vec<PassTime> {
    let mut passes: Vec<PassTime> = Vec::new();
    for view in views {
        let Some(index) = LABELS.iter().position(|label| *label == view.label) else { continue };
        for (name, ms) in timed(&view.nested_queries) {
            let at = passes.iter().position(|pass| pass.name == name).unwrap_or_else(|| {
                passes.push(PassTime { name, ms: [0.0; INDIVIDUALS] });
                passes.len() - 1
            });
            passes[at].ms[index] += ms;
        }
    }
    passes
}

/// Names and milliseconds; of a pass that is timed in parts, those of its parts.
fn timed(queries: &[GpuTimerQueryResult]) -> Vec<(String, f32)> {
    let of = |query: &GpuTimerQueryResult| {
        if query.nested_queries.iter().any(|part| part.time.is_some()) {
            return timed(&query.nested_queries);
        }
        let ms = query.time.as_ref().map(|time| ((time.end - time.start) * 1e3) as f32);
        ms.map(|ms| (query.label.clone(), ms)).into_iter().collect()
    };
    queries.iter().flat_map(of).collect()
}
