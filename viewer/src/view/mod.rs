//! One of the four pictures: a camera's targets, the landscape it shows, and the order in which passes draw it.

mod targets;
mod terrain;

use std::sync::Arc;

pub use targets::Targets;
use terrain::TerrainChoice;

use crate::camera::Camera;
use crate::gpu::Gpu;
use crate::options::{FrameInput, Options};
use crate::passes::grass::{self, Clump};
use crate::passes::plants::PlantChoice;
use crate::passes::{BoundScene, Cull, CullUniform, Passes, Tone, ViewUniform};
use crate::upload::{SceneBuffers, TreeSet};

#[derive(Debug)]
pub struct View {
    gpu: Gpu,
    label: String,
    uniform: wgpu::Buffer,
    targets: Targets,
    /// The targets were made anew, and no caller knows yet.
    fresh: bool,
    bound: Option<BoundScene>,
    terrain: TerrainChoice,
    /// Clumps of grass, kept from frame to frame.
    clumps: Vec<Clump>,
    /// Small plants, likewise.
    plants: PlantChoice,
}

/// What a picture took.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawn {
    /// Draw calls.
    pub draws: u32,
    /// Triangles of the land.
    pub land_triangles: u32,
}

impl View {
    /// A view without landscape.
    pub fn new(gpu: &Gpu, passes: &Passes, label: &str, size_px: [u32; 2]) -> Self {
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        Self {
            gpu: gpu.clone(),
            label: label.to_owned(),
            uniform: gpu.empty_buffer(label, size_of::<ViewUniform>() as u64, usage),
            targets: Targets::new(gpu, passes, label, size_px),
            fresh: false,
            bound: None,
            terrain: TerrainChoice::default(),
            clumps: Vec::new(),
            plants: PlantChoice::default(),
        }
    }

    /// The finished picture.
    pub fn targets(&self) -> &Targets {
        &self.targets
    }

    /// The landscape that is shown.
    pub fn scene(&self) -> Option<&Arc<SceneBuffers>> {
        self.bound.as_ref().map(|bound| &bound.scene)
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

    /// Shows a landscape from the next picture on.
    pub fn show(&mut self, passes: &Passes, scene: Arc<SceneBuffers>) {
        self.bound = Some(BoundScene::new(&self.gpu, &passes.layouts, scene, &self.uniform));
    }

    /// Goes on with other passes.
    pub fn adopt(&mut self, passes: &Passes) {
        self.targets = Targets::new(&self.gpu, passes, &self.label, self.targets.size_px);
        self.fresh = true;
        if let Some(bound) = self.bound.take() {
            self.show(passes, bound.scene);
        }
    }

    /// Shows nothing.
    pub fn clear(&mut self) {
        self.bound = None;
    }

    /// How many trees are drawn at each level of each template, where that is written on the device.
    pub fn tree_counts(&self) -> Option<(&TreeSet, &wgpu::Buffer)> {
        let (set, trees) = self.bound.as_ref()?.trees()?;
        Some((set, &trees.counts))
    }

    /// Records one picture as `camera` sees it, with levels of detail chosen for `lod_camera` (the same, but when one
    /// looks on from above).
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
            encoder.begin_render_pass(&display_pass(&self.targets.display()));
            return Drawn::default();
        };
        let mut scope = profiler.scope(self.label.as_str(), encoder);
        let (options, size_px) = (&frame.options, self.targets.size_px);
        let size = size_px.map(|side| side as f32);
        let frustum = lod_camera.frustum(size[0] / size[1]);

        let (detail, land_triangles) = self.terrain.choose(bound, &self.gpu, lod_camera, size, options);
        let uniform = ViewUniform::new(&bound.scene, camera, lod_camera, size_px, frame, &detail);
        self.gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));

        if let Some((set, trees)) = bound.trees() {
            let (eye_m, focal_px) = (lod_camera.position_m, lod_camera.focal_px(size[1]));
            let culling = CullUniform::for_view(set, &frustum, eye_m, focal_px, options);
            trees.set(&self.gpu.queue, &culling);
            passes.cull.dispatch(&mut scope.scoped_compute_pass(Cull::NAME), trees);
        }
        self.clumps.clear();
        self.plants.clear();
        // In pictures that explain levels of detail it would only hide them.
        if options.grass && !options.wireframe && !options.tint_levels && !options.overhead {
            let (ground, eye_m) = (&bound.scene.ground, lod_camera.position_m);
            grass::clumps(ground, eye_m, &frustum, frame.part, &mut self.clumps);
            self.plants.choose(ground, &bound.scene.land.plants, eye_m, &frustum);
        }
        bound.clumps.write(&self.gpu, &self.clumps);
        bound.plants.write(&self.gpu, &self.plants.instances);
        bound.plant_draws.clone_from(&self.plants.draws);
        bound.scene.land.ring.seen(&camera.frustum(size[0] / size[1]), &mut bound.ring);

        let draws = draw(&mut scope, passes, bound, &self.targets, options);
        Drawn { draws, land_triangles }
    }
}

/// Records everything that draws, and tells how many draws that are.
fn draw(
    scope: &mut wgpu_profiler::Scope<'_, wgpu::CommandEncoder>,
    passes: &Passes,
    bound: &BoundScene,
    targets: &Targets,
    options: &Options,
) -> u32 {
    let mut draws = 1;
    {
        let descriptor = wgpu::RenderPassDescriptor {
            color_attachments: &targets.radiance(),
            depth_stencil_attachment: Some(targets.depth()),
            ..Default::default()
        };
        let mut picture = scope.scoped_render_pass("picture", descriptor);
        picture.set_bind_group(0, &bound.view_group, &[]);
        for (name, pass) in passes.picture.iter().filter(|(_, pass)| pass.is_needed(bound, options)) {
            draws += pass.draw(&mut picture.scope(*name), bound, options);
        }
    }
    let mut pass = scope.scoped_render_pass(Tone::NAME, display_pass(&targets.display()));
    pass.set_bind_group(0, &bound.view_group, &[]);
    passes.tone.draw(&mut pass, &targets.radiance_group);
    draws
}

fn display_pass<'a>(
    display: &'a [Option<wgpu::RenderPassColorAttachment<'a>>],
) -> wgpu::RenderPassDescriptor<'a> {
    wgpu::RenderPassDescriptor { color_attachments: display, ..Default::default() }
}
