//! How different the next landscapes are to be from the best guess.

use std::fmt;
use std::str::FromStr;

/// From 0, close variations, to 1, anything that there is; in hundredths, so that what a file says is what was meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Variety(u8);

impl Variety {
    /// Close variations.
    pub const MIN: Self = Self(0);
    /// Variations of one landscape that can be told apart.
    pub const CLOSE: Self = Self(15);
    /// What breeding does where nobody says otherwise.
    pub const USUAL: Self = Self(50);
    /// Anything that there is.
    pub const MAX: Self = Self(100);

    /// The nearest hundredth; `None` beyond 0 … 1.
    pub fn of(part: f64) -> Option<Self> {
        (0.0..=1.0).contains(&part).then(|| Self((part * 100.0).round() as u8))
    }

    /// 0 … 1.
    pub fn part(self) -> f32 {
        f32::from(self.0) / 100.0
    }
}

impl fmt::Display for Variety {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.part().fmt(f)
    }
}

impl FromStr for Variety {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        text.parse().ok().and_then(Self::of).ok_or("a number from 0, close variations, to 1, anything")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_hundredth_is_read_as_it_is_written() {
        for hundredth in 0..=100 {
            let variety = Variety(hundredth);
            assert_eq!(variety.to_string().parse(), Ok(variety));
        }
        for wrong in ["-0.1", "1.01", "NaN", "inf", "much", ""] {
            assert!(wrong.parse::<Variety>().is_err(), "{wrong}");
        }
    }
}
