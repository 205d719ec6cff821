//! Strokes and shapes → an image in linear light with alpha, anti-aliased by their distance to the pixel.
//!
//! A canvas is `width` units wide (x from −width/2) and 1 unit high (y from 0 at the bottom to 1 at the top); its
//! pixels are square only in texture space.

use glam::{Vec2, Vec3};

use super::leaf_outline::Outline;

/// An image being painted: linear RGB, not multiplied by alpha, and alpha.
pub(super) struct Canvas {
    /// Pixels a side.
    pub size: usize,
    /// Width over height of the image as shown.
    pub width: f32,
    /// Rows from the top.
    pub pixels: Vec<[f32; 4]>,
}

/// How a leaf is coloured.
#[derive(Clone, Copy)]
pub(super) struct Paint {
    /// Albedo, linear.
    pub color: Vec3,
    /// How far veins differ from the blade.
    pub veins: f32,
    /// Pairs of side veins.
    pub pairs: f32,
    /// How much lighter one half is than the other.
    pub fold: f32,
}

/// A rectangle along a unit vector: `from`..`to` along it, ±`half` across it.
struct Oblong {
    origin: Vec2,
    axis: Vec2,
    from: f32,
    to: f32,
    half: f32,
}

/// The x for which start + x·slope lies within from..to.
fn interval(start: f32, slope: f32, from: f32, to: f32) -> (f32, f32) {
    if slope.abs() < 1e-5 {
        let inside = start >= from && start <= to;
        return if inside { (-4.0, 4.0) } else { (0.0, -4.0) };
    }
    let (a, b) = ((from - start) / slope, (to - start) / slope);
    (a.min(b).max(-4.0), a.max(b).min(4.0))
}

impl Canvas {
    pub fn new(size: usize, width: f32) -> Self {
        Self { size, width, pixels: vec![[0.0; 4]; size * size] }
    }

    /// Pixels a unit, on average of both directions.
    fn scale(&self) -> f32 {
        self.size as f32 / self.width.sqrt()
    }

    /// Calls `paint` for every pixel of an oblong with its distances along and across (from `origin`, in units of
    /// length), and lays what it returns (colour and coverage) over the image.
    fn over(&mut self, oblong: &Oblong, paint: impl Fn(f32, f32) -> Option<(Vec3, f32)>) {
        let size = self.size as f32;
        let (origin, axis) = (oblong.origin, oblong.axis);
        let side = Vec2::new(-axis.y, axis.x);
        let (from, to, half) = (oblong.from, oblong.to, oblong.half);
        let rise = (axis.y * from).min(axis.y * to) - side.y.abs() * half;
        let top = (axis.y * from).max(axis.y * to) + side.y.abs() * half;
        let row = |y: f32| ((1.0 - y) * size).clamp(0.0, size);
        let (y0, y1) = (row(origin.y + top).floor() as usize, row(origin.y + rise).ceil() as usize);
        let step = self.width / size;
        for y in y0..y1 {
            let up = 1.0 - (y as f32 + 0.5) / size - origin.y;
            // On this row, t = up·axis.y + x·axis.x and s = up·side.y + x·side.x.
            let along = interval(up * axis.y, axis.x, from, to);
            let across = interval(up * side.y, side.x, -half, half);
            let (lo, hi) = (along.0.max(across.0) + origin.x, along.1.min(across.1) + origin.x);
            let column = |x: f32| ((x / self.width + 0.5) * size).clamp(0.0, size);
            let (x0, x1) = (column(lo).floor() as usize, column(hi).ceil() as usize);
            for x in x0..x1 {
                let right = (x as f32 + 0.5) * step - 0.5 * self.width - origin.x;
                let t = right * axis.x + up * axis.y;
                let s = right * side.x + up * side.y;
                if let Some((color, cover)) = paint(t, s) {
                    blend(&mut self.pixels[y * self.size + x], color, cover);
                }
            }
        }
    }

    /// Makes the outermost pixels transparent.
    pub fn clear_rim(&mut self) {
        let last = self.size - 1;
        for (i, pixel) in self.pixels.iter_mut().enumerate() {
            if [i % self.size, i / self.size].iter().any(|&at| at == 0 || at == last) {
                pixel[3] = 0.0;
            }
        }
    }

    /// A straight stroke that tapers from radius `from` to `to` (units).
    pub fn stroke(&mut self, a: Vec2, b: Vec2, radii: (f32, f32), color: Vec3) {
        let scale = self.scale();
        let reach = radii.0.max(radii.1) + 1.0 / scale;
        let length = (b - a).length();
        let axis = if length > 1e-6 { (b - a) / length } else { Vec2::Y };
        let oblong = Oblong { origin: a, axis, from: -reach, to: length + reach, half: reach };
        self.over(&oblong, |t, s| {
            let on = t.clamp(0.0, length);
            let d = ((t - on) * (t - on) + s * s).sqrt();
            let radius = radii.0 + (radii.1 - radii.0) * on / length.max(1e-6);
            let inside = (radius - d) * scale + 0.5;
            (inside > 0.0).then(|| (color, inside.min(1.0)))
        });
    }

    /// A leaf from its base along the unit vector `axis`.
    pub fn leaf(&mut self, outline: &Outline, base: Vec2, axis: Vec2, length: f32, paint: &Paint) {
        let scale = self.scale() * length;
        let half = (outline.widest + 0.02) * length;
        let oblong = Oblong { origin: base, axis, from: -outline.back * length, to: 1.01 * length, half };
        let per_length = 1.0 / length;
        self.over(&oblong, |t, s| {
            let (t, s) = (t * per_length, s * per_length);
            let inside = outline.inside(t, s) * scale + 0.5;
            (inside > 0.0).then(|| (blade(paint, outline, t, s), inside.min(1.0)))
        });
    }
}

fn blend(pixel: &mut [f32; 4], color: Vec3, cover: f32) {
    let before = pixel[3] * (1.0 - cover);
    let alpha = before + cover;
    let part = cover / alpha;
    for (c, new) in color.to_array().into_iter().enumerate() {
        pixel[c] += (new - pixel[c]) * part;
    }
    pixel[3] = alpha;
}

/// Colour of a leaf's blade: folded along the midrib, with side veins that run forward.
fn blade(paint: &Paint, outline: &Outline, t: f32, s: f32) -> Vec3 {
    let aside = s.abs() / outline.widest;
    let mut light = 1.0 + if s > 0.0 { paint.fold } else { -paint.fold };
    light *= 0.9 + 0.16 * t.clamp(0.0, 1.0) - 0.06 * aside;
    let vein = |distance: f32, width: f32| (1.0 - distance.abs() / width).max(0.0);
    let phase = (t - 0.55 * s.abs()) * paint.pairs;
    let side_vein = vein(phase - phase.round(), 0.13) * (1.0 - aside).max(0.0);
    let rib = vein(s, 0.022 * (1.1 - t)) * (1.0 - t).clamp(0.0, 1.0).sqrt();
    light *= 1.0 + paint.veins * (0.5 * side_vein + rib);
    paint.color * light
}
