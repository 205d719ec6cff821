//! Triangles in pixels → which pixels they cover: rows of bits, from which it is counted how much of something is seen.
//!
//! A pixel counts when its centre is inside a triangle and, if that is cut out by a texture, opaque there.

use std::cell::LazyCell;
use std::ops::Range;

use glam::{Vec2, Vec4};

/// Pixels in a word.
const WORD: usize = u64::BITS as usize;

/// Which of a square of pixels are covered.
#[derive(Clone)]
pub struct Silhouette {
    /// Pixels a side.
    side: usize,
    /// Rows of pixels, each begins with a new word.
    words: Vec<u64>,
}

impl Silhouette {
    pub fn empty(side: usize) -> Self {
        Self { side, words: vec![0; side * side.div_ceil(WORD)] }
    }

    /// Pixels that are covered.
    pub fn covered(&self) -> u32 {
        self.words.iter().map(|word| word.count_ones()).sum()
    }

    /// The share that is covered of each square of `block` × `block` pixels, rows from the top; the side is a multiple of it.
    pub fn shares(&self, block: usize) -> Vec<f32> {
        let blocks = self.side / block;
        let share = |i: usize| {
            let columns = i % blocks * block..(i % blocks + 1) * block;
            let words = columns.start / WORD..columns.end.div_ceil(WORD);
            let in_row = |row: usize| -> u32 {
                let line = &self.words[row * self.across()..][..self.across()];
                words.clone().map(|word| (line[word] & bits(&columns, word)).count_ones()).sum()
            };
            let covered: u32 = (0..block).map(|row| in_row(i / blocks * block + row)).sum();
            covered as f32 / (block * block) as f32
        };
        (0..blocks * blocks).map(share).collect()
    }

    /// Covers a triangle.
    pub fn fill(&mut self, corners: [Vec2; 3]) {
        self.fill_where(corners, |bare, _, _| bare);
    }

    /// Covers what is opaque of a triangle with these texture coordinates at its corners: `opaque` gives a bit for each of four
    /// places in the texture.
    pub fn fill_cut_out(&mut self, corners: [Vec2; 3], uvs: [Vec2; 3], opaque: impl Fn([Vec4; 2]) -> u64) {
        // Most small triangles show nothing that is not covered yet, so their texture is placed only when it counts.
        let texture = LazyCell::new(|| Affine::through(corners, uvs));
        self.fill_where(corners, |bare, word, y| {
            let Some(texture) = texture.as_ref() else { return 0 };
            let (mut shown, mut rest) = (0, bare);
            while rest != 0 {
                let first = rest.trailing_zeros();
                shown |= opaque(texture.at_four(middle(WORD * word + first as usize), y)) << first;
                rest &= !(0b1111 << first);
            }
            shown & bare
        });
    }

    /// Covers what another one of the same size covers.
    pub fn add(&mut self, other: &Self) {
        self.words.iter_mut().zip(&other.words).for_each(|(word, other)| *word |= other);
    }

    /// Words in a row.
    fn across(&self) -> usize {
        self.side.div_ceil(WORD)
    }

    /// Whether any pixel in some columns of a row, at least one, is not covered.
    #[inline]
    fn has_bare(&self, row: usize, columns: &Range<usize>) -> bool {
        let first = row * self.across();
        (columns.start / WORD..columns.end.div_ceil(WORD))
            .any(|word| !self.words[first + word] & bits(columns, word) != 0)
    }

    /// Covers what `opaque` gives of a triangle's pixels that are not covered yet: it gets and gives some of a row's nth word,
    /// and the height of the row's middle.
    #[inline]
    fn fill_where(&mut self, corners: [Vec2; 3], opaque: impl Fn(u64, usize, f32) -> u64) {
        let [a, b, c] = corners;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let rows = whole(low.y)..whole(high.y).min(self.side);
        let around = whole(low.x)..whole(high.x).min(self.side);
        if around.is_empty() {
            return;
        }
        let across = self.across();
        let edges = LazyCell::new(|| Edges::of(corners));
        for four in rows.clone().step_by(4) {
            let four = four..(four + 4).min(rows.end);
            // Most triangles are small, and most of what they might cover is covered when it is their turn.
            if !four.clone().any(|row| self.has_bare(row, &around)) {
                continue;
            }
            let [left, right] = edges.spans(four.start).map(|ends| ends.to_array());
            for (k, row) in four.enumerate() {
                let columns = whole(left[k])..whole(right[k]).min(self.side);
                for word in columns.start / WORD..columns.end.div_ceil(WORD) {
                    let covered = &mut self.words[row * across + word];
                    *covered |= opaque(!*covered & bits(&columns, word), word, middle(row));
                }
            }
        }
    }
}

/// The edges of a triangle.
struct Edges([Edge; 3]);

/// From one corner to another.
#[derive(Clone, Copy)]
struct Edge {
    from: Vec2,
    to_y: f32,
    /// Pixels to the right a row.
    slope: f32,
}

impl Edges {
    #[inline]
    fn of([a, b, c]: [Vec2; 3]) -> Self {
        let edge = |(p, q): (Vec2, Vec2)| Edge { from: p, to_y: q.y, slope: (q.x - p.x) / (q.y - p.y) };
        Self([(a, b), (b, c), (c, a)].map(edge))
    }

    /// Where the middles of four rows enter and leave the triangle: from right to left where they do not.
    #[inline]
    fn spans(&self, first_row: usize) -> [Vec4; 2] {
        let y = middle(first_row) + Vec4::new(0.0, 1.0, 2.0, 3.0);
        self.0.iter().fold([Vec4::MAX, Vec4::MIN], |[left, right], edge| {
            let crosses = Vec4::splat(edge.from.y).cmplt(y) ^ Vec4::splat(edge.to_y).cmplt(y);
            let x = edge.from.x + (y - edge.from.y) * edge.slope;
            let at = |nowhere: Vec4| Vec4::select(crosses, x, nowhere);
            [left.min(at(Vec4::MAX)), right.max(at(Vec4::MIN))]
        })
    }
}

/// Those bits of a row's nth word that are in a range of columns which reaches into it.
#[inline]
fn bits(columns: &Range<usize>, word: usize) -> u64 {
    let first = WORD * word;
    let (from, to) = (columns.start.max(first) - first, columns.end.min(first + WORD) - first);
    u64::MAX << from & u64::MAX >> (WORD - to)
}

/// The first pixel whose centre is not before a place: without a call, since this is the bake's innermost loop but one.
#[inline]
fn whole(place: f32) -> usize {
    (place + 0.5).max(0.0) as i32 as usize
}

/// Where the middle of a pixel is. Sides are short, and an `i32` is converted sooner than a `usize`.
#[inline]
fn middle(pixel: usize) -> f32 {
    pixel as i32 as f32 + 0.5
}

/// Texture coordinates as a function of the place in a picture.
struct Affine {
    origin: Vec2,
    along_x: Vec2,
    along_y: Vec2,
}

impl Affine {
    fn through([a, b, c]: [Vec2; 3], [at_a, at_b, at_c]: [Vec2; 3]) -> Option<Self> {
        let (p, q) = (b - a, c - a);
        let area = p.perp_dot(q);
        let (u, v) = (at_b - at_a, at_c - at_a);
        let along_x = (u * q.y - v * p.y) / area;
        let along_y = (v * p.x - u * q.x) / area;
        let origin = at_a - along_x * a.x - along_y * a.y;
        origin.is_finite().then_some(Self { origin, along_x, along_y })
    }

    /// At a place and at the three pixels to the right of it.
    #[inline]
    fn at_four(&self, x: f32, y: f32) -> [Vec4; 2] {
        let x = Vec4::splat(x) + Vec4::new(0.0, 1.0, 2.0, 3.0);
        [0, 1].map(|axis: usize| self.origin[axis] + self.along_x[axis] * x + self.along_y[axis] * y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_that_share_an_edge_cover_each_pixel_once_and_none_beyond() {
        let [a, b, c, d] = [[3.2, 4.1], [80.7, 9.9], [75.3, 60.2], [10.8, 55.5]].map(Vec2::from_array);
        let of = |triangles: &[[Vec2; 3]]| {
            let mut silhouette = Silhouette::empty(96);
            triangles.iter().for_each(|&triangle| silhouette.fill(triangle));
            silhouette.covered()
        };
        let (one, other) = (of(&[[a, b, c]]), of(&[[a, c, d]]));
        assert_eq!(of(&[[a, b, c], [a, c, d]]), one + other, "no pixel is in both");
        let area = 0.5 * ((b - a).perp_dot(c - a) + (c - a).perp_dot(d - a));
        assert!((f64::from(one + other) - f64::from(area)).abs() < 0.01 * f64::from(area));
        assert_eq!(of(&[[a - 500.0, b - 500.0, c - 500.0]]), 0);
        assert_eq!(of(&[[Vec2::splat(-900.0), Vec2::new(3000.0, -900.0), Vec2::new(48.0, 5000.0)]]), 96 * 96);
    }

    #[test]
    fn shares_of_squares_are_what_is_covered_of_them() {
        let corners = [[3.0, 5.0], [90.0, 20.0], [40.0, 92.0]].map(Vec2::from_array);
        let mut silhouette = Silhouette::empty(96);
        silhouette.fill(corners);
        for block in [1, 12, 48, 96] {
            let shares = silhouette.shares(block);
            assert_eq!(shares.len(), (96 / block).pow(2));
            let sum = shares.iter().sum::<f32>() * (block * block) as f32;
            assert!((sum - silhouette.covered() as f32).abs() < 0.5, "{block}: {sum}");
        }
        silhouette = Silhouette::empty(96);
        silhouette.fill([[72.0, 24.0], [84.0, 24.0], [72.0, 48.0]].map(Vec2::from_array));
        let shares = silhouette.shares(12);
        let covered: Vec<usize> = (0..64).filter(|&i| shares[i] > 0.0).collect();
        assert_eq!(covered, [2 * 8 + 6, 3 * 8 + 6]);
    }

    #[test]
    fn what_a_texture_leaves_transparent_is_not_covered() {
        let corners = [[0.0, 0.0], [64.0, 0.0], [0.0, 64.0]].map(Vec2::from_array);
        let mut silhouette = Silhouette::empty(64);
        silhouette.fill_cut_out(corners, corners.map(|p| p / 64.0), |[u, _]| {
            u.cmplt(Vec4::splat(0.25)).bitmask().into()
        });
        // 16 columns of 64 to 49 pixels, some of them on the edge.
        assert!((silhouette.covered() as i32 - (16 * 56 + 8)).abs() <= 16, "{}", silhouette.covered());
    }
}
