//! One of the four pictures in the window: the view that draws it, its land, and what the user interface knows it by.

use std::sync::Arc;

use egui::TextureId;

use super::camera_control::CameraControl;
use super::ui_painter::UiPainter;
use crate::camera::Camera;
use crate::gpu::Gpu;
use crate::options::FrameInput;
use crate::passes::Passes;
use crate::scene_loader::Loaded;
use crate::upload::{Exhibit, SceneBuffers};
use crate::view::{Drawn, View};
use crate::walk::{Anchor, Land};

/// Before the window has given a view its size.
const FIRST_SIZE_PX: [u32; 2] = [16, 16];

pub struct Viewport {
    /// Which of the four it is.
    number: u64,
    pub view: View,
    pub land: Option<Arc<Land>>,
    /// The generation in which the land got its anchor.
    begun: Option<u32>,
    picture: Option<TextureId>,
    /// Of full resolution, sideways and upwards.
    pub part: f32,
    shadows: Shadows,
    /// What the picture shows.
    seen: Option<Seen>,
    /// Of so many pictures of the same it is the mean.
    pub accumulated: u32,
    /// What it took.
    pub drawn: Drawn,
    /// It was recorded in this frame.
    pub fresh: bool,
}

/// Which trees throw shadows on others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shadows {
    /// Those around the place from where the landscape was to be seen.
    Near,
    /// The same, and the rest was asked for.
    Asked,
    All,
}

/// What a picture was drawn from, besides its landscape and passes.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    frame: FrameInput,
    camera: Camera,
    lod_camera: Camera,
}

impl Viewport {
    pub fn new(gpu: &Gpu, passes: &Passes, number: usize, label: &str) -> Self {
        Self {
            number: number as u64,
            view: View::new(gpu, passes, label, number, FIRST_SIZE_PX),
            land: None,
            begun: None,
            picture: None,
            part: 1.0,
            shadows: Shadows::All,
            seen: None,
            accumulated: 0,
            drawn: Drawn::default(),
            fresh: false,
        }
    }

    /// What the user interface knows the picture by, if there is one.
    pub fn picture(&self) -> Option<TextureId> {
        self.picture.filter(|_| self.view.exhibit().is_some())
    }

    /// Shows a landscape of a generation, with the walk where `anchor` says.
    pub fn show(&mut self, passes: &Passes, loaded: Loaded, generation: u32, anchor: Anchor) {
        self.view.show(passes, loaded.exhibit);
        self.shadows = if loaded.lacks_shadows { Shadows::Near } else { Shadows::All };
        (self.land, self.seen, self.begun) = (Some(loaded.land), None, Some(generation));
        self.anchor_at(anchor);
    }

    /// The landscape's anchor, if it got it in that generation.
    pub fn anchor(&self, generation: u32) -> Option<Anchor> {
        let land = self.land.as_ref().filter(|_| self.begun == Some(generation));
        land.map(|land| land.anchor)
    }

    /// Lays the walk there.
    pub fn anchor_at(&mut self, anchor: Anchor) {
        if let Some(land) = &mut self.land {
            Arc::make_mut(land).anchor = anchor;
        }
    }

    pub fn clear(&mut self) {
        self.view.clear();
        self.shadows = Shadows::All;
        (self.land, self.begun, self.seen, self.drawn) = (None, None, None, Drawn::default());
    }

    /// The landscape, if its shadows are to be asked for, which they are then.
    pub fn ask_for_shadows(&mut self) -> Option<Arc<SceneBuffers>> {
        let lacks = self.shadows == Shadows::Near;
        lacks.then(|| self.shadows = Shadows::Asked)?;
        self.view.exhibit()?.landscape().cloned()
    }

    pub fn lacks_shadows(&self) -> bool {
        self.shadows != Shadows::All
    }

    /// A landscape, which may be this one, has got all of its shadows.
    pub fn shadowed(&mut self, buffers: &Arc<SceneBuffers>) {
        if self.view.exhibit().and_then(Exhibit::landscape).is_some_and(|scene| Arc::ptr_eq(scene, buffers)) {
            (self.shadows, self.seen) = (Shadows::All, None);
        }
    }

    pub fn adopt(&mut self, passes: &Passes) {
        self.view.adopt(passes);
        self.seen = None;
    }

    /// Gives the picture its size in the window and tells the user interface where to find it.
    pub fn fit(&mut self, passes: &Passes, painter: &mut UiPainter, size_px: [u32; 2], part: f32) {
        self.part = part;
        let size_px = size_px.map(|side| (side as f32 * part).round() as u32);
        if !self.view.resize(passes, size_px) && self.picture.is_some() {
            return;
        }
        self.seen = None;
        let texture = self.view.targets().display.create_view(&Default::default());
        self.picture = Some(painter.set(self.number, &texture));
    }

    /// What the picture ought to show at its size; nothing without a landscape.
    pub fn wanted(&self, frame: &FrameInput, control: &CameraControl) -> Option<Seen> {
        let land = self.land.as_ref()?;
        let fov_y_rad = frame.options.fov_y_deg.to_radians();
        let lod_camera = control.rig.camera(land, fov_y_rad);
        let camera = if frame.options.overhead { land.overhead(fov_y_rad) } else { lod_camera };
        Some(Seen { frame: FrameInput { part: self.part, ..*frame }, camera, lod_camera })
    }

    /// Whether the picture shows just this.
    pub fn shows(&self, wanted: &Seen) -> bool {
        self.seen.as_ref() == Some(wanted)
    }

    /// Whether the picture shows the landscape, from wherever.
    pub fn shows_anything(&self) -> bool {
        self.seen.is_some()
    }

    /// Records the picture; one that shows the same already becomes finer.
    pub fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        passes: &Passes,
        wanted: Seen,
        profiler: &wgpu_profiler::GpuProfiler,
    ) {
        let seen = Seen { frame: FrameInput { part: self.part, ..wanted.frame }, ..wanted };
        let accumulated = if self.shows(&seen) { self.accumulated } else { 0 };
        let (Seen { frame, camera, lod_camera }, view) = (&seen, &mut self.view);
        let frame = FrameInput { accumulated, ..*frame };
        self.drawn = view.record(encoder, passes, &frame, camera, lod_camera, profiler);
        self.accumulated = accumulated + 1;
        (self.seen, self.fresh) = (Some(seen), true);
    }
}
