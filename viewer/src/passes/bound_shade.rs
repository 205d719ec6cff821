//! The shade of near trees on the ground, as bound for one view: a square around the eye, drawn anew when the eye has come to
//! another place.

use glam::{Vec2, Vec3, Vec3Swizzles};

use super::{Binding, BoundTrees, CullUniform, Layouts, SHADE, SHADOW, SunView, ViewUniform, bind, sun_view};
use crate::gpu::{Gpu, flat};
use crate::upload::SceneBuffers;

/// Texels a side, of the square and of what the sun sees. A trunk is some decimetres wide: a seventh of a metre a texel shows it,
/// where a device is slow; a twentieth shows twigs.
const SIDE: [u32; 2] = [768, 2048];
const LEVELS: u32 = 8;
/// Of a tree the level is drawn whose error is that many texels: the sun's disc blurs what is finer.
const ERROR_TEXELS: f32 = 1.5;
/// How wide the square is. Shaders look up less of it (`near_shade_at` of `common.wgsl`): by as much as the eye may be beside its
/// middle.
const EXTENT_M: f32 = 104.0;
/// The eye may be so far from the middle.
const MAX_ASIDE_M: f32 = 3.5;
/// Sine of the sun's elevation below which shadows on the ground are too long to have any edges.
const MIN_ELEVATION: f32 = 0.03;

/// How much of the sun's light trees let through to the ground around an eye, with what it takes to draw that.
#[derive(Debug)]
pub struct BoundShade {
    pub(super) texture: wgpu::Texture,
    /// Of the texture, the finest first.
    pub(super) levels: Vec<Level>,
    /// What the sun sees.
    pub(super) depth: wgpu::TextureView,
    pub(super) sun_group: wgpu::BindGroup,
    /// None where there are none, or no sun to shade from.
    pub(super) trees: Option<BoundTrees>,
    uniform: wgpu::Buffer,
    /// Of the square, x and z; none before it is first drawn.
    middle_m: Option<Vec2>,
}

/// A version of the texture.
#[derive(Debug)]
pub(super) struct Level {
    pub view: wgpu::TextureView,
    /// What it is made from.
    pub source: wgpu::BindGroup,
}

impl BoundShade {
    pub(super) fn new(gpu: &Gpu, layouts: &Layouts, scene: &SceneBuffers) -> Self {
        let set = scene.trees.as_ref().filter(|_| scene.sky.sun_direction.y > MIN_ELEVATION);
        let (side, levels) = if set.is_some() { (SIDE[usize::from(!gpu.software)], LEVELS) } else { (1, 1) };
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            mip_level_count: levels,
            ..flat("shade of near trees", [side; 2], SHADE, usage)
        });
        let depth = gpu.device.create_texture(&flat("trees seen by the sun", [side; 2], SHADOW, usage));
        let depth = depth.create_view(&Default::default());
        let views: Vec<_> = (0..levels)
            .map(|level| {
                let only = wgpu::TextureViewDescriptor {
                    base_mip_level: level,
                    mip_level_count: Some(1),
                    ..Default::default()
                };
                texture.create_view(&only)
            })
            .collect();
        let source = |level: usize| match level.checked_sub(1) {
            None => {
                bind(gpu, "trees seen by the sun", &layouts.seen_by_sun, [(0, Binding::View(depth.clone()))])
            }
            Some(finer) => {
                bind(gpu, "finer shade", &layouts.finer, [(1, Binding::View(views[finer].clone()))])
            }
        };
        let levels = views.iter().enumerate();
        let levels =
            levels.map(|(level, view)| Level { view: view.clone(), source: source(level) }).collect();
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let uniform = gpu.empty_buffer("sun", size_of::<ViewUniform>() as u64, usage);
        Self {
            sun_group: sun_view::group(gpu, layouts, scene, &uniform),
            trees: set.map(|set| BoundTrees::new(gpu, layouts, set)),
            texture,
            levels,
            depth,
            uniform,
            middle_m: None,
        }
    }

    /// Follows the eye and says whether the square has to be drawn anew. Once it is drawn it only follows if it may.
    pub fn follow(&mut self, gpu: &Gpu, scene: &SceneBuffers, eye_m: Vec3, may_move: bool) -> bool {
        let is_near = |middle_m: Vec2| middle_m.distance(eye_m.xz()) <= MAX_ASIDE_M;
        let stays = self.middle_m.is_some_and(|middle_m| is_near(middle_m) || !may_move);
        let Some((set, trees)) = scene.trees.as_ref().zip(self.trees.as_ref()).filter(|_| !stays) else {
            return false;
        };
        // By whole texels, so that edges of shadows stay where they are.
        let texel_m = EXTENT_M / self.texture.width() as f32;
        let middle_m = (eye_m.xz() / texel_m).round() * texel_m;
        self.middle_m = Some(middle_m);
        let sun_view = SunView::of_ground(scene, middle_m, 0.5 * EXTENT_M);
        let numbers = ViewUniform { shade: self.place(), ..ViewUniform::for_sun(scene, &sun_view) };
        gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&numbers));
        let error_m = ERROR_TEXELS * sun_view.texel_m(self.texture.width());
        trees.set(&gpu.queue, &CullUniform::for_shadow(set, error_m, 0..set.count).between(sun_view.sides()));
        true
    }

    /// `shade` of `common.wgsl`'s `View`.
    pub fn place(&self) -> [f32; 4] {
        self.middle_m.map_or([0.0, 0.0, 1.0, 0.0], |middle_m| [middle_m.x, middle_m.y, EXTENT_M, 1.0])
    }
}
