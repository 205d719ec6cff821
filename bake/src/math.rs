//! Mathematics that several stages share: plain IEEE arithmetic in a fixed order, so the same bits on every machine.

use std::ops::Range;

/// From `a` at t = 0 to `b` at t = 1.
#[inline]
pub fn lerp(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// [`lerp`] of each component.
#[inline]
pub fn lerp_array<const N: usize>(a: [f32; N], b: [f32; N], t: f32) -> [f32; N] {
    std::array::from_fn(|k| lerp(a[k], b[k], t))
}

/// 0 at `from` and beyond, 1 at `to` and beyond, straight between.
#[inline]
pub fn ramp(from: f32, to: f32, x: f32) -> f32 {
    ((x - from) / (to - from)).clamp(0.0, 1.0)
}

/// Hermite's step: 0 up to `low`, 1 from `high`, smooth between; falling if `high` is less. The two must differ.
#[inline]
pub fn smoothstep(low: f32, high: f32, x: f32) -> f32 {
    hermite(ramp(low, high, x))
}

/// Hermite's curve from 0 at t = 0 to 1 at t = 1, level at both.
#[inline]
pub fn hermite(t: f32) -> f32 {
    t * t * (3.0 - 2.0 * t)
}

/// The whole number below and the fraction above it, without the call that `floor` is on processors before SSE 4.1.
#[inline]
pub fn split(x: f32) -> (i32, f32) {
    let cut = x as i32;
    let whole = cut - i32::from(cut as f32 > x);
    (whole, x - whole as f32)
}

/// e^x to a relative error of 1e-7 · (4 + |x|); 0 below −87. Without branches and conversions, so that compilers make vectors
/// of loops over it.
#[inline]
pub fn exp(x: f32) -> f32 {
    /// Numbers from here up to twice this are whole, and their last bits count.
    const WHOLE: f32 = 8_388_608.0;
    let within = if x < -87.0 { -87.0 } else { x };
    let within = if within > 88.0 { 88.0 } else { within };
    let scaled = within * std::f32::consts::LOG2_E;
    let from = scaled + 128.5;
    let nearest = (from + WHOLE) - WHOLE;
    let floor = if nearest > from { nearest - 1.0 } else { nearest };
    let f = (scaled - (floor - 128.0)) * std::f32::consts::LN_2;
    let series = 1.0
        + f * (1.0 + f * (0.5 + f * (1.0 / 6.0 + f * (1.0 / 24.0 + f * (1.0 / 120.0 + f * (1.0 / 720.0))))));
    let power = f32::from_bits((floor - 1.0 + WHOLE).to_bits() << 23);
    if x < -87.0 { 0.0 } else { series * power }
}

/// Of `count` samples, the one before a place in [0, count − 1] and the fraction of the way to the next; the last cell
/// includes its end.
#[inline]
pub fn cell(place: f32, count: usize) -> (usize, f32) {
    let whole = (place as usize).min(count - 2);
    (whole, place - whole as f32)
}

/// A table at a place between its samples.
#[inline]
pub fn interpolate(table: &[f32], place: f32) -> f32 {
    let (k, part) = cell(place, table.len());
    lerp(table[k], table[k + 1], part)
}

/// The sRGB transfer function (IEC 61966-2-1), both in [0, 1].
pub fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::powf(linear, 1.0 / 2.4) - 0.055 }
}

/// Its inverse.
pub fn linear_from_srgb(srgb: f32) -> f32 {
    if srgb <= 0.040_45 { srgb / 12.92 } else { libm::powf((srgb + 0.055) / 1.055, 2.4) }
}

/// A value in [0, 1] as a byte; values beyond are clamped.
#[inline]
pub fn unit_to_byte(value: f32) -> u8 {
    (255.0 * value.clamp(0.0, 1.0) + 0.5) as u8
}

/// The bits of the half float nearest to a value in [0, 65504]; ties go to even, as IEEE 754 has it.
#[inline]
pub fn half_bits(value: f32) -> u16 {
    // Not `clamp`, which would let a NaN through.
    let bits = if value > 0.0 { value.min(65504.0).to_bits() } else { 0 };
    // Below 2⁻¹⁴ the half is subnormal: adding ½ puts its ten bits at the end of the significand.
    let subnormal = (f32::from_bits(bits) + 0.5).to_bits().wrapping_sub(0.5f32.to_bits());
    let normal = bits.wrapping_sub(112 << 23).wrapping_add(0xFFF + ((bits >> 13) & 1)) >> 13;
    if bits < (113 << 23) { subnormal as u16 } else { normal as u16 }
}

/// The value of a half float by its bits.
#[inline]
pub fn value_of_half(bits: u16) -> f32 {
    let (sign, exponent, fraction) =
        (u32::from(bits >> 15) << 31, u32::from(bits >> 10 & 31), u32::from(bits & 1023));
    match exponent {
        0 => f32::from_bits(sign | (fraction as f32 / 16_777_216.0).to_bits()),
        31 => f32::from_bits(sign | 255 << 23 | fraction << 13),
        _ => f32::from_bits(sign | (exponent + 112) << 23 | fraction << 13),
    }
}

/// Four vectors, then the same turned by one, two and three quarters of a turn.
pub const fn quarter_turns(first: [[f32; 2]; 4]) -> [[f32; 2]; 16] {
    let mut all = [[0.0; 2]; 16];
    let mut k = 0;
    while k < 16 {
        all[k] = if k < 4 { first[k] } else { [-all[k - 4][1], all[k - 4][0]] };
        k += 1;
    }
    all
}

/// The triangles that fill the strip between two lines of vertices, at least one on each. Each triangle has its first
/// corner on `a`, its second on `b`, and its third on the line whose next vertex comes first: on `a`, where both are
/// level. `along` ascends on both lines.
pub fn triangles_between(a: &[u32], b: &[u32], along: impl Fn(u32) -> f32) -> Vec<[u32; 3]> {
    let ahead = |line: &[u32]| line.get(1).map_or(f32::MAX, |&vertex| along(vertex));
    let (mut a, mut b) = (a, b);
    let mut triangles = Vec::with_capacity(a.len() + b.len());
    while a.len() > 1 || b.len() > 1 {
        let on_a = ahead(a) <= ahead(b);
        triangles.push([a[0], b[0], if on_a { a[1] } else { b[1] }]);
        if on_a { a = &a[1..] } else { b = &b[1..] }
    }
    triangles
}

/// A count is close to its target when off by this part.
const TOLERANCE: f32 = 0.003;
/// How often [`matching`] counts at most.
const MAX_ROUNDS: u32 = 10;

/// Whether a count is so close to its target that [`matching`] ends.
pub fn is_close(count: u32, target: u32) -> bool {
    count.abs_diff(target) as f32 <= TOLERANCE * target as f32
}

/// Where in a range a growing function comes closest to the target: by false position, between a guess and a point beyond
/// the target.
pub fn matching(target: u32, range: Range<f32>, guess: f32, count: impl Fn(f32) -> u32) -> f32 {
    matching_with(target, range, guess, |x| (count(x), ())).0
}

/// The same for a function that gives something else beside each count: also what it gave there.
pub fn matching_with<T>(
    target: u32,
    range: Range<f32>,
    guess: f32,
    count: impl Fn(f32) -> (u32, T),
) -> (f32, T) {
    let (least, most) = (range.start, range.end.max(range.start));
    let (mut low, mut high) = ((least, f32::NEG_INFINITY), (most, f32::INFINITY));
    let mut at = guess.clamp(least, most);
    let mut min_step = 0.02 * (most - least);
    let mut rounds = 0;
    loop {
        let (counted, beside) = count(at);
        let off = counted as f32 - target as f32;
        let beyond = if off < 0.0 { at >= most } else { at <= least };
        rounds += 1;
        if is_close(counted, target) || beyond || high.0 - low.0 <= 1e-4 * high.0 || rounds == MAX_ROUNDS {
            return (at, beside);
        }
        *(if off < 0.0 { &mut low } else { &mut high }) = (at, off);
        at = if low.1.is_finite() && high.1.is_finite() {
            let part = (-low.1 / (high.1 - low.1)).clamp(0.1, 0.9);
            low.0 + (high.0 - low.0) * part
        } else {
            // About a third of what elements grow by is not hidden by others.
            let step = (3.0 * off.abs() / target as f32 * at).max(min_step);
            min_step *= 8.0;
            (at - step.copysign(off)).clamp(least, most)
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp_agrees_with_libm() {
        for i in -800..80 {
            let x = i as f32 * 0.1037;
            let (ours, theirs) = (exp(x), libm::expf(x));
            assert!(
                (ours - theirs).abs() <= 1e-7 * (4.0 + x.abs()) * theirs,
                "exp({x}) = {ours}, not {theirs}"
            );
        }
    }

    #[test]
    fn half_bits_agree_with_the_half_crate() {
        for i in 0..400_000u32 {
            let value = f32::from_bits(i * 2801);
            if value < 65504.0 {
                assert_eq!(half_bits(value), half::f16::from_f32(value).to_bits(), "{value:e}");
            }
        }
        for bits in 0..=u16::MAX {
            let (ours, theirs) = (value_of_half(bits), half::f16::from_bits(bits).to_f32());
            assert!(ours == theirs || ours.is_nan() && theirs.is_nan(), "{bits:x}: {ours} for {theirs}");
        }
        assert_eq!(half_bits(1e9), half::f16::MAX.to_bits());
        assert_eq!(half_bits(f32::NAN), 0);
    }
}
