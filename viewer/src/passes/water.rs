//! Draws the lake over everything else.

use super::shaders::ShaderError;
use super::{BoundMirror, BoundScene, Compiler, DrawPass, PipelineDesc, Shader};
use crate::options::Options;

pub const SHADER: Shader =
    Shader { name: "water", source: include_str!("water.wgsl"), constants: &[("CELLS", CELLS as f64)] };

/// The surface is drawn as so many cells a side.
const CELLS: u32 = 3;

#[derive(Debug)]
pub struct Water {
    pipeline: wgpu::RenderPipeline,
}

impl Water {
    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let (module, groups) =
            (compiler.module(&SHADER)?, [&compiler.layouts.view, &compiler.layouts.mirror]);
        // Not culled: a diver sees the surface from below.
        let blend = Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING);
        let desc = PipelineDesc { blend, ..PipelineDesc::new(&module, &groups) };
        Ok(Self { pipeline: compiler.pipeline(&desc) })
    }
}

impl DrawPass for Water {
    fn is_needed(&self, bound: &BoundScene, options: &Options) -> bool {
        options.draw_terrain && bound.mirror.as_ref().is_some_and(|mirror| mirror.reflection.is_some())
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, bound: &BoundScene, _: &Options) -> u32 {
        let Some(mirrored) = bound.mirror.as_ref().and_then(BoundMirror::group) else { return 0 };
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, mirrored, &[]);
        pass.draw(0..CELLS * CELLS * 6, 0..1);
        1
    }
}
