//! Where an axis has its numbers.

/// Places from `low` to `high` at steps of 1, 2 or 5 times a power of ten, about `wanted` of them, and how many digits after
/// the point tell them apart.
pub fn linear(low: f64, high: f64, wanted: f64) -> (Vec<f64>, usize) {
    let span = high - low;
    if !(span.is_finite() && span > 0.0) {
        return (vec![low], 3);
    }
    let rough = span / wanted;
    let power = libm::pow(10.0, libm::log10(rough).floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|factor| factor * power).find(|step| *step >= rough);
    let step = step.unwrap_or(10.0 * power);
    let digits = (-libm::log10(step).floor()).max(0.0) as usize;
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    ((first..=last).map(|number| number as f64 * step).collect(), digits)
}

/// Powers of ten from below `low` to above `high`, which are positive; with 2 and 5 times these where there are few.
pub fn logarithmic(low: f64, high: f64) -> Vec<f64> {
    let powers = libm::log10(low).floor() as i32..=libm::log10(high).ceil() as i32;
    let factors: &[f64] = if powers.clone().count() > 4 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let all =
        powers.flat_map(|power| factors.iter().map(move |factor| factor * libm::pow(10.0, f64::from(power))));
    all.filter(|tick| *tick >= low * 0.999 && *tick <= high * 1.001).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn ticks_lie_on_the_axis_and_are_neither_few_nor_many(low in -1e6f64..1e6, span in 1e-6f64..1e7) {
            let (ticks, _) = linear(low, low + span, 5.0);
            prop_assert!((2..=7).contains(&ticks.len()), "{:?}", ticks);
            prop_assert!(ticks.iter().all(|t| *t >= low - span * 1e-3 && *t <= low + span * 1.001));
        }
    }

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(linear(0.0, 96.0, 5.0), (vec![0.0, 20.0, 40.0, 60.0, 80.0], 0));
        assert_eq!(linear(0.0, 0.05, 5.0).1, 2);
        assert_eq!(linear(3.0, 3.0, 5.0).0, [3.0]);
        assert_eq!(logarithmic(1.5, 30.0), [2.0, 5.0, 10.0, 20.0]);
        assert_eq!(logarithmic(1.0, 1e5).len(), 6);
    }
}
