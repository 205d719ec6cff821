//! Small mathematics of the sky: arc tangent and the like as plain IEEE arithmetic on `f32`, so that they are fast
//! enough for every pixel and give the same bits on every machine.

use glam::Vec3A;

pub use crate::math::exp;
use crate::math::{lerp, split};

/// e^x of each component.
#[inline]
pub fn exp3(v: Vec3A) -> Vec3A {
    Vec3A::new(exp(v.x), exp(v.y), exp(v.z))
}

/// The angle of (x, y) as part of a full turn in [0, 1), to 2e-6 of a turn; 0 at the origin.
#[inline]
pub fn turn(y: f32, x: f32) -> f32 {
    let (ax, ay) = (x.abs(), y.abs());
    let largest = ax.max(ay);
    if largest == 0.0 {
        return 0.0;
    }
    // Abramowitz and Stegun 4.4.49, an odd polynomial for the arc tangent in [0, 1].
    let t = ax.min(ay) / largest;
    let s = t * t;
    let series = 1.0
        + s * (-0.333_331_45
            + s * (0.199_935_51
                + s * (-0.142_089
                    + s * (0.106_562_64
                        + s * (-0.075_289_64
                            + s * (0.042_909_614 + s * (-0.016_165_737 + s * 0.002_866_226)))))));
    let a = t * series * std::f32::consts::FRAC_1_PI * 0.5;
    let a = if ay > ax { 0.25 - a } else { a };
    let a = if x < 0.0 { 0.5 - a } else { a };
    let a = if y < 0.0 { 1.0 - a } else { a };
    if a >= 1.0 { 0.0 } else { a }
}

/// A tiling square of `side` texels (a power of two) a side, at a point in texels, interpolated. Where clouds are marched, two of
/// them are read at once, which takes less time than one after the other.
#[inline(always)]
pub fn bilinear(texels: &[f32], side: usize, u: f32, v: f32) -> f32 {
    let ((iu, du), (iv, dv)) = (split(u), split(v));
    let (iu, iv) = (iu as usize, iv as usize);
    let (x0, x1) = (iu & (side - 1), iu.wrapping_add(1) & (side - 1));
    let (y0, y1) = ((iv & (side - 1)) * side, (iv.wrapping_add(1) & (side - 1)) * side);
    let texels = &texels[..side * side];
    lerp(lerp(texels[y0 + x0], texels[y0 + x1], du), lerp(texels[y1 + x0], texels[y1 + x1], du), dv)
}

/// The least and the greatest of some values.
pub fn range(values: &[f32]) -> (f32, f32) {
    values.iter().fold((f32::MAX, f32::MIN), |(low, high), &v| (low.min(v), high.max(v)))
}

/// Luminance of linear sRGB (Rec. 709).
#[inline]
pub fn luminance(c: Vec3A) -> f32 {
    0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z
}

/// The phase function of Henyey and Greenstein (1941), per steradian.
#[inline]
pub fn henyey_greenstein(g: f32, cos_angle: f32) -> f32 {
    let d = (1.0 + g * g - 2.0 * g * cos_angle).max(1e-6);
    (1.0 - g * g) * (0.25 * std::f32::consts::FRAC_1_PI) / (d * d.sqrt())
}

/// The scalar product, summed in a fixed order whatever the width of the machine's vectors.
#[inline]
pub fn dot(a: Vec3A, b: Vec3A) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// Unit vector of a direction, by the same rule.
#[inline]
pub fn normalize(v: Vec3A) -> Vec3A {
    v / dot(v, v).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turn_agrees_with_libm() {
        for i in 0..720 {
            let angle = (i as f32 + 0.3) * std::f32::consts::PI / 360.0;
            let (y, x) = (libm::sinf(angle) * 3.0, libm::cosf(angle) * 3.0);
            assert!((turn(y, x) - angle / std::f32::consts::TAU).abs() < 4e-6, "at {angle}");
        }
    }
}
