//! Chooses trees and their levels of detail on the device: the processor's work does not grow with their number.

use std::ops::Range;

use glam::Vec3;

use super::{Layouts, ViewUniform};
use crate::camera::Frustum;
use crate::frame::Options;
use crate::gpu::Gpu;
use crate::shaders::{ShaderError, Shaders};
use crate::upload::TreeSet;

/// The pipelines.
#[derive(Debug)]
pub struct Cull {
    clear: wgpu::ComputePipeline,
    choose: wgpu::ComputePipeline,
    write_commands: wgpu::ComputePipeline,
}

/// `Cull` of `cull.wgsl`, field by field; a test compares the two.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[expect(missing_docs, reason = "cull.wgsl says what each field is")]
pub struct CullUniform {
    pub planes: [[f32; 4]; 5],
    pub eye: [f32; 3],
    pub error_per_m: f32,
    pub instances: u32,
    pub templates: u32,
    pub levels: u32,
    pub materials: u32,
    pub lod_mode: u32,
    pub fixed_error_m: f32,
    pub planes_used: u32,
    pub first: u32,
}

impl CullUniform {
    /// For a view: `frustum` and eye of the camera, which sees `focal_px` pixels a radian.
    pub fn for_view(set: &TreeSet, frustum: &Frustum, eye: Vec3, focal_px: f32, options: &Options) -> Self {
        Self {
            planes: frustum.planes.map(Into::into),
            eye: eye.into(),
            error_per_m: options.tree_error_px / focal_px,
            lod_mode: options.tree_lod as u32,
            planes_used: 1,
            ..Self::sizes(set)
        }
    }

    /// For a shadow map with texels of that size: of the trees of these numbers all.
    pub fn for_shadow(set: &TreeSet, texel_m: f32, trees: Range<u32>) -> Self {
        let (first, instances) = (trees.start, trees.end.min(set.count));
        Self { lod_mode: 4, fixed_error_m: texel_m, first, instances, ..Self::sizes(set) }
    }

    fn sizes(set: &TreeSet) -> Self {
        Self {
            instances: set.count,
            templates: set.template_count,
            levels: set.level_count,
            materials: set.materials.len() as u32,
            ..Default::default()
        }
    }
}

/// What the choice for one view of one landscape is written to.
#[derive(Debug)]
pub struct TreeLists {
    uniform: wgpu::Buffer,
    group: wgpu::BindGroup,
    /// Trees for each level and kind: u32 at level · kinds + kind.
    pub counts: wgpu::Buffer,
    /// Number of each visible tree, and its λ.
    pub visible: wgpu::Buffer,
    /// A [`crate::upload::DrawCommand`] for each material, level and kind.
    pub commands: wgpu::Buffer,
    /// Levels × kinds.
    pub buckets: u32,
    instances: u32,
    command_count: u32,
}

impl TreeLists {
    /// Room for all trees of a landscape.
    pub fn new(gpu: &Gpu, layouts: &Layouts, set: &TreeSet) -> Self {
        use wgpu::BufferUsages as Usage;
        use wgpu::util::DeviceExt;
        let buckets = set.template_count * set.level_count;
        let buffer = |label: &str, bytes: u64, usage: Usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes.max(16),
                usage,
                mapped_at_creation: false,
            })
        };
        let uniform = buffer("choice", size_of::<CullUniform>() as u64, Usage::UNIFORM | Usage::COPY_DST);
        let counts = buffer("counts", 4 * u64::from(buckets), Usage::STORAGE | Usage::COPY_SRC);
        let room = 8 * u64::from(set.list_capacity);
        let visible = buffer("visible trees", room, Usage::STORAGE | Usage::VERTEX | Usage::COPY_SRC);
        let commands = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("commands"),
            contents: bytemuck::cast_slice(&set.commands),
            usage: Usage::STORAGE | Usage::INDIRECT | Usage::COPY_SRC,
        });
        let bound = [&uniform, &set.trees, &set.templates, &counts, &visible, &commands];
        let entries: Vec<wgpu::BindGroupEntry<'_>> = (0..)
            .zip(bound)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("choice of trees"),
            layout: &layouts.cull,
            entries: &entries,
        });
        let (instances, command_count) = (set.count, set.commands.len() as u32);
        Self { uniform, group, counts, visible, commands, buckets, instances, command_count }
    }

    /// Says what to choose by.
    pub fn set(&self, queue: &wgpu::Queue, uniform: &CullUniform) {
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(uniform));
    }
}

/// Threads of a workgroup, as in `cull.wgsl`.
const GROUP: u32 = 64;
/// The most workgroups along one axis.
const MOST_GROUPS: u32 = 65535;

impl Cull {
    /// Compiles them.
    pub fn new(device: &wgpu::Device, layouts: &Layouts, shaders: &Shaders) -> Result<Self, ShaderError> {
        let module = shaders.module(device, "cull")?;
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("choice of trees"),
            // Group 0 is what common.wgsl declares; nothing of it is used here.
            bind_group_layouts: &[None, Some(&layouts.cull)],
            immediate_size: 0,
        });
        let pipeline = |entry: &str| {
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry),
                layout: Some(&layout),
                module: &module,
                entry_point: Some(entry),
                compilation_options: Default::default(),
                cache: None,
            })
        };
        Ok(Self {
            clear: pipeline("clear"),
            choose: pipeline("choose"),
            write_commands: pipeline("write_commands"),
        })
    }

    /// Three dispatches, whatever the number of trees.
    pub fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, lists: &TreeLists) {
        pass.set_bind_group(1, &lists.group, &[]);
        pass.set_pipeline(&self.clear);
        pass.dispatch_workgroups(lists.buckets.div_ceil(GROUP), 1, 1);
        pass.set_pipeline(&self.choose);
        let groups = lists.instances.div_ceil(GROUP);
        pass.dispatch_workgroups(groups.min(MOST_GROUPS), groups.div_ceil(MOST_GROUPS), 1);
        pass.set_pipeline(&self.write_commands);
        pass.dispatch_workgroups(lists.command_count.div_ceil(GROUP), 1, 1);
    }
}

const _: () =
    assert!(size_of::<ViewUniform>().is_multiple_of(16) && size_of::<CullUniform>().is_multiple_of(16));
