//! Draws the pictures of trees that are far away: one draw for all of them, and one instance, for four vertices would be little for
//! each of thousands of instances.

use super::shaders::ShaderError;
use super::{BoundScene, BoundTrees, Compiler, DrawPass, FilledOrWire, PipelineDesc, Shader};
use crate::options::Options;
use crate::scene::IMPOSTOR_ROWS;
use crate::upload::{DrawCommand, MAX_LEVELS, TreeSet};

pub const SHADER: Shader = Shader {
    name: "impostors",
    source: include_str!("impostors.wgsl"),
    constants: &[("ROWS", IMPOSTOR_ROWS as f64), ("PICTURES_LEVEL", MAX_LEVELS as f64)],
};

#[derive(Debug)]
pub struct Impostors {
    pipelines: FilledOrWire<wgpu::RenderPipeline>,
}

impl Impostors {
    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let (shader, layouts) = (compiler.module(&SHADER)?, compiler.layouts);
        let groups = [&layouts.view, &layouts.impostors];
        let pipelines = |wireframe: bool| {
            compiler.pipeline(&PipelineDesc { wireframe, ..PipelineDesc::new(&shader, &groups) })
        };
        Ok(Self { pipelines: FilledOrWire::new(compiler.gpu, pipelines) })
    }
}

impl DrawPass for Impostors {
    fn is_needed(&self, bound: &BoundScene, options: &Options) -> bool {
        options.draw_trees && bound.trees().is_some_and(|(set, _)| set.impostors.is_some())
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, bound: &BoundScene, options: &Options) -> u32 {
        pass.set_pipeline(self.pipelines.get(options.wireframe));
        bound.trees().map_or(0, |(set, trees)| draw(pass, set, trees))
    }
}

/// Draws the pictures that culling left and tells how many draws that takes.
pub(super) fn draw(pass: &mut wgpu::RenderPass<'_>, set: &TreeSet, trees: &BoundTrees) -> u32 {
    let (Some(pictures), Some(group)) = (&set.impostors, &trees.impostors_group) else { return 0 };
    pass.set_bind_group(1, group, &[]);
    pass.set_index_buffer(pictures.indices.slice(..), wgpu::IndexFormat::Uint32);
    let meshes = u64::from(set.mesh_draws) * u64::from(trees.buckets);
    pass.draw_indexed_indirect(&trees.commands, meshes * size_of::<DrawCommand>() as u64);
    1
}
