//! What a lake mirrors, as bound for one view: where it is drawn to, and the buffers that are written for each frame.

use std::ops::Range;

use glam::{Mat4, Vec3};

use super::{Binding, BoundTrees, DEPTH, Elements, Layouts, RADIANCE, ViewUniform, bind};
use crate::camera::{Camera, Frustum};
use crate::gpu::{Gpu, cleared, flat};
use crate::lod::nested::Sight;
use crate::upload::{Lake, SceneBuffers};

/// The mirror's pixels are that many of the picture's wide and high: waves blur them anyway.
const COARSER: u32 = 2;
/// How far beyond the lake's part of the picture waves fetch what they show, as a part of half the picture.
const REACH: f32 = 0.12;

/// The mirror of a view, with room for the trees that it shows.
#[derive(Debug)]
pub struct BoundMirror {
    pub(super) uniform: wgpu::Buffer,
    pub view_group: wgpu::BindGroup,
    /// None if the landscape has none, or no pictures of them.
    pub trees: Option<BoundTrees>,
    /// Numbers of samples: triangles of the land.
    pub land: Elements,
    /// What is drawn of the ring's indices.
    pub ring: Vec<Range<u32>>,
    targets: Option<Targets>,
    /// `None` while the picture does not show the lake.
    pub reflection: Option<Reflection>,
}

/// How the lake's surface mirrors one camera.
#[derive(Clone, Debug)]
pub struct Reflection {
    /// Clip space from the mirrored world.
    clip_from_world: Mat4,
    /// What of it the lake shows.
    pub frustum: Frustum,
    /// The same in pixels of the mirror: left, top, width, height.
    pub window_px: [u32; 4],
    level_m: f32,
    eye_m: Vec3,
}

#[derive(Debug)]
struct Targets {
    size_px: [u32; 2],
    radiance: wgpu::TextureView,
    depth: wgpu::TextureView,
    /// What water reads.
    group: wgpu::BindGroup,
}

impl Reflection {
    /// `None` if a picture of that size as `camera` sees it, with land drawn for that sight, shows nothing of the lake.
    pub fn of(lake: &Lake, camera: &Camera, size_px: [u32; 2], drawn: Sight) -> Option<Self> {
        let [width, height] = size_px.map(|side| side as f32);
        let clip_from_world = camera.clip_from_world(width / height);
        let window = lake.seen(&clip_from_world, camera.position_m, drawn)?.grown(REACH)?;
        let lifted = Mat4::from_translation(Vec3::Y * 2.0 * lake.level_m);
        let clip_from_world = clip_from_world * lifted * Mat4::from_scale(Vec3::new(1.0, -1.0, 1.0));
        Some(Self {
            clip_from_world,
            frustum: Frustum::of(window.crop() * clip_from_world),
            window_px: window.pixels(coarser(size_px)),
            level_m: lake.level_m,
            eye_m: camera.position_m,
        })
    }

    /// False for an eye under water, for which nothing is mirrored.
    pub fn is_from_above(&self) -> bool {
        self.eye_m.y > self.level_m
    }

    /// Pixels of the mirror that one radian covers, from those of the picture.
    pub fn focal_px(&self, of_view_px: f32) -> f32 {
        of_view_px / COARSER as f32
    }

    /// The numbers of the mirrored view, from those of the view.
    pub fn numbers(&self, of_view: ViewUniform) -> ViewUniform {
        let mirrored = |[x, y, z]: [f32; 3]| [x, 2.0 * self.level_m - y, z];
        ViewUniform {
            clip_from_world: self.clip_from_world.to_cols_array_2d(),
            eye: mirrored(of_view.eye),
            lod_eye: mirrored(of_view.lod_eye),
            focal_px: self.focal_px(of_view.focal_px),
            ..of_view
        }
    }
}

impl BoundMirror {
    /// `None` where there is no lake. `bind_view` makes a view's group from its uniform.
    pub(super) fn new(
        gpu: &Gpu,
        layouts: &Layouts,
        scene: &SceneBuffers,
        bind_view: impl Fn(&wgpu::Buffer) -> wgpu::BindGroup,
    ) -> Option<Self> {
        scene.land.lake.as_ref()?;
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let uniform = gpu.empty_buffer("mirror", size_of::<ViewUniform>() as u64, usage);
        let pictured = scene.trees.as_ref().filter(|set| set.impostors.is_some());
        Some(Self {
            view_group: bind_view(&uniform),
            uniform,
            trees: pictured.map(|set| BoundTrees::new(gpu, layouts, set)),
            land: Elements::new(gpu, "mirrored terrain"),
            ring: Vec::new(),
            targets: None,
            reflection: None,
        })
    }

    /// Says what to mirror, for a picture of that size.
    pub fn set(&mut self, gpu: &Gpu, layouts: &Layouts, size_px: [u32; 2], numbers: &ViewUniform) {
        gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(numbers));
        let size_px = coarser(size_px);
        if self.targets.as_ref().is_none_or(|targets| targets.size_px != size_px) {
            self.targets = Some(Targets::new(gpu, layouts, size_px));
        }
    }

    /// What water reads, if the picture shows any.
    pub(super) fn group(&self) -> Option<&wgpu::BindGroup> {
        self.reflection.as_ref().and(self.targets.as_ref()).map(|targets| &targets.group)
    }

    /// The pass that draws the mirror, empty at first.
    pub fn begin<'a>(
        &self,
        name: &'static str,
        scope: &'a mut wgpu_profiler::Scope<'_, wgpu::CommandEncoder>,
    ) -> Option<wgpu_profiler::OwningScope<'a, wgpu::RenderPass<'a>>> {
        let Targets { radiance, depth, .. } = self.targets.as_ref()?;
        let depth_ops = wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store };
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(depth_ops),
            stencil_ops: None,
        };
        let descriptor = wgpu::RenderPassDescriptor {
            color_attachments: &[cleared(radiance, None, wgpu::Color::TRANSPARENT)],
            depth_stencil_attachment: Some(depth),
            ..Default::default()
        };
        Some(scope.scoped_render_pass(name, descriptor))
    }
}

impl Targets {
    fn new(gpu: &Gpu, layouts: &Layouts, size_px: [u32; 2]) -> Self {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let view = |format| {
            let texture = gpu.device.create_texture(&flat("mirror", size_px, format, usage));
            texture.create_view(&Default::default())
        };
        let (radiance, depth) = (view(RADIANCE), view(DEPTH));
        let bound = [&radiance, &depth].map(|view| Binding::View(view.clone()));
        Self { size_px, group: bind(gpu, "mirror", &layouts.mirror, (0..).zip(bound)), radiance, depth }
    }
}

fn coarser(size_px: [u32; 2]) -> [u32; 2] {
    size_px.map(|side| side.div_ceil(COARSER))
}
