//! Clear sky, sun and clouds → cube faces and an equirectangular image in half floats. The clear sky is smooth and
//! is evaluated on a coarse grid; clouds and sun come in per pixel.

use glam::{Vec3A, Vec4};
use rayon::prelude::*;

use super::clear::{ClearSky, SunDisc};
use super::dome::Dome;
use super::math::{dot, normalize};
use crate::math::half_bits;
use crate::model::ImageF16;
use crate::raster::raster;

/// Unit direction of a point of a cube face; `s` runs right and `t` down in [−1, 1]. Faces in the order +X, −X, +Y,
/// −Y, +Z, −Z, oriented as in Vulkan and WebGPU.
pub fn face_direction(face: usize, s: f32, t: f32) -> Vec3A {
    normalize(match face {
        0 => Vec3A::new(1.0, -t, -s),
        1 => Vec3A::new(-1.0, -t, s),
        2 => Vec3A::new(s, 1.0, t),
        3 => Vec3A::new(s, -1.0, -t),
        4 => Vec3A::new(s, -t, 1.0),
        _ => Vec3A::new(-s, -t, -1.0),
    })
}

/// Unit direction of a point of the equirectangular image; `u` and `v` in [0, 1] from its top left corner.
pub fn equirect_direction(u: f32, v: f32) -> Vec3A {
    let azimuth = (u - 0.5) * std::f32::consts::TAU;
    let polar = v * std::f32::consts::PI;
    let flat = libm::sinf(polar);
    Vec3A::new(flat * libm::sinf(azimuth), libm::cosf(polar), -flat * libm::cosf(azimuth))
}

/// What is painted.
pub struct Painter<'a> {
    /// The cloudless sky.
    pub sky: &'a ClearSky,
    /// The sun as it is shown.
    pub disc: SunDisc,
    /// The clouds, if they are to be painted.
    pub dome: Option<&'a Dome>,
}

/// The clear sky on a grid of nodes, `across` × `down` pixels apart: it changes most from row to row.
struct Grid {
    /// Width and height of the image in pixels.
    size: (usize, usize),
    columns: usize,
    across: usize,
    down: usize,
    nodes: Vec<Vec3A>,
}

impl Grid {
    fn new(size: (usize, usize), step: (usize, usize), radiance: impl Fn(f32, f32) -> Vec3A + Sync) -> Self {
        let ((width, height), (across, down)) = (size, step);
        let (columns, rows) = (width.div_ceil(across) + 1, height.div_ceil(down) + 1);
        let nodes = raster(columns, rows, |row| {
            let (radiance, v) = (&radiance, (row * down) as f32 / height as f32);
            move |column| radiance((column * across) as f32 / width as f32, v)
        });
        Self { size, columns, across, down, nodes }
    }

    /// Pixels of one row, interpolated between nodes.
    fn row(&self, row: usize, pixels: &mut [Vec3A]) {
        let y = (row as f32 + 0.5) / self.down as f32;
        let j = y as usize;
        let fy = y - j as f32;
        let near = &self.nodes[j * self.columns..(j + 1) * self.columns];
        let far = &self.nodes[(j + 1) * self.columns..(j + 2) * self.columns];
        for (i, run) in pixels.chunks_mut(self.across).enumerate() {
            let (a, b) = (near[i].lerp(far[i], fy), near[i + 1].lerp(far[i + 1], fy));
            for (k, pixel) in run.iter_mut().enumerate() {
                *pixel = a.lerp(b, (k as f32 + 0.5) / self.across as f32);
            }
        }
    }

    /// The whole image: `pixel` makes each of its column, its row and the clear sky there.
    fn image(&self, pixel: impl Fn(usize, usize, Vec3A) -> Vec3A + Sync) -> ImageF16 {
        let (width, height) = self.size;
        let mut data = vec![0u16; width * height * 3];
        data.par_chunks_exact_mut(width * 3).enumerate().for_each_init(
            || vec![Vec3A::ZERO; width],
            |colors, (j, data)| {
                self.row(j, colors);
                for (i, out) in data.chunks_exact_mut(3).enumerate() {
                    out.copy_from_slice(&pixel(i, j, colors[i]).to_array().map(half_bits));
                }
            },
        );
        ImageF16 { width: width as u32, height: height as u32, data }
    }
}

impl Painter<'_> {
    /// One face of the cube, `side` pixels wide.
    pub fn face(&self, face: usize, side: usize) -> ImageF16 {
        let step = if face == 2 || face == 3 { (4, 4) } else { (4, 2) };
        let grid = Grid::new((side, side), step, |u, v| {
            self.sky.radiance(face_direction(face, 2.0 * u - 1.0, 2.0 * v - 1.0))
        });
        let place = |i: usize| (2 * i + 1) as f32 / side as f32 - 1.0;
        let pixel_rad = 1.6 / side as f32;
        let columns: Vec<f32> = match self.dome {
            // On the four sides an azimuth belongs to a column.
            Some(dome) if face != 2 && face != 3 => (0..side)
                .map(|i| {
                    let d = face_direction(face, place(i), 0.0);
                    dome.column(d.x, d.z)
                })
                .collect(),
            _ => Vec::new(),
        };
        grid.image(|i, j, color| {
            let direction = face_direction(face, place(i), place(j));
            let clouds = self.dome.filter(|_| direction.y > 0.0).map(|dome| {
                let column = columns.get(i).copied().unwrap_or_else(|| dome.column(direction.x, direction.z));
                dome.at(column, dome.row(direction.y))
            });
            self.pixel(direction, color, clouds, pixel_rad)
        })
    }

    /// The whole sky, `width` × `width` / 2.
    pub fn equirect(&self, width: usize) -> ImageF16 {
        let height = width / 2;
        let grid = Grid::new((width, height), (4, 2), |u, v| self.sky.radiance(equirect_direction(u, v)));
        let pixel_rad = std::f32::consts::TAU / width as f32;
        let column = |i: usize| {
            let d = equirect_direction((i as f32 + 0.5) / width as f32, 0.5);
            (d.x, d.z, self.dome.map_or(0.0, |dome| dome.column(d.x, d.z)))
        };
        let row = |j: usize| {
            let d = equirect_direction(0.5, (j as f32 + 0.5) / height as f32);
            (d.y, -d.z, self.dome.map_or(0.0, |dome| dome.row(d.y)))
        };
        let (columns, rows): (Vec<_>, Vec<_>) =
            ((0..width).map(column).collect(), (0..height).map(row).collect());
        grid.image(|i, j, color| {
            let ((x, z, column), (y, flat, row)) = (columns[i], rows[j]);
            let clouds = self.dome.filter(|_| y > 0.0).map(|dome| dome.at(column, row));
            self.pixel(Vec3A::new(flat * x, y, flat * z), color, clouds, pixel_rad)
        })
    }

    #[inline]
    fn pixel(&self, direction: Vec3A, clear: Vec3A, clouds: Option<Vec4>, pixel_rad: f32) -> Vec3A {
        let color = clouds.map_or(clear, |seen| clear * seen.w + Vec3A::from(seen.truncate()));
        if dot(direction, self.sky.sun) <= 0.998 {
            return color;
        }
        // A disc behind thin cloud is blotted out sooner than the sky around it.
        let through = clouds.map_or(1.0, |seen| seen.w * seen.w);
        color + self.disc.radiance(direction, pixel_rad) * through
    }
}
