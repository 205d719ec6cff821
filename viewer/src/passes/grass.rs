//! The land around the eye → clumps of grass, drawn at once; metres. Clumps belong to cells of the world, so that grass
//! stays where it is while one walks; which are drawn depends on the distance, and blades shrink into the ground before
//! their clump is left out.

use glam::{Vec2, Vec3};

use super::shaders::ShaderError;
use super::{BoundScene, Compiler, DrawPass, PipelineDesc, Shader, buffer_layout};
use crate::camera::Frustum;
use crate::options::Options;
use crate::scene::{Ground, Image};
use crate::upload::DrawCommand;

pub const SHADER: Shader = Shader {
    name: "grass",
    source: include_str!("grass.wgsl"),
    constants: &[
        ("CELL_M", CELL_M as f64),
        ("CLUMPS", CLUMPS as f64),
        ("BLADES", BLADES as f64),
        ("BLADE_VERTICES", BLADE_VERTICES as f64),
        ("DENSE_M", DENSE_M as f64),
        ("REACH_M", REACH_M as f64),
        ("FINE_M", FINE_M as f64),
    ],
};

/// Metres a side of a cell.
const CELL_M: f32 = 1.0;
/// Clumps of a cell near the eye.
const CLUMPS: u32 = 18;
/// Blades of a clump.
const BLADES: u16 = 16;
/// Vertices of a blade, and its triangles: two for the stalk, one for the tip.
const BLADE_VERTICES: u16 = 5;
const BLADE_TRIANGLES: [u16; 9] = [0, 1, 2, 2, 1, 3, 2, 3, 4];
/// A blade as one triangle, straight from its root to its tip.
const COARSE_BLADE: [u16; 3] = [0, 1, 4];
/// From this distance in metres on blades are that coarse: nobody sees that they are straight, and most of them stand there.
const FINE_M: f32 = 9.0;
/// In pictures at a smaller part of full resolution than this all of them are.
const FINE_PART: f32 = 0.6;
/// Up to this distance in metres all clumps stand.
const DENSE_M: f32 = 3.0;
/// Beyond this distance in metres there are none.
const REACH_M: f32 = 30.0;
/// Up to this distance in metres turf is seen to lie in the shade of blades.
pub(super) const SHADED_TURF_M: f32 = 14.0;
/// Metres from a cell's middle to the farthest of its blades: half a diagonal on steep land, and a blade.
const AROUND_M: f32 = 1.2 * CELL_M;
/// Bytes of rock, scree, snow and earth together beyond which no grass grows.
const BARE: u32 = 190;

/// [`BLADES`] blades of a cell, as the shader reads them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Clump {
    /// From `cell` · [`CELL_M`] one cell east and south.
    pub cell: [i32; 2],
    /// Number within the cell, less than [`CLUMPS`].
    pub number: u32,
}

/// Attributes of [`Clump`].
pub const CLUMP: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Sint32x2, 1 => Uint32];

#[derive(Debug)]
pub struct Grass {
    pipeline: wgpu::RenderPipeline,
    /// Of a clump with fine blades, then with coarse ones.
    indices: wgpu::Buffer,
}

impl Grass {
    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let module = compiler.module(&SHADER)?;
        let groups = [&compiler.layouts.view, &compiler.layouts.ground];
        let buffers = [buffer_layout::<Clump>(wgpu::VertexStepMode::Instance, &CLUMP)];
        let desc = PipelineDesc { buffers: &buffers, ..PipelineDesc::new(&module, &groups) };
        let fine = (0..BLADES).flat_map(|blade| BLADE_TRIANGLES.map(|v| blade * BLADE_VERTICES + v));
        let coarse = (0..BLADES).flat_map(|blade| COARSE_BLADE.map(|v| blade * BLADE_VERTICES + v));
        let indices: Vec<u16> = fine.chain(coarse).collect();
        Ok(Self {
            pipeline: compiler.pipeline(&desc),
            indices: compiler.gpu.buffer("blades", &indices, wgpu::BufferUsages::INDEX),
        })
    }
}

impl DrawPass for Grass {
    fn is_needed(&self, bound: &BoundScene, options: &Options) -> bool {
        options.draw_terrain && bound.clump_draws.count > 0
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, bound: &BoundScene, _: &Options) -> u32 {
        let draws = &bound.clump_draws;
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &bound.ground_group, &[]);
        pass.set_vertex_buffer(0, bound.clumps.buffer.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        pass.multi_draw_indexed_indirect(&draws.buffer, 0, draws.count);
        1
    }
}

/// Share of a cell's blades that stand at a distance, as `density` of `grass.wgsl`. In a picture that is drawn at a part of
/// full resolution what is near looks as small as what is far in a sharp one.
fn density(away_m: f32, part: f32) -> f32 {
    let away_m = away_m / part;
    let far = ((away_m / REACH_M - 0.6) / 0.4).clamp(0.0, 1.0);
    (DENSE_M / away_m.max(0.01)).min(1.0) * (1.0 - far * far * (3.0 - 2.0 * far))
}

/// What grass is drawn in a frame.
#[derive(Clone, Debug, Default)]
pub struct GrassChoice {
    /// Those with fine blades, then those with coarse ones.
    pub clumps: Vec<Clump>,
    /// How either are drawn.
    pub draws: Vec<DrawCommand>,
    /// Room for those with coarse blades.
    coarse: Vec<Clump>,
}

impl GrassChoice {
    /// Nothing is drawn.
    pub fn clear(&mut self) {
        self.clumps.clear();
        self.draws.clear();
    }

    /// Replaces them by those that an eye may see in a picture drawn at `part` of full resolution.
    pub fn choose(&mut self, ground: &Ground, eye_m: Vec3, frustum: &Frustum, part: f32) {
        self.clear();
        let fine_m = if part < FINE_PART { 0.0 } else { FINE_M * part };
        each_clump(ground, eye_m, frustum, part, |nearest_m, clump| {
            let list = if nearest_m < fine_m { &mut self.clumps } else { &mut self.coarse };
            list.push(clump);
        });
        let near = self.clumps.len() as u32;
        self.clumps.append(&mut self.coarse);
        let all = self.clumps.len() as u32;
        let [fine, coarse] =
            [BLADE_TRIANGLES.len(), COARSE_BLADE.len()].map(|n| u32::from(BLADES) * n as u32);
        let draws =
            [DrawCommand::of(&(0..fine), 0..near), DrawCommand::of(&(fine..fine + coarse), near..all)];
        self.draws.extend(draws.into_iter().flatten());
    }
}

/// Calls `found` for each clump that an eye may see in a picture drawn at `part` of full resolution, with the distance in metres
/// of its nearest blade at least.
fn each_clump(ground: &Ground, eye_m: Vec3, frustum: &Frustum, part: f32, mut found: impl FnMut(f32, Clump)) {
    let field = &ground.field;
    let half_m = 0.5 * field.extent_m();
    let water_m = ground.water_level_m.unwrap_or(f32::MIN);
    let reach_m = REACH_M * part;
    let lines = |middle_m: f32| {
        let line = |m: f32| (m.clamp(-half_m, half_m) / CELL_M).floor() as i32;
        line(middle_m - reach_m)..=line(middle_m + reach_m)
    };
    for z in lines(eye_m.z) {
        for x in lines(eye_m.x) {
            let middle = (Vec2::new(x as f32, z as f32) + 0.5) * CELL_M;
            if (middle - Vec2::new(eye_m.x, eye_m.z)).length() > reach_m + CELL_M {
                continue;
            }
            let height_m = field.height_m(middle.x, middle.y);
            let place = Vec3::new(middle.x, height_m, middle.y);
            let nearest_m = (place.distance(eye_m) - AROUND_M).max(0.0);
            let share = density(nearest_m, part);
            if share == 0.0 {
                continue;
            }
            let seen = frustum.sees_sphere(place, AROUND_M);
            if !seen || height_m < water_m - CELL_M || is_bare(&ground.surface.weights, middle, half_m) {
                continue;
            }
            let count = ((share * CLUMPS as f32).ceil() as u32).min(CLUMPS);
            (0..count).for_each(|number| found(nearest_m, Clump { cell: [x, z], number }));
        }
    }
}

/// True if nothing grows in a cell: neither in its middle nor at its corners.
fn is_bare(weights: &Image, middle_m: Vec2, half_m: f32) -> bool {
    let Some(pixels) = weights.levels.first() else { return false };
    let texel = |along_m: f32, size_px: u32| {
        let along = (along_m / half_m * 0.5 + 0.5) * size_px as f32;
        (along.max(0.0) as u32).min(size_px - 1)
    };
    let half = 0.5 * CELL_M;
    let around = [(0.0, 0.0), (-half, -half), (half, -half), (-half, half), (half, half)];
    around.iter().all(|&(x, z)| {
        let (i, j) = (texel(middle_m.x + x, weights.width_px), texel(middle_m.y + z, weights.height_px));
        let first = ((j * weights.width_px + i) * 4) as usize;
        pixels.get(first..first + 4).is_some_and(|p| p.iter().map(|&w| u32::from(w)).sum::<u32>() > BARE)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use crate::scene::{Apron, GroundSurface, Heightfield};
    use glam::Vec3Swizzles;
    use proptest::prelude::*;
    use std::sync::Arc;

    /// 64 m × 64 m that rise eastwards, bare in the northern half.
    fn slope() -> Ground {
        let mut field = Heightfield { side: 33, spacing_m: 2.0, ..Heightfield::default() };
        field.heights_m = (0..33 * 33).map(|n| (n % 33) as f32).collect();
        let pixels = |bare: u8| Image {
            name: String::new(),
            width_px: 1,
            height_px: 2,
            levels: vec![[bare, 0, 0, 0, 0, 0, 0, 0].as_slice().into()],
        };
        let (color, light) = (pixels(0), pixels(0));
        Ground {
            name: String::new(),
            field: Arc::new(field),
            lod: Arc::default(),
            water_level_m: Some(8.0),
            surface: GroundSurface {
                color,
                weights: pixels(255),
                light,
                details: Vec::new(),
                plants: Default::default(),
            },
            apron: Arc::new(Apron::default()),
        }
    }

    proptest! {
        #[test]
        fn every_blade_that_stands_has_its_clump(
            x in -15f32..31., z in 1f32..31., to_x in -20f32..20., to_z in -20f32..20., above in 0.5f32..12.,
            turn in -0.3f32..0.3, nod in -0.3f32..0.3, share in 0f32..0.99, part in 0.3f32..1.0,
        ) {
            let ground = slope();
            let on = |x: f32, z: f32| Vec3::new(x, ground.field.height_m(x, z), z);
            let (root, eye) = (on(x, z), on(x + to_x, z + to_z) + Vec3::Y * above);
            let look = root - eye;
            let camera = Camera {
                position_m: eye,
                yaw_rad: libm::atan2f(-look.x, -look.z) + turn,
                pitch_rad: libm::atan2f(look.y, look.xz().length()) + nod,
                fov_y_rad: 1.0,
            };
            let frustum = camera.frustum(1.5);
            prop_assume!(frustum.sees_sphere(root, 0.0) && density(look.length(), part) > 0.0);
            let mut grass = GrassChoice::default();
            grass.choose(&ground, eye, &frustum, part);
            let drawn = &grass.clumps;
            let rank = share * density(look.length(), part);
            let cell = [root.x, root.z].map(|m| (m / CELL_M).floor() as i32);
            let number = (rank * CLUMPS as f32) as u32;
            let wanted = Clump { cell, number };
            prop_assert!(drawn.contains(&wanted));
            prop_assert_eq!(grass.draws.iter().map(|draw| draw.instances).sum::<u32>(), drawn.len() as u32);
            prop_assert!(drawn.iter().all(|clump| clump.cell[1] >= -1 && clump.number < CLUMPS));
        }
    }
}
