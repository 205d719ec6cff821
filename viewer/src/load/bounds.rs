//! How large things in a landscape may be. What is larger, or no number, is damage or malice: a single triangle across
//! everything can take a processor seconds to draw, and thousands of them hours.

use genescape_schema::scene::{Instance, PlantKind};

/// From the middle of the land to anything, in metres; its edge is 10 km away.
pub(super) const MAX_LAND_M: f32 = 1e6;
/// From a tree's foot to any of its leaves, in metres.
const MAX_TREE_M: f32 = 1000.0;
/// What a tree may be scaled by.
const MAX_SCALE: f32 = 1000.0;
/// Pixels a side of a picture: more than any device need take, and 256 MiB.
pub(super) const MAX_PICTURE_PX: u32 = 8192;
/// The same of the sky's, which have 8 bytes a pixel and of which there are thirteen.
pub(super) const MAX_SKY_PX: usize = 4096;

/// How far away small plants may be drawn, how many of a kind within reach, and triangles of one.
const MAX_PLANT_REACH_M: f32 = 400.0;
const MAX_PLANTS: f32 = 100_000.0;
const MAX_PLANT_TRIANGLES: usize = 1000;

/// Whether all are numbers, none of them beyond ±`max`.
pub(super) fn within<'a>(values: impl IntoIterator<Item = &'a f32>, max: f32) -> bool {
    values.into_iter().all(|value| value.abs() <= max)
}

/// Whether a tree's places or their changes are those of a tree.
pub(super) fn is_tree_sized(places_m: &[[f32; 3]]) -> bool {
    within(places_m.as_flattened(), MAX_TREE_M)
}

/// Whether a tree stands somewhere, in some size.
pub(super) fn is_placed(tree: &Instance) -> bool {
    tree.world_from_tree.iter().all(|row| within(&row[..3], MAX_SCALE) && within(&row[3..], MAX_LAND_M))
        && within(&tree.trunk_cylinder_m, MAX_LAND_M)
}

/// Whether a kind of small plants is one, beside so many maps and tiling textures: few and small enough to be drawn, of corners
/// that are there.
pub(super) fn is_plant(kind: &PlantKind, maps: usize, details: usize) -> bool {
    let PlantKind { channel, per_m2, scale, reach_m, sway, texture, colors, shape, .. } = kind;
    let count = shape.positions_m.len();
    let corners = shape.triangles.as_flattened().iter().all(|&v| (v as usize) < count);
    let numbers = [reach_m, sway].into_iter().chain(scale).chain(colors.as_flattened().as_flattened());
    (*channel as usize) < 4 * maps
        && texture.is_none_or(|number| (number as usize) < details)
        && *per_m2 > 0.0
        && *reach_m > 0.0
        && per_m2 * (reach_m + 12.0) * (reach_m + 12.0) < MAX_PLANTS
        && within(numbers, MAX_PLANT_REACH_M)
        && corners
        && shape.triangles.len() <= MAX_PLANT_TRIANGLES
        && (shape.normals.len(), shape.tints.len()) == (count, count)
        && is_tree_sized(&shape.positions_m)
        && is_tree_sized(&shape.normals)
        && within(&shape.tints, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use genescape_schema::scene::PlantShape;

    #[test]
    fn kinds_of_plants_that_would_take_for_ever_are_found() {
        let shape = PlantShape {
            positions_m: vec![[0.0; 3]; 3],
            normals: vec![[0.0, 1.0, 0.0]; 3],
            tints: vec![0.0; 3],
            triangles: vec![[0, 1, 2]],
            coarse: 1,
        };
        let kind = PlantKind { per_m2: 3.0, reach_m: 20.0, channel: 3, shape, ..PlantKind::default() };
        assert!(is_plant(&kind, 1, 5) && !is_plant(&kind, 0, 5));
        let wrong: [fn(&mut PlantKind); 8] = [
            |kind| kind.channel = 4,
            |kind| kind.texture = Some(5),
            |kind| kind.per_m2 = f32::NAN,
            |kind| kind.per_m2 = 1e9,
            |kind| kind.reach_m = f32::INFINITY,
            |kind| kind.shape.triangles[0][1] = 3,
            |kind| kind.shape.positions_m[1][1] = f32::NAN,
            |kind| kind.shape.tints.truncate(2),
        ];
        for change in wrong {
            let mut kind = kind.clone();
            change(&mut kind);
            assert!(!is_plant(&kind, 1, 5), "{kind:?}");
        }
    }

    #[test]
    fn numbers_that_are_none_or_too_large_are_found() {
        for wrong in [f32::NAN, f32::INFINITY, -f32::INFINITY, 1001.0, -3e38] {
            assert!(!is_tree_sized(&[[0.0; 3], [1.0, wrong, 0.0]]), "{wrong}");
        }
        assert!(is_tree_sized(&[[-30.0, 0.0, 1000.0]]) && is_tree_sized(&[]));
        let tree = Instance {
            world_from_tree: [[1.0, 0.0, 0.0, -5000.0], [0.0, 1.0, 0.0, 3.0], [0.0, 0.0, 1.0, 5000.0]],
            template: 0,
            trunk_cylinder_m: [0.0, 0.0, 0.2],
        };
        assert!(is_placed(&tree));
        for (row, column, value) in [(0, 3, 1e7), (1, 1, 1e4), (2, 0, f32::NAN)] {
            let mut wrong = tree;
            wrong.world_from_tree[row][column] = value;
            assert!(!is_placed(&wrong), "{value}");
        }
    }
}
