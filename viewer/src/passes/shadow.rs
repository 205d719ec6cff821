//! Draws what the sun sees of a landscape, once.

use super::cull::{Cull, CullUniform, TreeLists};
use super::trees::{TreeGroups, buffers};
use super::view_uniform::{ViewUniform, shadow_from_world};
use super::{Layouts, SHADOW, bind, texture_view};
use crate::gpu::Gpu;
use crate::shaders::{ShaderError, Shaders};
use crate::upload::{DrawCommand, SceneBuffers};

/// The pipelines.
#[derive(Debug)]
pub struct Shadow {
    bark: wgpu::RenderPipeline,
    leaf: wgpu::RenderPipeline,
    land: wgpu::RenderPipeline,
}

/// The land is drawn as a grid of every so many samples; as in `shadow.wgsl`.
const LAND_STEP: u32 = 4;

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
        Ok(Self {
            // The sides of a trunk that face away bound its shadow (second-depth shadow mapping).
            bark: build("tree", None, Some(wgpu::Face::Front), true),
            leaf: build("tree", Some("leaf"), None, true),
            land: build("land", None, None, false),
        })
    }

    /// Draws a landscape's shadow map; may run on any thread. `cull` chooses trees: of each the level whose error is
    /// below half a texel.
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
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let trees = scene.trees.as_ref().map(|set| {
            let lists = TreeLists::new(gpu, layouts, set);
            lists.set(&gpu.queue, &CullUniform::for_shadow(set, 0.5 * texel_m(scene)));
            cull.dispatch(&mut encoder.begin_compute_pass(&Default::default()), &lists);
            (TreeGroups::new(gpu, layouts, set), lists)
        });
        let map = texture_view(&scene.shadow_map, wgpu::TextureViewDimension::D2);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadows"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &map,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        self.draw(&mut pass, scene, &view, trees.as_ref().map(|(groups, lists)| (groups, lists)));
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
    }

    /// Draws land and trees as the sun sees them; `view` is group 0 in the layout for this pass.
    fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        scene: &SceneBuffers,
        view: &wgpu::BindGroup,
        trees: Option<(&TreeGroups, &TreeLists)>,
    ) {
        pass.set_bind_group(0, view, &[]);
        pass.set_pipeline(&self.land);
        let cells = (scene.ground.field.side - 1) / LAND_STEP;
        pass.draw(0..cells * cells * 6, 0..1);
        let (Some(set), Some((groups, lists))) = (&scene.trees, trees) else { return };
        pass.set_bind_group(1, &groups.trees, &[]);
        pass.set_vertex_buffer(0, set.vertices.slice(..));
        pass.set_vertex_buffer(1, lists.visible.slice(..));
        pass.set_index_buffer(set.indices.slice(..), wgpu::IndexFormat::Uint32);
        for (slot, material) in set.materials.iter().enumerate() {
            pass.set_pipeline(if material.masked { &self.leaf } else { &self.bark });
            pass.set_bind_group(2, &groups.materials[slot], &[]);
            let first = slot as u64 * u64::from(lists.buckets) * size_of::<DrawCommand>() as u64;
            pass.multi_draw_indexed_indirect(&lists.commands, first, lists.buckets);
        }
    }
}

/// How wide a texel of a landscape's shadow map is: the map covers [−1, 1] along the first row of its matrix.
fn texel_m(scene: &SceneBuffers) -> f32 {
    let along = shadow_from_world(scene).transpose().x_axis.truncate().length();
    2.0 / (along * scene.shadow_map.width() as f32)
}
