//! Draws what the sun sees of a landscape, once.

use super::shaders::ShaderError;
use super::trees::{TreePipelines, buffers};
use super::{
    BoundTrees, Compiler, CullUniform, Passes, PipelineDesc, Shader, SunView, Target, ViewUniform, sun_view,
};
use crate::gpu::Gpu;
use crate::upload::{SceneBuffers, TreeSet};
use glam::Vec2;
use wgpu::{CommandEncoder, LoadOp, RenderPass, TextureView};

pub const SHADER: Shader = Shader {
    name: "shadow",
    source: include_str!("shadow.wgsl"),
    constants: &[("LAND_CELLS", LAND_CELLS as f64)],
};

/// The land is drawn as a grid of so many cells a side, 8 m each, or of as many as it has: both are powers of two.
const LAND_CELLS: u32 = 128;
/// Trees that are drawn in one go: in software, a fifth of what four pictures take.
const TREES_A_PIECE: u32 = 256;

#[derive(Debug)]
pub struct Shadow {
    pub(super) trees: TreePipelines,
    land: wgpu::RenderPipeline,
}

impl Shadow {
    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let (shader, layouts) = (compiler.module(&SHADER)?, compiler.layouts);
        let (buffers, groups) = (buffers(), [&layouts.sun_view, &layouts.trees, &layouts.material]);
        let usual = || PipelineDesc { target: Target::Shadow, ..PipelineDesc::new(&shader, &groups) };
        let trees = |fragment: Option<&str>, cull: Option<wgpu::Face>| {
            compiler.pipeline(&PipelineDesc { vertex: "tree", fragment, buffers: &buffers, cull, ..usual() })
        };
        let land = PipelineDesc { vertex: "land", fragment: None, groups: &groups[..1], ..usual() };
        Ok(Self {
            trees: TreePipelines {
                // The sides of a trunk that face away bound its shadow (second-depth shadow mapping).
                opaque: trees(None, Some(wgpu::Face::Front)),
                masked: trees(Some("leaf"), None),
                thin: trees(Some("twig"), None),
                clusters: trees(Some("leaf"), None),
            },
            land: compiler.pipeline(&land),
        })
    }

    /// Begins a landscape's shadow map; may run on any thread.
    pub fn begin<'a>(&'a self, gpu: &'a Gpu, passes: &'a Passes, scene: &'a SceneBuffers) -> ShadowBake<'a> {
        let sun_view = SunView::of_field(scene);
        let uniform =
            gpu.buffer("sun", &[ViewUniform::for_sun(scene, &sun_view)], wgpu::BufferUsages::UNIFORM);
        ShadowBake {
            view: sun_view::group(gpu, &passes.layouts, scene, &uniform),
            map: scene.shadow_map.create_view(&Default::default()),
            trees: scene.trees.as_ref().map(|set| (set, BoundTrees::new(gpu, &passes.layouts, set))),
            half_texel_m: 0.5 * sun_view.texel_m(scene.shadow_map.width()),
            gpu,
            passes,
            scene,
        }
    }
}

/// A shadow map that is being drawn, piece by piece (the land, then some trees after others), each waited for: a device does
/// one thing after the other, and drawn in one go a forest keeps pictures waiting, in software for a quarter of a second.
pub struct ShadowBake<'a> {
    gpu: &'a Gpu,
    passes: &'a Passes,
    scene: &'a SceneBuffers,
    view: wgpu::BindGroup,
    map: TextureView,
    trees: Option<(&'a TreeSet, BoundTrees)>,
    /// Of a tree the level is drawn whose error is below this.
    half_texel_m: f32,
}

impl ShadowBake<'_> {
    /// What the land hides from the sun; to be drawn before the trees.
    pub fn land(&self) {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = begin(&mut encoder, &self.map, LoadOp::Clear(1.0));
            pass.set_bind_group(0, &self.view, &[]);
            pass.set_pipeline(&self.passes.shadow.land);
            let cells = (self.scene.ground.field.side - 1).min(LAND_CELLS);
            pass.draw(0..cells * cells * 6, 0..1);
        }
        self.gpu.work(encoder.finish());
    }

    /// The trees within `reach_m` east, west, north and south of a place.
    pub fn trees_around(&self, place_m: Vec2, reach_m: f32) {
        let Some((set, _)) = &self.trees else { return };
        self.draw(
            &CullUniform::for_shadow(set, self.half_texel_m, 0..set.field_count).around(place_m, reach_m),
        );
    }

    /// Some trees from this number on; where to go on, if there are more.
    pub fn trees_from(&self, first: u32) -> Option<u32> {
        let (set, _) = self.trees.as_ref()?;
        let next = first.saturating_add(TREES_A_PIECE);
        self.draw(&CullUniform::for_shadow(set, self.half_texel_m, first..next.min(set.field_count)));
        Some(next).filter(|next| *next < set.field_count)
    }

    /// All of it.
    pub fn all(&self) {
        self.land();
        let mut next = Some(0);
        while let Some(first) = next {
            next = self.trees_from(first);
        }
    }

    fn draw(&self, chosen: &CullUniform) {
        let Some((set, trees)) = &self.trees else { return };
        trees.set(&self.gpu.queue, chosen);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.passes.cull.dispatch(&mut encoder.begin_compute_pass(&Default::default()), trees);
        {
            let mut pass = begin(&mut encoder, &self.map, LoadOp::Load);
            pass.set_bind_group(0, &self.view, &[]);
            self.passes.shadow.trees.draw(&mut pass, set, trees, None);
        }
        self.gpu.work(encoder.finish());
    }
}

/// Begins a pass that draws what the sun or a lamp sees.
pub(super) fn begin<'a>(
    encoder: &'a mut CommandEncoder,
    map: &TextureView,
    load: LoadOp<f32>,
) -> RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("shadows"),
        depth_stencil_attachment: Some(attached(map, load)),
        ..Default::default()
    })
}

/// What a pass draws into that draws what the sun sees.
pub(super) fn attached(map: &TextureView, load: LoadOp<f32>) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view: map,
        depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
        stencil_ops: None,
    }
}
