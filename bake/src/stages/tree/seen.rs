//! Levels of detail of a tree → how far each is from the full tree to the eye, as errors in metres.
//!
//! Each level is drawn as the full tree is, cut out by the alpha of its leaves, with its colours in the light of a sun, from
//! two sides, in square pictures around the sphere that holds all levels. Pixels are averaged to a 16th, an 8th and a 4th of
//! the sphere's radius R and brought to what the eye makes of them: the square root of linear light, which is near to L* of
//! CIELAB. Δ is the mean absolute difference of two such pictures over channels, pixels, sizes of pixels and sides.
//!
//! The error is 2RΔ, the mean width in metres of what differs in a row of the picture, black for white counting in full: where
//! a pixel is as large, a row differs by one pixel in all. An outline that lies ε off on either side has an error of 2ε times
//! its contrast; leaves that are moved a little differ less the larger the pixels are, leaves that are missed do not.
//!
//! Where little is seen of the tree at all, its twigs in winter, Δ of a level from which half of them are gone is small, and
//! yet everybody sees it. So Δ counts more, by the square root of how much less is seen of the tree than of one with leaves:
//! half way from what differs in the picture to what differs of the tree.

use glam::Vec3;
use rayon::prelude::*;

use super::raster::{Drawing, Look, Sample};
use super::surfaces::Surfaces;
use crate::model::Mesh;

/// Which of the impostor's sides the tree is drawn from: one beside the other.
const SIDES: [usize; 2] = [1, 3];
/// Pixels a side of the finest pictures that are compared, and how many sizes of pixels there are, each twice the last.
const PIXELS: usize = 32;
const SIZES: usize = 3;
/// Samples along each side of a pixel.
const SAMPLES: usize = 6;
/// Behind the tree: the sky, linear.
const SKY: Vec3 = Vec3::new(0.45, 0.6, 0.8);
/// Light of the sun, and that from all around.
const SUNLIGHT: f32 = 0.7;
const SKYLIGHT: f32 = 0.3;
/// Δ of a tree with leaves from the sky alone, and how much more a level's Δ counts at most where less is seen of a tree.
const USUALLY_SEEN: f32 = 0.1;
const MAX_SPARSE: f32 = 2.5;

/// The errors in metres of all levels but the first, which is the full tree: the same for any number of threads.
pub(super) fn errors(levels: &[&Mesh], surfaces: &Surfaces) -> Vec<f32> {
    let (foot_m, side_m) = frame(levels);
    let draw = |&(level, k): &(usize, usize)| {
        let look = Look::new(k, foot_m, [side_m; 2], PIXELS * SAMPLES);
        Picture::of(&Drawing::new(levels[level], surfaces, &look))
    };
    let sides = SIDES.len();
    let all: Vec<_> = (0..levels.len()).flat_map(|level| SIDES.map(move |k| (level, k))).collect();
    let pictures: Vec<Picture> = all.par_iter().map(draw).collect();
    let (full, coarser) = pictures.split_at(sides.min(pictures.len()));
    let differs =
        |other: &[Picture]| full.iter().zip(other).map(|(a, b)| a.difference(b)).sum::<f32>() / sides as f32;
    let seen = differs(&SIDES.map(|_| Picture::of_sky()));
    let sparse = (USUALLY_SEEN / seen.max(f32::MIN_POSITIVE)).sqrt().clamp(1.0, MAX_SPARSE);
    coarser.chunks(sides).map(|level| side_m * sparse * differs(level)).collect()
}

/// The square around the sphere that holds all levels: the middle of its lower edge, and its side in metres.
pub(super) fn frame(levels: &[&Mesh]) -> (Vec3, f32) {
    let points = || levels.iter().flat_map(|level| &level.positions).map(|&p| Vec3::from_array(p));
    let (low, high) = points().fold((Vec3::MAX, Vec3::MIN), |(low, high), p| (low.min(p), high.max(p)));
    let center = 0.5 * (low + high);
    let radius_m = points().map(|p| p.distance_squared(center)).fold(0.0, f32::max).sqrt();
    (center - radius_m * Vec3::Y, 2.0 * radius_m)
}

/// What the eye makes of a side of a tree before the sky, for each size of pixels.
struct Picture([Vec<Vec3>; SIZES]);

impl Picture {
    fn of(drawing: &Drawing<'_>) -> Self {
        const ALL: usize = SAMPLES * SAMPLES;
        let pixel = |i: usize| {
            let (x, y) = (i % PIXELS * SAMPLES, i / PIXELS * SAMPLES);
            let sample = |k: usize| drawing.sample(x + k % SAMPLES, y + k / SAMPLES).map_or(SKY, lit);
            (0..ALL).map(sample).sum::<Vec3>() / ALL as f32
        };
        let mut linear: Vec<Vec3> = (0..PIXELS * PIXELS).map(pixel).collect();
        Self(std::array::from_fn(|_| {
            let halved = halved(&linear);
            std::mem::replace(&mut linear, halved).into_iter().map(|color| color.map(f32::sqrt)).collect()
        }))
    }

    /// Nothing but sky.
    fn of_sky() -> Self {
        let sky = SKY.map(f32::sqrt);
        Self(std::array::from_fn(|size| vec![sky; (PIXELS >> size).pow(2)]))
    }

    /// Mean over channels, pixels and their sizes.
    fn difference(&self, other: &Self) -> f32 {
        let of_size = |(a, b): (&Vec<Vec3>, &Vec<Vec3>)| {
            let sum: f32 = a.iter().zip(b).map(|(a, b)| (a - b).abs().element_sum()).sum();
            sum / (3 * a.len()) as f32
        };
        self.0.iter().zip(&other.0).map(of_size).sum::<f32>() / SIZES as f32
    }
}

fn lit(sample: Sample) -> Vec3 {
    sample.color * (SKYLIGHT + SUNLIGHT * sample.sunlit)
}

/// A square picture with pixels twice as large.
fn halved(pixels: &[Vec3]) -> Vec<Vec3> {
    let side = pixels.len().isqrt();
    let pixel = |i: usize| {
        let first = 2 * (i / (side / 2) * side + i % (side / 2));
        [0, 1, side, side + 1].map(|offset| pixels[first + offset]).iter().sum::<Vec3>() / 4.0
    };
    (0..pixels.len() / 4).map(pixel).collect()
}

#[cfg(test)]
mod tests {
    use super::super::raster::SUN;
    use super::*;
    use crate::model::{Material, Part, PartKind};
    use crate::stages::tree::tests::{plain, presets, read};
    use crate::stages::tree::{levelled, template, textures};

    const BARK: [f32; 3] = [0.1; 3];

    /// A column of upright squares, one on the other.
    fn column(height: usize, side_m: f32, color: [u8; 4]) -> Mesh {
        let mut mesh = Mesh::default();
        let mut triangles = Vec::new();
        for y in 0..height {
            let first = mesh.positions.len() as u32;
            for [x, up] in [[-0.5, 0.0], [0.5, 0.0], [0.5, 1.0], [-0.5, 1.0f32]] {
                mesh.positions.push([side_m * x, side_m * (y as f32 + up), side_m * x]);
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
    fn the_number_of_threads_changes_nothing_and_errors_grow() {
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
        assert!(stored.is_sorted_by(|a, b| a < b), "{stored:?}");
    }

    #[test]
    fn what_a_slender_tree_loses_counts_more() {
        let errors_of = |width: f32| {
            let narrow = |height: usize| {
                let mut mesh = column(height, 1.0, [255; 4]);
                mesh.positions.iter_mut().for_each(|p| (p[0], p[2]) = (width * p[0], width * p[2]));
                mesh
            };
            errors(&[8, 7, 4].map(narrow).each_ref(), &Surfaces::of(&plain(BARK)))
        };
        let (wide, slender) = (errors_of(3.0), errors_of(0.75));
        for (wide, slender) in wide.iter().zip(&slender) {
            let part = slender / wide;
            assert!(0.3 < part && part < 0.8, "a quarter as wide: {part}, between a quarter and all");
        }
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
