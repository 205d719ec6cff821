//! Draws the pictures of trees that are far away: a draw for all of the field's and one for all beyond it, each of one instance, for
//! four vertices would be little for each of thousands of instances.

use super::pipeline::Module;
use super::shaders::ShaderError;
use super::{BoundScene, BoundTrees, Compiler, DrawPass, FilledOrWire, PipelineDesc, Shader, Target};
use crate::options::Options;
use crate::scene::IMPOSTOR_ROWS;
use crate::upload::{DrawCommand, MAX_LEVELS, PICTURE_LISTS, TreeSet};

pub const SHADER: Shader = Shader {
    name: "impostors",
    source: include_str!("impostors.wgsl"),
    constants: &[("ROWS", IMPOSTOR_ROWS as f64), ("PICTURES_LEVEL", MAX_LEVELS as f64)],
};

#[derive(Debug)]
pub struct Impostors {
    pipelines: FilledOrWire<PicturePipelines>,
}

/// One for the trees of the field and one for those beyond.
#[derive(Debug)]
pub(super) struct PicturePipelines([wgpu::RenderPipeline; PICTURE_LISTS as usize]);

impl Impostors {
    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let shader = compiler.module(&SHADER)?;
        let pipelines = |wireframe: bool| {
            PicturePipelines::new(compiler, &shader, ["field", "beyond"], Target::Radiance, wireframe)
        };
        Ok(Self { pipelines: FilledOrWire::new(compiler.gpu, pipelines) })
    }
}

impl DrawPass for Impostors {
    fn is_needed(&self, bound: &BoundScene, options: &Options) -> bool {
        options.draw_trees && bound.trees().is_some_and(|(set, _)| set.impostors.is_some())
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, bound: &BoundScene, options: &Options) -> u32 {
        let pipelines = self.pipelines.get(options.wireframe);
        bound.trees().map_or(0, |(set, trees)| pipelines.draw(pass, set, trees))
    }
}

impl PicturePipelines {
    /// Those of a lake's mirror.
    pub fn mirrored(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let (shader, fragments) = (compiler.module(&SHADER)?, ["mirrored_field", "mirrored_beyond"]);
        Ok(Self::new(compiler, &shader, fragments, Target::Mirror, false))
    }

    fn new(
        compiler: &Compiler<'_>,
        shader: &Module,
        fragments: [&str; PICTURE_LISTS as usize],
        target: Target,
        wireframe: bool,
    ) -> Self {
        let groups = [&compiler.layouts.view, &compiler.layouts.impostors];
        Self(fragments.map(|fragment| {
            let usual = PipelineDesc::new(shader, &groups);
            compiler.pipeline(&PipelineDesc { fragment: Some(fragment), target, wireframe, ..usual })
        }))
    }

    /// Draws the pictures that culling left and tells how many draws that takes.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, set: &TreeSet, trees: &BoundTrees) -> u32 {
        let (Some(pictures), Some(group)) = (&set.impostors, &trees.impostors_group) else { return 0 };
        pass.set_bind_group(1, group, &[]);
        pass.set_index_buffer(pictures.indices.slice(..), wgpu::IndexFormat::Uint32);
        let meshes = set.mesh_draws * trees.buckets;
        let has_trees = [set.field_count > 0, set.count > set.field_count];
        let needed = (meshes..).zip(&self.0).zip(has_trees).filter(|(_, has_trees)| *has_trees);
        let mut draws = 0;
        for ((command, pipeline), _) in needed {
            pass.set_pipeline(pipeline);
            pass.draw_indexed_indirect(&trees.commands, u64::from(command) * size_of::<DrawCommand>() as u64);
            draws += 1;
        }
        draws
    }
}
