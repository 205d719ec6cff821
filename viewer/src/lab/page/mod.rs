//! A page of findings, before it is HTML or Markdown: plots, tables, pictures, and sentences with a verdict.

mod html;
mod markdown;
mod plot;
mod ticks;

pub use html::html;
pub use markdown::markdown;
pub use plot::{Line, Mark, Plot, Scale};

/// A whole page.
#[derive(Clone, Debug, Default)]
pub struct Page {
    pub title: String,
    /// What stands on top: names and values.
    pub facts: Vec<(String, String)>,
    pub sections: Vec<Section>,
}

/// A part of a page.
#[derive(Clone, Debug, Default)]
pub struct Section {
    pub title: String,
    /// What the thesis says of it, or what is to be seen.
    pub said: String,
    pub blocks: Vec<Block>,
    pub findings: Vec<Finding>,
}

#[derive(Clone, Debug)]
pub enum Block {
    /// Side by side as far as there is room.
    Plots(Vec<Plot>),
    Table(Table),
    Pictures(Vec<Picture>),
}

/// Names of columns, then rows; the first cell of a row says what it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    pub caption: String,
    pub head: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

/// A picture with a line below.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Of its file beside a Markdown page, without an ending.
    pub name: String,
    pub png: Vec<u8>,
    pub caption: String,
}

/// A sentence made of what was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    pub verdict: Verdict,
    /// What was claimed or wanted.
    pub claim: String,
    pub sentence: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The thesis's finding holds here; a target is reached.
    Holds,
    HoldsNot,
    /// It was not measured.
    Open,
}

impl Verdict {
    pub fn of(holds: bool) -> Self {
        if holds { Self::Holds } else { Self::HoldsNot }
    }

    /// A word for people.
    pub fn word(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::HoldsNot => "does not hold",
            Self::Open => "not measured",
        }
    }
}

impl Finding {
    pub fn new(holds: bool, claim: impl Into<String>, sentence: impl Into<String>) -> Self {
        Self { verdict: Verdict::of(holds), claim: claim.into(), sentence: sentence.into() }
    }
}

/// Three significant digits, and all digits before the point; nothing of what is no number.
pub fn rounded(value: f64) -> String {
    to_digits(value, digits(value))
}

/// A mean with its deviation, to as many digits.
pub fn with_deviation(mean: f64, deviation: f64) -> String {
    format!("{} ± {}", rounded(mean), to_digits(deviation, digits(mean)))
}

/// Digits after the point that make three significant ones.
fn digits(value: f64) -> usize {
    if value == 0.0 || !value.is_finite() {
        0
    } else {
        (2.0 - libm::log10(value.abs()).floor()).clamp(0.0, 9.0) as usize
    }
}

fn to_digits(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    let text = format!("{value:.digits$}");
    let (sign, number) = text.strip_prefix('-').map_or(("", &*text), |number| ("-", number));
    if digits > 0 || number.len() < 5 {
        return text;
    }
    // Thousands in groups, as people read them.
    let groups: Vec<&str> = (0..number.len().div_ceil(3))
        .rev()
        .map(|group| {
            let end = number.len() - 3 * group;
            &number[end.saturating_sub(3)..end]
        })
        .collect();
    format!("{sign}{}", groups.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_told_in_three_digits() {
        let told = [
            0.001_234_5,
            0.012_345,
            0.123_45,
            1.234_5,
            12.345,
            123.45,
            12_345.6,
            1_234_567.0,
            0.0,
            -20_000.0,
        ];
        let expected =
            ["0.00123", "0.0123", "0.123", "1.23", "12.3", "123", "12,346", "1,234,567", "0", "-20,000"];
        assert_eq!(told.map(rounded), expected);
        assert_eq!(
            (rounded(f64::NAN), with_deviation(20.0, 1.234)),
            ("–".to_owned(), "20.0 ± 1.2".to_owned())
        );
    }
}
