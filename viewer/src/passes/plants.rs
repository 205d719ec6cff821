//! The land around the eye → small plants and stones: an instance each, drawn kind by kind; metres. Where they stand is the
//! scene's matter (`PlantKind::in_cell`); here it is decided which of them are near enough, in view, and how finely to
//! draw them. They shrink into the ground before they are left out.

use std::ops::Range;

use genescape_schema::scene::{Plant, PlantKind};
use glam::{Vec2, Vec3};
use half::f16;

use super::shaders::ShaderError;
use super::{BoundScene, Compiler, DrawPass, PipelineDesc, Shader, buffer_layout};
use crate::camera::Frustum;
use crate::options::Options;
use crate::scene::Ground;
use crate::upload::{PLANT_BLOCK_M, PlantBuffers, PlantVertex};

pub const SHADER: Shader = Shader { name: "plants", source: include_str!("plants.wgsl"), constants: &[] };

/// Part of its reach up to which a kind is drawn finely, and beyond which plants get fewer and smaller.
const FINE: f32 = 0.3;
const FULL: f32 = 0.45;
/// Part of them that stands at the end of the reach.
const FEWEST: f32 = 0.35;
/// More metres than any plant is high or a block is uneven.
const AROUND_M: f32 = PLANT_BLOCK_M;

/// A plant as the shader reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct PlantInstance {
    /// x, z and the height of the land there in metres.
    pub place: [f32; 3],
    /// Cosine and sine of its turn, times its scale.
    pub turn: [f32; 2],
    /// Albedo at tint 0; how far it moves in the wind.
    pub root: [f16; 4],
    /// Albedo at tint 1; 1 if light comes through it.
    pub tip: [f16; 4],
}

/// Attributes of [`PlantInstance`].
pub const INSTANCE: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x2, 2 => Float16x4, 3 => Float16x4];
/// Attributes of [`PlantVertex`].
pub const VERTEX: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![4 => Float32x3, 5 => Float32x3, 6 => Float32];

/// Plants that are drawn together: of one kind, equally fine.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantDraw {
    indices: Range<u32>,
    instances: Range<u32>,
}

/// What is drawn of a landscape's plants, kept from frame to frame.
#[derive(Debug, Default)]
pub struct PlantChoice {
    pub instances: Vec<PlantInstance>,
    pub draws: Vec<PlantDraw>,
    coarse: Vec<PlantInstance>,
}

#[derive(Debug)]
pub struct Plants {
    pipeline: wgpu::RenderPipeline,
}

impl Plants {
    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let module = compiler.module(&SHADER)?;
        let groups = [&compiler.layouts.view];
        let buffers = [
            buffer_layout::<PlantInstance>(wgpu::VertexStepMode::Instance, &INSTANCE),
            buffer_layout::<PlantVertex>(wgpu::VertexStepMode::Vertex, &VERTEX),
        ];
        let desc = PipelineDesc { buffers: &buffers, ..PipelineDesc::new(&module, &groups) };
        Ok(Self { pipeline: compiler.pipeline(&desc) })
    }
}

impl DrawPass for Plants {
    fn is_needed(&self, bound: &BoundScene, options: &Options) -> bool {
        options.draw_terrain && !bound.plant_draws.is_empty()
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, bound: &BoundScene, _: &Options) -> u32 {
        let shapes = &bound.scene.land.plants;
        pass.set_pipeline(&self.pipeline);
        pass.set_vertex_buffer(0, bound.plants.buffer.slice(..));
        pass.set_vertex_buffer(1, shapes.vertices.slice(..));
        pass.set_index_buffer(shapes.indices.slice(..), wgpu::IndexFormat::Uint32);
        for draw in &bound.plant_draws {
            pass.draw_indexed(draw.indices.clone(), 0, draw.instances.clone());
        }
        bound.plant_draws.len() as u32
    }
}

impl PlantChoice {
    pub fn clear(&mut self) {
        self.instances.clear();
        self.draws.clear();
    }

    /// The plants that an eye may see in a picture drawn at `part` of full resolution, instead of what was chosen before.
    pub fn choose(
        &mut self,
        ground: &Ground,
        buffers: &PlantBuffers,
        eye_m: Vec3,
        frustum: &Frustum,
        part: f32,
    ) {
        self.clear();
        for (kind, shape) in ground.surface.plants.kinds.iter().zip(&buffers.kinds) {
            let Some(map) = ground.plant_map(kind) else { continue };
            // What has as few pixels at full resolution is so far away.
            let reach_m = kind.reach_m * part;
            let half_m = 0.5 * ground.field.extent_m();
            let density =
                |x: f32, z: f32| map.at(kind.channel, 0.5 + 0.5 * x / half_m, 0.5 + 0.5 * z / half_m);
            let first = self.instances.len() as u32;
            self.coarse.clear();
            let seen = |middle: Vec3| frustum.sees_sphere(middle, 0.75 * PLANT_BLOCK_M + AROUND_M);
            for block in blocks(reach_m, ground, eye_m).filter(|&block| shape.grows_in(block)) {
                let middle = (Vec2::new(block[0] as f32, block[1] as f32) + 0.5) * PLANT_BLOCK_M;
                let middle = Vec3::new(middle.x, ground.field.height_m(middle.x, middle.y), middle.y);
                if !seen(middle) {
                    continue;
                }
                for plant in cells(kind, block).filter_map(|cell| kind.in_cell(cell, density)) {
                    let height_m = ground.field.height_m(plant.x_m, plant.z_m);
                    let away = Vec3::new(plant.x_m, height_m, plant.z_m).distance(eye_m) / reach_m;
                    let size = plant.scale * presence(&plant, away);
                    if size > 0.0 {
                        let list = if away < FINE { &mut self.instances } else { &mut self.coarse };
                        list.push(instance(&plant, kind, height_m, size));
                    }
                }
            }
            let fine = self.instances.len() as u32;
            self.instances.append(&mut self.coarse);
            let all = self.instances.len() as u32;
            for (indices, instances) in [(&shape.fine, first..fine), (&shape.coarse, fine..all)] {
                if !instances.is_empty() {
                    self.draws.push(PlantDraw { indices: indices.clone(), instances });
                }
            }
        }
    }
}

fn instance(plant: &Plant, kind: &PlantKind, height_m: f32, size: f32) -> PlantInstance {
    let [root, tip] = kind.colors.get(plant.color as usize).copied().unwrap_or_default();
    let with = |[r, g, b]: [f32; 3], more: f32| [r, g, b, more].map(f16::from_f32);
    PlantInstance {
        place: [plant.x_m, plant.z_m, height_m],
        turn: (size * Vec2::from_angle(plant.turn_rad)).to_array(),
        root: with(root, kind.sway),
        tip: with(tip, if kind.sway > 0.0 { 1.0 } else { 0.0 }),
    }
}

/// Part of all plants that are growing up at once as one comes nearer.
const GROWS: f32 = 0.15;

/// The part of its size that a plant has at a part of its kind's reach.
fn presence(plant: &Plant, away: f32) -> f32 {
    let far = ((away - FULL) / (1.0 - FULL)).clamp(0.0, 1.0);
    let share = 1.0 - (1.0 - FEWEST) * far;
    // Where all stand, the last has its full size, too.
    ((share * (1.0 + GROWS) - plant.rank) / GROWS).clamp(0.0, 1.0) * ((1.0 - away) / 0.2).clamp(0.0, 1.0)
}

/// The blocks within a reach: numbers of their north-west corners in blocks.
fn blocks(reach_m: f32, ground: &Ground, eye_m: Vec3) -> impl Iterator<Item = [i32; 2]> {
    let half_m = 0.5 * ground.field.extent_m();
    let line = move |m: f32| (m.clamp(-half_m, half_m - 0.01) / PLANT_BLOCK_M).floor() as i32;
    let lines = move |m: f32| line(m - reach_m)..=line(m + reach_m);
    let near = move |block: &[i32; 2]| {
        let middle = (Vec2::new(block[0] as f32, block[1] as f32) + 0.5) * PLANT_BLOCK_M;
        middle.distance(Vec2::new(eye_m.x, eye_m.z)) < reach_m + PLANT_BLOCK_M
    };
    lines(eye_m.z).flat_map(move |z| lines(eye_m.x).map(move |x| [x, z])).filter(near)
}

/// The cells of a kind whose corners lie in a block.
fn cells(kind: &PlantKind, [x, z]: [i32; 2]) -> impl Iterator<Item = [i32; 2]> {
    let cell_m = kind.cell_m();
    let from = move |block: i32| (block as f32 * PLANT_BLOCK_M / cell_m).ceil() as i32;
    let lines = move |block: i32| from(block)..from(block + 1);
    lines(z).flat_map(move |j| lines(x).map(move |i| [i, j]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_cell_belongs_to_one_block(per_m2 in 0.01f32..9.0, i in -3000i32..3000, j in -3000i32..3000) {
            let kind = PlantKind { per_m2, ..PlantKind::default() };
            let corner = |k: i32| (k as f32 * kind.cell_m() / PLANT_BLOCK_M).floor() as i32;
            let around = |k: i32| corner(k) - 1..=corner(k) + 1;
            let holders = around(i).flat_map(|x| around(j).map(move |z| [x, z]))
                .filter(|&block| cells(&kind, block).any(|cell| cell == [i, j])).count();
            prop_assert_eq!(holders, 1);
        }

        #[test]
        fn plants_neither_pop_up_nor_stand_beyond_their_reach(rank in 0f32..1., away in 0f32..1.2) {
            let plant = Plant { x_m: 0.0, z_m: 0.0, turn_rad: 0.0, scale: 1.0, color: 0, rank };
            let here = presence(&plant, away);
            prop_assert!((here - presence(&plant, away + 0.002)).abs() < 0.03);
            prop_assert!(here >= presence(&plant, away + 0.002));
            prop_assert_eq!(presence(&plant, 1.0), 0.0);
            prop_assert_eq!(presence(&plant, FINE), 1.0);
        }
    }
}
