//! Land, trees, sun → where a walk starts, in metres: a dry, level, open spot not far from the middle with a long view
//! that has trees in it; and the direction of the first look, with the sun beside or behind.
//!
//! The spot depends on land and trees alone, so that another sky shows the same place, and [`clear_around`] keeps
//! trunks away from it. The direction depends on the sun, too.

use glam::{Vec2, Vec3};
use serde::Serialize;

use crate::graph::{Context, Input, Stage, StageError};
use crate::model::{Heightfield, Instance, Landform, Placement, SkyLight, StartView};

/// Metres around the start in which no trunk stands.
pub const CLEARING_M: f32 = 6.0;

const EYE_M: f32 = StartView::EYE_HEIGHT_M;
const SPOTS: i32 = 9;
const AZIMUTHS: u32 = 24;

/// Landform, placement, sun → where the walk starts, and the first look.
#[derive(Serialize)]
pub struct StartStage {
    pub landform: Input<Landform>,
    pub placement: Input<Placement>,
    pub light: Input<SkyLight>,
}

impl Stage for StartStage {
    const NAME: &'static str = "start";
    const VERSION: u32 = 2;
    type Output = StartView;

    fn run(&self, context: &Context<'_>) -> Result<StartView, StageError> {
        let (landform, placement) = (context.get(&self.landform)?, context.get(&self.placement)?);
        Ok(start_view(&landform, &placement, context.get(&self.light)?.sun_direction))
    }
}

/// The best of a fixed list of spots, as x and z in metres, if no trunk stood around it.
pub fn start_spot(land: &Landform, trees: &[Instance]) -> [f32; 2] {
    let scene = Surroundings::new(land, trees);
    let step_m = land.field.extent_m() * 0.055;
    let mut best = (f32::MIN, Vec2::ZERO);
    for j in -SPOTS / 2..=SPOTS / 2 {
        for i in -SPOTS / 2..=SPOTS / 2 {
            let spot = Vec2::new(i as f32, j as f32) * step_m;
            let Some(standing) = scene.standing(spot) else { continue };
            let trees = scene.trees_by_azimuth(spot);
            let views = (0..AZIMUTHS).map(|azimuth| scene.view(spot, azimuth, &trees));
            let score = standing + views.fold(f32::MIN, f32::max);
            if score > best.0 {
                best = (score, spot);
            }
        }
    }
    best.1.to_array()
}

/// Removes the trees whose trunks reach into the clearing around a start.
pub fn clear_around(start_m: [f32; 2], trees: &mut Vec<Instance>) {
    trees.retain(|tree| clearance_m(Vec2::from(start_m), tree) >= CLEARING_M);
}

/// Metres from a spot to a trunk.
fn clearance_m(spot: Vec2, tree: &Instance) -> f32 {
    let [x, z, radius] = tree.trunk_cylinder_m;
    spot.distance(Vec2::new(x, z)) - radius
}

/// The best of a fixed list of looks from the start.
///
/// `towards_sun` is a unit vector.
pub fn start_view(land: &Landform, placement: &Placement, towards_sun: Vec3) -> StartView {
    let scene = Surroundings::new(land, &placement.instances);
    let spot = Vec2::from(placement.start_m);
    let trees = scene.trees_by_azimuth(spot);
    let score = |azimuth| scene.view(spot, azimuth, &trees) + scene.light(spot, azimuth, towards_sun);
    // The first of equal ones.
    let best = (0..AZIMUTHS).rev().max_by(|&a, &b| score(a).total_cmp(&score(b))).unwrap_or(0);
    let ground_m = scene.surface_m(spot);
    let along = heading(best);
    let direction = Vec3::new(along.x, scene.pitch(spot, along), along.y).normalize();
    StartView { position_m: Vec3::new(spot.x, ground_m + EYE_M, spot.y), direction }
}

/// Unit vector in the (x, z) plane, clockwise from north (−z).
fn heading(azimuth: u32) -> Vec2 {
    let angle = azimuth as f32 * (core::f32::consts::TAU / AZIMUTHS as f32);
    Vec2::new(libm::sinf(angle), -libm::cosf(angle))
}

struct Surroundings<'a> {
    land: &'a Heightfield,
    water_m: f32,
    trees: &'a [Instance],
}

impl<'a> Surroundings<'a> {
    fn new(land: &'a Landform, trees: &'a [Instance]) -> Self {
        Self { land: &land.field, water_m: land.water_level_m.unwrap_or(f32::MIN), trees }
    }

    /// Height of the land or of the water on it.
    fn surface_m(&self, p: Vec2) -> f32 {
        self.land.height_m(p.x, p.y).max(self.water_m)
    }

    /// How good a spot is to stand on: `None` in water and on a steep slope.
    fn standing(&self, spot: Vec2) -> Option<f32> {
        let at = |x: f32, z: f32| self.land.height_m(spot.x + x, spot.y + z);
        let rise = |x: f32, z: f32| at(x, z) - at(-x, -z);
        let (ground, rise) = (at(0.0, 0.0), Vec2::new(rise(2.0, 0.0), rise(0.0, 2.0)).length() / 4.0);
        if ground < self.water_m + 0.3 || rise > 0.6 {
            return None;
        }
        let far = spot.length() / self.land.extent_m();
        // Shores are bare; the grass begins a little above.
        let bare = (1.0 - (ground - self.water_m - 0.6)).clamp(0.0, 1.0);
        Some(-0.7 * rise - 0.4 * far - 0.4 * bare)
    }

    /// For each azimuth, how many trees outside the clearing stand in a cone of ±30° around it: x in the way, y in
    /// view.
    fn trees_by_azimuth(&self, spot: Vec2) -> Vec<Vec2> {
        let mut bins = vec![Vec2::ZERO; AZIMUTHS as usize];
        let standing = self.trees.iter().filter(|tree| clearance_m(spot, tree) >= CLEARING_M);
        for tree in standing {
            let offset = Vec2::new(tree.trunk_cylinder_m[0], tree.trunk_cylinder_m[1]) - spot;
            let distance = offset.length();
            if distance > 200.0 {
                continue;
            }
            let turn = libm::atan2f(offset.x, -offset.y) / core::f32::consts::TAU;
            let bin = ((turn + 1.0) * AZIMUTHS as f32 + 0.5) as usize % AZIMUTHS as usize;
            if distance < 22.0 {
                bins[bin].x += 1.0 - distance / 22.0;
            } else if self.sees(spot, tree) {
                // A tree near enough to show its leaves counts for many distant ones.
                bins[bin].y += 1.0 / (1.0 + distance * distance * 0.001);
            }
        }
        let n = bins.len();
        (0..n).map(|i| (0..5).map(|j| bins[(i + n + j - 2) % n]).sum()).collect()
    }

    /// Whether the middle of a tree can be seen over the land between.
    fn sees(&self, spot: Vec2, tree: &Instance) -> bool {
        let foot = Vec2::new(tree.trunk_cylinder_m[0], tree.trunk_cylinder_m[1]);
        let eye_m = self.land.height_m(spot.x, spot.y) + EYE_M;
        let middle_m = self.land.height_m(foot.x, foot.y) + 4.0;
        [0.2, 0.4, 0.6, 0.8].into_iter().all(|t| {
            let p = spot.lerp(foot, t);
            self.land.height_m(p.x, p.y) < eye_m + (middle_m - eye_m) * t
        })
    }

    /// Whether no hill stands between a place and the sun.
    fn is_lit(&self, place: Vec2, towards_sun: Vec3) -> bool {
        let ground_m = self.land.height_m(place.x, place.y);
        (1..12).all(|step| {
            let p = Vec3::new(place.x, ground_m + 0.5, place.y) + towards_sun * (4.0 * (step * step) as f32);
            self.land.height_m(p.x, p.z) < p.y
        })
    }

    /// How good a look is, whatever the light.
    fn view(&self, spot: Vec2, azimuth: u32, trees: &[Vec2]) -> f32 {
        let along = heading(azimuth);
        let eye_m = self.land.height_m(spot.x, spot.y) + EYE_M;
        let (mut steepest, mut seen, mut steps, mut top) = (f32::MIN, 0.0, 0.0, f32::MIN);
        let mut lake = 0.0;
        let mut distance = 6.0f32;
        loop {
            let p = spot + along * distance;
            if p.abs().max_element() > 0.5 * self.land.extent_m() {
                break;
            }
            let ground = self.surface_m(p);
            let slope = (ground - eye_m) / distance;
            steps += 1.0;
            if slope >= steepest {
                (steepest, seen) = (slope, seen + 1.0);
                if ground <= self.water_m && distance > 12.0 {
                    lake += 1.0;
                }
            }
            top = top.max(slope);
            distance *= 1.15;
        }
        let open = seen / f32::max(steps, 1.0);
        // Mountains are worth looking at, but not a wall right ahead.
        let relief = top.clamp(0.0, 0.3) - 5.0 * (top - 0.4).max(0.0);
        let Vec2 { x: in_the_way, y: in_view } = trees[azimuth as usize];
        // A view without trees says nothing about the trees, and water doubles the sky.
        let trees = in_view / (1.5 + in_view);
        let water = (4.0 * lake / f32::max(steps, 1.0)).min(1.0);
        0.8 * open + 1.2 * relief + 1.8 * trees + 0.6 * water - 1.2 * in_the_way.min(2.0)
    }

    /// How good the light is in a look.
    fn light(&self, spot: Vec2, azimuth: u32, towards_sun: Vec3) -> f32 {
        let along = heading(azimuth);
        let sun = Vec2::new(towards_sun.x, towards_sun.z);
        let facing_sun = if sun.length() > 1e-3 { along.dot(sun.normalize()) } else { 0.0 };
        // Light from the side or from behind models the land; against the sun, all is flat.
        let lit = [5.0, 12.0, 30.0].iter().all(|d| self.is_lit(spot + along * *d, towards_sun));
        let shade = if lit { 0.0 } else { -0.5 };
        shade - 0.7 * (facing_sun + 0.1).max(0.0) - 0.15 * (-facing_sun - 0.7).max(0.0)
    }

    /// Slope of the look: towards the middle of the view, within ±10°.
    fn pitch(&self, spot: Vec2, along: Vec2) -> f32 {
        let eye_m = self.surface_m(spot) + EYE_M;
        let slope = |distance: f32| (self.surface_m(spot + along * distance) - eye_m) / distance;
        let mean = (slope(60.0) + slope(150.0) + slope(400.0)) / 3.0;
        (0.6 * mean + 0.03).clamp(-0.17, 0.17)
    }
}
