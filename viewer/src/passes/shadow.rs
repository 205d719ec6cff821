//! Draws what the sun sees of a landscape, once.

use super::cull::{Cull, CullUniform, TreeLists};
use super::trees::{TreeGroups, buffers, draw_chosen};
use super::view_uniform::{ViewUniform, shadow_from_world};
use super::{Layouts, SHADOW, bind, texture_view};
use crate::gpu::Gpu;
use crate::shaders::{ShaderError, Shaders};
use crate::upload::SceneBuffers;

/// The pipelines.
#[derive(Debug)]
pub struct Shadow {
    /// As [`draw_chosen`] wants them.
    trees: [wgpu::RenderPipeline; 2],
    land: wgpu::RenderPipeline,
}

/// The land is drawn as a grid of every so many samples; as in `shadow.wgsl`.
const LAND_STEP: u32 = 4;

/// Trees that are drawn in one go: in software, a fifth of what four pictures take.
const TREES_A_PIECE: u32 = 256;

impl Shadow {
    /// Compiles them.
    pub fn new(device: &wgpu::Device, layouts: &Layouts, shaders: &Shaders) -> Result<Self, ShaderError> {
        let module = shaders.module(device, "shadow")?;
        let tree_buffers = buffers();
        let build = |vertex: &str, fragment: Option<&str>, cull: Option<wgpu::Face>, of_trees: bool| {
            let groups = [Some(&layouts.sun_view), Some(&layouts.trees), Some(&layouts.material)];
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("shadow"),
                bind_group_layouts: if of_trees { &groups } else { &groups[..1] },
                immediate_size: 0,
            });
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("shadow"),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(vertex),
                    compilation_options: Default::default(),
                    buffers: if of_trees { &tree_buffers } else { &[] },
                },
                primitive: wgpu::PrimitiveState { cull_mode: cull, ..Default::default() },
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: SHADOW,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::Less),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                multisample: Default::default(),
                fragment: fragment.map(|entry| wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(entry),
                    compilation_options: Default::default(),
                    targets: &[],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        // The sides of a trunk that face away bound its shadow (second-depth shadow mapping).
        let bark = build("tree", None, Some(wgpu::Face::Front), true);
        let leaf = build("tree", Some("leaf"), None, true);
        Ok(Self { trees: [bark, leaf], land: build("land", None, None, false) })
    }

    /// Draws a landscape's shadow map; may run on any thread. `cull` chooses trees: of each the level whose error is
    /// below half a texel. Waits until it is done, and works in pieces (the land, then some trees after others): a device
    /// does one thing after the other, and drawn in one go a forest keeps pictures waiting, in software for a quarter of a
    /// second.
    pub fn bake(&self, gpu: &Gpu, layouts: &Layouts, cull: &Cull, scene: &SceneBuffers) {
        use wgpu::util::DeviceExt;
        let sun = ViewUniform::for_sun(scene);
        let uniform = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("sun"),
            contents: bytemuck::bytes_of(&sun),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let heights = texture_view(&scene.land.heights, wgpu::TextureViewDimension::D2);
        let bound = [
            (0, uniform.as_entire_binding()),
            (2, wgpu::BindingResource::Sampler(&layouts.clamped)),
            (9, wgpu::BindingResource::TextureView(&heights)),
        ];
        let view = bind(&gpu.device, "view of the sun", &layouts.sun_view, &bound);
        let map = texture_view(&scene.shadow_map, wgpu::TextureViewDimension::D2);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = begin(&mut encoder, &map, wgpu::LoadOp::Clear(1.0));
            pass.set_bind_group(0, &view, &[]);
            self.draw_land(&mut pass, scene);
        }
        finish(gpu, encoder);
        let Some(set) = &scene.trees else { return };
        let (groups, lists) = (TreeGroups::new(gpu, layouts, set), TreeLists::new(gpu, layouts, set));
        for first in (0..set.count).step_by(TREES_A_PIECE as usize) {
            let piece = first..first.saturating_add(TREES_A_PIECE);
            lists.set(&gpu.queue, &CullUniform::for_shadow(set, 0.5 * texel_m(scene), piece));
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            cull.dispatch(&mut encoder.begin_compute_pass(&Default::default()), &lists);
            {
                let mut pass = begin(&mut encoder, &map, wgpu::LoadOp::Load);
                pass.set_bind_group(0, &view, &[]);
                draw_chosen(&mut pass, set, &groups, &lists, &self.trees);
            }
            finish(gpu, encoder);
        }
    }

    fn draw_land(&self, pass: &mut wgpu::RenderPass<'_>, scene: &SceneBuffers) {
        pass.set_pipeline(&self.land);
        let cells = (scene.ground.field.side - 1) / LAND_STEP;
        pass.draw(0..cells * cells * 6, 0..1);
    }
}

fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    map: &wgpu::TextureView,
    load: wgpu::LoadOp<f32>,
) -> wgpu::RenderPass<'a> {
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
fn finish(gpu: &Gpu, encoder: wgpu::CommandEncoder) {
    let submitted = gpu.queue.submit([encoder.finish()]);
    // An error here means a lost device, which the next call reports.
    let _ = gpu.device.poll(wgpu::PollType::Wait { submission_index: Some(submitted), timeout: None });
}

/// How wide a texel of a landscape's shadow map is: the map covers [−1, 1] along the first row of its matrix.
fn texel_m(scene: &SceneBuffers) -> f32 {
    let along = shadow_from_world(scene).transpose().x_axis.truncate().length();
    2.0 / (along * scene.shadow_map.width() as f32)
}
