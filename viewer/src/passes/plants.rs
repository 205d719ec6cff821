//! The land around the eye → small plants and stones: an instance each, drawn kind by kind; metres. Where they stand is the
//! scene's matter (`PlantKind::in_cell`); here it is decided which of them are near enough, in view, and how finely to
//! draw them. They shrink into the ground before they are left out. Those of a block are worked out when it comes within
//! reach and kept while it is.

use std::collections::HashMap;

use genescape_schema::scene::{DensityMap, Plant, PlantKind};
use glam::{Vec2, Vec3, Vec3Swizzles};
use half::f16;

use super::shaders::ShaderError;
use super::{BoundScene, Compiler, DrawPass, PipelineDesc, Shader, buffer_layout};
use crate::camera::Frustum;
use crate::options::Options;
use crate::scene::Ground;
use crate::upload::{DrawCommand, PLANT_BLOCK_M, PlantBuffersOfKind, PlantVertex};

pub const SHADER: Shader = Shader { name: "plants", source: include_str!("plants.wgsl"), constants: &[] };

/// Part of its reach up to which a kind is drawn finely, and beyond which plants get fewer and smaller.
const FINE: f32 = 0.3;
const FULL: f32 = 0.45;
/// Metres up to which leaves are several in the place of one, of a plant as large as its shape.
const LEAFY_M: f32 = 9.0;
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
    /// Albedo at tint 1; 1 if light comes through it, or the number of its texture if it has one.
    pub tip: [f16; 4],
}

/// Attributes of [`PlantInstance`].
pub const INSTANCE: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x2, 2 => Float16x4, 3 => Float16x4];
/// Attributes of [`PlantVertex`].
pub const VERTEX: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![4 => Float32x3, 5 => Float32x3, 6 => Float32];

/// What is drawn of a landscape's plants, kept from frame to frame.
#[derive(Debug, Default)]
pub struct PlantChoice {
    pub instances: Vec<PlantInstance>,
    /// Of plants of one kind, equally fine; first of those that are plain.
    pub draws: Vec<DrawCommand>,
    /// How many of the draws are of those.
    pub plain: u32,
    /// Of the ground around the feet of what is rough and near.
    pub feet: Vec<DrawCommand>,
    coarse: Vec<PlantInstance>,
    leafy: Vec<PlantInstance>,
    /// The plants of blocks that are or were within reach, by number of their kind and block.
    known: HashMap<(usize, [i32; 2]), Box<[Standing]>>,
    /// How many blocks were left when those out of reach were last forgotten.
    kept: usize,
}

/// A plant of full size where it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Standing {
    instance: PlantInstance,
    /// [`Plant::rank`].
    rank: f32,
}

/// Blocks that come to be known before those out of reach are forgotten, at least.
const FORGETFUL: usize = 512;

/// How a shape and its places are read.
pub(super) fn buffers() -> [Option<wgpu::VertexBufferLayout<'static>>; 2] {
    [
        buffer_layout::<PlantInstance>(wgpu::VertexStepMode::Instance, &INSTANCE),
        buffer_layout::<PlantVertex>(wgpu::VertexStepMode::Vertex, &VERTEX),
    ]
}

#[derive(Debug)]
pub struct Plants {
    plain: wgpu::RenderPipeline,
    textured: wgpu::RenderPipeline,
}

impl Plants {
    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let module = compiler.module(&SHADER)?;
        let groups = [&compiler.layouts.view, &compiler.layouts.ground];
        let buffers = buffers();
        let plain = PipelineDesc { buffers: &buffers, ..PipelineDesc::new(&module, &groups[..1]) };
        let textured = PipelineDesc {
            vertex: "textured_vertex",
            fragment: Some("textured"),
            buffers: &buffers,
            ..PipelineDesc::new(&module, &groups)
        };
        Ok(Self { plain: compiler.pipeline(&plain), textured: compiler.pipeline(&textured) })
    }
}

impl DrawPass for Plants {
    fn is_needed(&self, bound: &BoundScene, options: &Options) -> bool {
        options.draw_terrain && bound.plant_draws.count > 0
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, bound: &BoundScene, _: &Options) -> u32 {
        let shapes = &bound.scene.land.plants;
        pass.set_vertex_buffer(0, bound.plants.buffer.slice(..));
        pass.set_vertex_buffer(1, shapes.vertices.slice(..));
        pass.set_index_buffer(shapes.indices.slice(..), wgpu::IndexFormat::Uint32);
        let (draws, plain) = (&bound.plant_draws, bound.plain_plants);
        if plain > 0 {
            pass.set_pipeline(&self.plain);
            pass.multi_draw_indexed_indirect(&draws.buffer, 0, plain);
        }
        if plain < draws.count {
            pass.set_bind_group(1, &bound.ground_group, &[]);
            pass.set_pipeline(&self.textured);
            let first = u64::from(plain) * size_of::<DrawCommand>() as u64;
            pass.multi_draw_indexed_indirect(&draws.buffer, first, draws.count - plain);
        }
        u32::from(plain > 0) + u32::from(plain < draws.count)
    }
}

impl PlantChoice {
    /// Draws none; what is known of them stays known.
    pub fn clear(&mut self) {
        self.instances.clear();
        self.draws.clear();
        self.feet.clear();
        self.plain = 0;
    }

    /// The plants that an eye may see in a picture drawn at `part` of full resolution, instead of what was chosen before.
    pub fn choose(
        &mut self,
        ground: &Ground,
        buffers: &[PlantBuffersOfKind],
        eye_m: Vec3,
        frustum: &Frustum,
        part: f32,
    ) {
        self.clear();
        self.forget(ground, eye_m);
        let all = || ground.surface.plants.kinds.iter().zip(buffers).enumerate();
        let [plain, textured] =
            [false, true].map(|is| all().filter(move |(_, (kind, _))| kind.texture.is_some() == is));
        for (number, (kind, shape)) in plain.chain(textured) {
            let Some(map) = ground.plant_map(kind) else { continue };
            // What has as few pixels at full resolution is so far away.
            let reach_m = kind.reach_m * part;
            let first = self.instances.len() as u32;
            self.coarse.clear();
            let leafy = if shape.leafy.is_empty() { 0.0 } else { LEAFY_M / kind.reach_m };
            for block in blocks(reach_m, ground, eye_m).filter(|&block| shape.grows_in(block)) {
                let middle = block_middle_m(block);
                let middle = Vec3::new(middle.x, ground.field.height_m(middle.x, middle.y), middle.y);
                if !frustum.sees_sphere(middle, 0.75 * PLANT_BLOCK_M + AROUND_M) {
                    continue;
                }
                let known = self.known.entry((number, block));
                let plants = known.or_insert_with(|| standing(ground, kind, &map, block));
                let nearest = (middle.distance(eye_m) - 0.75 * PLANT_BLOCK_M - AROUND_M).max(0.0) / reach_m;
                for plant in plants.iter().take_while(|plant| presence(plant.rank, nearest) > 0.0) {
                    let away = Vec3::from(plant.instance.place).xzy().distance(eye_m) / reach_m;
                    let size = presence(plant.rank, away);
                    if size > 0.0 {
                        let [x, y] = plant.instance.turn;
                        let list = if away * away < leafy * leafy * (x * x + y * y) {
                            &mut self.leafy
                        } else if away < FINE {
                            &mut self.instances
                        } else {
                            &mut self.coarse
                        };
                        let turn = plant.instance.turn.map(|along| along * size);
                        list.push(PlantInstance { turn, ..plant.instance });
                    }
                }
            }
            let fine = self.instances.len() as u32;
            self.instances.append(&mut self.coarse);
            let coarse = self.instances.len() as u32;
            self.instances.append(&mut self.leafy);
            let all = self.instances.len() as u32;
            let draws = [
                DrawCommand::of(&shape.fine, first..fine),
                DrawCommand::of(&shape.coarse, fine..coarse),
                DrawCommand::of(&shape.leafy, coarse..all),
            ];
            self.draws.extend(draws.into_iter().flatten());
            self.feet.extend(DrawCommand::of(&shape.foot, first..fine));
            if kind.texture.is_none() {
                self.plain = self.draws.len() as u32;
            }
        }
    }

    /// Forgets blocks that are out of reach, when many are known.
    fn forget(&mut self, ground: &Ground, eye_m: Vec3) {
        if self.known.len() < 2 * self.kept.max(FORGETFUL) {
            return;
        }
        let kinds = &ground.surface.plants.kinds;
        self.known.retain(|&(number, block), _| {
            kinds.get(number).is_some_and(|kind| is_near(block, 2.0 * kind.reach_m, eye_m))
        });
        self.kept = self.known.len();
    }
}

/// The plants of a kind in a block, in the order of their ranks.
fn standing(ground: &Ground, kind: &PlantKind, map: &DensityMap<'_>, block: [i32; 2]) -> Box<[Standing]> {
    let half_m = 0.5 * ground.field.extent_m();
    let density = |x: f32, z: f32| map.at(kind.channel, 0.5 + 0.5 * x / half_m, 0.5 + 0.5 * z / half_m);
    let plants = cells(kind, block).filter_map(|cell| kind.in_cell(cell, density));
    let standing = |plant: Plant| {
        let height_m = ground.field.height_m(plant.x_m, plant.z_m);
        Standing { instance: instance(&plant, kind, height_m), rank: plant.rank }
    };
    let mut plants: Vec<Standing> = plants.map(standing).collect();
    plants.sort_unstable_by(|a, b| a.rank.total_cmp(&b.rank));
    plants.into()
}

fn instance(plant: &Plant, kind: &PlantKind, height_m: f32) -> PlantInstance {
    let [root, tip] = kind.colors.get(plant.color as usize).copied().unwrap_or_default();
    let with = |[r, g, b]: [f32; 3], more: f32| [r, g, b, more].map(f16::from_f32);
    PlantInstance {
        place: [plant.x_m, plant.z_m, height_m],
        turn: (plant.scale * Vec2::from_angle(plant.turn_rad)).to_array(),
        root: with(root, kind.sway),
        tip: with(tip, kind.texture.map_or(f32::from(u8::from(kind.sway > 0.0)), |number| number as f32)),
    }
}

/// Part of all plants that are growing up at once as one comes nearer.
const GROWS: f32 = 0.15;

/// The part of its size that a plant of a rank has at a part of its kind's reach.
fn presence(rank: f32, away: f32) -> f32 {
    let far = ((away - FULL) / (1.0 - FULL)).clamp(0.0, 1.0);
    let share = 1.0 - (1.0 - FEWEST) * far;
    // Where all stand, the last has its full size, too.
    ((share * (1.0 + GROWS) - rank) / GROWS).clamp(0.0, 1.0) * ((1.0 - away) / 0.2).clamp(0.0, 1.0)
}

/// The blocks within a reach: numbers of their north-west corners in blocks.
fn blocks(reach_m: f32, ground: &Ground, eye_m: Vec3) -> impl Iterator<Item = [i32; 2]> {
    let half_m = 0.5 * ground.field.extent_m();
    let line = move |m: f32| (m.clamp(-half_m, half_m - 0.01) / PLANT_BLOCK_M).floor() as i32;
    let lines = move |m: f32| line(m - reach_m)..=line(m + reach_m);
    let near = move |&block: &[i32; 2]| is_near(block, reach_m, eye_m);
    lines(eye_m.z).flat_map(move |z| lines(eye_m.x).map(move |x| [x, z])).filter(near)
}

/// Whether any of a block may be within reach of an eye.
fn is_near(block: [i32; 2], reach_m: f32, eye_m: Vec3) -> bool {
    block_middle_m(block).distance(eye_m.xz()) < reach_m + PLANT_BLOCK_M
}

/// x and z.
fn block_middle_m([x, z]: [i32; 2]) -> Vec2 {
    (Vec2::new(x as f32, z as f32) + 0.5) * PLANT_BLOCK_M
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
    use std::sync::Arc;

    use super::*;
    use crate::camera::Camera;
    use crate::scene::{Apron, GroundSurface, Heightfield, Image};
    use genescape_schema::scene::{GroundPlants, PlantShape};
    use proptest::prelude::*;

    /// 1,024 m of level land with two kinds of plants, neither of which grows everywhere.
    fn meadow() -> Ground {
        let field = Heightfield { side: 3, spacing_m: 512.0, heights_m: vec![2.0; 9] };
        let picture = |pixels: Vec<u8>| Image {
            name: String::new(),
            width_px: 64,
            height_px: 64,
            levels: vec![pixels.as_slice().into()],
        };
        let growth = |n: u32| [(n % 64 * 4) as u8, if n / 64 % 9 < 5 { 90 } else { 0 }, 0, 0];
        let none = || picture(vec![0; 4 * 64 * 64]);
        let kind = |channel, per_m2, reach_m| PlantKind {
            channel,
            per_m2,
            reach_m,
            scale: [0.5, 1.5],
            colors: vec![[[0.1; 3]; 2]],
            shape: PlantShape { triangles: vec![[0, 1, 2]; 2], coarse: 1, ..PlantShape::default() },
            ..PlantKind::default()
        };
        let plants = GroundPlants {
            maps: vec![picture((0..64 * 64).flat_map(growth).collect())],
            kinds: vec![kind(0, 1.5, 40.0), kind(1, 0.2, 90.0)],
        };
        Ground {
            name: String::new(),
            field: Arc::new(field),
            lod: Arc::default(),
            water_level_m: None,
            surface: GroundSurface {
                color: none(),
                weights: none(),
                light: none(),
                details: Vec::new(),
                plants,
            },
            apron: Arc::new(Apron::default()),
        }
    }

    #[test]
    fn what_is_known_from_before_is_what_stands_there() {
        let ground = meadow();
        let kinds = &ground.surface.plants.kinds;
        let buffers: Vec<_> = kinds.iter().map(|kind| PlantBuffersOfKind::new(&ground, kind, 0..6)).collect();
        let (mut walker, mut most) = (PlantChoice::default(), 0);
        for step in 0..400u16 {
            // There, and back on the same way.
            let along = 1.0 - (f32::from(step) / 200.0 - 1.0).abs();
            let camera = Camera {
                position_m: Vec3::new(900.0 * along - 450.0, 3.7, 300.0 * along),
                yaw_rad: 0.1 * f32::from(step),
                pitch_rad: -0.1,
                fov_y_rad: 1.0,
            };
            let part = if step % 3 == 0 { 0.5 } else { 1.0 };
            let mut stranger = PlantChoice::default();
            for choice in [&mut walker, &mut stranger] {
                choice.choose(&ground, &buffers, camera.position_m, &camera.frustum(1.6), part);
            }
            assert_eq!(walker.instances, stranger.instances, "step {step}");
            assert_eq!(walker.draws, stranger.draws, "step {step}");
            most = most.max(walker.known.len());
        }
        assert!(most < 4 * FORGETFUL, "{most} blocks known at once");
        assert!(walker.kept > 0, "blocks were forgotten");
    }

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
            let here = presence(rank, away);
            prop_assert!((here - presence(rank, away + 0.002)).abs() < 0.03);
            prop_assert!(here >= presence(rank, away + 0.002));
            prop_assert_eq!(presence(rank, 1.0), 0.0);
            prop_assert_eq!(presence(rank, FINE), 1.0);
        }
    }
}
