//! Pictures of a tree, for where it is far away (`GSC_impostor`).

use glam::Vec3;

use super::Image;

/// Leaves that are kept as [`LeafSide`]s.
pub const LEAVES: usize = 32;

/// The pictures of a template and where they stand; metres in its space.
#[derive(Clone, Debug)]
pub struct Impostor {
    /// Albedo, sRGB, with alpha: four pictures side by side.
    pub color: Image,
    /// Red: how far what is seen lies before the axis, ½ for none, 1 for half of the width. Green: share of leaves.
    /// Blue: share of the pixel that the tree covers.
    pub relief: Image,
    /// Below this alpha there is no leaf; 0 where leaves are seen one by one, and cover pixels in part.
    pub alpha_cutoff: f32,
    /// x and z of the vertical axis.
    pub axis_m: [f32; 2],
    /// y of the lower edge.
    pub low_m: f32,
    /// Width and height of a picture.
    pub size_m: [f32; 2],
    /// From this error on they serve as well as any mesh.
    pub error_m: f32,
    /// The ellipsoid around the leaves.
    pub crown: Crown,
    /// Some leaves, evenly spread over all their area, for the light that leaves get on average; zero where there are none.
    pub leaves: [LeafSide; LEAVES],
}

/// How a leaf lies; unit vectors in the template's space, on either side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeafSide {
    /// The normal by which it is lit.
    pub normal: [f32; 3],
    /// That of its triangle, by which an eye sees more or less of it.
    pub face: [f32; 3],
}

/// The ellipsoid around the leaves of a tree; metres in the template's space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crown {
    pub middle_m: [f32; 3],
    /// Semi-axes along x, y and z, above 0.
    pub half_m: [f32; 3],
}

impl Crown {
    /// In the box around all places.
    pub fn around(places: impl Iterator<Item = Vec3> + Clone) -> Self {
        let (low, high) = (places.clone().fold(Vec3::MAX, Vec3::min), places.fold(Vec3::MIN, Vec3::max));
        if !low.cmple(high).all() {
            return Self::default();
        }
        let (middle, half) = (0.5 * (low + high), (0.5 * (high - low)).max(Vec3::splat(1e-3)));
        Self { middle_m: middle.into(), half_m: half.into() }
    }
}

impl Default for Crown {
    fn default() -> Self {
        Self { middle_m: [0.0; 3], half_m: [1.0; 3] }
    }
}
