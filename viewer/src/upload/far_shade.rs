//! Trees → what they leave of the sun on the coarse land around the field, of which neither the light map nor the shadow map
//! tells.
//!
//! A tree's shadow is its picture, laid on the land along the light: the mean of the pictures from all sides, for one cannot be told
//! from the other at that distance. The land below a shadow is taken to be a plane.

use glam::{Vec2, Vec3, Vec3Swizzles};
use rayon::prelude::*;

use super::Uploader;
use crate::gpu::flat;
use crate::scene::{Apron, Impostor, Instance, Trees};

/// Metres beyond the field that have shadows.
pub const SHADED_M: f32 = 1200.0;
/// Texels a side.
const SIDE: usize = 2048;
/// Rows of texels that one task works on.
const BAND_ROWS: usize = 32;
/// What is known of a picture, from the top and from the axis to the side.
const ROWS: usize = 32;
const COLUMNS: usize = 8;
/// Shadows are not longer than those of a sun that is so steep above the land.
const MIN_RISE: f32 = 0.1;
/// Square metres of the largest shadow that is drawn, several times that of the tallest trees: a file may hold any sizes.
const MAX_AREA_M2: f32 = 100_000.0;
/// Metres of a cell in which the land is a plane.
const CELL_M: f32 = 64.0;

/// A template as it throws its shadow; metres in its space.
struct Outline {
    /// The share that is covered.
    covered: [[f32; COLUMNS]; ROWS],
    /// Width and height.
    size_m: Vec2,
    low_m: f32,
    /// Height of the crown's middle.
    middle_m: f32,
    /// By how much the shadow is longer than the picture's, for crowns are as deep as they are wide.
    stretch: f32,
}

impl Outline {
    /// For a sun that rises by `rise` in a metre.
    fn of(pictures: &Impostor, rise: f32) -> Self {
        let [half_x, half_y, half_z] = pictures.crown.half_m;
        Self {
            covered: covered(pictures),
            size_m: pictures.size_m.into(),
            low_m: pictures.low_m,
            middle_m: pictures.crown.middle_m[1],
            stretch: Vec2::new(1.0, 0.5 * (half_x + half_z) / half_y * rise).length(),
        }
    }

    /// What is covered at metres from the axis and above the foot.
    fn at(&self, aside_m: f32, height_m: f32) -> f32 {
        let height_m = self.middle_m + (height_m - self.middle_m) / self.stretch;
        let column = (2.0 * aside_m.abs() / self.size_m.x * COLUMNS as f32) as usize;
        let row = (1.0 - (height_m - self.low_m) / self.size_m.y) * ROWS as f32;
        if row < 0.0 {
            return 0.0;
        }
        self.covered.get(row as usize).and_then(|row| row.get(column)).copied().unwrap_or(0.0)
    }

    /// Between which heights above the foot there may be any shadow.
    fn heights_m(&self) -> [f32; 2] {
        let high_m = self.low_m + self.size_m.y;
        [self.low_m, high_m].map(|m| self.middle_m + (m - self.middle_m) * self.stretch)
    }
}

/// The mean of all pictures and of each with its mirror image.
fn covered(pictures: &Impostor) -> [[f32; COLUMNS]; ROWS] {
    let (strip, side) = (pictures.relief.width_px as usize, pictures.relief.height_px as usize);
    let mut covered = [[0.0; COLUMNS]; ROWS];
    let texels = pictures.relief.levels.first().map_or(&[][..], |level| level.as_chunks::<4>().0);
    let all = 255.0 * (strip * side) as f32 / (ROWS * COLUMNS) as f32;
    for (n, [_, _, share, _]) in texels.iter().enumerate() {
        let (x, y) = (n % strip % side, n / strip);
        let aside = (2 * x + 1).abs_diff(side) * COLUMNS / side;
        covered[y * ROWS / side][aside.min(COLUMNS - 1)] += f32::from(*share) / all;
    }
    covered
}

/// Where the sun is: in plan towards it, of unit length, and by how much it is higher than a metre that way.
#[derive(Clone, Copy)]
struct Sun {
    towards: Vec2,
    rise: f32,
}

impl Sun {
    /// `None` if it is not up.
    fn of(direction: Vec3) -> Option<Self> {
        let level = direction.xz().length().max(1e-3);
        (direction.y > 0.0).then(|| Self { towards: direction.xz() / level, rise: direction.y / level })
    }
}

/// A tree's shadow on a plane. The ray from a place on it to the sun passes the tree `aside` · place beside its axis and `height` ·
/// place above its foot; places are x and z in metres from the foot.
struct Shadow<'a> {
    outline: &'a Outline,
    foot_m: Vec2,
    aside: Vec2,
    height: Vec2,
    /// Of the tree, to the sides and upwards.
    scale: Vec2,
}

impl<'a> Shadow<'a> {
    /// On land with that slope, by which it rises along x and z. `None` if no sun falls on it, or if the shadow would be too large.
    fn of(tree: &Instance, pictures: &Impostor, outline: &'a Outline, sun: Sun, slope: Vec2) -> Option<Self> {
        let [x, y, z] = tree.world_from_tree.map(|row| Vec3::new(row[0], row[1], row[2]));
        let axis = Vec3::new(pictures.axis_m[0], 0.0, pictures.axis_m[1]);
        let foot_m =
            Vec2::new(x.dot(axis) + tree.world_from_tree[0][3], z.dot(axis) + tree.world_from_tree[2][3]);
        let steepness = sun.rise - slope.dot(sun.towards);
        if steepness <= 0.0 {
            return None;
        }
        let rise = sun.rise + (MIN_RISE - steepness).max(0.0);
        let shadow = Self {
            outline,
            foot_m,
            aside: Vec2::new(-sun.towards.y, sun.towards.x),
            height: slope - rise * sun.towards,
            scale: Vec2::new((x.x * z.z - x.z * z.x).abs().sqrt(), y.y).max(Vec2::splat(1e-3)),
        };
        let (half_m, [low_m, high_m]) = shadow.reach_m();
        let area_m2 = 2.0 * half_m * (high_m - low_m) / shadow.aside.perp_dot(shadow.height).abs();
        (area_m2 <= MAX_AREA_M2).then_some(shadow)
    }

    /// Half its width, and the heights between which it lies.
    fn reach_m(&self) -> (f32, [f32; 2]) {
        let half_m = 0.5 * self.outline.size_m.x * self.scale.x;
        (half_m, self.outline.heights_m().map(|m| m * self.scale.y))
    }

    /// Corners of the parallelogram that holds it, from the foot.
    fn corners_m(&self) -> [Vec2; 4] {
        let (half_m, [low_m, high_m]) = self.reach_m();
        let area = self.aside.perp_dot(self.height);
        [(-half_m, low_m), (half_m, low_m), (-half_m, high_m), (half_m, high_m)].map(|(aside_m, height_m)| {
            Vec2::new(
                aside_m * self.height.y - height_m * self.aside.y,
                height_m * self.aside.x - aside_m * self.height.x,
            ) / area
        })
    }

    /// What it leaves of the sun at a place, from the foot.
    fn left(&self, from_foot_m: Vec2) -> f32 {
        let (aside_m, height_m) = (self.aside.dot(from_foot_m), self.height.dot(from_foot_m));
        1.0 - self.outline.at(aside_m / self.scale.x, height_m / self.scale.y)
    }
}

/// The slopes of the land around the field.
struct Slopes {
    across: usize,
    half_m: f32,
    /// Sums over the vertices of each cell, and how many there are.
    cells: Vec<(Vec2, f32)>,
}

impl Slopes {
    fn of(apron: &Apron, half_m: f32) -> Self {
        let across = (2.0 * half_m / CELL_M).ceil() as usize;
        let mut slopes = Self { across, half_m, cells: vec![(Vec2::ZERO, 0.0); across * across] };
        for (place_m, normal) in apron.positions_m.iter().zip(&apron.normals) {
            let [x, y, z] = *normal;
            if let Some(cell) = slopes.cell(Vec2::new(place_m[0], place_m[2])) {
                slopes.cells[cell].0 -= Vec2::new(x, z) / y.max(0.1);
                slopes.cells[cell].1 += 1.0;
            }
        }
        slopes
    }

    fn cell(&self, place_m: Vec2) -> Option<usize> {
        let cell = (place_m + self.half_m) / CELL_M;
        let is_inside = cell.min_element() >= 0.0 && cell.max_element() < self.across as f32;
        is_inside.then_some(cell.y as usize * self.across + cell.x as usize)
    }

    /// Level where nothing is known.
    fn at(&self, place_m: Vec2) -> Vec2 {
        let (sum, count) = self.cell(place_m).map_or((Vec2::ZERO, 0.0), |cell| self.cells[cell]);
        sum / count.max(1.0)
    }
}

/// What trees leave of the sun, rows from north to south of a square of so many texels that reaches so far from the middle.
fn sunlight(trees: &Trees, apron: &Apron, half_m: f32, side: usize, sun: Vec3) -> Vec<u8> {
    let mut left = vec![u8::MAX; side * side];
    let Some(sun) = Sun::of(sun) else { return left };
    let outlines: Vec<Option<(&Impostor, Outline)>> = trees
        .templates
        .iter()
        .map(|template| {
            template.impostor.as_ref().map(|pictures| (pictures, Outline::of(pictures, sun.rise)))
        })
        .collect();
    let slopes = Slopes::of(apron, half_m);
    let shadow = |tree: &Instance| {
        let (pictures, outline) = outlines.get(tree.template as usize)?.as_ref()?;
        let place_m = Vec2::new(tree.world_from_tree[0][3], tree.world_from_tree[2][3]);
        Shadow::of(tree, pictures, outline, sun, slopes.at(place_m))
    };
    // Of the field's, those by its edge reach across it.
    let shadows: Vec<Shadow<'_>> = trees.all().filter_map(shadow).collect();
    let texel_m = 2.0 * half_m / side as f32;
    let bands = left.par_chunks_mut(BAND_ROWS * side).enumerate();
    bands.for_each(|(band, rows)| {
        let first = band * BAND_ROWS;
        shadows.iter().for_each(|shadow| darken(shadow, rows, first, side, half_m, texel_m));
    });
    left
}

fn darken(shadow: &Shadow<'_>, band: &mut [u8], first: usize, side: usize, half_m: f32, texel_m: f32) {
    let foot = (shadow.foot_m + half_m) / texel_m - 0.5;
    let corners = shadow.corners_m().map(|corner_m| foot + corner_m / texel_m);
    let (low, high) =
        corners.iter().fold((Vec2::MAX, Vec2::MIN), |(low, high), &c| (low.min(c), high.max(c)));
    let last = first + band.len() / side;
    let rows = (low.y.max(first as f32) as usize).max(first)..((high.y + 1.0).max(0.0) as usize).min(last);
    let (half_width_m, heights_m) = shadow.reach_m();
    for row in rows {
        let z = (row as f32 - foot.y) * texel_m;
        let across = narrowed(
            [low.x, high.x].map(|x| (x - foot.x) * texel_m),
            shadow.aside.x,
            shadow.aside.y * z,
            [-half_width_m, half_width_m],
        );
        let [from_m, to_m] = narrowed(across, shadow.height.x, shadow.height.y * z, heights_m);
        let column = |x_m: f32| (foot.x + x_m / texel_m).clamp(-1.0, side as f32);
        let columns = column(from_m).ceil() as usize..((column(to_m) + 1.0) as usize).min(side);
        for column in columns {
            let x = (column as f32 - foot.x) * texel_m;
            let texel = &mut band[(row - first) * side + column];
            *texel = (f32::from(*texel) * shadow.left(Vec2::new(x, z)) + 0.5) as u8;
        }
    }
}

/// The part of a range of x where slope · x + offset lies within another.
fn narrowed([from, to]: [f32; 2], slope: f32, offset: f32, [low, high]: [f32; 2]) -> [f32; 2] {
    if slope.abs() < 1e-6 {
        return if (low..=high).contains(&offset) { [from, to] } else { [from, from - 1.0] };
    }
    let ends = [(low - offset) / slope, (high - offset) / slope];
    [from.max(ends[0].min(ends[1])), to.min(ends[0].max(ends[1]))]
}

/// A square of texels, a power of two a side, with its mip levels after it, means of four down to one.
fn with_means(mut texels: Vec<u8>) -> Vec<u8> {
    let (mut start, mut wide) = (0, texels.len().isqrt());
    while wide > 1 {
        let (finer, half) = (&texels[start..], wide / 2);
        let mean = |n: usize| {
            let corner = 2 * (n / half * wide + n % half);
            let four = [0, 1, wide, wide + 1].map(|by| u32::from(finer[corner + by]));
            ((four.iter().sum::<u32>() + 2) / 4) as u8
        };
        let coarser: Vec<u8> = (0..half * half).into_par_iter().map(mean).collect();
        (start, wide) = (texels.len(), half);
        texels.extend(coarser);
    }
    texels
}

impl Uploader {
    /// What trees leave of the sun within [`SHADED_M`] of a field that reaches so far from its middle.
    pub(super) fn far_shade(
        &self,
        trees: &Trees,
        apron: &Apron,
        field_half_m: f32,
        sun: Vec3,
    ) -> wgpu::Texture {
        let half_m = field_half_m + SHADED_M;
        let finest = match trees.far.is_empty() {
            true => vec![u8::MAX],
            false => sunlight(trees, apron, half_m, SIDE, sun),
        };
        let side = finest.len().isqrt() as u32;
        let usage = wgpu::TextureUsages::TEXTURE_BINDING;
        let mut texture = flat("shade of far trees", [side; 2], wgpu::TextureFormat::R8Unorm, usage);
        texture.mip_level_count = side.ilog2() + 1;
        self.gpu.texture(&texture, &with_means(finest))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scene::{Crown, IMPOSTOR_ROWS, Image, LEAVES, LeafSide, Template};

    const HALF_M: f32 = 200.0;
    const SIDE: usize = 400;
    /// Height of the ball's middle, and its radius.
    const MIDDLE_M: f32 = 8.0;
    const RADIUS_M: f32 = 4.0;

    /// A ball in the air.
    fn ball() -> Template {
        let picture = |n: u32| {
            let [x, y] = [n % 128 % 32, n / 128].map(|t| (t as f32 - 15.5) / 16.0);
            [0, 0, if x * x + y * y < 1.0 { 255 } else { 0 }, 255]
        };
        let levels = vec![(0..128 * 32).flat_map(picture).collect::<Vec<u8>>().into()];
        let pictures = Impostor {
            color: Image::of_one_pixel([255; 4]),
            relief: Image { name: "ball".into(), width_px: 128, height_px: 32, levels },
            axis_m: [0.0; 2],
            low_m: MIDDLE_M - RADIUS_M,
            size_m: [2.0 * RADIUS_M; 2],
            error_m: 1.0,
            crown: Crown { middle_m: [0.0, MIDDLE_M, 0.0], half_m: [RADIUS_M; 3] },
            leaves: [LeafSide::default(); LEAVES],
            leaf_m: 0.1,
            middles_m: [[0.0; 2]; IMPOSTOR_ROWS],
        };
        Template { impostor: Some(pictures), ..Template::default() }
    }

    /// The shadow of a ball on land that rises by `slope` along x and z: its middle from there, and how large
    /// it is in square metres.
    fn shadow(slope: [f32; 2], sun: Vec3) -> (Vec2, f32) {
        let place = Vec2::new(40.3, -29.8);
        let world_from_tree = [[1.0, 0.0, 0.0, place.x], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, place.y]];
        let tree = Instance { world_from_tree, template: 0, trunk_cylinder_m: [place.x, place.y, 0.1] };
        let trees = Trees { templates: vec![Arc::new(ball())], far: Arc::new([tree]), ..Trees::default() };
        let corners = [-150.0, -40.0, 40.0, 150.0f32];
        let positions_m: Vec<[f32; 3]> = corners.iter().flat_map(|&x| corners.map(|z| [x, 0.0, z])).collect();
        let normal = Vec3::new(-slope[0], 1.0, -slope[1]).normalize();
        let apron =
            Apron { normals: vec![normal.into(); positions_m.len()], positions_m, ..Apron::default() };
        let left = sunlight(&trees, &apron, HALF_M, SIDE, sun);
        let mut sum = (Vec2::ZERO, 0.0);
        for (n, &left) in left.iter().enumerate() {
            let dark = 1.0 - f32::from(left) / 255.0;
            let at = Vec2::new((n % SIDE) as f32, (n / SIDE) as f32) + 0.5 - HALF_M;
            sum = (sum.0 + dark * (at - place), sum.1 + dark);
        }
        (sum.0 / sum.1, sum.1)
    }

    #[test]
    fn a_shadow_lies_where_the_sun_throws_it_and_is_as_large_as_that_of_a_ball() {
        for (sun, rise) in [(Vec3::new(0.6, 0.8, 0.0), 0.8 / 0.6), (Vec3::new(-0.48, 0.6, 0.64), 0.75)] {
            let (middle, area) = shadow([0.0; 2], sun);
            let expected = -sun.xz().normalize() * MIDDLE_M / rise;
            assert!(middle.distance(expected) < 0.3, "{middle} instead of {expected}");
            let along = RADIUS_M * (1.0 + 1.0 / (rise * rise)).sqrt();
            let ball = std::f32::consts::PI * RADIUS_M * along;
            assert!((area - ball).abs() < 0.05 * ball, "{area} m² instead of {ball}");
        }
    }

    #[test]
    fn it_is_shorter_where_land_rises_behind_the_tree_and_longer_where_it_falls() {
        let sun = Vec3::new(0.8, 0.6, 0.0);
        for rises in [0.5, -0.4] {
            let (middle, _) = shadow([-rises, 0.0], sun);
            let expected = -MIDDLE_M / (0.75 + rises);
            assert!((middle.x - expected).abs() < 0.4 && middle.y.abs() < 0.1, "{middle}, not {expected}");
        }
        assert_eq!(shadow([0.9, 0.0], sun).1, 0.0, "it is turned away from the sun");
        assert_eq!(shadow([0.0; 2], Vec3::new(0.9, -0.1, 0.4)).1, 0.0, "the sun is down");
    }
}
