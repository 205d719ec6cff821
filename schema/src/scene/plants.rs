//! Small plants and stones on the ground. There are too many to list: where each stands follows from its cell and from
//! pictures that say how densely its kind grows, so that the bake, a viewer and other programs agree on every one.

use serde::{Deserialize, Serialize};

/// All that stands and lies on the ground besides trees and grass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct GroundPlants<P> {
    /// RGBA over the field, linear: row 0 is its north edge (−z), column 0 its west edge (−x).
    pub maps: Vec<P>,
    pub kinds: Vec<PlantKind>,
}

/// One kind of them: what it looks like and how densely it grows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct PlantKind {
    /// "fern", "stone".
    pub name: String,
    /// Channel c mod 4 of picture ⌊c/4⌋ of the maps.
    pub channel: u32,
    /// How many stand on a square metre where the channel is 255.
    pub per_m2: f32,
    /// Smallest and largest factor on the shape.
    pub scale: [f32; 2],
    /// How far away in metres they are worth drawing.
    pub reach_m: f32,
    /// How far its top moves in the wind, as a part of its height.
    pub sway: f32,
    /// The tiling texture of the ground that it is made of, by number, if it is not plain.
    #[serde(default)]
    pub texture: Option<u32>,
    /// Linear albedo at tint 0 and at tint 1; each plant has one of these pairs.
    pub colors: Vec<[[f32; 3]; 2]>,
    pub shape: PlantShape,
}

/// A few triangles around the origin, growing along +y. All lists of vertices have one entry a vertex.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct PlantShape {
    /// Metres.
    pub positions_m: Vec<[f32; 3]>,
    /// Unit length.
    pub normals: Vec<[f32; 3]>,
    /// 0 has the first colour, 1 the second.
    pub tints: Vec<f32>,
    /// Seen from both sides.
    pub triangles: Vec<[u32; 3]>,
    /// How many of the first triangles are enough from afar.
    pub coarse: u32,
}

/// One of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plant {
    pub x_m: f32,
    pub z_m: f32,
    /// Turn around +y, from +x towards +z.
    pub turn_rad: f32,
    pub scale: f32,
    /// Which pair of colours.
    pub color: u32,
    /// In [0, 1): where only a share of them can be drawn, those below it.
    pub rank: f32,
}

impl PlantKind {
    /// Metres a side of a cell. Cell (i, j) reaches from i and j times this one cell east and south.
    pub fn cell_m(&self) -> f32 {
        1.0 / self.per_m2.max(1e-6).sqrt()
    }

    /// The plant of a cell, if one stands there: `density` gives the kind's channel at a place, in [0, 1].
    pub fn in_cell(&self, [i, j]: [i32; 2], density: impl FnOnce(f32, f32) -> f32) -> Option<Plant> {
        let seed = [i as u32, j as u32, self.channel];
        let place = pcg3d(seed);
        let [x, z, chance] = place.map(unit);
        let cell_m = self.cell_m();
        let (x_m, z_m) = ((i as f32 + x) * cell_m, (j as f32 + z) * cell_m);
        if chance >= density(x_m, z_m) {
            return None;
        }
        let look = pcg3d(place);
        let [turn, size, color] = look.map(unit);
        let [small, large] = self.scale;
        Some(Plant {
            x_m,
            z_m,
            turn_rad: std::f32::consts::TAU * turn,
            scale: small + (large - small) * size,
            color: (color * self.colors.len() as f32) as u32,
            rank: unit(pcg3d(look)[0]),
        })
    }
}

/// The height in metres on which a corner of a plant stands, `away_m` from the plant's middle: that of the land under it,
/// so that what lies on a slope lies along it; but no stone is drawn out down a cliff, or up one.
pub fn ground_m(here_m: f32, middle_m: f32, away_m: f32) -> f32 {
    here_m.clamp(middle_m - 1.2 * away_m - 0.1, middle_m + 0.7 * away_m + 0.1)
}

impl<P> Default for GroundPlants<P> {
    fn default() -> Self {
        Self { maps: Vec::new(), kinds: Vec::new() }
    }
}

impl<P> GroundPlants<P> {
    /// The same with `f` of each picture.
    ///
    /// # Errors
    /// The first that `f` gives.
    pub fn try_map<Q, E>(&self, f: impl FnMut(&P) -> Result<Q, E>) -> Result<GroundPlants<Q>, E> {
        let maps = self.maps.iter().map(f).collect::<Result<_, _>>()?;
        Ok(GroundPlants { maps, kinds: self.kinds.clone() })
    }
}

/// A map's pixels.
#[derive(Clone, Copy, Debug)]
pub struct DensityMap<'a> {
    pub width_px: u32,
    pub height_px: u32,
    /// 4 bytes a pixel, row by row.
    pub rgba: &'a [u8],
}

impl DensityMap<'_> {
    /// Between which two of `size` columns, or rows, a place in 0..1 over the field is read, and how far on the way to the second.
    pub fn between(part: f32, size: u32) -> ([u32; 2], f32) {
        let last = size.saturating_sub(1);
        let place = (part * size as f32 - 0.5).clamp(0.0, last as f32);
        let first = place as u32;
        ([first, (first + 1).min(last)], place - first as f32)
    }

    /// A channel at a place in 0..1 over the field, linear between the middles of pixels; 0 where there are none.
    pub fn at(&self, channel: u32, u: f32, v: f32) -> f32 {
        let ((columns, right), (rows, down)) =
            (Self::between(u, self.width_px), Self::between(v, self.height_px));
        let pixel = |column: u32, row: u32| {
            let at = (row as usize * self.width_px as usize + column as usize) * 4 + channel as usize % 4;
            f32::from(self.rgba.get(at).copied().unwrap_or(0)) / 255.0
        };
        let along = |row: u32| pixel(columns[0], row) * (1.0 - right) + pixel(columns[1], row) * right;
        along(rows[0]) * (1.0 - down) + along(rows[1]) * down
    }
}

/// Three numbers from three (Jarzynski & Olano, "Hash Functions for GPU Rendering", 2020).
fn pcg3d(seed: [u32; 3]) -> [u32; 3] {
    let [mut x, mut y, mut z] = seed.map(|v| v.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    let mix = |x: &mut u32, y: &mut u32, z: &mut u32| {
        *x = x.wrapping_add(y.wrapping_mul(*z));
        *y = y.wrapping_add(z.wrapping_mul(*x));
        *z = z.wrapping_add(x.wrapping_mul(*y));
    };
    mix(&mut x, &mut y, &mut z);
    [x, y, z] = [x, y, z].map(|v| v ^ v >> 16);
    mix(&mut x, &mut y, &mut z);
    [x, y, z]
}

/// In [0, 1), by the 24 bits that a float holds.
fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 / 16_777_216.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(per_m2: f32) -> PlantKind {
        PlantKind { per_m2, scale: [0.5, 2.0], colors: vec![[[0.1; 3]; 2]; 3], ..PlantKind::default() }
    }

    #[test]
    fn as_many_stand_as_pictures_say_each_in_its_cell() {
        for (per_m2, density) in [(0.25, 1.0), (4.0, 0.5), (4.0, 0.1)] {
            let kind = kind(per_m2);
            let cells = (-100..100).flat_map(|i| (-100..100).map(move |j| [i, j]));
            let mut count = 0.0;
            for cell in cells {
                let Some(plant) = kind.in_cell(cell, |_, _| density) else { continue };
                let own = [plant.x_m, plant.z_m].map(|m| (m / kind.cell_m()).floor() as i32);
                assert!(own.iter().zip(cell).all(|(own, cell)| (own - cell).abs() <= 1), "{own:?} {cell:?}");
                assert!((0.5..=2.0).contains(&plant.scale) && plant.color < 3, "{plant:?}");
                count += 1.0;
            }
            let wanted = 40_000.0 * density;
            assert!((count / wanted - 1.0f32).abs() < 0.05, "{count} instead of {wanted}");
        }
    }

    #[test]
    fn maps_are_read_between_pixels_and_never_beyond() {
        let rgba: Vec<u8> = [0, 255, 255, 0].iter().flat_map(|&g| [9, g, 9, 9]).collect();
        let map = DensityMap { width_px: 2, height_px: 2, rgba: &rgba };
        for (u, v, density) in
            [(0.0, 0.0, 0.0), (1.0, 0.0, 1.0), (0.5, 0.1, 0.5), (0.5, 0.5, 0.5), (-3.0, 9.0, 1.0)]
        {
            assert_eq!(map.at(5, u, v), density, "{u} {v}");
        }
        assert_eq!(DensityMap { rgba: &rgba[..5], ..map }.at(1, 1.0, 1.0), 0.0);
        assert_eq!(DensityMap { width_px: 0, height_px: 0, rgba: &[] }.at(1, 0.5, 0.5), 0.0);
    }

    #[test]
    fn the_example_of_the_page() {
        let plant = kind(4.0).in_cell([-3, 7], |_, _| 1.0).expect("one stands there");
        let numbers = [plant.x_m, plant.z_m, plant.turn_rad, plant.scale, plant.rank];
        assert_eq!(pcg3d([1, 2, 3]), PCG_1_2_3);
        assert!(numbers.iter().zip(PLANT).all(|(a, b)| (a - b).abs() < 1e-4), "{numbers:?}");
    }

    const PCG_1_2_3: [u32; 3] = [4_204_755_366, 1_223_881_804, 1_500_469_937];
    const PLANT: [f32; 5] = [-1.262_715, 3.714_929, 6.058_918, 1.876_752, 0.723_572];
}
