//! Draws what a lake mirrors: the land, the ring around it, and trees as their pictures, as seen by an eye as far below the
//! surface as the picture's is above. `water.wgsl` reads it.

use super::bound_mirror::{BoundMirror, Reflection};
use super::impostors::PicturePipelines;
use super::shaders::ShaderError;
use super::terrain::{self, RING};
use super::{BoundScene, Compiler, PipelineDesc, Target, buffer_layout};
use crate::options::Options;
use crate::upload::RingVertex;

#[derive(Debug)]
pub struct Mirror {
    land: wgpu::RenderPipeline,
    ring: wgpu::RenderPipeline,
    trees: PicturePipelines,
}

impl Mirror {
    pub const NAME: &str = "mirror";

    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let ground = compiler.module(&terrain::SHADER)?;
        let layouts = compiler.layouts;
        let on_land = [&layouts.view, &layouts.ground];
        let pipeline = |vertex: &str, fragment: &str, cull, buffers: &[_]| {
            let usual = PipelineDesc::new(&ground, &on_land);
            let (fragment, target) = (Some(fragment), Target::Mirror);
            compiler.pipeline(&PipelineDesc { vertex, fragment, cull, buffers, target, ..usual })
        };
        // A mirror turns triangles round.
        let outside = Some(wgpu::Face::Front);
        let ring = [buffer_layout::<RingVertex>(wgpu::VertexStepMode::Vertex, &RING)];
        Ok(Self {
            land: pipeline("risen_vertex", "mirrored_ground", outside, &[]),
            ring: pipeline("ring_vertex", "mirrored_ring", outside, &ring),
            trees: PicturePipelines::mirrored(compiler)?,
        })
    }

    /// Records its draws and tells how many they are.
    pub fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        bound: &BoundScene,
        mirror: &BoundMirror,
        reflection: &Reflection,
        options: &Options,
    ) -> u32 {
        let [left, top, width, height] = reflection.window_px;
        pass.set_scissor_rect(left, top, width, height);
        pass.set_bind_group(0, &mirror.view_group, &[]);
        let trees = if options.draw_trees { self.draw_trees(pass, bound, mirror) } else { 0 };
        pass.set_bind_group(1, &bound.ground_group, &[]);
        pass.set_pipeline(&self.land);
        mirror.land.draw_as_indices(pass);
        pass.set_pipeline(&self.ring);
        trees + 1 + bound.scene.land.ring.draw(pass, &mirror.ring)
    }

    fn draw_trees(&self, pass: &mut wgpu::RenderPass<'_>, bound: &BoundScene, mirror: &BoundMirror) -> u32 {
        let Some((set, trees)) = bound.scene.trees.as_ref().zip(mirror.trees.as_ref()) else { return 0 };
        self.trees.draw(pass, set, trees)
    }
}
