//! Square grids of values over the field → the same at another resolution.

use bytemuck::Zeroable;
use rayon::prelude::*;

use super::FIELD_M;
use crate::math::smoothstep;
use crate::raster::square;

/// side² values, row by row, `spacing_m` apart, centred on the origin as a `Heightfield` is.
#[derive(Clone, Debug)]
pub(super) struct Grid<T = f32> {
    pub side: u32,
    pub spacing_m: f32,
    pub values: Vec<T>,
}

fn place_m(side: u32, spacing_m: f32, k: usize) -> f32 {
    (k as f32 - 0.5 * (side - 1) as f32) * spacing_m
}

impl<T: Zeroable + Copy + Send> Grid<T> {
    /// A grid over the field, each value from its position (x, z) in metres; rows in parallel.
    pub fn from_field(side: u32, value: impl Fn(f32, f32) -> T + Sync) -> Self {
        Self::from_square(side, FIELD_M / (side - 1) as f32, value)
    }

    /// A grid of any spacing, centred on the origin.
    pub fn from_square(side: u32, spacing_m: f32, value: impl Fn(f32, f32) -> T + Sync) -> Self {
        let place_m = |k: usize| place_m(side, spacing_m, k);
        Self { side, spacing_m, values: square(side as usize, |i, j| value(place_m(i), place_m(j))) }
    }

    /// The same grid with each value changed by itself.
    pub fn map<U>(&self, f: impl Fn(T) -> U) -> Grid<U> {
        let values = self.values.iter().map(|&v| f(v)).collect();
        Grid { side: self.side, spacing_m: self.spacing_m, values }
    }

    /// Coordinate in metres of sample `k` of a row or column.
    pub fn place_m(&self, k: usize) -> f32 {
        place_m(self.side, self.spacing_m, k)
    }
}

impl Grid {
    /// The same grid with each value combined with that of another of the same size.
    pub fn zip(&self, other: &Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let pairs = self.values.iter().zip(&other.values);
        Self { values: pairs.map(|(&a, &b)| f(a, b)).collect(), ..*self }
    }

    /// Lowest and highest value.
    pub fn range(&self) -> (f32, f32) {
        self.values.iter().fold((f32::MAX, f32::MIN), |(lo, hi), &v| (lo.min(v), hi.max(v)))
    }

    /// The same land on another grid of 2^k+1 samples a side: a subset where it is coarser, Catmull-Rom where it is
    /// finer.
    pub fn resized(&self, side: u32) -> Self {
        let mut grid = if side < self.side { self.every((self.side - 1) / (side - 1)) } else { self.clone() };
        while grid.side < side {
            grid = grid.doubled();
        }
        grid
    }

    fn every(&self, step: u32) -> Self {
        let side = (self.side - 1) / step + 1;
        let take = |j: u32| (0..side).map(move |i| self.values[(j * step * self.side + i * step) as usize]);
        Self { side, spacing_m: self.spacing_m * step as f32, values: (0..side).flat_map(take).collect() }
    }

    /// Twice as fine: old samples stay, new ones are cubic between them.
    fn doubled(&self) -> Self {
        let (n, m) = (self.side as usize, self.side as usize * 2 - 1);
        let mut wide = vec![0.0; n * m];
        wide.par_chunks_mut(m).zip(self.values.par_chunks(n)).for_each(|(out, row)| {
            for i in 0..n - 1 {
                out[2 * i] = row[i];
                out[2 * i + 1] =
                    midpoint(row[i.saturating_sub(1)], row[i], row[i + 1], row[(i + 2).min(n - 1)]);
            }
            out[m - 1] = row[n - 1];
        });
        let mut values = vec![0.0; m * m];
        values.par_chunks_mut(m).enumerate().for_each(|(j, out)| {
            let row = |r: usize| &wide[r * m..][..m];
            let k = j / 2;
            if j % 2 == 0 {
                out.copy_from_slice(row(k));
                return;
            }
            let (a, b, c, d) = (row(k.saturating_sub(1)), row(k), row(k + 1), row((k + 2).min(n - 1)));
            for i in 0..m {
                out[i] = midpoint(a[i], b[i], c[i], d[i]);
            }
        });
        Self { side: m as u32, spacing_m: 0.5 * self.spacing_m, values }
    }

    /// Smoothed once by the binomial kernel 1-2-1 both ways; beyond the edge, its own samples repeat.
    pub fn smoothed(&self) -> Self {
        let n = self.side as usize;
        let mut out = self.clone();
        out.values.par_chunks_mut(n).enumerate().for_each(|(j, out)| {
            let row = |r: usize| &self.values[r * n..][..n];
            let (a, b, c) = (row(j.saturating_sub(1)), row(j), row((j + 1).min(n - 1)));
            let column = |k: usize| a[k] + 2.0 * b[k] + c[k];
            for (i, out) in out.iter_mut().enumerate().take(n - 1).skip(1) {
                *out = (column(i - 1) + 2.0 * column(i) + column(i + 1)) * 0.0625;
            }
            out[0] = (3.0 * column(0) + column(1)) * 0.0625;
            out[n - 1] = (column(n - 2) + 3.0 * column(n - 1)) * 0.0625;
        });
        out
    }
}

/// Half-way between b and c on the Catmull-Rom curve through a, b, c, d.
#[inline]
fn midpoint(a: f32, b: f32, c: f32, d: f32) -> f32 {
    0.5625 * (b + c) - 0.0625 * (a + d)
}

/// Adds to `field`, of any size, what turned `before` into `after`.
pub(super) fn add_change(field: &mut Grid, before: &Grid, after: &Grid) {
    let change = after.zip(before, |after, before| after - before).resized(field.side);
    field.values.iter_mut().zip(&change.values).for_each(|(h, c)| *h += c);
}

/// How freely rain acts: not at all at the border, where drops from outside are missing, fully from 40 m inside.
pub(super) fn border_guard(side: u32) -> Grid {
    Grid::from_field(side, |x, z| {
        let inside_m = 0.5 * FIELD_M - x.abs().max(z.abs());
        smoothstep(4.0, 40.0, inside_m)
    })
}
