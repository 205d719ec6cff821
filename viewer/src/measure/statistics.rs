//! Figures over many values.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// The arithmetic mean; 0 of none.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The standard deviation of a sample (n − 1); 0 of fewer than two.
pub fn deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    (squares / (values.len() as f64 - 1.0).max(1.0)).sqrt()
}

/// The middle value; 0 of none.
pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// The least value that a share of all values does not exceed (nearest rank); 0 of none.
pub fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.saturating_sub(1)).copied().unwrap_or(0.0)
}

/// Spearman's rank correlation of pairs, equal values at the mean of their ranks; `None` of fewer than two pairs, or where all
/// values of a side are equal.
pub fn spearman(pairs: &[(f64, f64)]) -> Option<f64> {
    let ranks = |of: fn(&(f64, f64)) -> f64| -> Vec<f64> {
        let values: Vec<f64> = pairs.iter().map(of).collect();
        let rank = |value: &f64| {
            let below = values.iter().filter(|other| *other < value).count();
            let alike = values.iter().filter(|other| *other == value).count();
            below as f64 + 0.5 * (alike as f64 - 1.0)
        };
        values.iter().map(rank).collect()
    };
    let (a, b) = (ranks(|pair| pair.0), ranks(|pair| pair.1));
    let (mean_a, mean_b) = (mean(&a), mean(&b));
    let products: Vec<f64> = a.iter().zip(&b).map(|(a, b)| (a - mean_a) * (b - mean_b)).collect();
    let covariance = products.iter().sum::<f64>() / (pairs.len() as f64 - 1.0);
    let correlation = covariance / (deviation(&a) * deviation(&b));
    correlation.is_finite().then_some(correlation)
}

/// Student's test of a mean against 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TTest {
    pub t: f64,
    /// How often chance gives a mean at least as far from 0, on either side.
    pub p: f64,
}

/// The test of a sample; `None` of fewer than two values, or of equal ones.
pub fn t_test(values: &[f64]) -> Option<TTest> {
    let freedom = values.len().checked_sub(1).filter(|freedom| *freedom > 0)? as f64;
    let t = mean(values) / (deviation(values) / (freedom + 1.0).sqrt());
    let student = StudentsT::new(0.0, 1.0, freedom).ok()?;
    t.is_finite().then(|| TTest { t, p: 2.0 * student.sf(t.abs()) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_the_nearest_rank() {
        let values: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        assert_eq!(
            (quantile(&values, 0.99), quantile(&values, 0.0), quantile(&values, 1.0)),
            (99.0, 1.0, 100.0)
        );
        assert_eq!((median(&[3.0, 1.0, 2.0]), median(&[])), (2.0, 0.0));
    }

    #[test]
    fn ranks_correlate_whatever_the_values_are() {
        let pairs = |ys: [f64; 5]| [1.0, 2.0, 30.0, 400.0, 1e9].into_iter().zip(ys).collect::<Vec<_>>();
        let expected = [
            ([0.1, 0.2, 0.3, 0.35, 0.36], 1.0),
            ([5.0, 4.0, 3.0, 2.0, 1.0], -1.0),
            // Σd² = 4 of n = 5: 1 − 6 · 4 / (5 · 24).
            ([2.0, 1.0, 3.0, 5.0, 4.0], 0.8),
        ];
        for (values, expected) in expected {
            let told = spearman(&pairs(values)).expect("five pairs");
            assert!((told - expected).abs() < 1e-12, "{told} for {values:?}");
        }
        assert_eq!((spearman(&pairs([1.0; 5])), spearman(&[(1.0, 2.0)])), (None, None));
    }

    #[test]
    fn students_test_is_that_of_the_tables() {
        // Quantile 0.975 for 4 degrees of freedom: 2.776.
        let of_t = |t: f64| {
            let spread = [-2.0, -1.0, 0.0, 1.0, 2.0];
            let shift = t * deviation(&spread) / 5.0_f64.sqrt();
            t_test(&spread.map(|value| value + shift)).expect("five values")
        };
        for t in [2.776, -2.776] {
            assert!((of_t(t).t - t).abs() < 1e-9 && (of_t(t).p - 0.05).abs() < 1e-4, "{:?}", of_t(t));
        }
        assert_eq!((t_test(&[1.0]), t_test(&[2.0, 2.0])), (None, None));
    }

    #[test]
    fn the_deviation_is_that_of_a_sample() {
        assert_eq!(mean(&[1.0, 2.0, 6.0]), 3.0);
        assert_eq!(deviation(&[1.0, 2.0, 6.0]), 7.0_f64.sqrt());
        assert_eq!((mean(&[]), deviation(&[]), deviation(&[5.0])), (0.0, 0.0, 0.0));
    }
}
