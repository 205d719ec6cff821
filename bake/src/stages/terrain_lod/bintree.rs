//! The bintree of right triangles over a grid of (2^k+1)² samples, as integer geometry without heights.
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
pub(super) type Sample = [u32; 2];

/// A triangle of the bintree, counter-clockwise from above: the ends of its hypotenuse, then its apex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
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

/// The lowest bit set in either coordinate: the sample's distance from the ends of the edges or the sides of the
/// block that it splits, in samples. Not for the field's north-west corner.
pub(super) fn step([i, j]: Sample) -> u32 {
    let bits = i | j;
    bits & bits.wrapping_neg()
}

/// The ends of the hypotenuse that a sample (no corner) splits.
pub(super) fn hypotenuse([i, j]: Sample) -> [Sample; 2] {
    let s = step([i, j]);
    match (i & s != 0, j & s != 0) {
        (true, false) => [[i - s, j], [i + s, j]],
        (false, _) => [[i, j - s], [i, j + s]],
        (true, true) if falls_south_east([i, j], s) => [[i - s, j - s], [i + s, j + s]],
        (true, true) => [[i + s, j - s], [i - s, j + s]],
    }
}

/// The samples that must be in use before this one (no corner) may be: the apexes of the triangles it splits.
/// One of them at the field's edge.
pub(super) fn parents([i, j]: Sample, side: u32) -> [Option<Sample>; 2] {
    let s = step([i, j]);
    let last = side - 1;
    match (i & s != 0, j & s != 0) {
        (true, false) => [j.checked_sub(s).map(|j| [i, j]), (j < last).then_some([i, j + s])],
        (false, _) => [i.checked_sub(s).map(|i| [i, j]), (i < last).then_some([i + s, j])],
        (true, true) if falls_south_east([i, j], s) => [Some([i + s, j - s]), Some([i - s, j + s])],
        (true, true) => [Some([i - s, j - s]), Some([i + s, j + s])],
    }
}

/// Whether the diagonal of the block around a centre runs from north-west to south-east.
fn falls_south_east([i, j]: Sample, step: u32) -> bool {
    (i / (2 * step) + j / (2 * step)) & 1 == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Walks the whole tree: the arithmetic on samples must agree with the recursion on triangles.
    fn check(triangle: Triangle, side: u32) {
        let Some(middle) = triangle.middle() else { return };
        let ends = hypotenuse(middle);
        assert!(ends == [triangle.a, triangle.b] || ends == [triangle.b, triangle.a], "{triangle:?}");
        assert!(parents(middle, side).contains(&Some(triangle.apex)), "{triangle:?}");
        for child in triangle.children(middle) {
            check(child, side);
        }
    }

    #[test]
    fn samples_and_triangles_agree() {
        for side in [3, 5, 17, 33] {
            Triangle::roots(side).into_iter().for_each(|root| check(root, side));
        }
    }
}
