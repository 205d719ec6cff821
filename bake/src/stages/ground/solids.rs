//! Maps of small plants and the stems of trees → the same maps without the boulders, stumps and fallen trunks that would lie in
//! a tree or in each other. Metres.

use glam::Vec2;

use super::patch::plan;
use crate::model::{DensityMap, GroundPlants, Image8, Plant, PlantShape};

/// Metres a side of the cells in which what is near is looked for.
const CELL_M: f32 = 8.0;
/// Part of a shape's width that it takes up: its sides are round, and may touch.
const FILLED: f32 = 0.85;

/// What nothing else may reach into: all within a distance of a line.
#[derive(Clone, Copy)]
struct Solid {
    ends: [Vec2; 2],
    radius_m: f32,
}

impl Solid {
    /// A stem: x, z and radius.
    fn of_stem([x, z, radius_m]: [f32; 3]) -> Self {
        Self { ends: [Vec2::new(x, z); 2], radius_m }
    }

    /// A plant of that length and width from its middle; it lies along +x where it is longer than wide.
    fn of_plant(plant: &Plant, reach: Vec2) -> Self {
        let radius_m = FILLED * reach.y * plant.scale;
        let (sin, cos) = libm::sincosf(plant.turn_rad);
        let along = (reach.x * plant.scale - radius_m).max(0.0) * Vec2::new(cos, sin);
        let middle = Vec2::new(plant.x_m, plant.z_m);
        Self { ends: [middle - along, middle + along], radius_m }
    }

    fn touches(&self, other: &Self) -> bool {
        distance(self.ends, other.ends) < self.radius_m + other.radius_m
    }
}

/// How far a shape reaches to either side along x and along z, without its twigs.
fn reach(shape: &PlantShape) -> Vec2 {
    let coarse = shape.triangles.iter().take(shape.coarse as usize).flatten();
    coarse.map(|&v| plan(shape.positions_m[v as usize]).abs()).fold(Vec2::ZERO, Vec2::max)
}

/// Between two lines from end to end.
fn distance([a, b]: [Vec2; 2], [c, d]: [Vec2; 2]) -> f32 {
    let side = |from: Vec2, to: Vec2, at: Vec2| (to - from).perp_dot(at - from);
    if side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0 {
        return 0.0;
    }
    let to_line = |at: Vec2, [from, to]: [Vec2; 2]| {
        let along = to - from;
        let part = (at - from).dot(along) / along.length_squared().max(f32::MIN_POSITIVE);
        at.distance(from + part.clamp(0.0, 1.0) * along)
    };
    let ends = [(a, [c, d]), (b, [c, d]), (c, [a, b]), (d, [a, b])];
    ends.into_iter().map(|(at, line)| to_line(at, line)).fold(f32::MAX, f32::min)
}

/// Where something is already, by the cells that it reaches into.
struct Taken {
    /// Cells a side, the first in the field's corner.
    side: usize,
    corner_m: f32,
    cells: Vec<Vec<Solid>>,
}

impl Taken {
    fn new(extent_m: f32) -> Self {
        let side = (extent_m / CELL_M).ceil() as usize + 1;
        Self { side, corner_m: -0.5 * extent_m, cells: vec![Vec::new(); side * side] }
    }

    /// The cells into which something reaches; what lies outside of the field is in the outermost.
    fn around(&self, solid: &Solid) -> impl Iterator<Item = usize> + use<> {
        let low = solid.ends[0].min(solid.ends[1]) - solid.radius_m;
        let high = solid.ends[0].max(solid.ends[1]) + solid.radius_m;
        let (side, corner_m) = (self.side, self.corner_m);
        let line = move |at: f32| (((at - corner_m) / CELL_M).max(0.0) as usize).min(side - 1);
        let columns = line(low.x)..=line(high.x);
        (line(low.y)..=line(high.y)).flat_map(move |j| columns.clone().map(move |i| j * side + i))
    }

    fn add(&mut self, solid: Solid) {
        self.around(&solid).for_each(|cell| self.cells[cell].push(solid));
    }

    fn has_room_for(&self, solid: &Solid) -> bool {
        !self.around(solid).flat_map(|cell| &self.cells[cell]).any(|other| other.touches(solid))
    }
}

/// Takes those of some kinds away that have no room among the stems and those before them. `extent_m` is the side of the field.
pub(super) fn set_apart(
    plants: &mut GroundPlants<Image8>,
    channels: &[usize],
    stems: &[[f32; 3]],
    extent_m: f32,
) {
    let mut taken = Taken::new(extent_m);
    stems.iter().for_each(|&stem| taken.add(Solid::of_stem(stem)));
    let GroundPlants { maps, kinds } = plants;
    let solid = channels.iter().filter_map(|&channel| kinds.iter().find(|k| k.channel as usize == channel));
    for kind in solid {
        let Some(map) = maps.get_mut(kind.channel as usize / 4) else { continue };
        let reach = reach(&kind.shape);
        let lines = (0.5 * extent_m / kind.cell_m()) as i32 + 1;
        let cells = (-lines..lines).flat_map(|j| (-lines..lines).map(move |i| [i, j]));
        for cell in cells {
            let density = |x: f32, z: f32| {
                let map = DensityMap { width_px: map.width, height_px: map.height, rgba: &map.data };
                map.at(kind.channel, x / extent_m + 0.5, z / extent_m + 0.5)
            };
            let Some(plant) = kind.in_cell(cell, density) else { continue };
            let solid = Solid::of_plant(&plant, reach);
            if taken.has_room_for(&solid) {
                taken.add(solid);
            } else {
                clear(map, kind.channel, [plant.x_m, plant.z_m].map(|m| m / extent_m + 0.5));
            }
        }
    }
}

/// Makes a channel 0 in the four pixels between which it is read at a place in 0..1.
fn clear(map: &mut Image8, channel: u32, [u, v]: [f32; 2]) {
    for row in DensityMap::between(v, map.height).0 {
        for column in DensityMap::between(u, map.width).0 {
            map.data[4 * (row * map.width + column) as usize + channel as usize % 4] = 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_apart_by_the_nearest_of_their_points() {
        let line = |from: [f32; 2], to: [f32; 2]| [from, to].map(Vec2::from_array);
        let across = line([0.0, 0.0], [4.0, 0.0]);
        for (other, expected) in [
            (line([2.0, -1.0], [2.0, 1.0]), 0.0),
            (line([2.0, 1.0], [2.0, 3.0]), 1.0),
            (line([6.0, 0.0], [9.0, 0.0]), 2.0),
            (line([7.0, 4.0], [7.0, 4.0]), 5.0),
            (line([1.0, 2.0], [3.0, 2.0]), 2.0),
        ] {
            let found = [distance(across, other), distance(other, across)];
            assert!(found.iter().all(|d| (d - expected).abs() < 1e-6), "{found:?}, not {expected}");
        }
    }
}
