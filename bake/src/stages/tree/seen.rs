//! Levels of detail of a tree → how far each is from the full tree to the eye, as errors in metres.
//!
//! Each level is drawn as the full tree is, cut out by the alpha of its leaves, with its colours in the light of a sun, from
//! two sides, in square pictures that just hold the tree. Pixels are averaged to a 32nd and a 16th of the picture's side. In
//! each the two differ by the share of the pixel that one covers and the other doesn't, as a black tree before white sky
//! would; in those of a 16th of the first side also by the mean difference of their channels in the square root of linear light,
//! which is near to L* of CIELAB. An outline stands out whatever is behind the tree, colours hardly change. Δ is
//! the power mean of that over pixels, sizes of pixels and sides, of exponent 0.7: that of FLIP (Andersson et al. 2020, section
//! 4), by which much that differs a little counts more than little that differs much.
//!
//! The error is Δ times the tree's height: of trees that are drawn equally large, errors are ordered as FLIP is.

use glam::Vec3;
use libm::powf;
use rayon::prelude::*;

use super::outline::cover;
use super::raster::{Drawing, Look, Sample};
use super::surfaces::Surfaces;
use crate::model::{Impostor, Mesh};
use crate::silhouette::Silhouette;

/// Which of the impostor's sides the tree is drawn from: one beside the other.
const SIDES: [usize; 2] = [1, 3];
/// Pixels a side of the pictures in which outlines alone are compared; those with colours have half as many.
const PIXELS: usize = 32;
/// Samples along each side of the first's pixels, and of the second's: leaves are small beside pixels, and what is seen of them
/// by chance must not pass for a difference.
const OUTLINE_SAMPLES: usize = 10;
const COLOR_SAMPLES: usize = 6;
/// The square is wider than the full tree by this factor, for levels may reach a little further.
const MARGIN: f32 = 1.04;
/// Behind the tree: the sky, linear.
const SKY: Vec3 = Vec3::new(0.45, 0.6, 0.8);
/// Light of the sun, and that from all around.
const SUNLIGHT: f32 = 0.7;
const SKYLIGHT: f32 = 0.3;
/// How much a difference of colour counts beside one of coverage, where it is seen from one side: half as much among both.
const COLOR: f32 = 1.0;
/// The exponent of the mean.
const POWER: f32 = 0.7;

/// What comes out of it.
pub(super) struct Compared {
    /// Of all levels but the first, which is the full tree.
    pub errors_m: Vec<f32>,
    /// The share of its pictures that the full tree covers; none without one.
    pub coverage: Option<f32>,
}

/// Compares levels with the first, which is the full tree: the same for any number of threads. Its colours are those of
/// `colored`, which shows nearly the same in less time.
pub(super) fn compare(levels: &[&Mesh], colored: &Mesh, surfaces: &Surfaces) -> Compared {
    let Some((full, _)) = levels.split_first() else {
        return Compared { errors_m: Vec::new(), coverage: None };
    };
    let (frame, height_m) = (frame(full), height_m(full));
    let sides = SIDES.len();
    let meshes = levels.iter().enumerate().map(|(n, level)| [*level, if n == 0 { colored } else { level }]);
    let all: Vec<_> = meshes.flat_map(|meshes| SIDES.map(move |k| (meshes, k))).collect();
    let pictures: Vec<Picture> =
        all.par_iter().map(|(meshes, k)| Picture::of(*meshes, surfaces, *k, frame)).collect();
    let (full, coarser) = pictures.split_at(sides);
    let error_m = |level: &[Picture]| {
        let sum: f32 = full.iter().zip(level).map(|(a, b)| a.difference(b)).sum();
        height_m * powf(sum / sides as f32, 1.0 / POWER)
    };
    let coverage = full.iter().map(Picture::coverage).sum::<f32>() / sides as f32;
    Compared { errors_m: coarser.chunks(sides).map(error_m).collect(), coverage: Some(coverage) }
}

/// The square that holds a mesh as it is seen from each of an impostor's sides: the middle of its lower edge, and its side in
/// metres.
pub(super) fn frame(mesh: &Mesh) -> (Vec3, f32) {
    let bounds = mesh.bounds();
    let axis = 0.5 * (bounds.min + bounds.max);
    let rights = [0, 1, 2, 3].map(|k| Impostor::eye_and_right(k)[1]);
    let beside_m = |p: &[f32; 3]| {
        let from_axis = Vec3::from_array(*p) - axis;
        rights.map(|right| from_axis.dot(right).abs()).into_iter().fold(0.0, f32::max)
    };
    let reach_m = mesh.positions.iter().map(beside_m).fold(0.0, f32::max);
    let side_m = MARGIN * height_m(mesh).max(2.0 * reach_m);
    (axis - 0.5 * side_m * Vec3::Y, side_m)
}

fn height_m(mesh: &Mesh) -> f32 {
    let bounds = mesh.bounds();
    bounds.max.y - bounds.min.y
}

/// What is seen of a side of a tree, rows from the top.
struct Picture {
    /// The share of each pixel that is covered.
    covered: Vec<f32>,
    /// The same of pixels twice as large.
    covered_coarsely: Vec<f32>,
    /// Their colours before the sky, as the eye has them; of the first side alone, for they differ less than outlines, and cost
    /// as much.
    colors: Option<Vec<Vec3>>,
}

impl Picture {
    /// Of one mesh the outline, of the other the colours.
    fn of(
        [outlined, colored]: [&Mesh; 2],
        surfaces: &Surfaces,
        side: usize,
        (foot_m, side_m): (Vec3, f32),
    ) -> Self {
        let look = |samples: usize| Look::new(side, foot_m, [side_m; 2], samples);
        let mut outline = Silhouette::empty(PIXELS * OUTLINE_SAMPLES);
        cover(outlined, |_| true, surfaces, &look(PIXELS * OUTLINE_SAMPLES), &mut outline);
        let colors = || {
            let drawing = Drawing::new(colored, surfaces, &look(PIXELS / 2 * COLOR_SAMPLES));
            (0..(PIXELS / 2).pow(2)).map(|i| color(&drawing, i)).collect()
        };
        Self {
            covered: outline.shares(OUTLINE_SAMPLES),
            covered_coarsely: outline.shares(2 * OUTLINE_SAMPLES),
            colors: (side == SIDES[0]).then(colors),
        }
    }

    fn coverage(&self) -> f32 {
        self.covered.iter().sum::<f32>() / self.covered.len() as f32
    }

    /// The mean over pixels and their sizes of what differs, to the power of [`POWER`].
    fn difference(&self, other: &Self) -> f32 {
        let outline = |a: &f32, b: &f32| (a - b).abs();
        let fine: f32 =
            self.covered.iter().zip(&other.covered).map(|(a, b)| powf(outline(a, b), POWER)).sum();
        let color = |i: usize| match (&self.colors, &other.colors) {
            (Some(a), Some(b)) => COLOR / 3.0 * (a[i] - b[i]).abs().element_sum(),
            _ => 0.0,
        };
        let outlines = self.covered_coarsely.iter().zip(&other.covered_coarsely).map(|(a, b)| outline(a, b));
        let coarse: f32 = outlines.enumerate().map(|(i, outline)| powf(outline + color(i), POWER)).sum();
        0.5 * (fine / self.covered.len() as f32 + coarse / self.covered_coarsely.len() as f32)
    }
}

/// What the eye makes of a pixel's mean colour.
fn color(drawing: &Drawing<'_>, pixel: usize) -> Vec3 {
    const ALL: usize = COLOR_SAMPLES * COLOR_SAMPLES;
    let (x, y) = (pixel % (PIXELS / 2) * COLOR_SAMPLES, pixel / (PIXELS / 2) * COLOR_SAMPLES);
    let sample = |k: usize| drawing.sample(x + k % COLOR_SAMPLES, y + k / COLOR_SAMPLES).map_or(SKY, lit);
    ((0..ALL).map(sample).sum::<Vec3>() / ALL as f32).map(f32::sqrt)
}

fn lit(sample: Sample) -> Vec3 {
    sample.color * (SKYLIGHT + SUNLIGHT * sample.sunlit)
}

#[cfg(test)]
mod tests {
    use super::super::raster::SUN;
    use super::*;
    use crate::model::{Material, Part, PartKind};
    use crate::stages::tree::tests::{plain, presets, read};
    use crate::stages::tree::{levelled, template, textures};

    const BARK: [f32; 3] = [0.1; 3];

    fn errors(levels: &[&Mesh], surfaces: &Surfaces) -> Vec<f32> {
        let full = levels.first().copied().cloned().unwrap_or_default();
        compare(levels, &full, surfaces).errors_m
    }

    /// A column of upright squares, one on the other, which face the side from which colours are compared.
    fn column(height: usize, side_m: f32, color: [u8; 4]) -> Mesh {
        let mut mesh = Mesh::default();
        let mut triangles = Vec::new();
        for y in 0..height {
            let first = mesh.positions.len() as u32;
            for [x, up] in [[-0.5, 0.0], [0.5, 0.0], [0.5, 1.0], [-0.5, 1.0f32]] {
                mesh.positions.push([side_m * x, side_m * (y as f32 + up), -side_m * x]);
                mesh.uvs.push([0.5; 2]);
                mesh.colors.push(color);
            }
            triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        mesh.parts.push(Part { material: Material::Bark, kind: PartKind::Surface, triangles });
        mesh
    }

    #[test]
    fn the_error_grows_with_what_is_missing_and_with_the_size_of_the_tree() {
        let white = [255; 4];
        let of = |side_m: f32| {
            let meshes = [8, 8, 7, 6, 4].map(|height| column(height, side_m, white));
            errors(&meshes.each_ref(), &Surfaces::of(&plain(BARK)))
        };
        let (small, large) = (of(1.0), of(3.0));
        assert_eq!(small[0], 0.0, "the same is no error");
        assert!(small.is_sorted_by(|a, b| a < b), "{small:?}");
        for (small, large) in small.iter().zip(&large) {
            assert!((large - 3.0 * small).abs() <= 1e-4 * large, "{small} and {large}");
        }
    }

    #[test]
    fn a_change_of_colour_or_of_light_is_an_error() {
        let white = column(8, 1.0, [255; 4]);
        let mut turned = white.clone();
        turned.normals = vec![SUN.to_array(); turned.positions.len()];
        let all =
            [&white, &column(8, 1.0, [255, 200, 255, 255]), &column(8, 1.0, [255, 120, 255, 255]), &turned];
        let found = errors(&all, &Surfaces::of(&plain(BARK)));
        assert!(0.0 < found[0] && found[0] < found[1] && found[2] > 0.0, "{found:?}");
    }

    #[test]
    fn the_number_of_threads_changes_nothing_and_the_coarsest_is_farthest() {
        let (_, genome) = presets().remove(0);
        let (tree, textures) = (template(&read(&genome), 1), textures(&read(&genome)));
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| levelled(&tree.mesh, &textures, &mut |_| ()))
        };
        let (one, four) = (on(1), on(4));
        assert_eq!(one.mesh, four.mesh);
        assert_eq!(one.clusters, four.clusters);
        let stored: Vec<f32> = one.mesh.levels.iter().skip(1).map(|level| level.error_m).collect();
        let farthest = stored.iter().copied().fold(0.0, f32::max);
        assert!(stored.len() > 3 && stored.last() == Some(&farthest), "{stored:?}");
    }

    #[test]
    fn nothing_differs_from_nothing() {
        let surfaces = Surfaces::of(&plain(BARK));
        assert_eq!(errors(&[&Mesh::default(), &Mesh::default()], &surfaces), [0.0]);
        let point = column(2, 0.0, [255; 4]);
        assert_eq!(errors(&[&point, &Mesh::default()], &surfaces), [0.0]);
        assert!(errors(&[], &surfaces).is_empty());
    }
}
