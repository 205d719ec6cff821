//! Weights → points that keep their distance, each with its tree.
//!
//! Each cell of a coarse map of the weights has darts of its own, the more often the more it weighs, so that a dart costs
//! the same whether trees grow everywhere or in one valley; they are then weighed where they fall. What a cell's n-th dart
//! is, depends on nothing else: land that is only a little different, as a sketch is, has nearly the same trees in the same
//! places, where one sequence of darts for all cells would give it another forest. A tree claims a circle of three quarters
//! of its crown, and at least so much that trees spread evenly (about 0.7 of the widest spacing that dart throwing reaches).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::model::Placement;
use crate::noise::hash01;
use crate::raster::square;
use crate::seed::{Dice, noise_seed};

use super::site::Site;
use super::stand::{self, Foot, TRUNK_RESERVE_M};
use super::{MAX_TREES, PlacementParams, TreeFootprint};

/// Cells a side of the map of weights.
const MAP_SIDE: u32 = 128;
/// With fewer trees, scenes could not be told apart, and from most places one would see a lonely shrub or none: where little
/// land bears trees, they stand closer than asked, up to `CROWDED_PER_HA`.
const MIN_TREES: f32 = 700.0;
const CROWDED_PER_HA: f32 = 100.0;
/// Spacing of saturated dart throwing times √density (covering 0.547 of the plane), and how much of it we ask for.
const SATURATED: f32 = 0.834;
const EVENNESS: f32 = 0.7;
/// Part of a crown's radius that no other's part may enter: neighbours touch and mingle a little.
const CROWN_CLAIM: f32 = 0.75;
/// Misses in a row after which the land counts as full.
const PATIENCE: u32 = 500;

/// Plants `trees` at the asked density as far as there is room, in a fixed order.
pub(super) fn scatter(params: &PlacementParams, site: &Site, trees: &[TreeFootprint]) -> Placement {
    let map = WeightMap::new(site);
    let hectares = map.area_m2 / 10_000.0;
    let wanted = wanted(params.density_per_ha, hectares);
    if wanted == 0 {
        return Placement::default();
    }
    let even_m = 0.5 * EVENNESS * SATURATED * (map.area_m2 / wanted as f32).sqrt();
    let largest = trees.iter().map(|tree| claim_m(tree, stand::MAX_SCALE)).fold(even_m, f32::max);
    let mut taken = Taken::new(site.half_m, 2.0 * largest);
    let mut darts = Darts::new(&map, params.tree_seed);
    let mut instances = Vec::with_capacity(wanted as usize);
    let mut misses = 0;
    while instances.len() < wanted as usize && misses < PATIENCE {
        misses += 1;
        let Some(Dart { x, z, weight, mut dice }) = darts.next() else { break };
        let keep = dice.unit();
        let Some(spot) = site.at(x, z).filter(|spot| spot.weight > keep * weight) else { continue };
        let template = ((dice.unit() * trees.len() as f32) as usize).min(trees.len() - 1);
        let tree = &trees[template];
        let scale = stand::scale(params.height_variation, spot.vigour, &mut dice);
        let claim = claim_m(tree, scale).max(even_m);
        if !taken.is_free(x, z, claim) {
            continue;
        }
        let foot = |radius_m: f32| Foot::on(site, [x, z], radius_m);
        let Some(instance) = stand::stand(tree, template as u32, [x, z], scale, &mut dice, foot) else {
            continue;
        };
        taken.take(x, z, claim);
        instances.push(instance);
        misses = 0;
    }
    let per_m2 = instances.len() as f32 / map.area_m2;
    Placement { instances, per_m2 }
}

/// How many trees to plant on land that counts as `hectares`.
fn wanted(density_per_ha: f32, hectares: f32) -> u32 {
    let few = MIN_TREES.min(CROWDED_PER_HA * hectares);
    let n = (density_per_ha * hectares).max(few);
    let max = MAX_TREES as f32;
    (n * max / (n + max)) as u32
}

/// Radius of the circle that no other tree's may enter.
fn claim_m(tree: &TreeFootprint, scale: f32) -> f32 {
    (CROWN_CLAIM * tree.crown_radius_m * scale).max(stand::trunk_reach_m(tree, scale) + TRUNK_RESERVE_M)
}

/// Weights on a coarse grid.
struct WeightMap {
    half_m: f32,
    cell_m: f32,
    weights: Vec<f32>,
    /// The area in square metres, weighted.
    area_m2: f32,
}

impl WeightMap {
    fn new(site: &Site) -> Self {
        let half_m = site.half_m;
        let cell_m = 2.0 * half_m / MAP_SIDE as f32;
        let centre = |k: usize| (k as f32 + 0.5) * cell_m - half_m;
        let weight = |i: usize, j: usize| site.at(centre(i), centre(j)).map_or(0.0, |spot| spot.weight);
        let weights = square(MAP_SIDE as usize, weight);
        // f64, since 16,384 small numbers add up.
        let sum: f64 = weights.iter().map(|&weight| f64::from(weight)).sum();
        Self { half_m, cell_m, weights, area_m2: sum as f32 * cell_m * cell_m }
    }
}

/// A place where a tree may stand, its cell's weight, and the dice for all that is left to chance about it.
struct Dart {
    x: f32,
    z: f32,
    weight: f32,
    dice: Dice,
}

/// The darts of all cells, as if in each one fell after every so many moments, fewer of them where it weighs more.
struct Darts<'a> {
    map: &'a WeightMap,
    tree_seed: u32,
    seed: u32,
    /// The moment when the next one falls, as the bits of a number that is not negative, in which cell, and which one of
    /// its cell it is.
    next: BinaryHeap<Reverse<[u32; 3]>>,
}

impl<'a> Darts<'a> {
    fn new(map: &'a WeightMap, tree_seed: u32) -> Self {
        let seed = noise_seed(tree_seed.into(), "placement/darts", 0);
        let mut darts = Self { map, tree_seed, seed, next: BinaryHeap::new() };
        let cells = (0..map.weights.len()).filter(|&cell| map.weights[cell] > 0.0);
        darts.next = cells.map(|cell| darts.falls(cell as u32, 0)).collect();
        darts
    }

    /// When a cell's `number`-th dart falls.
    fn falls(&self, cell: u32, number: u32) -> Reverse<[u32; 3]> {
        let chance = hash01(self.seed, cell as i32, number as i32, 0);
        let moment = (number as f32 + chance) / self.map.weights[cell as usize];
        Reverse([moment.to_bits(), cell, number])
    }
}

impl Iterator for Darts<'_> {
    type Item = Dart;

    /// Never the last, unless there is no cell.
    fn next(&mut self) -> Option<Dart> {
        let Reverse([_, cell, number]) = *self.next.peek()?;
        let after = self.falls(cell, number + 1);
        *self.next.peek_mut()? = after;
        let mut dice = Dice::new(self.tree_seed, "placement", u64::from(cell) << 32 | u64::from(number));
        let WeightMap { half_m, cell_m, weights, .. } = self.map;
        let place = |k: u32, part: f32| (k as f32 + part) * cell_m - half_m;
        let x = place(cell % MAP_SIDE, dice.unit());
        let z = place(cell / MAP_SIDE, dice.unit());
        Some(Dart { x, z, weight: weights[cell as usize], dice })
    }
}

/// The circles that trees claim, by cells of a grid no smaller than any circle.
struct Taken {
    half_m: f32,
    cell_m: f32,
    side: usize,
    /// x, z and radius.
    circles: Vec<Vec<[f32; 3]>>,
}

impl Taken {
    /// For circles at most `widest_m` wide.
    fn new(half_m: f32, widest_m: f32) -> Self {
        let side = ((2.0 * half_m / widest_m.max(1.0)) as usize).clamp(1, 512);
        let cell_m = 2.0 * half_m / side as f32;
        Self { half_m, cell_m, side, circles: vec![Vec::new(); side * side] }
    }

    fn cell(&self, along_m: f32) -> usize {
        (((along_m + self.half_m) / self.cell_m) as usize).min(self.side - 1)
    }

    fn is_free(&self, x: f32, z: f32, radius: f32) -> bool {
        let near = |cell: usize| cell.saturating_sub(1)..=(cell + 1).min(self.side - 1);
        let (columns, rows) = (near(self.cell(x)), near(self.cell(z)));
        let cells = rows.flat_map(|j| columns.clone().map(move |i| j * self.side + i));
        !cells.flat_map(|cell| &self.circles[cell]).any(|&[other_x, other_z, other]| {
            let apart = radius + other;
            (other_x - x) * (other_x - x) + (other_z - z) * (other_z - z) < apart * apart
        })
    }

    fn take(&mut self, x: f32, z: f32, radius: f32) {
        let cell = self.cell(z) * self.side + self.cell(x);
        self.circles[cell].push([x, z, radius]);
    }
}
