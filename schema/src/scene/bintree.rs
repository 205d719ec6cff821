//! The bintree of right triangles over a grid of (2^k+1)² samples (4–8 mesh: Lindstrom et al. 1996; ROAM, Duchaineau et
//! al. 1997), as integer geometry without heights.
//!
//! The square is cut along its north-west to south-east diagonal; each triangle is split from its apex to the
//! midpoint of its hypotenuse. A sample other than the four corners is the midpoint of exactly one hypotenuse, so
//! a sample names the (one or two) triangles that it splits. With `step`, the lowest bit set in i or j:
//! - both coordinates odd multiples of `step`: the sample is the centre of a block of 2·step cells a side and
//!   splits its diagonal. Block (I, J), counted in blocks of that size, has the diagonal north-west to south-east
//!   if I+J is even, north-east to south-west if it is odd; so diagonals alternate as in the thesis's figure 5;
//! - one odd: it is the middle of an edge of such blocks.
//!
//! Uniform refinement to cells of 2^l samples gives the uniform triangulation of level l, with diagonals by the
//! same rule; each contains all edges of the next coarser one.

/// A sample's grid coordinates (i east, j south).
pub type Sample = [u32; 2];

/// A triangle of the bintree, counter-clockwise from above: the ends of its hypotenuse, then its apex.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    pub a: Sample,
    pub b: Sample,
    pub apex: Sample,
}

impl Triangle {
    /// The two triangles that make up the whole field: south-west, then north-east half.
    pub fn roots(side: u32) -> [Self; 2] {
        let n = side - 1;
        [Self { a: [n, n], b: [0, 0], apex: [0, n] }, Self { a: [0, 0], b: [n, n], apex: [n, 0] }]
    }

    /// The sample that splits it; `None` for half a cell.
    pub fn middle(&self) -> Option<Sample> {
        let sum = [self.a[0] + self.b[0], self.a[1] + self.b[1]];
        ((sum[0] | sum[1]) & 1 == 0).then(|| [sum[0] / 2, sum[1] / 2])
    }

    /// Its halves at `a` and at `b`.
    pub fn children(&self, middle: Sample) -> [Self; 2] {
        [Self { a: self.apex, b: self.a, apex: middle }, Self { a: self.b, b: self.apex, apex: middle }]
    }
}

/// The lowest bit set in either coordinate: 2^level, the sample's distance from the ends of the edges or the sides of
/// the block that it splits, in samples. The greatest power of two for the north-west corner.
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

/// A sample's first parent, to which it slides when its level ends: the northern end of the hypotenuse that it splits,
/// or the western one if both lie equally far north. Not for corners of the field.
#[inline]
pub fn first_parent([i, j]: Sample) -> Sample {
    let s = step([i, j]);
    match (i & s != 0, j & s != 0) {
        (true, true) if !falls_south_east([i, j], s) => [i + s, j - s],
        (odd_i, odd_j) => [i - s * u32::from(odd_i), j - s * u32::from(odd_j)],
    }
}

/// The ends of the hypotenuse that a sample (no corner of the field) splits; [`first_parent`] first.
#[inline]
pub fn parents(sample: Sample) -> [Sample; 2] {
    let near = first_parent(sample);
    [near, [2 * sample[0] - near[0], 2 * sample[1] - near[1]]]
}

/// The samples that must be in use before this one (no corner) may be: the apexes of the triangles that it splits. One
/// of them at the edge of the field, whose last line is `last`.
#[inline]
pub fn requires([i, j]: Sample, last: u32) -> [Option<Sample>; 2] {
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

    /// Walks the whole tree: the arithmetic on samples must agree with the recursion on triangles.
    fn check(triangle: Triangle, last: u32) {
        let Some(middle) = triangle.middle() else { return };
        let ends = parents(middle);
        assert!(ends == [triangle.a, triangle.b] || ends == [triangle.b, triangle.a], "{triangle:?}");
        assert!(ends[0][1] < ends[1][1] || (ends[0][1] == ends[1][1] && ends[0][0] < ends[1][0]));
        assert!(ends.iter().all(|&end| level(end) > level(middle)));
        assert!(requires(middle, last).contains(&Some(triangle.apex)), "{triangle:?}");
        for child in triangle.children(middle) {
            check(child, last);
        }
    }

    #[test]
    fn samples_and_triangles_agree() {
        for last in [2, 4, 16, 32] {
            Triangle::roots(last + 1).into_iter().for_each(|root| check(root, last));
        }
    }
}
