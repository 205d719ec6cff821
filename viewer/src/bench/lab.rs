//! A device to measure on, forests of any number of trees, the camera's way across a land, and what a frame took.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, Result};
use cpu_time::{ProcessTime, ThreadTime};
use glam::{Vec2, Vec3};

use crate::camera::Camera;
use crate::frame::{FrameInput, Options};
use crate::gpu::Gpu;
use crate::load::{self, Store};
use crate::lod_mode::{TerrainLodMode, TreeLodMode};
use crate::passes::Passes;
use crate::scene::{Instance, Scene};
use crate::shaders::Shaders;
use crate::upload::{SceneBuffers, Uploader};
use crate::view::{Drawn, View};
use crate::walk::{EYE_HEIGHT_M, Land, nearest_free};

/// A device with everything that draws.
pub(super) struct Lab {
    pub gpu: Gpu,
    pub passes: Arc<Passes>,
    store: Store,
    uploader: Uploader,
    profiler: wgpu_profiler::GpuProfiler,
}

/// What something took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Cost {
    /// Milliseconds on the clock.
    pub wall_ms: f64,
    /// Milliseconds of processors, all threads of this process together.
    pub cpu_ms: f64,
}

impl Cost {
    /// The lesser of each: what other programs added is left out.
    pub fn least(self, other: Self) -> Self {
        Self { wall_ms: self.wall_ms.min(other.wall_ms), cpu_ms: self.cpu_ms.min(other.cpu_ms) }
    }

    /// What `work` takes.
    pub fn of<T>(work: impl FnOnce() -> T) -> (Self, T) {
        let (wall, cpu) = (Instant::now(), ProcessTime::try_now());
        let result = work();
        let cpu_ms = cpu.map_or(f64::NAN, |start| milliseconds(start.elapsed()));
        (Self { wall_ms: milliseconds(wall.elapsed()), cpu_ms }, result)
    }

    /// Milliseconds of a processor that `work` takes on this thread alone.
    pub fn of_thread<T>(work: impl FnOnce() -> T) -> (f64, T) {
        let start = ThreadTime::try_now();
        let result = work();
        (start.map_or(f64::NAN, |start| milliseconds(start.elapsed())), result)
    }
}

impl std::iter::Sum for Cost {
    fn sum<I: Iterator<Item = Self>>(costs: I) -> Self {
        costs.fold(Self::default(), |a, b| Self {
            wall_ms: a.wall_ms + b.wall_ms,
            cpu_ms: a.cpu_ms + b.cpu_ms,
        })
    }
}

fn milliseconds(time: std::time::Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

impl Lab {
    /// Opens the best device, with one sample a pixel.
    pub fn open(shaders: &Shaders) -> Result<Self> {
        let gpu = Gpu::headless()?;
        let passes = Arc::new(Passes::new(&gpu, shaders, 1)?);
        let settings =
            wgpu_profiler::GpuProfilerSettings { enable_timer_queries: false, ..Default::default() };
        let profiler = wgpu_profiler::GpuProfiler::new(&gpu.device, settings)?;
        Ok(Self { uploader: Uploader::new(&gpu), store: Store::default(), gpu, passes, profiler })
    }

    /// Reads a landscape.
    pub fn load(&self, path: &Path) -> Result<Scene> {
        Ok(load::load(path, &self.store)?)
    }

    /// Brings a landscape to the device, shadows included.
    pub fn upload(&self, scene: &Scene) -> Result<Arc<SceneBuffers>> {
        let uploaded = self.uploader.upload(scene).map_err(anyhow::Error::msg);
        let uploaded = uploaded.with_context(|| format!("cannot show {}", scene.name))?;
        self.passes.shadow.bake(&self.gpu, &self.passes.layouts, &self.passes.cull, &uploaded);
        self.gpu.wait();
        Ok(Arc::new(uploaded))
    }

    /// A view of it.
    pub fn view(&self, scene: &Arc<SceneBuffers>, size_px: [u32; 2]) -> View {
        let mut view = View::new(&self.gpu, &self.passes, "measured", size_px);
        view.show(&self.passes, scene.clone());
        view
    }

    /// Records one picture of each view with one encoder, as the window does.
    pub fn record(
        &self,
        views: &mut [View],
        frame: &FrameInput,
        camera: &Camera,
    ) -> (wgpu::CommandBuffer, Drawn) {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let mut last = Drawn::default();
        for view in views {
            last = view.record(&mut encoder, &self.passes, frame, camera, camera, &self.profiler);
        }
        (encoder.finish(), last)
    }

    /// One picture of each view, waited for.
    pub fn frame(&self, views: &mut [View], frame: &FrameInput, camera: &Camera) -> Cost {
        let work = || {
            let (commands, _) = self.record(views, frame, camera);
            self.gpu.queue.submit([commands]);
            self.gpu.wait();
        };
        Cost::of(work).0
    }
}

/// What a frame is drawn from with these LOD modes.
pub(super) fn frame_with(tree_lod: TreeLodMode, terrain_lod: TerrainLodMode) -> FrameInput {
    FrameInput { options: Options { tree_lod, terrain_lod, ..Options::default() }, time_s: 0.0 }
}

/// The camera's way: straight across the middle of the land, a quarter of its extent to each side, at a walker's height
/// and clear of trunks, with the sun behind and to the side (thesis section 7).
pub(super) fn way(scene: &Scene, steps: u32) -> Vec<Camera> {
    let land = Land::of(scene);
    let [x, _, z] = scene.sky.sun_direction;
    let away = Vec2::new(-x, -z).normalize_or(Vec2::NEG_Y);
    let ahead = Vec2::from_angle(0.6).rotate(away);
    let half_m = 0.25 * scene.ground.field.extent_m();
    let at = |step: u32| {
        let wished_m = ahead * half_m * (2.0 * step as f32 / (steps - 1).max(1) as f32 - 1.0);
        let place_m = nearest_free(&[&land], wished_m).unwrap_or(wished_m);
        let position_m = Vec3::new(place_m.x, land.footing_m(place_m) + EYE_HEIGHT_M, place_m.y);
        Camera {
            position_m,
            yaw_rad: libm::atan2f(-ahead.x, -ahead.y),
            pitch_rad: 0.0,
            fov_y_rad: Options::default().fov_y_deg.to_radians(),
        }
    };
    (0..steps).map(at).collect()
}

/// The same landscape with `count` trees: of more than are wanted an even choice; else copies stand between them,
/// spread evenly over the dry land (the additive recurrence of Roberts 2018).
pub(super) fn forest(scene: &Scene, count: usize) -> Scene {
    let known = &scene.trees.instances;
    let mut scene_with = scene.clone();
    if known.is_empty() || count <= known.len() {
        let stride = |i: usize| known[i * known.len() / count];
        scene_with.trees.instances = (0..count.min(known.len())).map(stride).collect();
        return scene_with;
    }
    let field = &scene.ground.field;
    let dry_m = scene.ground.water_level_m.unwrap_or(f32::MIN);
    let place = |i: u32| {
        // Exact in f64 for any number of trees; the constants are 1/g and 1/g² of the plastic number g.
        let part = |step: f64| ((0.5 + f64::from(i) * step).fract() as f32 - 0.5) * field.extent_m() * 0.98;
        Vec2::new(part(0.754_877_666_246_692_7), part(0.569_840_290_998_053_3))
    };
    let dry = |place_m: &Vec2| field.height_m(place_m.x, place_m.y) > dry_m;
    // A land that is all lake gets its trees in the lake.
    let any = (0..1000).map(place).any(|place_m| dry(&place_m));
    let places = (0..).map(place).filter(|place_m| !any || dry(place_m));
    let copies = known.iter().cycle().zip(places).map(|(tree, place_m)| moved(tree, place_m, field));
    scene_with.trees.instances = known.iter().copied().chain(copies).take(count).collect();
    scene_with
}

/// A tree at another place, as high above the land as before.
fn moved(tree: &Instance, place_m: Vec2, field: &crate::scene::Heightfield) -> Instance {
    let mut copy = *tree;
    let [x, y, z] = tree.world_from_tree.map(|row| row[3]);
    let above_m = y - field.height_m(x, z);
    copy.world_from_tree[0][3] = place_m.x;
    copy.world_from_tree[1][3] = field.height_m(place_m.x, place_m.y) + above_m;
    copy.world_from_tree[2][3] = place_m.y;
    copy.trunk_cylinder_m[0] += place_m.x - x;
    copy.trunk_cylinder_m[1] += place_m.y - z;
    copy
}
