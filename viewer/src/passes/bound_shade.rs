//! The shade of near trees on the ground, as bound for one view: a square around the eye, drawn anew when the eye has come to
//! another place.

use glam::{Vec2, Vec3, Vec3Swizzles};

use genescape_schema::INDIVIDUALS;

use super::{Binding, BoundTrees, CullUniform, Layouts, SHADE, SHADOW, SunView, ViewUniform, bind, sun_view};
use crate::gpu::{Gpu, flat};
use crate::upload::SceneBuffers;

/// Texels a side, of the square and of what the sun sees. A trunk is some decimetres wide: a seventh of a metre a texel shows it,
/// where a device is slow; a twentieth shows twigs.
const SIDE: [u32; 2] = [768, 2048];
const LEVELS: u32 = 8;
/// Of a tree the level is drawn whose error is that large, and larger with its distance: the sun's disc blurs what is finer, by a
/// hundredth of the way from a leaf to its shadow. Near trees in full took a graphics card longer than all else of a picture.
const ERROR_M: f32 = 0.2;
const ERROR_PER_M: f32 = 0.01;
/// How wide the square is. Shaders look up less of it (`near_shade_at` of `common.wgsl`): by as much as the eye may be beside its
/// middle.
const EXTENT_M: f32 = 104.0;
/// Middles are that far from each other, east and south: views that move together draw theirs one after the other, for each has a
/// lattice of its own. So a picture does not wait for four.
const STEP_M: f32 = 5.0;
/// Where those of the four lie, in steps: different along both ways.
const TURNS: [[f32; 2]; INDIVIDUALS] = [[0.0, 0.0], [0.25, 0.5], [0.5, 0.25], [0.75, 0.75]];
/// The eye may be so far from the middle: a little farther than from the nearest of the lattice, which whole texels move by up to a
/// decimetre, so that one who stands between two stays with one.
const MAX_ASIDE_M: f32 = 0.74 * STEP_M;
/// Sine of the sun's elevation below which shadows on the ground are too long to have any edges.
const MIN_ELEVATION: f32 = 0.03;

/// How much of the sun's light trees let through to the ground around an eye, with what it takes to draw that.
#[derive(Debug)]
pub struct BoundShade {
    pub(super) texture: wgpu::Texture,
    /// Of the texture, the finest first.
    pub(super) levels: Vec<Level>,
    /// What the sun sees.
    pub(super) depth: wgpu::TextureView,
    pub(super) sun_group: wgpu::BindGroup,
    /// None where there are none, or no sun to shade from.
    pub(super) trees: Option<BoundTrees>,
    uniform: wgpu::Buffer,
    turn: usize,
    /// Of the square, x and z; none before it is first drawn.
    middle_m: Option<Vec2>,
}

/// A version of the texture.
#[derive(Debug)]
pub(super) struct Level {
    pub view: wgpu::TextureView,
    /// What it is made from.
    pub source: wgpu::BindGroup,
}

impl BoundShade {
    /// `turn`: which of the four views it is for.
    pub(super) fn new(gpu: &Gpu, layouts: &Layouts, scene: &SceneBuffers, turn: usize) -> Self {
        let set = scene.trees.as_ref().filter(|_| scene.sky.sun_direction.y > MIN_ELEVATION);
        let (side, levels) = if set.is_some() { (SIDE[usize::from(!gpu.software)], LEVELS) } else { (1, 1) };
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            mip_level_count: levels,
            ..flat("shade of near trees", [side; 2], SHADE, usage)
        });
        let depth = gpu.device.create_texture(&flat("trees seen by the sun", [side; 2], SHADOW, usage));
        let depth = depth.create_view(&Default::default());
        let views: Vec<_> = (0..levels)
            .map(|level| {
                let only = wgpu::TextureViewDescriptor {
                    base_mip_level: level,
                    mip_level_count: Some(1),
                    ..Default::default()
                };
                texture.create_view(&only)
            })
            .collect();
        let source = |level: usize| match level.checked_sub(1) {
            None => {
                bind(gpu, "trees seen by the sun", &layouts.seen_by_sun, [(0, Binding::View(depth.clone()))])
            }
            Some(finer) => {
                bind(gpu, "finer shade", &layouts.finer, [(1, Binding::View(views[finer].clone()))])
            }
        };
        let levels = views.iter().enumerate();
        let levels =
            levels.map(|(level, view)| Level { view: view.clone(), source: source(level) }).collect();
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let uniform = gpu.empty_buffer("sun", size_of::<ViewUniform>() as u64, usage);
        Self {
            sun_group: sun_view::group(gpu, layouts, scene, &uniform),
            trees: set.map(|set| BoundTrees::new(gpu, layouts, set)),
            texture,
            levels,
            depth,
            uniform,
            turn,
            middle_m: None,
        }
    }

    /// Follows the eye and says whether the square has to be drawn anew. Once it is drawn it only follows if it may.
    pub fn follow(&mut self, gpu: &Gpu, scene: &SceneBuffers, eye_m: Vec3, may_move: bool) -> bool {
        let eye_m = eye_m.xz();
        let stays = self.middle_m.is_some_and(|middle_m| is_near(middle_m, eye_m) || !may_move);
        let Some((set, trees)) = scene.trees.as_ref().zip(self.trees.as_ref()).filter(|_| !stays) else {
            return false;
        };
        let middle_m = nearest_m(eye_m, self.turn, self.texture.width());
        self.middle_m = Some(middle_m);
        let ground_m = Vec3::new(middle_m.x, scene.ground.field.height_m(middle_m.x, middle_m.y), middle_m.y);
        let sun_view = SunView::of_ground(scene, middle_m, 0.5 * EXTENT_M);
        let numbers = ViewUniform { shade: self.place(), ..ViewUniform::for_sun(scene, &sun_view) };
        gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&numbers));
        let chosen = CullUniform::for_shadow(set, ERROR_M, 0..set.count).between(sun_view.sides());
        trees.set(&gpu.queue, &chosen.coarser_from(ground_m, ERROR_PER_M));
        true
    }

    /// `shade` of `common.wgsl`'s `View`.
    pub fn place(&self) -> [f32; 4] {
        self.middle_m.map_or([0.0, 0.0, 1.0, 0.0], |middle_m| [middle_m.x, middle_m.y, EXTENT_M, 1.0])
    }
}

fn is_near(middle_m: Vec2, eye_m: Vec2) -> bool {
    middle_m.distance(eye_m) <= MAX_ASIDE_M
}

/// The middle nearest to an eye on the lattice of one of the four views, whose square has so many texels a side.
fn nearest_m(eye_m: Vec2, turn: usize, texels: u32) -> Vec2 {
    let phase_m = STEP_M * Vec2::from(TURNS[turn % INDIVIDUALS]);
    let middle_m = ((eye_m - phase_m) / STEP_M).round() * STEP_M + phase_m;
    // By whole texels, so that edges of shadows stay where they are.
    let texel_m = EXTENT_M / texels as f32;
    (middle_m / texel_m).round() * texel_m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_eye_is_so_far_from_its_middle_that_it_is_drawn_in_every_picture() {
        for (turn, texels) in (0..INDIVIDUALS).flat_map(|turn| SIDE.map(|texels| (turn, texels))) {
            let lines = || (-60..60i16).map(|k| f32::from(k) + 0.5);
            for (x, z) in lines().flat_map(|x| lines().map(move |z| (x, z))) {
                // Between four of the lattice, on each side.
                let corner_m = STEP_M * (Vec2::new(x, z) + Vec2::from(TURNS[turn]));
                for aside_m in [[-0.001, -0.001], [-0.001, 0.001], [0.001, -0.001], [0.001, 0.001]] {
                    let eye_m = corner_m + Vec2::from(aside_m);
                    let middle_m = nearest_m(eye_m, turn, texels);
                    assert!(
                        is_near(middle_m, eye_m),
                        "{eye_m} from {middle_m}, view {turn}, {texels} texels"
                    );
                }
            }
        }
    }

    #[test]
    fn views_that_walk_together_take_turns() {
        for direction in 0..48u8 {
            let ahead = Vec2::from_angle(f32::from(direction) / 48.0 * std::f32::consts::TAU);
            let mut middles = [0, 1, 2, 3].map(|turn| nearest_m(Vec2::ZERO, turn, SIDE[0]));
            let (mut drawn, mut together) = (0, 0);
            for step in 1..4000u16 {
                let eye_m = 0.05 * f32::from(step) * ahead;
                let moved: Vec<usize> = (0..4).filter(|&turn| !is_near(middles[turn], eye_m)).collect();
                for &turn in &moved {
                    middles[turn] = nearest_m(eye_m, turn, SIDE[0]);
                    assert!(is_near(middles[turn], eye_m), "it would be drawn in every picture");
                }
                drawn += moved.len();
                together += moved.len().saturating_sub(2);
            }
            // Each about every step of the lattice.
            assert!((100..280).contains(&drawn), "{drawn} times in 200 m, direction {direction}");
            assert!(together <= 2, "{together} times more than two at once, direction {direction}");
        }
    }
}
