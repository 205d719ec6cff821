//! How much of a picture a cutoff of its alpha leaves, as the picture is drawn: between texels alpha is interpolated.

/// A picture's alpha, [0, 1], in rows from the top.
#[derive(Clone, Copy, Debug)]
pub struct Alpha<'a> {
    values: &'a [f32],
    width: usize,
}

/// A side is looked at in so many places, or nearly, as a whole number for each texel; one for each texel where these are more,
/// but at most so many.
const PLACES: usize = 128;
const MAX_PLACES: usize = 256;
/// Factors from 2⁻⁶ to 2⁶ are searched, by halving what is left of these powers so many times.
const POWERS: f32 = 6.0;
const STEPS: usize = 14;

impl<'a> Alpha<'a> {
    /// # Panics
    /// Where `values` aren't whole rows of `width`.
    pub fn new(values: &'a [f32], width: usize) -> Self {
        assert!(values.len().is_multiple_of(width.max(1)), "{} values in rows of {width}", values.len());
        Self { values, width: width.max(1) }
    }

    /// The share of the picture where alpha is at least `cutoff`.
    pub fn share(&self, cutoff: f32) -> f32 {
        self.share_scaled(1.0, cutoff)
    }

    /// The factor on alpha by which `share` of the picture reaches `cutoff`, as nearly as that can be, with alpha ending at 1
    /// (Castaño, "Computing Alpha Mipmaps", 2010); 1 where no alpha is or nothing is to be left.
    pub fn scale_for(&self, share: f32, cutoff: f32) -> f32 {
        if share <= 0.0 || self.values.iter().all(|alpha| *alpha <= 0.0) {
            return 1.0;
        }
        let [mut less, mut more] = [-POWERS, POWERS];
        for _ in 0..STEPS {
            let power = 0.5 * (less + more);
            if self.share_scaled(libm::exp2f(power), cutoff) < share { less = power } else { more = power }
        }
        let [less, more] = [less, more].map(libm::exp2f);
        let away = |scale: f32| (self.share_scaled(scale, cutoff) - share).abs();
        if away(less) < away(more) { less } else { more }
    }

    fn share_scaled(&self, scale: f32, cutoff: f32) -> f32 {
        let height = self.values.len() / self.width;
        let columns: Vec<Place> = places(self.width).collect();
        let (mut passing, mut all) = (0_usize, 0_usize);
        let mut row = vec![0.0; self.width];
        for Place { texels, t } in places(height) {
            let [upper, lower] = texels.map(|y| &self.values[y * self.width..][..self.width]);
            for ((mixed, a), b) in row.iter_mut().zip(upper).zip(lower) {
                let [a, b] = [a, b].map(|alpha| (alpha * scale).min(1.0));
                *mixed = a + t * (b - a);
            }
            let at = |place: &&Place| {
                let [a, b] = place.texels.map(|x| row[x]);
                a + place.t * (b - a) >= cutoff
            };
            passing += columns.iter().filter(at).count();
            all += columns.len();
        }
        passing as f32 / all.max(1) as f32
    }
}

/// A place between two texels: which, and how far from the first to the second.
struct Place {
    texels: [usize; 2],
    t: f32,
}

/// Evenly along a side of so many texels; beyond the middles of the outer ones nothing changes.
fn places(texels: usize) -> impl Iterator<Item = Place> {
    let count = (texels * PLACES.div_ceil(texels.max(1))).min(MAX_PLACES);
    let last = texels.saturating_sub(1);
    (0..count).map(move |place| {
        let at = ((place as f32 + 0.5) * texels as f32 / count as f32 - 0.5).clamp(0.0, last as f32);
        let first = at as usize;
        Place { texels: [first, (first + 1).min(last)], t: at - first as f32 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Alpha on a square of so many texels by how far from its middle, in parts of its side.
    fn round(side: usize, alpha: impl Fn(f32) -> f32) -> Vec<f32> {
        let from_middle = |n: usize| (n as f32 + 0.5) / side as f32 - 0.5;
        (0..side * side).map(|n| alpha(libm::hypotf(from_middle(n % side), from_middle(n / side)))).collect()
    }

    #[test]
    fn a_disc_is_a_disc_in_few_texels() {
        let area = std::f32::consts::PI / 9.0;
        for side in [8, 16, 64, 200, 1000] {
            let disc = round(side, |away| (0.5 + (1.0 / 3.0 - away) * side as f32).clamp(0.0, 1.0));
            let share = Alpha::new(&disc, side).share(0.5);
            assert!((share - area).abs() < 0.01, "{share} of {side} texels a side, {area} is true");
        }
    }

    #[test]
    fn what_is_scaled_shows_the_share_that_was_asked_for() {
        let faint = round(16, |away| 0.3 * (1.0 - 1.4 * away));
        for share in [0.1, 0.2, 0.3] {
            let scale = Alpha::new(&faint, 16).scale_for(share, 0.5);
            let scaled: Vec<f32> = faint.iter().map(|alpha| (alpha * scale).min(1.0)).collect();
            let shown = Alpha::new(&scaled, 16).share(0.5);
            assert!((shown - share).abs() < 0.005, "{shown} instead of {share}");
        }
    }

    #[test]
    fn a_single_texel_is_all_or_nothing_and_nothing_stays_nothing() {
        for (share, shown) in [(0.2, 0.0), (0.8, 1.0)] {
            let scale = Alpha::new(&[0.4], 1).scale_for(share, 0.5);
            assert_eq!(Alpha::new(&[0.4 * scale], 1).share(0.5), shown);
        }
        assert_eq!(Alpha::new(&[0.0; 4], 2).scale_for(0.5, 0.5), 1.0);
        assert_eq!(Alpha::new(&[0.4; 4], 2).scale_for(0.0, 0.5), 1.0);
    }
}
