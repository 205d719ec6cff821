//! One of the four pictures: a camera's size and targets, and the landscape it shows with all that is bound and
//! chosen for it.

use std::sync::Arc;

use crate::camera::{Camera, Frustum};
use crate::frame::{FrameInput, Options};
use crate::gpu::Gpu;
use crate::lod::morph::Detail;
use crate::lod::quadtree;
use crate::lod::roam::Roam;
use crate::lod_mode::TerrainLodMode;
use crate::passes::grass::{self, Clump};
use crate::passes::{
    CullUniform, DEPTH, DISPLAY, Land, Layouts, Passes, RADIANCE, TreeGroups, TreeLists, ViewUniform, bind,
    focal_px, texture_view,
};
use crate::upload::{SceneBuffers, TreeSet};

/// No block of the land is wider, so that what is not seen can be left out.
const LARGEST_BLOCK_M: f32 = 256.0;

/// A picture's targets.
#[derive(Debug)]
pub struct Targets {
    /// Width and height.
    pub size_px: [u32; 2],
    /// Radiance, one sample a pixel.
    radiance: wgpu::TextureView,
    /// Several samples a pixel, if that is wished for.
    multisampled: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
    /// The finished picture.
    pub display: wgpu::Texture,
    display_view: wgpu::TextureView,
    group: wgpu::BindGroup,
    /// They were made anew and nobody has been told.
    fresh: bool,
}

/// A view.
#[derive(Debug)]
pub struct View {
    gpu: Gpu,
    label: String,
    uniform: wgpu::Buffer,
    targets: Targets,
    shown: Option<Shown>,
    land: LandChoice,
    clumps: Vec<Clump>,
}

/// Which triangles of the land are drawn; its lists are kept from frame to frame.
#[derive(Debug, Default)]
struct LandChoice {
    blocks: Vec<quadtree::Block>,
    roam: Roam,
    strip: Vec<u32>,
}

impl LandChoice {
    /// Chooses and uploads; how many triangles that are.
    #[expect(clippy::too_many_arguments, reason = "one frame's facts, each from another owner")]
    fn choose(
        &mut self,
        shown: &mut Shown,
        gpu: &Gpu,
        camera: &Camera,
        detail: &Detail,
        frustum: &Frustum,
        size_px: [u32; 2],
        options: &Options,
    ) -> u32 {
        let field = &shown.scene.ground.field;
        if options.terrain_lod == TerrainLodMode::Roam {
            let [width, height] = size_px.map(|side| side as f32);
            let shape = (width / height, height);
            let stats =
                self.roam.triangulate(field, camera, shape, options.terrain_error_px, &mut self.strip);
            shown.land = Land::Strip(self.strip.len() as u32);
            shown.write_land(gpu, bytemuck::cast_slice(&self.strip));
            return stats.triangles;
        }
        let stats = quadtree::select(field, detail, Some(frustum), &mut self.blocks);
        shown.land = Land::Blocks(self.blocks.len() as u32);
        shown.write_land(gpu, bytemuck::cast_slice(&self.blocks));
        stats.triangles
    }
}

/// A landscape as bound for one view.
#[derive(Debug)]
struct Shown {
    scene: Arc<SceneBuffers>,
    view_group: wgpu::BindGroup,
    ground_group: wgpu::BindGroup,
    trees: Option<(TreeGroups, TreeLists)>,
    land: Land,
    land_buffer: wgpu::Buffer,
    clumps: u32,
    clump_buffer: wgpu::Buffer,
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
        let uniform = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: size_of::<ViewUniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let targets = Targets::new(gpu, &passes.layouts, label, size_px, passes.samples);
        Self {
            gpu: gpu.clone(),
            label: label.to_owned(),
            uniform,
            targets,
            shown: None,
            land: LandChoice::default(),
            clumps: Vec::new(),
        }
    }

    /// The finished picture.
    pub fn targets(&self) -> &Targets {
        &self.targets
    }

    /// The landscape that is shown.
    pub fn scene(&self) -> Option<&Arc<SceneBuffers>> {
        self.shown.as_ref().map(|shown| &shown.scene)
    }

    /// Gives the picture another size; `true` if there are new targets since the last call.
    pub fn resize(&mut self, passes: &Passes, size_px: [u32; 2]) -> bool {
        let size_px = size_px.map(|side| side.max(1));
        if self.targets.size_px == size_px {
            return std::mem::take(&mut self.targets.fresh);
        }
        self.targets = Targets::new(&self.gpu, &passes.layouts, &self.label, size_px, passes.samples);
        true
    }

    /// Shows a landscape from the next picture on.
    pub fn show(&mut self, passes: &Passes, scene: Arc<SceneBuffers>) {
        self.shown = Some(Shown::new(&self.gpu, &passes.layouts, scene, &self.uniform));
    }

    /// Goes on with other passes.
    pub fn adopt(&mut self, passes: &Passes) {
        self.targets =
            Targets::new(&self.gpu, &passes.layouts, &self.label, self.targets.size_px, passes.samples);
        self.targets.fresh = true;
        if let Some(shown) = self.shown.take() {
            self.show(passes, shown.scene);
        }
    }

    /// Shows nothing.
    pub fn clear(&mut self) {
        self.shown = None;
    }

    /// How many trees are drawn at each level of each kind, where that is written on the device.
    pub fn tree_counts(&self) -> Option<(&TreeSet, &wgpu::Buffer)> {
        let shown = self.shown.as_ref()?;
        Some((shown.scene.trees.as_ref()?, &shown.trees.as_ref()?.1.counts))
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
        let Some(shown) = &mut self.shown else {
            self.targets.blank(encoder);
            return Drawn::default();
        };
        let mut scope = profiler.scope(self.label.as_str(), encoder);
        let [width, height] = self.targets.size_px.map(|side| side as f32);
        let focal = focal_px(lod_camera, height);
        let frustum = lod_camera.frustum(width / height);

        let detail = shown.detail(lod_camera, focal, &frame.options);
        let size = self.targets.size_px;
        let uniform = ViewUniform::new(&shown.scene, camera, lod_camera, size, frame, &detail);
        self.gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
        let land_triangles =
            self.land.choose(shown, &self.gpu, lod_camera, &detail, &frustum, size, &frame.options);

        if let (Some(set), Some((_, lists))) = (&shown.scene.trees, &shown.trees) {
            let choice = CullUniform::for_view(set, &frustum, lod_camera.position_m, focal, &frame.options);
            lists.set(&self.gpu.queue, &choice);
            let mut pass = scope.scoped_compute_pass("choose trees");
            passes.cull.dispatch(&mut pass, lists);
        }
        self.clumps.clear();
        // In pictures that explain levels of detail it would only hide them.
        let options = &frame.options;
        if options.grass && !options.wireframe && !options.tint_levels && !options.overhead {
            grass::clumps(&shown.scene.ground, lod_camera.position_m, &frustum, &mut self.clumps);
        }
        shown.write_clumps(&self.gpu, &self.clumps);
        let draws = shown.draw(&mut scope, passes, &self.targets, frame);
        Drawn { draws, land_triangles }
    }
}

impl Shown {
    fn new(gpu: &Gpu, layouts: &Layouts, scene: Arc<SceneBuffers>, uniform: &wgpu::Buffer) -> Self {
        let trees = scene
            .trees
            .as_ref()
            .map(|set| (TreeGroups::new(gpu, layouts, set), TreeLists::new(gpu, layouts, set)));
        Self {
            view_group: view_group(gpu, layouts, &scene, uniform),
            ground_group: ground_group(gpu, layouts, &scene),
            trees,
            land: Land::Blocks(0),
            land_buffer: land_buffer(gpu, 64 * 1024),
            clumps: 0,
            clump_buffer: land_buffer(gpu, 64 * 1024),
            scene,
        }
    }

    /// How detailed the land is where. Without levels of detail no error is allowed.
    fn detail(&self, camera: &Camera, focal_px: f32, options: &Options) -> Detail {
        let error_px =
            if options.terrain_lod == TerrainLodMode::Off { 0.0 } else { options.terrain_error_px };
        let (field, errors) = (&self.scene.ground.field, &self.scene.land.errors);
        quadtree::detail(field, errors, camera.position_m, focal_px, error_px, LARGEST_BLOCK_M)
    }

    fn write_clumps(&mut self, gpu: &Gpu, clumps: &[Clump]) {
        write(gpu, &mut self.clump_buffer, bytemuck::cast_slice(clumps));
        self.clumps = clumps.len() as u32;
    }

    fn write_land(&mut self, gpu: &Gpu, bytes: &[u8]) {
        write(gpu, &mut self.land_buffer, bytes);
    }

    fn draw(
        &self,
        scope: &mut wgpu_profiler::Scope<'_, wgpu::CommandEncoder>,
        passes: &Passes,
        targets: &Targets,
        frame: &FrameInput,
    ) -> u32 {
        let options = &frame.options;
        let mut draws = 2;
        {
            let descriptor = wgpu::RenderPassDescriptor {
                color_attachments: &targets.radiance(),
                depth_stencil_attachment: Some(targets.depth()),
                ..Default::default()
            };
            let mut pass = scope.scoped_render_pass("picture", descriptor);
            pass.set_bind_group(0, &self.view_group, &[]);
            if let (true, Some(set), Some((groups, lists))) =
                (options.draw_trees, &self.scene.trees, &self.trees)
            {
                let mut pass = pass.scope("trees");
                passes.trees.draw(&mut pass, set, groups, lists, options.wireframe);
                draws += set.materials.len() as u32;
            }
            // Before the land: what it hides needs no light.
            if options.draw_terrain && self.clumps > 0 {
                let (grass, buffer) = (&mut pass.scope("grass"), &self.clump_buffer);
                passes.grass.draw(grass, &self.ground_group, buffer, self.clumps);
                draws += 1;
            }
            if options.draw_terrain {
                let mut pass = pass.scope("land");
                let land = (self.land, &self.land_buffer);
                passes.terrain.draw(&mut pass, &self.scene.land, &self.ground_group, land, options.wireframe);
                draws += 2;
            }
            passes.sky.draw(&mut pass.scope("sky"));
            if options.draw_terrain && self.scene.ground.water_level_m.is_some() {
                passes.water.draw(&mut pass.scope("water"));
                draws += 1;
            }
        }
        let descriptor =
            wgpu::RenderPassDescriptor { color_attachments: &targets.finished(), ..Default::default() };
        let mut pass = scope.scoped_render_pass("tones", descriptor);
        pass.set_bind_group(0, &self.view_group, &[]);
        passes.tone.draw(&mut pass, &targets.group);
        draws
    }
}

/// Into a buffer, which is made anew if it is too small.
fn write(gpu: &Gpu, buffer: &mut wgpu::Buffer, bytes: &[u8]) {
    if bytes.len() as u64 > buffer.size() {
        *buffer = land_buffer(gpu, (bytes.len() as u64).next_power_of_two());
    }
    gpu.queue.write_buffer(buffer, 0, bytes);
}

fn land_buffer(gpu: &Gpu, size: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("land"),
        size,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::INDEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

fn view_group(gpu: &Gpu, layouts: &Layouts, scene: &SceneBuffers, uniform: &wgpu::Buffer) -> wgpu::BindGroup {
    use wgpu::BindingResource::{Sampler, TextureView};
    use wgpu::TextureViewDimension::{Cube, D2};
    let (heaven, land) = (&scene.heaven, &scene.land);
    let views = [
        (3, texture_view(&heaven.cube, Cube)),
        (4, texture_view(&heaven.clear_cube, Cube)),
        (5, texture_view(&heaven.cumulus, D2)),
        (6, texture_view(&heaven.cirrus, D2)),
        (7, texture_view(&scene.shadow_map, D2)),
        (9, texture_view(&land.heights, D2)),
        (10, texture_view(&land.light, D2)),
    ];
    let mut bound = vec![
        (0, uniform.as_entire_binding()),
        (1, Sampler(&layouts.repeating)),
        (2, Sampler(&layouts.clamped)),
        (8, Sampler(&layouts.comparing)),
    ];
    bound.extend(views.iter().map(|(binding, view)| (*binding, TextureView(view))));
    bind(&gpu.device, "view", &layouts.view, &bound)
}

fn ground_group(gpu: &Gpu, layouts: &Layouts, scene: &SceneBuffers) -> wgpu::BindGroup {
    use wgpu::TextureViewDimension::{D2, D2Array};
    let land = &scene.land;
    let views = [
        texture_view(&land.color, D2),
        texture_view(&land.weights, D2),
        texture_view(&land.details, D2Array),
        texture_view(&land.detail_normals, D2Array),
    ];
    let bound: Vec<_> = (0..).zip(views.iter().map(wgpu::BindingResource::TextureView)).collect();
    bind(&gpu.device, "ground", &layouts.ground, &bound)
}

impl Targets {
    fn new(gpu: &Gpu, layouts: &Layouts, label: &str, size_px: [u32; 2], samples: u32) -> Self {
        let texture = |format: wgpu::TextureFormat, samples: u32, usage: wgpu::TextureUsages| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size_px[0], height: size_px[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: samples,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            })
        };
        use wgpu::TextureUsages as Usage;
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        let radiance = view(&texture(RADIANCE, 1, Usage::TEXTURE_BINDING));
        let display = texture(DISPLAY, 1, Usage::TEXTURE_BINDING | Usage::COPY_SRC);
        let bound = [(0, wgpu::BindingResource::TextureView(&radiance))];
        let group = bind(&gpu.device, "radiance", &layouts.radiance, &bound);
        Self {
            size_px,
            multisampled: (samples > 1).then(|| view(&texture(RADIANCE, samples, Usage::empty()))),
            depth: view(&texture(DEPTH, samples, Usage::empty())),
            display_view: view(&display),
            display,
            radiance,
            group,
            fresh: false,
        }
    }

    /// Where radiance is drawn to.
    fn radiance(&self) -> [Option<wgpu::RenderPassColorAttachment<'_>>; 1] {
        [Some(wgpu::RenderPassColorAttachment {
            view: self.multisampled.as_ref().unwrap_or(&self.radiance),
            depth_slice: None,
            resolve_target: self.multisampled.as_ref().map(|_| &self.radiance),
            ops: cleared(),
        })]
    }

    fn depth(&self) -> wgpu::RenderPassDepthStencilAttachment<'_> {
        wgpu::RenderPassDepthStencilAttachment {
            view: &self.depth,
            // Reversed depth: infinitely far is 0.
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(0.0),
                store: wgpu::StoreOp::Discard,
            }),
            stencil_ops: None,
        }
    }

    /// Where the finished picture is drawn to.
    fn finished(&self) -> [Option<wgpu::RenderPassColorAttachment<'_>>; 1] {
        [Some(wgpu::RenderPassColorAttachment {
            view: &self.display_view,
            depth_slice: None,
            resolve_target: None,
            ops: cleared(),
        })]
    }

    /// A picture of nothing.
    fn blank(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("nothing"),
            color_attachments: &self.finished(),
            ..Default::default()
        });
    }
}

fn cleared() -> wgpu::Operations<wgpu::Color> {
    wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store }
}
