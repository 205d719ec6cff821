//! Draws the shade of near trees on the ground, finer than the light map has it.

use super::shaders::ShaderError;
use super::{BoundShade, Compiler, Cull, Passes, PipelineDesc, Shader, Target, shadow};
use crate::gpu::cleared;
use crate::upload::SceneBuffers;

pub const SHADER: Shader = Shader { name: "shade", source: include_str!("shade.wgsl"), constants: &[] };

#[derive(Debug)]
pub struct Shade {
    look_up: wgpu::RenderPipeline,
    halve: wgpu::RenderPipeline,
}

impl Shade {
    pub const NAME: &str = SHADER.name;

    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let (module, layouts) = (compiler.module(&SHADER)?, compiler.layouts);
        let pipeline = |fragment: &str, groups: &[&wgpu::BindGroupLayout]| {
            let usual = PipelineDesc::new(&module, groups);
            compiler.pipeline(&PipelineDesc { target: Target::Shade, fragment: Some(fragment), ..usual })
        };
        Ok(Self {
            look_up: pipeline("fragment", &[&layouts.sun_view, &layouts.seen_by_sun]),
            halve: pipeline("halve", &[&layouts.sun_view, &layouts.finer]),
        })
    }

    /// Draws what the sun sees of the trees that shade the ground near an eye, and looks that up for the ground. Draws nothing
    /// where there are no trees.
    pub fn record(
        &self,
        scope: &mut wgpu_profiler::Scope<'_, wgpu::CommandEncoder>,
        passes: &Passes,
        scene: &SceneBuffers,
        bound: &BoundShade,
    ) {
        let Some((set, trees)) = scene.trees.as_ref().zip(bound.trees.as_ref()) else { return };
        passes.cull.dispatch(&mut scope.scoped_compute_pass(Cull::NAME), trees);
        {
            let descriptor = wgpu::RenderPassDescriptor {
                depth_stencil_attachment: Some(shadow::attached(&bound.depth, wgpu::LoadOp::Clear(1.0))),
                ..Default::default()
            };
            let mut pass = scope.scoped_render_pass("trees seen by the sun", descriptor);
            pass.set_bind_group(0, &bound.sun_group, &[]);
            passes.shadow.trees.draw(&mut pass, set, trees, None);
        }
        for (level, target) in bound.levels.iter().enumerate() {
            let descriptor = wgpu::RenderPassDescriptor {
                color_attachments: &[cleared(&target.view, None, wgpu::Color::WHITE)],
                ..Default::default()
            };
            let mut pass = scope.scoped_render_pass(Self::NAME, descriptor);
            pass.set_pipeline(if level == 0 { &self.look_up } else { &self.halve });
            pass.set_bind_group(0, &bound.sun_group, &[]);
            pass.set_bind_group(1, &target.source, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}
