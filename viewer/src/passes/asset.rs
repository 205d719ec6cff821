//! Draws anyone's meshes: what was chosen of each shape, solid and cut-out parts first, then, behind the backdrop's pass,
//! transparent ones from far to near.

use super::bound_asset::{AssetDraw, BoundAsset, VisibleCopy};
use super::shaders::ShaderError;
use super::{Compiler, FilledOrWire, PipelineDesc, Shader, buffer_layout};
use crate::scene::{Alpha, AssetVertex};
use crate::upload::{HALF_DEPTH, RINGS};

pub const SHADER: Shader = Shader {
    name: "asset",
    source: include_str!("asset.wgsl"),
    constants: &[("RINGS", RINGS as f64), ("HALF_DEPTH", HALF_DEPTH as f64)],
};

/// Attributes of [`AssetVertex`].
pub const VERTEX: [wgpu::VertexAttribute; 9] = wgpu::vertex_attr_array![
    0 => Float32x3, 1 => Unorm8x4, 2 => Float32x3, 3 => Snorm16x2, 4 => Float32x2, 5 => Float32x2,
    6 => Float32x2, 7 => Snorm16x2, 8 => Snorm16x4,
];
/// Attributes of a [`VisibleCopy`].
pub const VISIBLE: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![9 => Uint32, 10 => Float32, 11 => Float32];

/// The two vertex buffers of every draw of a file.
pub(super) fn buffers() -> [Option<wgpu::VertexBufferLayout<'static>>; 2] {
    [
        buffer_layout::<AssetVertex>(wgpu::VertexStepMode::Vertex, &VERTEX),
        buffer_layout::<VisibleCopy>(wgpu::VertexStepMode::Instance, &VISIBLE),
    ]
}

#[derive(Debug)]
pub struct AssetPass {
    pipelines: FilledOrWire<Pipelines>,
}

/// By what alpha means, then whether both sides are drawn.
#[derive(Debug)]
struct Pipelines {
    solid: [wgpu::RenderPipeline; 2],
    masked: [wgpu::RenderPipeline; 2],
    blended: [wgpu::RenderPipeline; 2],
}

impl AssetPass {
    pub const NAME: &str = SHADER.name;

    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let (shader, layouts) = (compiler.module(&SHADER)?, compiler.layouts);
        let buffers = buffers();
        let groups = [&layouts.camera, &layouts.studio, &layouts.surface];
        let pipelines = |wireframe: bool| {
            let build = |entry: &str, blend: Option<wgpu::BlendState>| {
                [Some(wgpu::Face::Back), None].map(|cull| {
                    let usual = PipelineDesc::new(&shader, &groups);
                    let (fragment, depth_write) = (Some(entry), blend.is_none());
                    compiler.pipeline(&PipelineDesc {
                        fragment,
                        buffers: &buffers,
                        cull,
                        wireframe,
                        blend,
                        depth_write,
                        ..usual
                    })
                })
            };
            Pipelines {
                solid: build("solid", None),
                masked: build("masked", None),
                blended: build("blended", Some(wgpu::BlendState::ALPHA_BLENDING)),
            }
        };
        Ok(Self { pipelines: FilledOrWire::new(compiler.gpu, pipelines) })
    }

    /// Records draws and tells how many they are. Group 0 is set.
    pub fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        bound: &BoundAsset,
        draws: &[AssetDraw],
        wireframe: bool,
    ) -> u32 {
        if draws.is_empty() {
            return 0;
        }
        let (asset, pipelines) = (&bound.asset, self.pipelines.get(wireframe));
        pass.set_bind_group(1, &bound.studio_group, &[]);
        pass.set_vertex_buffer(0, asset.vertices.slice(..));
        pass.set_vertex_buffer(1, bound.visible.buffer.slice(..));
        pass.set_index_buffer(asset.indices.slice(..), wgpu::IndexFormat::Uint32);
        let mut surface = usize::MAX;
        for draw in draws {
            if draw.surface != surface {
                surface = draw.surface;
                let data = &asset.surfaces[surface];
                let by_sides = match data.alpha {
                    Alpha::Opaque => &pipelines.solid,
                    Alpha::Mask(_) => &pipelines.masked,
                    Alpha::Blend => &pipelines.blended,
                };
                pass.set_pipeline(&by_sides[usize::from(data.double_sided)]);
                pass.set_bind_group(2, &bound.surface_groups[surface], &[]);
            }
            pass.draw_indexed(draw.indices.clone(), 0, draw.copies.clone());
        }
        draws.len() as u32
    }
}
