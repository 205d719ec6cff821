//! A template → pictures of it from four sides, for where it is so far away that single leaves no longer count.

#[cfg(test)]
mod tests;

use glam::Vec3;
use rayon::prelude::*;

use super::clusters;
use super::mips::Encoder;
use super::picture::{self, Picture};
use super::raster::{Drawing, Look};
use super::surfaces::Surfaces;
use crate::model::{Impostor, Level, Mesh, TreeTextures};

/// Pixels a side of one picture, of a tree with leaves and of one without, whose twigs need more.
const SIDE: usize = 128;
const BARE_SIDE: usize = 256;
/// Each picture is drawn this many times as wide and high, and reduced.
const SAMPLES: usize = 2;
/// Pictures are larger than the tree by this factor, which leaves more than 3 of their pixels transparent along each
/// edge: two mip levels on, a picture still doesn't show in the one beside it.
const MARGIN: f32 = 1.06;
/// No picture is smaller than this, in metres, not even of nothing.
const MIN_SIZE_M: f32 = 1e-3;
/// The error is so many of its pixels. Where an error of 2.3 pixels of the screen is allowed, a tree is then shown in nine
/// tenths as many as its picture has at most.
const ERROR_PX: f32 = 2.5;

/// What part of space the pictures show.
#[derive(Clone, Copy, Debug)]
struct Frame {
    /// On the axis, at the lower edge.
    foot_m: Vec3,
    size_m: [f32; 2],
    /// Pixels a side.
    side: usize,
}

impl Frame {
    fn of<P>(mesh: &Mesh, textures: &TreeTextures<P>) -> Self {
        let bounds = mesh.bounds();
        let axis = 0.5 * (bounds.min + bounds.max);
        let from_axis = |p: &[f32; 3]| {
            let (x, z) = (p[0] - axis.x, p[2] - axis.z);
            x * x + z * z
        };
        let reach_m = mesh.positions.iter().map(from_axis).fold(0.0, f32::max).sqrt();
        let height_m = bounds.max.y - bounds.min.y;
        let size_m = [2.0 * reach_m, height_m].map(|m| (MARGIN * m).max(MIN_SIZE_M));
        let side = if has_leaves(mesh, textures) { SIDE } else { BARE_SIDE };
        Self { foot_m: axis.with_y(axis.y - 0.5 * size_m[1]), size_m, side }
    }

    fn error_m(&self) -> f32 {
        ERROR_PX / self.side as f32 * self.size_m[0].max(self.size_m[1])
    }
}

/// Draws a template, whose finest or next level `mesh` is, from four sides: the same bytes for any number of threads.
pub fn impostor<P>(mesh: &Mesh, textures: &TreeTextures<P>) -> Impostor {
    let frame = Frame::of(mesh, textures);
    let surfaces = Surfaces::of(textures);
    let draw = |k: usize| {
        let look = Look::new(k, frame.foot_m, frame.size_m, SAMPLES * frame.side);
        let drawing = Drawing::new(mesh, &surfaces, &look);
        Picture::of(&drawing, SAMPLES, frame.size_m[0])
    };
    let pictures: Vec<Picture> = (0..Impostor::AZIMUTHS.len()).into_par_iter().map(draw).collect();
    let (colors, relief) = picture::side_by_side(&pictures, &Encoder::new());
    Impostor {
        colors,
        relief,
        axis_m: [frame.foot_m.x, frame.foot_m.z],
        low_m: frame.foot_m.y,
        size_m: frame.size_m,
        error_m: frame.error_m(),
    }
}

fn has_leaves<P>(mesh: &Mesh, textures: &TreeTextures<P>) -> bool {
    mesh.has_cards() && !textures.is_thin
}

/// The error in metres that pictures of a template will have.
pub fn impostor_error_m<P>(mesh: &Mesh, textures: &TreeTextures<P>) -> f32 {
    Frame::of(mesh, textures).error_m()
}

/// The level of which pictures are drawn: with half of the leaves, which cover as much, in half of the time, where a leaf is less
/// than a pixel of them. A tree without leaves has no twig to spare, and fronds are few and large.
pub fn drawn_from_afar<'a, P>(levels: &'a [Level], textures: &TreeTextures<P>) -> &'a Mesh {
    let full = &levels[0].mesh;
    let has_small_leaves = has_leaves(full, textures) && clusters::first_level(full).is_some();
    &levels[usize::from(has_small_leaves && levels.len() > 1)].mesh
}
