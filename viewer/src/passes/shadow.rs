//! Draws what the sun sees of a landscape, once.

use super::bind;
use super::layouts::SUN_VIEW;
use super::shaders::ShaderError;
use super::trees::{TreePipelines, buffers};
use super::view_uniform::shadow_from_world;
use super::{Binding, BoundTrees, Compiler, Cull, CullUniform, Layouts};
use super::{PipelineDesc, Shader, Target, ViewUniform};
use crate::gpu::Gpu;
use crate::upload::SceneBuffers;
use wgpu::{CommandEncoder, LoadOp, RenderPass, TextureView};

pub const SHADER: Shader = Shader {
    name: "shadow",
    source: include_str!("shadow.wgsl"),
    constants: &[("LAND_STEP", LAND_STEP as f64)],
};

/// The land is drawn as a grid of every so many samples.
const LAND_STEP: u32 = 4;
/// Trees that are drawn in one go: in software, a fifth of what four pictures take.
const TREES_A_PIECE: u32 = 256;

#[derive(Debug)]
pub struct Shadow {
    trees: TreePipelines,
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
            },
            land: compiler.pipeline(&land),
        })
    }

    /// Draws a landscape's shadow map; may run on any thread. `cull` chooses trees: of each the level whose error is
    /// below half a texel. Waits until it is done, and works in pieces (the land, then some trees after others): a device
    /// does one thing after the other, and drawn in one go a forest keeps pictures waiting, in software for a quarter of a
    /// second.
    pub fn bake(&self, gpu: &Gpu, layouts: &Layouts, cull: &Cull, scene: &SceneBuffers) {
        let usage = wgpu::BufferUsages::UNIFORM;
        let uniform = gpu.buffer("sun", &[ViewUniform::for_sun(scene)], usage);
        let bound = [
            Binding::Buffer(&uniform),
            Binding::Sampler(&layouts.clamped),
            Binding::texture(&scene.land.heights),
        ];
        let view = bind(gpu, "view of the sun", &layouts.sun_view, SUN_VIEW.into_iter().zip(bound));
        let map = scene.shadow_map.create_view(&Default::default());
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = begin(&mut encoder, &map, LoadOp::Clear(1.0));
            pass.set_bind_group(0, &view, &[]);
            pass.set_pipeline(&self.land);
            let cells = (scene.ground.field.side - 1) / LAND_STEP;
            pass.draw(0..cells * cells * 6, 0..1);
        }
        finish(gpu, encoder);
        let Some(set) = &scene.trees else { return };
        let trees = BoundTrees::new(gpu, layouts, set);
        for first in (0..set.count).step_by(TREES_A_PIECE as usize) {
            let piece = first..first.saturating_add(TREES_A_PIECE);
            trees.set(&gpu.queue, &CullUniform::for_shadow(set, 0.5 * texel_m(scene), piece));
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            cull.dispatch(&mut encoder.begin_compute_pass(&Default::default()), &trees);
            {
                let mut pass = begin(&mut encoder, &map, LoadOp::Load);
                pass.set_bind_group(0, &view, &[]);
                self.trees.draw(&mut pass, set, &trees);
            }
            finish(gpu, encoder);
        }
    }
}

fn begin<'a>(encoder: &'a mut CommandEncoder, map: &TextureView, load: LoadOp<f32>) -> RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("shadows"),
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: map,
            depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}

/// Hands work over and waits for it, so that pictures that others draw come in between.
fn finish(gpu: &Gpu, encoder: CommandEncoder) {
    let submitted = gpu.queue.submit([encoder.finish()]);
    // An error here means a lost device, which the next call reports.
    let _ = gpu.device.poll(wgpu::PollType::Wait { submission_index: Some(submitted), timeout: None });
}

/// How wide a texel of a landscape's shadow map is: the map covers [−1, 1] along the first row of its matrix.
fn texel_m(scene: &SceneBuffers) -> f32 {
    let along = shadow_from_world(scene).transpose().x_axis.truncate().length();
    2.0 / (along * scene.shadow_map.width() as f32)
}
