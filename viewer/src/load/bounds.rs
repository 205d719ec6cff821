//! How large things in a landscape may be. What is larger, or no number, is damage or malice: a single triangle across
//! everything can take a processor seconds to draw, and thousands of them hours.

use genescape_schema::scene::Instance;

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

#[cfg(test)]
mod tests {
    use super::*;

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
