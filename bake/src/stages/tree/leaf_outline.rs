//! Kinds of leaf → outlines as tables, in lengths of the leaf: t runs from the base (0) to the tip (1), s across.

use std::f32::consts::PI;

use crate::math::{cell, lerp};

const TABLE: usize = 96;

/// The outline of a blade, the same on both sides of its rib.
pub(super) struct Outline {
    /// Half width (or radius) and the factor from excess to distance, by place along the outline.
    table: Vec<(f32, f32)>,
    /// Whether the table is of radii by angle around a centre at t = `centre`, not of half widths by t.
    polar: bool,
    centre: f32,
    /// Greatest half width.
    pub widest: f32,
    /// Of both halves.
    pub area: f32,
    /// How far lobes reach behind the base.
    pub back: f32,
}

impl Outline {
    /// The outline of leaf shape 0–7 (needles and leaflets of fronds included) for `leaf_aspect`.
    pub fn new(leaf_shape: u32, leaf_aspect: f32) -> Self {
        match leaf_shape {
            1 => Self::blade(0.26 * narrow(leaf_aspect), |t| beta(t, 0.7, 1.15)),
            2 => Self::blade(0.11 * narrow(leaf_aspect), |t| beta(t, 0.6, 0.9)),
            3 => Self::blade(0.36 * leaf_aspect, |t| {
                let lobes = 0.5 + 0.5 * libm::cosf(2.0 * PI * (3.6 * t - 0.45));
                beta(t, 1.0, 0.42) * (0.62 + 0.38 * lobes)
            }),
            4 => Self::polar(0.36, leaf_aspect, palmate),
            5 => Self::polar(0.34, leaf_aspect, heart),
            6 => Self::blade(0.045, |t| beta(t, 0.25, 0.4)),
            7 => Self::blade(0.13 * narrow(leaf_aspect), |t| beta(t, 0.45, 0.8)),
            _ => Self::blade(0.33 * leaf_aspect, |t| {
                let teeth = 1.0 - 0.05 * (t * 17.0).fract();
                beta(t, 0.62, 0.9) * teeth
            }),
        }
    }

    /// A petal: round, notched at the tip.
    pub fn petal() -> Self {
        Self::blade(0.42, |t| beta(t, 0.95, 0.42) * if t > 0.9 { 1.0 - 2.0 * (t - 0.9) } else { 1.0 })
    }

    fn blade(half: f32, profile: impl Fn(f32) -> f32) -> Self {
        let values: Vec<f32> = (0..TABLE).map(|i| half * profile(i as f32 / (TABLE - 1) as f32)).collect();
        let widest = values.iter().copied().fold(0.0, f32::max);
        let table = with_slopes(&values, |_| 1.0 / (TABLE - 1) as f32);
        let area = 2.0 * values.iter().sum::<f32>() / TABLE as f32;
        Self { table, polar: false, centre: 0.0, widest, area, back: 0.02 }
    }

    fn polar(centre: f32, aspect: f32, radius: impl Fn(f32) -> f32) -> Self {
        let angle = |i: usize| PI * i as f32 / (TABLE - 1) as f32;
        let values: Vec<f32> = (0..TABLE)
            .map(|i| {
                // Stretch sideways by the aspect: ρ such that the point keeps its angle roughly.
                let (sin, cos) = libm::sincosf(angle(i));
                let r = radius(angle(i)) * (1.0 - centre);
                let (t, s) = (r * cos, r * sin * aspect.clamp(0.5, 1.3));
                (t * t + s * s).sqrt()
            })
            .collect();
        let reach =
            |f: fn(f32) -> f32| values.iter().enumerate().map(|(i, r)| r * f(angle(i))).fold(0.0, f32::max);
        let (widest, behind) = (reach(libm::sinf), reach(|a| -libm::cosf(a)));
        let table = with_slopes(&values, |r| r * PI / (TABLE - 1) as f32);
        let area = PI * values.iter().map(|r| r * r).sum::<f32>() / TABLE as f32;
        Self { table, polar: true, centre, widest, area, back: (behind - centre).max(0.0) + 0.02 }
    }

    /// About the distance from (t, s) to the outline: positive inside.
    #[inline]
    pub fn inside(&self, t: f32, s: f32) -> f32 {
        let (place, at) = if self.polar {
            let (x, y) = (t - self.centre, s.abs());
            let rho = (x * x + y * y).sqrt();
            (angle_part(x, y), rho)
        } else {
            if !(0.0..=1.0).contains(&t) {
                return -1.0;
            }
            (t, s.abs())
        };
        let (i, f) = cell(place * (TABLE - 1) as f32, TABLE);
        let (a, b) = (self.table[i], self.table[i + 1]);
        (lerp(a.0, b.0, f) - at) * lerp(a.1, b.1, f)
    }
}

/// Narrow leaves stay narrow whatever the gene says.
fn narrow(leaf_aspect: f32) -> f32 {
    leaf_aspect.clamp(0.4, 1.5)
}

/// t^a·(1 − t)^b, scaled to a greatest value of 1.
fn beta(t: f32, a: f32, b: f32) -> f32 {
    let top = a / (a + b);
    let raw = |t: f32| libm::powf(t, a) * libm::powf(1.0 - t, b);
    raw(t.clamp(0.0, 1.0)) / raw(top)
}

/// Angle of (x, y ≥ 0) from the x axis over π.
#[inline]
fn angle_part(x: f32, y: f32) -> f32 {
    // Rational arctangent after Hastings: the error of 1e-4 is far below a texel.
    let q = x.abs().min(y) / x.abs().max(y).max(1e-12);
    let q2 = q * q;
    let a = ((-0.046_496_475 * q2 + 0.159_314_22) * q2 - 0.327_622_76) * q2 * q + q;
    let a = if y > x.abs() { 0.5 * PI - a } else { a };
    (if x < 0.0 { PI - a } else { a }) / PI
}

/// Five pointed lobes by angle from the tip: radius with 1 at the tip.
fn palmate(angle: f32) -> f32 {
    let mut radius = 0.36_f32;
    for (centre, length, width) in [(0.0, 1.0, 0.36), (0.92, 0.92, 0.34), (1.9, 0.66, 0.32)] {
        let away = ((angle - centre) / width as f32).abs();
        let tooth = if away < 0.62 && away > 0.34 { 0.07 } else { 0.0 };
        radius = radius.max(length * (1.0 - 0.62 * libm::powf(away.min(1.6), 0.85)) + tooth);
    }
    // The notch where the stalk comes in.
    radius * (1.0 - 0.72 * ((angle - 2.5) / 0.64).clamp(0.0, 1.0))
}

/// A heart by angle from the tip.
fn heart(angle: f32) -> f32 {
    let (sin, cos) = libm::sincosf(angle);
    let tip = libm::expf(-angle * angle * 3.0);
    let notch = ((angle - 2.45) / 0.69).clamp(0.0, 1.0);
    0.62 + 0.38 * tip + 0.1 * sin * sin - 0.05 * cos.min(0.0) - 0.4 * notch * notch
}

/// Pairs each value with the factor from its excess to distance: 1/√(1 + slope²).
fn with_slopes(values: &[f32], step: impl Fn(f32) -> f32) -> Vec<(f32, f32)> {
    (0..values.len())
        .map(|i| {
            let (a, b) = (i.saturating_sub(1), (i + 1).min(values.len() - 1));
            let slope = (values[b] - values[a]) / (step(values[i]).max(1e-4) * (b - a) as f32);
            (values[i], 1.0 / (1.0 + slope * slope).sqrt())
        })
        .collect()
}
