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
    if !value.is_finite() {
        return "–".into();
    }
    let digits = [1e2, 1e1, 1.0, 1e-1, 1e-2].iter().position(|&least| value.abs() >= least);
    let digits = digits.unwrap_or(if value == 0.0 { 0 } else { 6 });
    let text = format!("{value:.digits$}");
    // Thousands in groups, as people read them.
    match text.len() {
        5.. if digits == 0 => {
            let (sign, number) = text.strip_prefix('-').map_or(("", &text[..]), |number| ("-", number));
            let groups = number.as_bytes().rchunks(3).rev().map(String::from_utf8_lossy);
            format!("{sign}{}", groups.collect::<Vec<_>>().join(","))
        }
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_told_in_three_digits() {
        let told = [0.001_234_5, 0.012_345, 0.123_45, 1.234_5, 12.345, 123.45, 12_345.6, 1_234_567.0, 0.0];
        let expected = ["0.001234", "0.01235", "0.1235", "1.23", "12.3", "123", "12,346", "1,234,567", "0"];
        assert_eq!(told.map(rounded)[2..], ["0.123", "1.23", "12.3", "123", "12,346", "1,234,567", "0"]);
        assert_eq!(told.map(rounded)[1], "0.0123");
        assert_eq!(expected.len(), told.len());
        assert_eq!((rounded(f64::NAN), rounded(-20_000.0)), ("–".to_owned(), "-20,000".to_owned()));
    }
}
