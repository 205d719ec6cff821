//! The four pictures on the device: which landscape each shows, how large they are, how long they take.

use std::sync::Arc;
use std::time::Instant;

use anyhow::Result;
use egui::TextureId;
use genescape_schema::INDIVIDUALS;
use image::RgbaImage;
use wgpu_profiler::{GpuProfiler, GpuProfilerSettings, GpuTimerQueryResult};

use super::camera_control::CameraControl;
use super::lod_readback::LodReadback;
use super::pace::Shown;
use super::sharpness::{Before, Sharpness};
use super::ui_painter::UiPainter;
use super::viewport::Viewport;
use crate::gpu::Gpu;
use crate::image_file;
use crate::measure::timed;
use crate::options::FrameInput;
use crate::passes::{Passes, ShaderError, Shaders, pictures};
use crate::scene_loader::Loaded;
use crate::ui::arrange::Slot;
use crate::ui::model::{PassTime, Stats};
use crate::upload::{Exhibit, SceneBuffers};
use crate::walk::{Anchor, Land, anchor_for};

/// Frames that statistics look back on.
const FRAMES: usize = 240;
/// Names of the views for times on the device.
const LABELS: [&str; INDIVIDUALS] = ["view 1", "view 2", "view 3", "view 4"];

/// What is wanted of the pictures of one frame.
pub struct Wish {
    pub frame: FrameInput,
    pub sharpness: Sharpness,
    /// Where no picture has to be drawn, one becomes finer.
    pub refines: bool,
    /// Those whose landscape another is about to replace: only what the camera's motion demands is drawn of them.
    pub outdated: [bool; INDIVIDUALS],
}

pub struct Viewports {
    gpu: Gpu,
    passes: Arc<Passes>,
    shaders: Shaders,
    each: [Viewport; INDIVIDUALS],
    profiler: GpuProfiler,
    lod_readback: LodReadback,
    last_frame: Option<Instant>,
    /// Whether trees were counted in the last frame.
    counts_trees: bool,
    stats: Stats,
}

impl Viewports {
    /// Compiles the passes; nothing is shown yet.
    pub fn new(gpu: &Gpu, shaders: Shaders, samples: u32) -> Result<Self> {
        let passes = Arc::new(Passes::new(gpu, &shaders, samples)?);
        let each = std::array::from_fn(|view| Viewport::new(gpu, &passes, view, LABELS[view]));
        Ok(Self {
            profiler: GpuProfiler::new(&gpu.device, GpuProfilerSettings::default())?,
            lod_readback: LodReadback::new(),
            stats: Stats { adapter: gpu.name.clone(), ..Stats::default() },
            gpu: gpu.clone(),
            passes,
            shaders,
            each,
            last_frame: None,
            counts_trees: false,
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
        self.each[view].picture()
    }

    /// What a view shows.
    pub fn exhibit(&self, view: usize) -> Option<&Exhibit> {
        self.each[view].view.exhibit()
    }

    /// The lands that a walker is in.
    pub fn lands(&self) -> Vec<&Land> {
        self.each.iter().filter_map(|one| one.land.as_deref()).collect()
    }

    /// What a walker meets in the landscape of a view.
    pub fn land(&self, view: usize) -> Option<&Land> {
        self.each[view].land.as_deref()
    }

    /// Shows a landscape from the next frame on.
    pub fn show(&mut self, view: usize, loaded: Loaded, generation: u32) {
        let of_generation = self.each.iter().filter(|one| one.anchor(generation).is_some());
        let others: Vec<&Land> = of_generation.filter_map(|one| one.land.as_deref()).collect();
        let anchor = anchor_for(&loaded.land, self.anchor(view, generation), &others);
        self.each[view].show(&self.passes, loaded, generation, anchor);
    }

    /// Where the walk lies in a landscape of that generation, if that is known.
    pub fn anchor(&self, view: usize, generation: u32) -> Option<Anchor> {
        self.each[view].anchor(generation)
    }

    /// Lays the walk where each landscape looks best now.
    pub fn anchor_anew(&mut self) {
        for view in 0..self.each.len() {
            let (before, [one, ..]) = self.each.split_at_mut(view) else { return };
            let others: Vec<&Land> = before.iter().filter_map(|one| one.land.as_deref()).collect();
            let anchor = one.land.as_ref().map(|land| anchor_for(land, None, &others));
            anchor.into_iter().for_each(|anchor| one.anchor_at(anchor));
        }
    }

    /// Landscapes whose shadows are to be asked for, each once.
    pub fn ask_for_shadows(&mut self) -> Vec<Arc<SceneBuffers>> {
        self.each.iter_mut().filter_map(Viewport::ask_for_shadows).collect()
    }

    /// A landscape has got all of its shadows.
    pub fn shadowed(&mut self, buffers: &Arc<SceneBuffers>) {
        self.each.iter_mut().for_each(|one| one.shadowed(buffers));
    }

    /// Some landscape will look different when it has got all of its shadows.
    pub fn awaits_shadows(&self) -> bool {
        self.each.iter().any(Viewport::lacks_shadows)
    }

    /// Shows nothing any more.
    pub fn clear(&mut self) {
        self.each.iter_mut().for_each(Viewport::clear);
    }

    /// The finished pictures of some views, copied from the device; views without a landscape are left out.
    pub fn pixels(&self, views: &[usize]) -> Result<Vec<RgbaImage>> {
        let shown = views.iter().map(|view| &self.each[*view].view).filter(|view| view.exhibit().is_some());
        shown.map(|view| image_file::read(&self.gpu, &view.targets().display)).collect()
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
        self.each.iter_mut().for_each(|one| one.adopt(&self.passes));
        Ok(())
    }

    /// Changes the number of samples a pixel, if it is another one.
    pub fn set_samples(&mut self, samples: u32) -> Result<(), ShaderError> {
        if samples == self.passes.samples { Ok(()) } else { self.reload_shaders(samples) }
    }

    /// Records the pictures that are on the screen and not yet as they should be; what came of it.
    pub fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        painter: &mut UiPainter,
        slots: &[Slot],
        wish: &Wish,
        control: &CameraControl,
    ) -> Shown {
        let Wish { frame, sharpness, outdated, .. } = wish;
        let start = Instant::now();
        let mut shown = Shown::default();
        (self.stats.triangles, self.stats.draws) = Default::default();
        self.each.iter_mut().for_each(|one| one.fresh = false);
        let mut sharpened = false;
        for slot in slots {
            let one = &mut self.each[slot.view];
            let Some(wanted) = one.wanted(frame, control) else { continue };
            let is_outdated = outdated[slot.view] && one.shows_anything();
            let before = Before { part: one.part, is_right: one.shows(&wanted), is_outdated };
            let part = sharpness.of(before, &mut sharpened);
            one.fit(&self.passes, painter, slot.size_px, part.unwrap_or(one.part));
            // Unless the window has got another size, which leaves nothing of what was there.
            let stays = part.is_none() && one.shows_anything();
            if !stays && !one.shows(&wanted) {
                one.record(encoder, &self.passes, wanted, &self.profiler);
            }
            shown.blurred |= part.is_some_and(|part| part < 1.0);
            shown.drawn |= one.fresh;
            self.stats.draws[slot.view] = one.drawn.draws;
            self.stats.triangles[slot.view] = u64::from(one.drawn.triangles);
        }
        if wish.refines && !shown.drawn {
            shown.drawn = self.refine(encoder, slots, frame, control);
        }
        shown.rough = frame.options.refine && slots.iter().any(|slot| self.is_rough(slot.view));
        self.profiler.resolve_queries(encoder);
        self.stats.cpu_record_ms = start.elapsed().as_secs_f32() * 1e3;
        shown
    }

    /// Makes that picture finer which is the least fine: one a frame, so that none takes long. Whether there was any.
    fn refine(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        slots: &[Slot],
        frame: &FrameInput,
        control: &CameraControl,
    ) -> bool {
        let rough = slots.iter().map(|slot| slot.view).filter(|view| self.is_rough(*view));
        let Some(view) = rough.min_by_key(|view| self.each[*view].accumulated) else { return false };
        let one = &mut self.each[view];
        let Some(wanted) = one.wanted(frame, control).filter(|wanted| one.shows(wanted)) else {
            return false;
        };
        one.record(encoder, &self.passes, wanted, &self.profiler);
        true
    }

    /// Whether a view's picture may become finer.
    fn is_rough(&self, view: usize) -> bool {
        let one = &self.each[view];
        one.part >= 1.0 && one.shows_anything() && one.accumulated < pictures(self.passes.samples)
    }

    /// After the frame was submitted: gathers what the device has measured of this and earlier ones. Trees are counted only
    /// where somebody looks, for each count is copied and waited for.
    pub fn end_frame(&mut self, counts_trees: bool) {
        let now = Instant::now();
        let frames_ms = &mut self.stats.frames_ms;
        frames_ms.extend(self.last_frame.replace(now).map(|last| (now - last).as_secs_f32() * 1e3));
        frames_ms.drain(..frames_ms.len().saturating_sub(FRAMES));
        let begins = counts_trees && !std::mem::replace(&mut self.counts_trees, counts_trees);
        let counted = |one: &Viewport| counts_trees && (begins || one.fresh);
        for (index, one) in self.each.iter().enumerate().filter(|(_, one)| counted(one)) {
            if let Some((set, counts)) = one.view.tree_counts() {
                self.lod_readback.request(&self.gpu, index, set, counts);
            }
        }
        // An error here means a lost device, which the next call reports.
        let _ = self.gpu.device.poll(wgpu::PollType::Poll);
        self.lod_readback.read(&mut self.stats);
        for one in self.each.iter().filter(|one| one.land.is_some()) {
            self.stats.add_copies(&one.drawn.copies_by_level);
        }
        // A frame without queries is no fault.
        let _ = self.profiler.end_frame();
        while let Some(times) = self.profiler.process_finished_frame(self.gpu.queue.get_timestamp_period()) {
            self.stats.gpu = pass_times(&times);
        }
    }

    /// Something of the last frames is still on its way back.
    pub fn awaits_stats(&self) -> bool {
        self.lod_readback.is_pending()
    }

    /// Time goes by without pictures: the next frame's duration means nothing.
    pub fn pause(&mut self) {
        self.last_frame = None;
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
