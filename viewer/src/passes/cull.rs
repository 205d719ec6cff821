//! Culls trees and chooses their levels of detail on the device: the processor's work does not grow with their number.

use std::ops::Range;

use glam::{Vec2, Vec3, Vec4};
use strum::VariantArray;

use super::shaders::ShaderError;
use super::{BoundTrees, Compiler, Shader, ViewUniform};
use crate::camera::Frustum;
use crate::lod::tree::{MIN_DISTANCE_M, SEEN_PX, SMALL_TREE_M, STEEP};
use crate::lod_mode::TreeLodMode;
use crate::options::Options;
use crate::upload::{PICTURE_INDICES, PICTURE_LISTS, TreeSet};

/// Threads of a workgroup.
const GROUP: u32 = 64;
/// The most workgroups along one axis.
const MAX_GROUPS: u32 = 65535;
/// What stands in the place of a mode where all trees are to be drawn as their pictures, and where none is.
const PICTURES: u32 = TreeLodMode::VARIANTS.len() as u32;
const MESHES: u32 = PICTURES + 1;

pub const SHADER: Shader = Shader {
    name: "cull",
    source: include_str!("cull.wgsl"),
    constants: &[
        ("GROUP", GROUP as f64),
        ("MAX_GROUPS", MAX_GROUPS as f64),
        ("MIN_DISTANCE_M", MIN_DISTANCE_M as f64),
        ("SMALL_PX", SEEN_PX[0] as f64),
        ("LARGE_PX", SEEN_PX[1] as f64),
        ("SMALL_TREE_M", SMALL_TREE_M as f64),
        ("STEEP", STEEP[0] as f64),
        ("TOO_STEEP", STEEP[1] as f64),
        ("QUALITY", TreeLodMode::Quality as u32 as f64),
        ("SIMPLE", TreeLodMode::Simple as u32 as f64),
        ("DISCRETE", TreeLodMode::Discrete as u32 as f64),
        ("OFF", TreeLodMode::Off as u32 as f64),
        ("PICTURES", PICTURES as f64),
        ("MESHES", MESHES as f64),
        ("PICTURE_INDICES", PICTURE_INDICES.len() as f64),
        ("PICTURE_LISTS", PICTURE_LISTS as f64),
    ],
};

#[derive(Debug)]
pub struct Cull {
    clear: wgpu::ComputePipeline,
    choose: wgpu::ComputePipeline,
    write_commands: wgpu::ComputePipeline,
}

/// `Cull` of `cull.wgsl`, which says what each field is; a test compares the two.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct CullUniform {
    pub planes: [[f32; 4]; 5],
    pub eye: [f32; 3],
    pub error_per_m: f32,
    pub instances: u32,
    pub templates: u32,
    pub levels: u32,
    pub mesh_draws: u32,
    pub lod_mode: u32,
    pub fixed_error_m: f32,
    pub planes_used: u32,
    pub first: u32,
    pub field: u32,
    pub focal_px: f32,
    pub unused: [u32; 2],
}

impl CullUniform {
    /// For a view: `frustum` and eye of the camera, which sees `focal_px` pixels a radian.
    pub fn for_view(set: &TreeSet, frustum: &Frustum, eye: Vec3, focal_px: f32, options: &Options) -> Self {
        Self {
            planes: frustum.planes.map(Into::into),
            eye: eye.into(),
            error_per_m: options.tree_error_px / focal_px,
            focal_px,
            lod_mode: options.tree_lod as u32,
            planes_used: u32::from(options.cull),
            ..Self::sizes(set)
        }
    }

    /// For a mirror: pictures of all trees that `frustum` sees.
    pub fn for_mirror(set: &TreeSet, frustum: &Frustum) -> Self {
        let planes = frustum.planes.map(Into::into);
        Self { planes, lod_mode: PICTURES, planes_used: 1, ..Self::sizes(set) }
    }

    /// For a shadow map: of `trees` all, each at the coarsest level whose error is no larger than that.
    pub fn for_shadow(set: &TreeSet, error_m: f32, trees: Range<u32>) -> Self {
        let (first, instances) = (trees.start, trees.end.min(set.count));
        Self { lod_mode: MESHES, fixed_error_m: error_m, first, instances, ..Self::sizes(set) }
    }

    /// The same with so much more error for each metre from a place, whose surroundings are shaded.
    pub fn coarser_from(self, place_m: Vec3, error_per_m: f32) -> Self {
        Self { eye: place_m.into(), error_per_m, ..self }
    }

    /// The same, but only trees that reach into the square of that many metres to all four sides of a place.
    pub fn around(self, place_m: Vec2, reach_m: f32) -> Self {
        let side = |axis: Vec3, at_m: f32| (axis, [at_m - reach_m, at_m + reach_m]);
        self.between([side(Vec3::X, place_m.x), side(Vec3::Z, place_m.y)])
    }

    /// The same, but only trees that reach between two pairs of planes: across two directions, from where to where along each.
    pub fn between(self, sides: [(Vec3, [f32; 2]); 2]) -> Self {
        let [[a, b], [c, d]] =
            sides.map(|(axis, [from_m, to_m])| [axis.extend(-from_m), (-axis).extend(to_m)]);
        // Everything is inside of the last.
        let planes = [a, b, c, d, Vec4::W].map(Into::into);
        Self { planes, planes_used: 1, ..self }
    }

    fn sizes(set: &TreeSet) -> Self {
        Self {
            instances: set.count,
            templates: set.template_count,
            levels: set.level_count,
            mesh_draws: set.mesh_draws,
            field: set.field_count,
            ..Default::default()
        }
    }
}

impl Cull {
    pub const NAME: &str = SHADER.name;

    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let module = compiler.module(&SHADER)?;
        let groups = [None, Some(&compiler.layouts.cull)];
        let pipeline = |entry: &str| compiler.compute(&module, groups, entry);
        let (clear, choose) = (pipeline("clear"), pipeline("choose"));
        Ok(Self { clear, choose, write_commands: pipeline("write_commands") })
    }

    /// Three dispatches, whatever the number of trees.
    pub fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, trees: &BoundTrees) {
        pass.set_bind_group(1, &trees.cull_group, &[]);
        pass.set_pipeline(&self.clear);
        dispatch_each(pass, trees.buckets + PICTURE_LISTS);
        pass.set_pipeline(&self.choose);
        dispatch_each(pass, trees.instances);
        pass.set_pipeline(&self.write_commands);
        dispatch_each(pass, trees.command_count);
    }
}

/// A thread for each of so many.
fn dispatch_each(pass: &mut wgpu::ComputePass<'_>, count: u32) {
    let groups = count.div_ceil(GROUP);
    pass.dispatch_workgroups(groups.min(MAX_GROUPS), groups.div_ceil(MAX_GROUPS), 1);
}

const _: () =
    assert!(size_of::<ViewUniform>().is_multiple_of(16) && size_of::<CullUniform>().is_multiple_of(16));
