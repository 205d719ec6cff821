//! Strokes and shapes → a picture in linear light with alpha, anti-aliased by their distance to the pixel.
//!
//! A canvas is `width` units wide (x from −width/2) and 1 unit high (y from 0 at the bottom to 1 at the top); its
//! pixels are square only in texture space.

use glam::{Vec2, Vec3};

use super::leaf_outline::Outline;

/// A picture being painted: linear RGB, not multiplied by alpha, and alpha.
pub(super) struct Canvas {
    /// Pixels a side.
    pub size: usize,
    /// Width over height of what is shown.
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

impl Canvas {
    /// An empty canvas.
    pub fn new(size: usize, width: f32) -> Self {
        Self { size, width, pixels: vec![[0.0; 4]; size * size] }
    }

    /// Pixels a unit, on average of both directions.
    fn scale(&self) -> f32 {
        self.size as f32 / self.width.sqrt()
    }

    /// Calls `paint` for every pixel of the box, with the pixel's place in units, and lays what it returns (colour
    /// and coverage) over the picture.
    fn over(&mut self, lo: Vec2, hi: Vec2, paint: impl Fn(Vec2) -> Option<(Vec3, f32)>) {
        let size = self.size as f32;
        let column = |x: f32| ((x / self.width + 0.5) * size).clamp(0.0, size);
        let row = |y: f32| ((1.0 - y) * size).clamp(0.0, size);
        let (x0, x1) = (column(lo.x).floor() as usize, column(hi.x).ceil() as usize);
        let (y0, y1) = (row(hi.y).floor() as usize, row(lo.y).ceil() as usize);
        for y in y0..y1 {
            let up = 1.0 - (y as f32 + 0.5) / size;
            for x in x0..x1 {
                let right = ((x as f32 + 0.5) / size - 0.5) * self.width;
                if let Some((color, cover)) = paint(Vec2::new(right, up)) {
                    blend(&mut self.pixels[y * self.size + x], color, cover);
                }
            }
        }
    }

    /// A straight stroke that tapers from radius `from` to `to` (units).
    pub fn stroke(&mut self, a: Vec2, b: Vec2, radii: (f32, f32), color: Vec3) {
        let scale = self.scale();
        let reach = radii.0.max(radii.1) + 1.5 / scale;
        let (along, square) = (b - a, (b - a).length_squared().max(1e-9));
        self.over(a.min(b) - reach, a.max(b) + reach, |p| {
            let t = ((p - a).dot(along) / square).clamp(0.0, 1.0);
            let d = (p - a - along * t).length();
            let inside = (radii.0 + (radii.1 - radii.0) * t - d) * scale + 0.5;
            (inside > 0.0).then(|| (color, inside.min(1.0)))
        });
    }

    /// A leaf from its base along the unit vector `axis`.
    pub fn leaf(&mut self, outline: &Outline, base: Vec2, axis: Vec2, length: f32, paint: &Paint) {
        let scale = self.scale() * length;
        let side = Vec2::new(-axis.y, axis.x);
        let (back, half) = (outline.back, outline.widest + 0.02);
        let ends = [(-back, -half), (-back, half), (1.0, -half), (1.0, half)]
            .map(|(t, s)| base + (axis * t + side * s) * length);
        let lo = ends.iter().fold(Vec2::MAX, |lo, p| lo.min(*p));
        let hi = ends.iter().fold(Vec2::MIN, |hi, p| hi.max(*p));
        self.over(lo, hi, |p| {
            let local = (p - base) / length;
            let (t, s) = (local.dot(axis), local.dot(side));
            let inside = outline.inside(t, s) * scale + 0.5;
            (inside > 0.0).then(|| (blade(paint, outline, t, s), inside.min(1.0)))
        });
    }

    /// Part of the pixels that are kept at the cutoff.
    #[cfg(test)]
    pub fn coverage(&self, cutoff: f32) -> f32 {
        let kept = self.pixels.iter().filter(|p| p[3] >= cutoff).count();
        kept as f32 / self.pixels.len() as f32
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
