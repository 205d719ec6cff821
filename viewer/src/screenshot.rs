//! Landscapes → pictures without a window.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Result, anyhow};
use genescape_bake::say;
use glam::{Vec2, Vec3};

use crate::app::desk::Source;
use crate::camera::Camera;
use crate::cli::Cli;
use crate::frame::FrameInput;
use crate::gpu::Gpu;
use crate::load::{self, Store};
use crate::passes::Passes;
use crate::picture_file::{self, Pixels};
use crate::shaders::Shaders;
use crate::upload::{SceneBuffers, Uploader};
use crate::view::View;
use crate::walk::{Land, Rig, START_RADIUS_M, start_pose};
use crate::world_files::WorldFiles;

/// A device with everything that draws, for pictures without a window.
pub struct Studio {
    /// The device.
    pub gpu: Gpu,
    /// The passes.
    pub passes: Passes,
    store: Store,
    uploader: Uploader,
    profiler: wgpu_profiler::GpuProfiler,
}

/// A landscape on the device and underfoot.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// What is drawn.
    pub buffers: Arc<SceneBuffers>,
    /// What a walker meets.
    pub land: Arc<Land>,
}

impl Studio {
    /// Opens a device. `samples`: 1 or 4 a pixel.
    pub fn open(shaders: &Shaders, samples: u32) -> Result<Self> {
        let gpu = Gpu::headless()?;
        let passes = Passes::new(&gpu, shaders, samples)?;
        let settings =
            wgpu_profiler::GpuProfilerSettings { enable_timer_queries: false, ..Default::default() };
        let profiler = wgpu_profiler::GpuProfiler::new(&gpu.device, settings)?;
        Ok(Self { uploader: Uploader::new(&gpu), store: Store::default(), gpu, passes, profiler })
    }

    /// Reads a landscape and brings it to the device.
    pub fn load(&self, path: &Path) -> Result<Loaded> {
        let scene = load::load(path, &self.store)?;
        let uploaded = self.uploader.upload(&scene).map_err(anyhow::Error::msg);
        let uploaded = uploaded.with_context(|| format!("cannot show {}", path.display()))?;
        self.passes.shadow.bake(&self.gpu, &self.passes.layouts, &self.passes.cull, &uploaded);
        Ok(Loaded { buffers: Arc::new(uploaded), land: Arc::new(Land::of(&scene)) })
    }

    /// A view of a landscape.
    pub fn view(&self, scene: Arc<SceneBuffers>, size_px: [u32; 2]) -> View {
        let mut view = View::new(&self.gpu, &self.passes, "picture", size_px);
        view.show(&self.passes, scene);
        view
    }

    /// Draws one picture as `camera` sees it, with the levels of detail that `lod_camera` calls for.
    pub fn draw(&self, view: &mut View, frame: &FrameInput, camera: &Camera, lod_camera: &Camera) {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        view.record(&mut encoder, &self.passes, frame, camera, lod_camera, &self.profiler);
        self.gpu.queue.submit([encoder.finish()]);
    }

    /// Draws one picture and fetches it.
    pub fn shoot(
        &self,
        view: &mut View,
        frame: &FrameInput,
        camera: &Camera,
        lod_camera: &Camera,
    ) -> Result<Pixels> {
        self.draw(view, frame, camera, lod_camera);
        picture_file::read(&self.gpu, &view.targets().display)
    }
}

/// Puts pictures of one size side by side, `columns` in a row.
pub fn sheet(pictures: &[Pixels], columns: usize) -> Option<Pixels> {
    let first = pictures.first()?;
    let (width, height) = (first.width_px as usize, first.height_px as usize);
    let rows = pictures.len().div_ceil(columns);
    let mut rgba = vec![0; width * columns * height * rows * 4];
    for (index, picture) in pictures.iter().enumerate() {
        let (column, row) = (index % columns, index / columns);
        for y in 0..height {
            let to = (((row * height + y) * columns + column) * width) * 4;
            rgba[to..to + width * 4].copy_from_slice(&picture.rgba[y * width * 4..(y + 1) * width * 4]);
        }
    }
    Some(Pixels { width_px: (width * columns) as u32, height_px: (height * rows) as u32, rgba })
}

/// Size of a picture that nobody asked for another of.
const USUAL_SIZE_PX: [u32; 2] = [1280, 800];

/// Does what `viewer --screenshot` says.
pub fn take(cli: &Cli, source: &Source, out: &Path) -> Result<()> {
    let paths = scene_files(source)?;
    let chosen: Vec<&PathBuf> = match cli.scene {
        Some(scene) => {
            let path = paths.get(usize::from(scene));
            vec![path.ok_or_else(|| anyhow!("there is no scene {scene}: there are {}", paths.len()))?]
        }
        None if cli.all => paths.iter().collect(),
        None => paths.iter().take(1).collect(),
    };
    let shaders = cli.shaders.clone().map_or_else(Shaders::builtin, Shaders::from_folder);
    let options = cli.drawing.options();
    let studio = Studio::open(&shaders, options.samples)?;
    let loaded = chosen.iter().map(|path| studio.load(path)).collect::<Result<Vec<_>>>()?;
    let lands: Vec<&Land> = loaded.iter().map(|loaded| &*loaded.land).collect();
    let sun = loaded.first().map(|loaded| Vec3::from(loaded.buffers.sky.sun_direction));
    let rig = Rig::new(start_pose(&lands, START_RADIUS_M, sun), &lands);

    let [width, height] = cli.size.unwrap_or(USUAL_SIZE_PX);
    let columns = if loaded.len() > 1 { 2 } else { 1 };
    let rows = loaded.len().div_ceil(columns) as u32;
    let size = [(width / columns as u32).max(1), (height / rows).max(1)];
    let frame = FrameInput { options, time_s: cli.time };
    let mut pictures = Vec::new();
    for one in &loaded {
        let mut view = studio.view(one.buffers.clone(), size);
        let eye = camera(cli, &rig, &one.land, options.fov_y_deg.to_radians());
        let from = if options.overhead { one.land.overhead(eye.fov_y_rad) } else { eye };
        pictures.push(studio.shoot(&mut view, &frame, &from, &eye)?);
    }
    let sheet = sheet(&pictures, columns).ok_or_else(|| anyhow!("there is nothing to draw"))?;
    picture_file::write_png(out, &sheet)?;
    say!("wrote {} ({} × {}), drawn by {}", out.display(), sheet.width_px, sheet.height_px, studio.gpu.name);
    Ok(())
}

/// The scene files of a source: of a world, those that were baked last.
pub(crate) fn scene_files(source: &Source) -> Result<Vec<PathBuf>> {
    let root = match source {
        Source::Scenes(paths) => return Ok(paths.clone()),
        Source::World(root) => root,
    };
    let current = WorldFiles::new(root).current()?;
    let current = current.ok_or_else(|| {
        anyhow!("{} holds nothing baked; `bake --world {}` bakes it", root.display(), root.display())
    })?;
    Ok(current.scenes.iter().map(|scene| root.join(scene)).collect())
}

fn camera(cli: &Cli, rig: &Rig, land: &Land, fov_y_rad: f32) -> Camera {
    let Some(place) = cli.camera else { return rig.camera(land, fov_y_rad) };
    let place_m = Vec2::new(place.x_m, place.z_m);
    let height_m = (land.ground_m(place_m) + place.height_m).max(land.floor_m(place_m));
    Camera {
        position_m: Vec3::new(place.x_m, height_m, place.z_m),
        yaw_rad: place.yaw_deg.to_radians(),
        pitch_rad: place.pitch_deg.to_radians(),
        fov_y_rad,
    }
}
