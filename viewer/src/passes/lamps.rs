//! Draws what each lamp of the room sees of anyone's file, once: nothing in it moves.

use glam::Vec3;

use super::asset::{SHADER, buffers};
use super::bound_asset::surface_groups;
use super::shaders::ShaderError;
use super::{
    AssetDraw, Binding, Compiler, Layouts, PipelineDesc, Target, ViewUniform, VisibleCopy, bind, shadow,
};
use crate::gpu::Gpu;
use crate::scene::Alpha;
use crate::upload::{AssetBuffers, Lamp, ShapeData};

/// Pipelines by what alpha means; what is half transparent throws no shadow.
#[derive(Debug)]
pub struct Lamps {
    solid: wgpu::RenderPipeline,
    masked: wgpu::RenderPipeline,
}

/// What lamps are shown.
struct Chosen {
    draws: Vec<AssetDraw>,
    /// [`VisibleCopy`]s.
    copies: wgpu::Buffer,
}

impl Lamps {
    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let (module, layouts) = (compiler.module(&SHADER)?, compiler.layouts);
        let (buffers, groups) = (buffers(), [&layouts.camera, &layouts.places, &layouts.surface]);
        let pipeline = |vertex: &str, fragment: Option<&str>, groups: &[_]| {
            let usual = PipelineDesc::new(&module, groups);
            let desc = PipelineDesc { vertex, fragment, buffers: &buffers, target: Target::Shadow, ..usual };
            compiler.pipeline(&desc)
        };
        Ok(Self {
            solid: pipeline("seen_by_lamp", None, &groups[..2]),
            masked: pipeline("seen_by_lamp", Some("hole"), &groups),
        })
    }

    /// Draws all and waits for it; may run on any thread.
    pub fn draw(&self, gpu: &Gpu, layouts: &Layouts, asset: &AssetBuffers) {
        let surfaces = surface_groups(gpu, layouts, asset);
        let places = bind(gpu, "places", &layouts.places, [(1, Binding::Buffer(&asset.places))]);
        let texel_m = 2.0 * asset.staging.radius_m / asset.lamp_maps.width() as f32;
        let chosen = Chosen::new(gpu, asset, 0.5 * texel_m);
        for (lamp, layer) in asset.lamps.iter().zip(0..) {
            let camera = [(0, Binding::Buffer(&uniform(gpu, asset, lamp)))];
            let camera = bind(gpu, "lamp", &layouts.camera, camera);
            let map = asset.lamp_maps.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer: layer,
                array_layer_count: Some(1),
                ..Default::default()
            });
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            {
                let mut pass = shadow::begin(&mut encoder, &map, wgpu::LoadOp::Clear(1.0));
                pass.set_bind_group(0, &camera, &[]);
                pass.set_bind_group(1, &places, &[]);
                pass.set_vertex_buffer(0, asset.vertices.slice(..));
                pass.set_vertex_buffer(1, chosen.copies.slice(..));
                pass.set_index_buffer(asset.indices.slice(..), wgpu::IndexFormat::Uint32);
                for draw in &chosen.draws {
                    match asset.surfaces[draw.surface].alpha {
                        Alpha::Opaque => pass.set_pipeline(&self.solid),
                        Alpha::Mask(_) => {
                            pass.set_pipeline(&self.masked);
                            pass.set_bind_group(2, &surfaces[draw.surface], &[]);
                        }
                        Alpha::Blend => continue,
                    }
                    pass.draw_indexed(draw.indices.clone(), 0, draw.copies.clone());
                }
            }
            gpu.work(encoder.finish());
        }
    }
}

fn uniform(gpu: &Gpu, asset: &AssetBuffers, lamp: &Lamp) -> wgpu::Buffer {
    let staging = &asset.staging;
    let shadow_from_world = lamp.clip_from_world(Vec3::Y * staging.middle_m, staging.radius_m);
    let view = ViewUniform { shadow_from_world: shadow_from_world.to_cols_array_2d(), ..Default::default() };
    gpu.buffer("lamp", &[view], wgpu::BufferUsages::UNIFORM)
}

impl Chosen {
    /// Every copy at its coarsest level that is off by less than `error_m`.
    fn new(gpu: &Gpu, asset: &AssetBuffers, error_m: f32) -> Self {
        let (mut draws, mut chosen) = (Vec::new(), Vec::new());
        for shape in &asset.shapes {
            let with_level = |copy: u32| (level(shape, error_m / asset.copies[copy as usize].scale), copy);
            let mut copies: Vec<(usize, u32)> =
                (shape.first_copy..shape.first_copy + shape.copies).map(with_level).collect();
            copies.sort_unstable();
            for same in copies.chunk_by(|a, b| a.0 == b.0) {
                let (level, first) = (same[0].0, chosen.len() as u32);
                chosen.extend(same.iter().map(|(_, copy)| VisibleCopy {
                    number: *copy,
                    lambda: level as f32,
                    error_m,
                }));
                let copies = first..chosen.len() as u32;
                draws.extend(shape.parts[level].iter().map(|part| AssetDraw::of(part, copies.clone())));
            }
        }
        Self { draws, copies: gpu.buffer("copies", &chosen, wgpu::BufferUsages::VERTEX) }
    }
}

fn level(shape: &ShapeData, error_m: f32) -> usize {
    let coarser = shape.errors_m.iter().take(shape.parts.len()).skip(1);
    coarser.take_while(|error| **error <= error_m).count()
}
