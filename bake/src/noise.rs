//! Lattice noise in two dimensions: gradient noise after Perlin ("Improving noise", 2002), fractal sums, and cellular
//! noise after Worley (1996). Pure arithmetic, so the same on every machine.
//!
//! Points are in lattice units (one cell = 1); values of gradient noise lie within about [-1, 1].
//! `period` wraps the lattice so that a texture tiles; 0 never wraps.

use crate::math::{lerp, quarter_turns, split};

/// A lattice hash: 32 well-mixed bits for a cell (lowbias32 by Wellons over a linear combination).
#[inline]
pub fn hash(seed: u32, x: i32, y: i32, z: i32) -> u32 {
    let mut h = seed
        ^ (x as u32).wrapping_mul(0x9E37_79B1)
        ^ (y as u32).wrapping_mul(0x85EB_CA77)
        ^ (z as u32).wrapping_mul(0xC2B2_AE3D);
    h ^= h >> 16;
    h = h.wrapping_mul(0x7FEB_352D);
    h ^= h >> 15;
    h = h.wrapping_mul(0x846C_A68B);
    h ^ (h >> 16)
}

/// A hash as a number in [0, 1).
#[inline]
pub fn hash01(seed: u32, x: i32, y: i32, z: i32) -> f32 {
    (hash(seed, x, y, z) >> 8) as f32 * (1.0 / 16_777_216.0)
}

#[inline]
fn fade(t: f32) -> f32 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

#[inline]
fn wrap(i: i32, period: i32) -> i32 {
    // Division only beyond the period: it costs more than all the rest.
    if period <= 0 || (0..period).contains(&i) { i } else { i.rem_euclid(period) }
}

/// Sixteen unit vectors, evenly around the circle: cos and sin of k·22.5° + 11.25°.
const GRADIENTS_2D: [[f32; 2]; 16] = {
    let [a, b, c, d] = [0.980_785_25, 0.831_469_6, 0.555_570_24, 0.195_090_32];
    quarter_turns([[a, d], [b, c], [c, b], [d, a]])
};

#[inline]
fn gradient_2d(h: u32, x: f32, y: f32) -> f32 {
    let g = GRADIENTS_2D[(h >> 28) as usize];
    g[0] * x + g[1] * y
}

/// Gradient noise, in about [-1, 1].
#[inline]
pub fn gradient2(seed: u32, x: f32, y: f32, period: i32) -> f32 {
    let ((ix, dx), (iy, dy)) = (split(x), split(y));
    let (x0, x1, y0, y1) = (wrap(ix, period), wrap(ix + 1, period), wrap(iy, period), wrap(iy + 1, period));
    let a = gradient_2d(hash(seed, x0, y0, 0), dx, dy);
    let b = gradient_2d(hash(seed, x1, y0, 0), dx - 1.0, dy);
    let c = gradient_2d(hash(seed, x0, y1, 0), dx, dy - 1.0);
    let d = gradient_2d(hash(seed, x1, y1, 0), dx - 1.0, dy - 1.0);
    let (u, v) = (fade(dx), fade(dy));
    lerp(lerp(a, b, u), lerp(c, d, u), v) * std::f32::consts::SQRT_2
}

/// A fractal sum of `octaves` of [`gradient2`], each twice as fine and `gain` times as high as the one before,
/// divided by the sum of amplitudes.
pub fn fbm2(seed: u32, x: f32, y: f32, octaves: u32, gain: f32, period: i32) -> f32 {
    let (mut sum, mut amplitude, mut total, mut frequency) = (0.0, 1.0, 0.0, 1.0);
    for octave in 0..octaves {
        let wrapped = period << octave;
        sum += amplitude * gradient2(seed.wrapping_add(octave), x * frequency, y * frequency, wrapped);
        total += amplitude;
        amplitude *= gain;
        frequency *= 2.0;
    }
    sum / total
}

/// [`fbm2`] at the ascending points `xs` of one row, the same bit by bit at a third of the cost: points that share a
/// cell share its corners. `out` is as long as `xs`.
pub fn fbm2_row(seed: u32, xs: &[f32], y: f32, octaves: u32, gain: f32, period: i32, out: &mut [f32]) {
    let (mut amplitude, mut total, mut frequency) = (1.0, 0.0, 1.0);
    out.fill(0.0);
    for octave in 0..octaves {
        let wrapped = period << octave;
        add_row(seed.wrapping_add(octave), xs, frequency, y * frequency, wrapped, amplitude, out);
        total += amplitude;
        amplitude *= gain;
        frequency *= 2.0;
    }
    out.iter_mut().for_each(|value| *value /= total);
}

/// Adds amplitude × [`gradient2`] at (x · frequency, y) to each point of a row.
fn add_row(seed: u32, xs: &[f32], frequency: f32, y: f32, period: i32, amplitude: f32, out: &mut [f32]) {
    let (iy, dy) = split(y);
    let (y0, y1, v) = (wrap(iy, period), wrap(iy + 1, period), fade(dy));
    let corner = |x: i32, y: i32| GRADIENTS_2D[(hash(seed, x, y, 0) >> 28) as usize];
    let end = xs.len().min(out.len());
    let mut start = 0;
    while start < end {
        let ix = split(xs[start] * frequency).0;
        let same = |x: &&f32| split(**x * frequency).0 == ix;
        let stop = start + 1 + xs[start + 1..end].iter().take_while(same).count();
        let (x0, x1) = (wrap(ix, period), wrap(ix + 1, period));
        let (a, b, c, d) = (corner(x0, y0), corner(x1, y0), corner(x0, y1), corner(x1, y1));
        for (value, x) in out[start..stop].iter_mut().zip(&xs[start..stop]) {
            let dx = x * frequency - ix as f32;
            let at = |g: [f32; 2], dx: f32, dy: f32| g[0] * dx + g[1] * dy;
            let u = fade(dx);
            let (north, south) = (
                lerp(at(a, dx, dy), at(b, dx - 1.0, dy), u),
                lerp(at(c, dx, dy - 1.0), at(d, dx - 1.0, dy - 1.0), u),
            );
            *value += amplitude * (lerp(north, south, v) * std::f32::consts::SQRT_2);
        }
        start = stop;
    }
}

/// Cellular noise: distance to the nearest and second nearest of one jittered point per cell, and the nearest
/// cell's hash.
pub fn cellular2(seed: u32, x: f32, y: f32, period: i32) -> (f32, f32, u32) {
    let (ix, iy) = (split(x).0, split(y).0);
    let (mut first, mut second, mut id) = (f32::MAX, f32::MAX, 0);
    for cy in iy - 1..=iy + 1 {
        for cx in ix - 1..=ix + 1 {
            let h = hash(seed, wrap(cx, period), wrap(cy, period), 1);
            let px = cx as f32 + (h & 0xFFFF) as f32 / 65536.0;
            let py = cy as f32 + (h >> 16) as f32 / 65536.0;
            let d = (px - x) * (px - x) + (py - y) * (py - y);
            if d < first {
                (second, first, id) = (first, d, h);
            } else if d < second {
                second = d;
            }
        }
    }
    (first.sqrt(), second.sqrt(), id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_its_points_bit_by_bit() {
        for (step, from, period) in [(0.043, 0.0, 9), (0.61, -20.0, 0), (1.7, 3.0, 5)] {
            let xs: Vec<f32> = (0..300).map(|i| from + i as f32 * step).collect();
            for y in [-3.3, 0.0, 8.99, 41.5] {
                let mut row = vec![7.0; xs.len()];
                fbm2_row(5, &xs, y, 3, 0.6, period, &mut row);
                let points: Vec<f32> = xs.iter().map(|&x| fbm2(5, x, y, 3, 0.6, period)).collect();
                assert!(row == points, "{step} {y} {period}");
            }
        }
    }
}
