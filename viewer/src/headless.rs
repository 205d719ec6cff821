//! Landscapes → pictures without a window.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Result, anyhow};
use genescape_world::{Source, World};
use image::RgbaImage;

use crate::camera::Camera;
use crate::gpu::Gpu;
use crate::image_file;
use crate::options::FrameInput;
use crate::passes::{Passes, Shaders, pictures};
use crate::scene::{Asset, Scene};
use crate::scene_loader::{Loaded, SceneLoader};
use crate::upload::{AssetBuffers, Exhibit, SceneBuffers};
use crate::view::{Drawn, View};

/// A device with everything that draws.
pub struct Headless {
    pub gpu: Gpu,
    pub passes: Arc<Passes>,
    loader: SceneLoader,
    profiler: wgpu_profiler::GpuProfiler,
}

impl Headless {
    /// Opens the best device. `samples`: 1 or 4 a pixel.
    pub fn open(shaders: &Shaders, samples: u32) -> Result<Self> {
        let gpu = Gpu::headless()?;
        let passes = Arc::new(Passes::new(&gpu, shaders, samples)?);
        let settings =
            wgpu_profiler::GpuProfilerSettings { enable_timer_queries: false, ..Default::default() };
        let profiler = wgpu_profiler::GpuProfiler::new(&gpu.device, settings)?;
        Ok(Self { loader: SceneLoader::new(&gpu), gpu, passes, profiler })
    }

    /// Reads a landscape.
    pub fn read(&self, path: &Path) -> Result<Scene> {
        self.loader.read(path)
    }

    /// Brings a landscape to the device, shadows included.
    pub fn upload(&self, scene: &Scene) -> Result<Arc<SceneBuffers>> {
        self.loader.upload(scene, &self.passes).with_context(|| format!("cannot show {}", scene.name))
    }

    /// Brings anyone's file to the device.
    pub fn upload_asset(&self, asset: &Asset) -> Result<Arc<AssetBuffers>> {
        self.loader.upload_asset(asset, &self.passes)
    }

    /// Reads a landscape or anyone's file and brings it to the device.
    pub fn load(&self, path: &Path) -> Result<Loaded> {
        self.loader.load(path, &self.passes)
    }

    /// A view of a landscape or of anyone's file.
    pub fn view(&self, exhibit: impl Into<Exhibit>, size_px: [u32; 2]) -> View {
        self.view_of_four(0, exhibit, size_px)
    }

    /// The same, as one of four that move together.
    pub fn view_of_four(&self, number: usize, exhibit: impl Into<Exhibit>, size_px: [u32; 2]) -> View {
        let mut view = View::new(&self.gpu, &self.passes, "headless", number, size_px);
        view.show(&self.passes, exhibit);
        view
    }

    /// Records one picture of each view with one encoder, as the window does: as `camera` sees it, with the levels of
    /// detail that `lod_camera` calls for. What the last of them took.
    pub fn record(
        &self,
        views: &mut [View],
        frame: &FrameInput,
        camera: &Camera,
        lod_camera: &Camera,
    ) -> (wgpu::CommandBuffer, Drawn) {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let mut last = Drawn::default();
        for view in views {
            last = self.record_into(&mut encoder, view, frame, camera, lod_camera);
        }
        (encoder.finish(), last)
    }

    /// Records one picture beside what else an encoder does.
    pub fn record_into(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        view: &mut View,
        frame: &FrameInput,
        camera: &Camera,
        lod_camera: &Camera,
    ) -> Drawn {
        view.record(encoder, &self.passes, frame, camera, lod_camera, &self.profiler)
    }

    /// Draws what a still picture becomes and fetches it: the mean of several, unless that is not wanted. `cameras`: the one
    /// that sees, and that for which levels of detail are chosen.
    pub fn shoot_still(
        &self,
        view: &mut View,
        frame: &FrameInput,
        cameras: [&Camera; 2],
    ) -> Result<RgbaImage> {
        let count = if frame.options.refine { pictures(self.passes.samples) } else { 1 };
        for accumulated in 0..count {
            self.draw(view, &FrameInput { accumulated, ..*frame }, cameras);
        }
        image_file::read(&self.gpu, &view.targets().display)
    }

    /// Draws one picture and fetches it.
    pub fn shoot(
        &self,
        view: &mut View,
        frame: &FrameInput,
        camera: &Camera,
        lod_camera: &Camera,
    ) -> Result<RgbaImage> {
        self.draw(view, frame, [camera, lod_camera]);
        image_file::read(&self.gpu, &view.targets().display)
    }

    fn draw(&self, view: &mut View, frame: &FrameInput, [camera, lod_camera]: [&Camera; 2]) {
        let (commands, _) = self.record(std::slice::from_mut(view), frame, camera, lod_camera);
        self.gpu.queue.submit([commands]);
    }
}

/// The scene files of a source: of a world, those that were baked last.
pub fn scene_files(source: &Source) -> Result<Vec<PathBuf>> {
    let root = match source {
        Source::Scenes(paths) => return Ok(paths.clone()),
        Source::World(root) => root,
    };
    let current = World::new(root).current()?;
    let current = current.ok_or_else(|| {
        anyhow!("{} holds nothing baked; `bake --world {}` bakes it", root.display(), root.display())
    })?;
    Ok(current.scenes.iter().map(|scene| root.join(scene)).collect())
}
