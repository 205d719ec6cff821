//! How the leaves of trees that are drawn as pictures are lit, on average: worked out for each tree once, not for each corner of its
//! picture.

use super::cull::dispatch_each;
use super::shaders::ShaderError;
use super::{BoundTrees, Compiler, impostors};

#[derive(Debug)]
pub struct LeafLight {
    pipeline: wgpu::ComputePipeline,
}

impl LeafLight {
    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let (module, layouts) = (compiler.module(&impostors::SHADER)?, compiler.layouts);
        let groups = [Some(&layouts.view), Some(&layouts.leaf_light)];
        Ok(Self { pipeline: compiler.compute(&module, groups, "light_leaves") })
    }

    /// For the pictures that culling left, as seen from a view.
    pub fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, view: &wgpu::BindGroup, trees: &BoundTrees) {
        let Some(group) = &trees.leaf_light_group else { return };
        pass.set_bind_group(0, view, &[]);
        pass.set_bind_group(1, group, &[]);
        pass.set_pipeline(&self.pipeline);
        dispatch_each(pass, trees.instances);
    }
}
