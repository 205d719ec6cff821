//! The bintree of right triangles over a grid of (2^k+1)² samples, as arithmetic on samples (i east, j south); the page
//! on `GSC_heightfield` describes it. Every sample but the four corners splits exactly one hypotenuse.

/// A sample's grid coordinates (i east, j south).
pub type Sample = [u32; 2];

/// The lowest bit set in either coordinate: 2^level; the greatest power of two for the north-west corner.
#[inline]
pub fn step([i, j]: Sample) -> u32 {
    let bits = i | j | 1 << 31;
    bits & bits.wrapping_neg()
}

/// The coarsest level whose uniform triangulation uses the sample; at least k for the corners of the field.
#[inline]
pub fn level(sample: Sample) -> u32 {
    step(sample).trailing_zeros()
}

/// The parent that a sample slides to: of the ends of the hypotenuse that it splits the northern one, or the western one
/// if both lie equally far north. Not for corners of the field.
#[inline]
pub fn slides_to([i, j]: Sample) -> Sample {
    let s = step([i, j]);
    match (i & s != 0, j & s != 0) {
        (true, true) if !falls_south_east([i, j], s) => [i + s, j - s],
        (odd_i, odd_j) => [i - s * u32::from(odd_i), j - s * u32::from(odd_j)],
    }
}

/// Both ends of the hypotenuse that a sample (no corner of the field) splits; [`slides_to`] first.
pub fn parents(sample: Sample) -> [Sample; 2] {
    let near = slides_to(sample);
    [near, [2 * sample[0] - near[0], 2 * sample[1] - near[1]]]
}

/// The samples that must be in use before this one (no corner) may be: the apexes of the triangles that it splits. One
/// of them at the edge of the field, whose last line is `last`.
#[inline]
pub fn needs([i, j]: Sample, last: u32) -> [Option<Sample>; 2] {
    let s = step([i, j]);
    match (i & s != 0, j & s != 0) {
        (true, false) => [(j > 0).then(|| [i, j - s]), (j < last).then_some([i, j + s])],
        (false, _) => [(i > 0).then(|| [i - s, j]), (i < last).then_some([i + s, j])],
        (true, true) if falls_south_east([i, j], s) => [Some([i + s, j - s]), Some([i - s, j + s])],
        (true, true) => [Some([i - s, j - s]), Some([i + s, j + s])],
    }
}

/// Whether the diagonal of the block of 2·`step` cells around a centre runs from north-west to south-east.
#[inline]
fn falls_south_east([i, j]: Sample, step: u32) -> bool {
    (i / (2 * step) + j / (2 * step)) & 1 == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Walks the whole tree of triangles (ends of the hypotenuse, apex): arithmetic must agree with recursion.
    fn check([a, b, apex]: [Sample; 3], last: u32) {
        let sum = [a[0] + b[0], a[1] + b[1]];
        if (sum[0] | sum[1]) & 1 != 0 {
            return;
        }
        let middle = [sum[0] / 2, sum[1] / 2];
        let ends = parents(middle);
        assert!(ends == [a, b] || ends == [b, a], "{middle:?}");
        assert!(ends[0][1] < ends[1][1] || (ends[0][1] == ends[1][1] && ends[0][0] < ends[1][0]));
        assert!(ends.iter().all(|&end| level(end) > level(middle)));
        assert!(needs(middle, last).contains(&Some(apex)), "{middle:?}");
        check([apex, a, middle], last);
        check([b, apex, middle], last);
    }

    #[test]
    fn samples_and_triangles_agree() {
        for last in [2, 4, 16, 32] {
            check([[last, last], [0, 0], [0, last]], last);
            check([[0, 0], [last, last], [last, 0]], last);
        }
    }
}
