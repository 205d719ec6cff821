//! One of the four pictures in the window: the view that draws it, its land, and what the user interface knows it by.

use std::sync::Arc;

use egui::TextureId;
use egui_wgpu::Renderer;

use super::camera_control::CameraControl;
use crate::camera::Camera;
use crate::gpu::Gpu;
use crate::options::FrameInput;
use crate::passes::Passes;
use crate::scene_loader::Loaded;
use crate::view::{Drawn, View};
use crate::walk::Land;

/// Before the window has given a view its size.
const FIRST_SIZE_PX: [u32; 2] = [16, 16];

pub struct Viewport {
    pub view: View,
    pub land: Option<Arc<Land>>,
    picture: Option<TextureId>,
    /// Of full resolution, sideways and upwards.
    pub part: f32,
    /// What the picture shows.
    seen: Option<Seen>,
    /// What it took.
    pub drawn: Drawn,
    /// It was recorded in this frame.
    pub fresh: bool,
}

/// What a picture was drawn from, besides its landscape and passes.
#[derive(Clone, Debug, PartialEq)]
struct Seen {
    frame: FrameInput,
    camera: Camera,
    lod_camera: Camera,
}

impl Viewport {
    pub fn new(gpu: &Gpu, passes: &Passes, label: &str) -> Self {
        Self {
            view: View::new(gpu, passes, label, FIRST_SIZE_PX),
            land: None,
            picture: None,
            part: 1.0,
            seen: None,
            drawn: Drawn::default(),
            fresh: false,
        }
    }

    /// What the user interface knows the picture by, if there is one.
    pub fn picture(&self) -> Option<TextureId> {
        self.picture.filter(|_| self.view.scene().is_some())
    }

    pub fn show(&mut self, passes: &Passes, loaded: Loaded) {
        self.view.show(passes, loaded.buffers);
        (self.land, self.seen) = (Some(loaded.land), None);
    }

    pub fn clear(&mut self) {
        self.view.clear();
        (self.land, self.seen, self.drawn) = (None, None, Drawn::default());
    }

    pub fn adopt(&mut self, passes: &Passes) {
        self.view.adopt(passes);
        self.seen = None;
    }

    /// Gives the picture its size in the window and tells the user interface where to find it.
    pub fn fit(&mut self, gpu: &Gpu, passes: &Passes, painter: &mut Renderer, size_px: [u32; 2], part: f32) {
        self.part = part;
        let size_px = size_px.map(|side| (side as f32 * part).round() as u32);
        if !self.view.resize(passes, size_px) && self.picture.is_some() {
            return;
        }
        self.seen = None;
        let texture = self.view.targets().display.create_view(&Default::default());
        // Linear: a picture of less than full resolution is stretched.
        let filter = wgpu::FilterMode::Linear;
        match self.picture {
            Some(id) => {
                painter.update_egui_texture_from_wgpu_texture(&gpu.device, &texture, filter, id);
            }
            None => self.picture = Some(painter.register_native_texture(&gpu.device, &texture, filter)),
        }
    }

    /// Records the picture, unless it would be the one that is there.
    pub fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        passes: &Passes,
        frame: &FrameInput,
        control: &CameraControl,
        profiler: &wgpu_profiler::GpuProfiler,
    ) {
        let Some(land) = &self.land else { return };
        let fov_y_rad = frame.options.fov_y_deg.to_radians();
        let lod_camera = control.rig.camera(land, fov_y_rad);
        let camera = if frame.options.overhead { land.overhead(fov_y_rad) } else { lod_camera };
        let wanted = Seen { frame: *frame, camera, lod_camera };
        if self.seen.as_ref() != Some(&wanted) {
            self.drawn = self.view.record(encoder, passes, frame, &camera, &lod_camera, profiler);
            (self.seen, self.fresh) = (Some(wanted), true);
        }
    }
}
