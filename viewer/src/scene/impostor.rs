//! Pictures of a tree, for where it is far away (`GSC_impostor`).

use genescape_schema::scene::IMPOSTOR_PICTURES;
use glam::Vec3;

use super::Image;

/// Rows in which a tree's middle is kept.
pub const IMPOSTOR_ROWS: usize = 32;

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
    /// Some leaves, evenly spread over all their area, for the light that leaves get on average; means nothing where there are none.
    pub leaves: [LeafSide; LEAVES],
    /// How wide what shows of a leaf is, above 0.
    pub leaf_m: f32,
    /// Where the middle of the tree is in each of [`IMPOSTOR_ROWS`] from top to bottom, in x and z from the axis: between the sides that
    /// there are pictures of, a trunk that leans or bends stands where it does by this.
    pub middles_m: [[f32; 2]; IMPOSTOR_ROWS],
}

/// How a leaf lies: unit vectors in the template's space, on either side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeafSide {
    /// The normal by which it is lit.
    pub normal: Vec3,
    /// That of its triangle, by which an eye sees more or less of it.
    pub face: Vec3,
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

/// The middle of what pictures of a width cover in each of [`IMPOSTOR_ROWS`], in x and z from the axis; as in the nearest row where nothing is.
///
/// Seen from +z, x runs to the right; seen from +x, −z does.
pub fn middles_m(relief: &Image, width_m: f32) -> [[f32; 2]; IMPOSTOR_ROWS] {
    let along_x = middles(relief, 0);
    let along_z = middles(relief, IMPOSTOR_PICTURES as usize / 2);
    std::array::from_fn(|row| [along_x[row] * width_m, -along_z[row] * width_m])
}

/// The same to the right in one picture, as parts of its width.
fn middles(relief: &Image, picture: usize) -> [f32; IMPOSTOR_ROWS] {
    let (strip, side) = (relief.width_px as usize, relief.height_px as usize);
    let Some(pixels) = relief.levels.first().filter(|_| side > 0) else { return [0.0; IMPOSTOR_ROWS] };
    let (mut covered, mut moments) = ([0.0; IMPOSTOR_ROWS], [0.0; IMPOSTOR_ROWS]);
    for (y, x) in (0..side).flat_map(|y| (0..side).map(move |x| (y, x))) {
        let share = f32::from(pixels[4 * (y * strip + picture * side + x) + 2]);
        covered[y * IMPOSTOR_ROWS / side] += share;
        moments[y * IMPOSTOR_ROWS / side] += share * ((x as f32 + 0.5) / side as f32 - 0.5);
    }
    let known: Vec<usize> = (0..IMPOSTOR_ROWS).filter(|&row| covered[row] > 0.0).collect();
    std::array::from_fn(|row| {
        let nearest = known.iter().min_by_key(|known| known.abs_diff(row));
        nearest.map_or(0.0, |&row| moments[row] / covered[row])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trunk_that_bends_is_where_it_is() {
        // To the right as seen from +z, towards the eye there, and so to the left as seen from +x.
        let (side, x_part, z_part) = (64, 0.25, 0.125);
        let mut pixels = vec![0; 4 * 4 * side * side];
        for y in side / 2..side {
            let bend = (side - y) as f32 / side as f32;
            for (picture, part) in [(0, x_part), (2, -z_part)] {
                let x = ((0.5 + 2.0 * part * bend) * side as f32) as usize;
                pixels[4 * (4 * side * y + picture * side + x) + 2] = 255;
            }
        }
        let levels = vec![pixels.into()];
        let relief = Image { name: String::new(), width_px: 256, height_px: 64, levels };
        let middles = middles_m(&relief, 8.0);
        let near = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).abs() < 0.2 && (a[1] - b[1]).abs() < 0.2;
        assert!(near(middles[IMPOSTOR_ROWS - 1], [0.0, 0.0]), "{:?}", middles[IMPOSTOR_ROWS - 1]);
        assert!(
            near(middles[IMPOSTOR_ROWS / 2], [8.0 * x_part, 8.0 * z_part]),
            "{:?}",
            middles[IMPOSTOR_ROWS / 2]
        );
        assert_eq!(middles[0], middles[IMPOSTOR_ROWS / 2], "above the tree as at its top");
    }
}
