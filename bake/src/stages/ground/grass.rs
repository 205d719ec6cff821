//! The foreground → blades of grass that stand on it around the eye, as plain triangles in the ground's colours: no
//! texture, no alpha, so any viewer draws them well. Metres.
//!
//! Tufts stand on a jittered grid, the fewer the farther away, while their blades get wider; none where the ground is
//! not grass. They shrink towards the edge, so that no edge shows.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::cover::KINDS;
use super::patch::{Patch, SIDE_M, plan};
use super::textures::factor_on;
use super::window::MapWindow;
use crate::model::{Material, Mesh, Part, PartKind, StartView};
use crate::noise::{gradient2, hash01};

/// Metres between tufts where they stand closest.
const TUFT_M: f32 = 0.3;
/// Metres from the eye up to which they stand that close.
const DENSE_M: f32 = 5.0;
/// Metres from the eye to the last tufts.
const REACH_M: f32 = 42.0;
/// Metres around the eye that stay free.
const FREE_M: f32 = 0.9;
/// Albedo of a vertex colour of 1, as the palest petals have: grass is dark, and bytes are few.
pub const BLADE_WHITE: f32 = 0.75;

/// Blades on the piece of ground around the eye; one part, `Material::Foreign(5)`, empty where no grass grows.
pub(super) fn grass(patch: &Patch<'_>, window: &MapWindow, view: &StartView) -> Mesh {
    let eye = plan(view.position_m.to_array());
    let ahead = plan(view.direction.to_array()).normalize_or_zero();
    let across = (SIDE_M / TUFT_M) as i32;
    let field = &Meadow { patch, window, eye: view.position_m, ahead };
    let near = |j: &i32| (patch.corner.y + *j as f32 * TUFT_M - eye.y).abs() <= REACH_M;
    let rows = (0..across).into_par_iter().filter(near);
    let blades: Vec<Blade> =
        rows.flat_map_iter(|j| (0..across).flat_map(move |i| field.tuft(i, j))).collect();
    let mut mesh = Mesh::default();
    let mut triangles = Vec::new();
    for blade in &blades {
        let first = mesh.positions.len() as u32;
        for (point, color) in blade.points.iter().zip([blade.root, blade.root, blade.tip]) {
            mesh.positions.push(point.to_array());
            mesh.normals.push(blade.normal.to_array());
            mesh.colors.push(factor_on(BLADE_WHITE, color));
        }
        triangles.push([first, first + 1, first + 2]);
    }
    mesh.parts = vec![Part { material: Material::Foreign(KINDS as u32), kind: PartKind::Surface, triangles }];
    mesh
}

struct Blade {
    points: [Vec3; 3],
    normal: Vec3,
    root: [f32; 3],
    tip: [f32; 3],
}

struct Meadow<'a> {
    patch: &'a Patch<'a>,
    window: &'a MapWindow,
    eye: Vec3,
    ahead: Vec2,
}

impl Meadow<'_> {
    /// The blades of a cell of the grid: often none.
    fn tuft(&self, i: i32, j: i32) -> Vec<Blade> {
        let seed = self.patch.seed ^ 0x6721;
        let dice = |salt: i32| hash01(seed, i, j, salt);
        let place = self.patch.corner + Vec2::new(i as f32 + dice(0), j as f32 + dice(1)) * TUFT_M;
        let offset = place - Vec2::new(self.eye.x, self.eye.z);
        let distance = offset.length();
        // Behind the eye, a third will do.
        let facing = if offset.dot(self.ahead) > -2.0 { 1.0 } else { 0.35 };
        let chance = (DENSE_M / distance.max(DENSE_M)) * facing;
        if !(FREE_M..REACH_M).contains(&distance) || dice(2) > chance || self.patch.inward(place) < 0.03 {
            return Vec::new();
        }
        let here = self.window.at(place);
        let clump = gradient2(seed, place.x / 1.4, place.y / 1.4, 0)
            + 0.6 * gradient2(seed, place.x / 0.5, place.y / 0.5, 0);
        // Where there is as much snow as grass, it is under the snow.
        let grassy = here.parts[0] - here.parts[3];
        let growth = (grassy - 0.35) * 1.8 + 0.8 * clump + 0.3 * (dice(3) - 0.5);
        if growth < 0.05 || grassy < 0.3 {
            return Vec::new();
        }
        let growth = growth.min(1.0);
        let edge = ((REACH_M - distance) / 24.0).min(1.0);
        let tall = if dice(4) > 0.96 { 1.9 } else { 1.0 };
        let height = (0.05 + 0.13 * growth) * (0.7 + 0.6 * dice(5)) * tall * edge;
        let count = ((4.0 + 7.0 * growth) * (1.0 - 0.5 * (distance / REACH_M))) as i32;
        let tone = 0.85 + 0.5 * dice(6);
        let color = here.grass.map(|c| c * tone);
        (0..count).map(|b| self.blade(place, [i, j, b], height, distance, color)).collect()
    }

    fn blade(&self, tuft: Vec2, [i, j, b]: [i32; 3], height: f32, distance: f32, color: [f32; 3]) -> Blade {
        let seed = self.patch.seed ^ 0xb1ad;
        let dice = |salt: i32| hash01(seed, i, j, b * 8 + salt);
        let turn = dice(0) * std::f32::consts::TAU;
        let out = Vec2::new(libm::cosf(turn), libm::sinf(turn));
        let root = tuft + out * (0.5 * TUFT_M * dice(1));
        let base = Vec3::new(root.x, self.patch.height_m(root) - 0.01, root.y);
        let height = height * (0.55 + 0.75 * dice(2));
        let lean = out * (height * (0.25 + 0.75 * dice(3)));
        let tip = base + Vec3::new(lean.x, height, lean.y);
        // Broad side to the eye, more or less.
        let to_eye = (self.eye - base).with_y(0.0).normalize_or(Vec3::Z);
        let side = Vec3::new(to_eye.z, 0.0, -to_eye.x);
        let side = (side + to_eye * (1.2 * (dice(4) - 0.5))).normalize();
        let half = side * (0.0035 + 0.0025 * dice(5)) * (1.0 + 0.11 * distance).min(3.6);
        let normal = (Vec3::Y + 0.3 * to_eye + 0.25 * Vec3::new(out.x, 0.0, out.y)).normalize();
        // Some blades are straw.
        let straw = if dice(6) > 0.86 { [1.9, 1.45, 1.2] } else { [1.0; 3] };
        let shade = |factor: f32| [0, 1, 2].map(|c| color[c] * straw[c] * factor);
        Blade { points: [base - half, base + half, tip], normal, root: shade(0.9), tip: shade(2.0) }
    }
}
