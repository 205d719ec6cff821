//! One of the four pictures: a camera's targets, what it shows, and the order in which passes draw it.

mod asset;
mod landscape;
mod mirror;
mod targets;
mod terrain;

pub use targets::Targets;
pub use terrain::MAX_BLOCK_M;

use asset::AssetChoice;
use landscape::LandscapeChoice;

use crate::camera::Camera;
use crate::gpu::Gpu;
use crate::options::FrameInput;
use crate::passes::{Binding, BoundAsset, BoundScene, Mean, Passes, Tone, ViewUniform, bind};
use crate::upload::{Exhibit, TreeSet};

#[derive(Debug)]
pub struct View {
    gpu: Gpu,
    label: String,
    turn: usize,
    uniform: wgpu::Buffer,
    targets: Targets,
    /// The targets were made anew, and no caller knows yet.
    fresh: bool,
    /// The uniform alone.
    camera_group: wgpu::BindGroup,
    exhibit: Option<Exhibit>,
    bound: Option<Bound>,
}

/// What is shown, as bound for this view, with what is kept from frame to frame.
#[derive(Debug)]
enum Bound {
    Landscape(Box<BoundScene>, Box<LandscapeChoice>),
    Asset(Box<BoundAsset>, AssetChoice),
}

/// What a picture took.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawn {
    /// Draw calls.
    pub draws: u32,
    /// Triangles of the land, or of anyone's file.
    pub triangles: u32,
    /// Copies of a file's shapes at each level, finest first. How many trees a landscape has where is known on the device.
    pub copies_by_level: Vec<u32>,
}

impl View {
    /// A view of nothing. `turn`: which of the four it is, for views that move together do some of their work in turn.
    pub fn new(gpu: &Gpu, passes: &Passes, label: &str, turn: usize, size_px: [u32; 2]) -> Self {
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let uniform = gpu.empty_buffer(label, size_of::<ViewUniform>() as u64, usage);
        Self {
            gpu: gpu.clone(),
            label: label.to_owned(),
            turn,
            camera_group: camera_group(gpu, passes, &uniform),
            uniform,
            targets: Targets::new(gpu, passes, label, size_px),
            fresh: false,
            exhibit: None,
            bound: None,
        }
    }

    /// The finished picture.
    pub fn targets(&self) -> &Targets {
        &self.targets
    }

    /// What is shown.
    pub fn exhibit(&self) -> Option<&Exhibit> {
        self.exhibit.as_ref()
    }

    /// Has the pass that draws the landscape counted by the first query of `statistics`, until the picture's size changes.
    pub fn count(&mut self, statistics: Option<wgpu::QuerySet>) {
        self.targets.statistics = statistics;
    }

    /// Gives the picture another size; `true` if there are new targets since the last call.
    pub fn resize(&mut self, passes: &Passes, size_px: [u32; 2]) -> bool {
        let size_px = size_px.map(|side| side.max(1));
        if self.targets.size_px != size_px {
            self.targets = Targets::new(&self.gpu, passes, &self.label, size_px);
            self.fresh = true;
        }
        std::mem::take(&mut self.fresh)
    }

    /// Shows a landscape or a file from the next picture on.
    pub fn show(&mut self, passes: &Passes, exhibit: impl Into<Exhibit>) {
        let (gpu, layouts, exhibit) = (&self.gpu, &passes.layouts, exhibit.into());
        self.bound = Some(match exhibit.clone() {
            Exhibit::Landscape(scene) => {
                let bound = BoundScene::new(gpu, layouts, scene, &self.uniform, self.turn);
                Bound::Landscape(Box::new(bound), Box::default())
            }
            Exhibit::Asset(asset) => {
                Bound::Asset(Box::new(BoundAsset::new(gpu, layouts, asset)), AssetChoice::default())
            }
        });
        self.exhibit = Some(exhibit);
    }

    /// Goes on with other passes.
    pub fn adopt(&mut self, passes: &Passes) {
        self.targets = Targets::new(&self.gpu, passes, &self.label, self.targets.size_px);
        self.camera_group = camera_group(&self.gpu, passes, &self.uniform);
        self.fresh = true;
        if let Some(exhibit) = self.exhibit.take() {
            self.show(passes, exhibit);
        }
    }

    /// Shows nothing.
    pub fn clear(&mut self) {
        (self.exhibit, self.bound) = (None, None);
    }

    /// How many trees are drawn at each level of each template, where that is written on the device.
    pub fn tree_counts(&self) -> Option<(&TreeSet, &wgpu::Buffer)> {
        let Bound::Landscape(bound, _) = self.bound.as_ref()? else { return None };
        let (set, trees) = bound.trees()?;
        Some((set, &trees.counts))
    }

    /// Records one picture as `camera` sees it, with levels of detail chosen for `lod_camera` (the same, but when one
    /// looks on from above). Where `frame` says that others have been accumulated, the last calls have recorded them, and the
    /// picture's size and what it shows have not changed since.
    pub fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        passes: &Passes,
        frame: &FrameInput,
        camera: &Camera,
        lod_camera: &Camera,
        profiler: &wgpu_profiler::GpuProfiler,
    ) -> Drawn {
        let Some(bound) = &mut self.bound else {
            encoder.begin_render_pass(&colors(&self.targets.display()));
            return Drawn::default();
        };
        let mut scope = profiler.scope(self.label.as_str(), encoder);
        let (gpu, targets) = (&self.gpu, &self.targets);
        if frame.accumulated == 1 {
            // The one before was shown as it was, and is the first of the mean.
            accumulate(&mut scope, passes, &self.camera_group, targets, 0);
        }
        let drawn = match bound {
            Bound::Landscape(bound, choice) => {
                let cameras = [camera, lod_camera];
                choice.record(bound, gpu, &self.uniform, &mut scope, passes, targets, frame, cameras)
            }
            Bound::Asset(bound, choice) => {
                let numbers = ViewUniform::of_camera(camera, targets.size_px, frame, bound.asset.exposure);
                gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&numbers));
                let size = targets.size_px.map(|side| side as f32);
                choice.choose(bound, gpu, lod_camera, size, &frame.options);
                asset::draw(&mut scope, passes, bound, choice, &self.camera_group, targets, &frame.options)
            }
        };
        let mut radiance = &targets.radiance_group;
        if frame.accumulated > 0 {
            accumulate(&mut scope, passes, &self.camera_group, targets, frame.accumulated);
            radiance = &targets.mean_group;
        }
        let mut pass = scope.scoped_render_pass(Tone::NAME, colors(&targets.display()));
        pass.set_bind_group(0, &self.camera_group, &[]);
        let like_film = matches!(self.exhibit, Some(Exhibit::Landscape(_)));
        passes.tone.draw(&mut pass, radiance, like_film);
        drawn
    }
}

/// Takes the radiance of the last picture into the mean of `accumulated` others.
fn accumulate(
    scope: &mut wgpu_profiler::Scope<'_, wgpu::CommandEncoder>,
    passes: &Passes,
    camera: &wgpu::BindGroup,
    targets: &Targets,
    accumulated: u32,
) {
    let mut pass = scope.scoped_render_pass(Mean::NAME, colors(&targets.mean(accumulated)));
    pass.set_bind_group(0, camera, &[]);
    passes.mean.draw(&mut pass, &targets.radiance_group, accumulated);
}

fn camera_group(gpu: &Gpu, passes: &Passes, uniform: &wgpu::Buffer) -> wgpu::BindGroup {
    bind(gpu, "camera", &passes.layouts.camera, [(0, Binding::Buffer(uniform))])
}

/// A pass without depth.
fn colors<'a>(
    attachments: &'a [Option<wgpu::RenderPassColorAttachment<'a>>],
) -> wgpu::RenderPassDescriptor<'a> {
    wgpu::RenderPassDescriptor { color_attachments: attachments, ..Default::default() }
}
